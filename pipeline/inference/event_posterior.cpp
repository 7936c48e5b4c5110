// SPDX-License-Identifier: Apache-2.0
#include "pipeline/inference/event_posterior.hpp"

#include <algorithm>
#include <array>
#include <numeric>
#include <string>
#include <utility>

#include "core/clip/frame_stream.hpp"
#include "core/error.hpp"
#include "core/parallel.hpp"
#include "mcmc/inference/change_posterior.hpp"
#include "pipeline/inference/event_paths.hpp"
#include "sketch/refinement/amplitude.hpp"

namespace emberfold::pipeline {

namespace {

constexpr int kReach = 10;               // frames to each side of an event
constexpr double kSlip = 1.5;            // px across, of a patch that is carried along
constexpr int kLevelFrames = 4;          // in which what appears is taken to be there in full
constexpr double kLeastLevel = 0.15;     // of a patch's own amplitude
constexpr double kMostMeasurements = 3;  // independent ones in a frame, of a stroke
constexpr double kMeasurementsOfJoint = 2;
constexpr std::size_t kFollowed = 3;  // frames in which what joins two strokes can be told apart from them
constexpr std::size_t kWeakest = 3;   // one in so many patches of a joint decides whether it is open

bool is_of_stroke(graph::EventType type) {
  return type == graph::EventType::birth || type == graph::EventType::death;
}

/// How strongly a path shows: a stroke on average, a joint at its weakest.
double path_amplitude(const cv::Mat& levels, const Path& path, bool of_stroke) {
  std::vector<double> all;
  for (const graph::Patch& patch : path) all.push_back(sketch::measure_amplitude(levels, patch, kSlip));
  const std::size_t count = of_stroke ? all.size() : std::max<std::size_t>(1, all.size() / kWeakest);
  std::ranges::sort(all);
  return std::accumulate(all.begin(), all.begin() + static_cast<std::ptrdiff_t>(count), 0.0) /
         static_cast<double>(count);
}

/// Returns the log Bayes factor of an event whose frames are all in the window.
double event_factor(const graph::TracedEvent& traced, const MotionIndex& motion, const FrameWindow& window,
                    int frames) {
  using enum graph::EventType;
  const graph::Event& event = traced.event;
  const bool of_stroke = is_of_stroke(event.type);
  const int first = std::max(0, event.frame - kReach), last = std::min(frames - 1, event.frame + kReach - 1);
  const auto guesses = follow_event(traced, motion, window, first, last);
  mcmc::ChangeSeries series;
  series.at = static_cast<std::size_t>(event.frame - first);
  series.appears = event.type == birth || event.type == merge || event.type == connect;
  series.weight =
      of_stroke ? std::min(kMostMeasurements, static_cast<double>(traced.path.size())) : kMeasurementsOfJoint;
  series.followed = of_stroke ? 0 : kFollowed;
  for (int t = first; t <= last; ++t) {
    double most = -1e9;
    for (const Path& path : guesses[static_cast<std::size_t>(t - first)])
      most = std::max(most, path_amplitude(window.levels(t), path, of_stroke));
    series.amplitude.push_back(most);
  }
  std::vector<double> there;
  for (int k = 0; k < kLevelFrames; ++k) {
    const int t = series.appears ? event.frame + k : event.frame - 1 - k;
    if (t >= first && t <= last) there.push_back(series.amplitude[static_cast<std::size_t>(t - first)]);
  }
  std::ranges::sort(there);
  series.level = std::max(kLeastLevel, there[there.size() / 2]);
  return mcmc::log_change_factor(series);
}

/// Sets the probabilities of the events of strokes, and those of joints.
void set_probabilities(std::vector<graph::Event>& events, const std::vector<double>& factors) {
  for (const bool of_stroke : {true, false}) {
    std::vector<std::size_t> which;
    std::vector<double> of_these;
    for (std::size_t k = 0; k < events.size(); ++k)
      if (is_of_stroke(events[k].type) == of_stroke) which.push_back(k), of_these.push_back(factors[k]);
    const auto probabilities = mcmc::change_probabilities(of_these);
    for (std::size_t k = 0; k < which.size(); ++k) events[which[k]].probability = probabilities[k];
  }
}

}  // namespace

std::vector<graph::Event> event_posterior(core::FrameSource& source, const graph::MotionGraph& motion,
                                          const core::Context& context) {
  const auto traced = graph::trace_stroke_events(motion);
  const int frames = static_cast<int>(motion.sketch.frames.size());
  const MotionIndex index(motion);
  std::vector<double> factors(traced.size());
  FrameWindow window;
  std::size_t done = 0;
  const auto measure = [&](int end) {  // all events whose frames come before `end`
    std::size_t ready = done;
    while (ready < traced.size() && std::min(frames, traced[ready].event.frame + kReach) <= end) ++ready;
    window.prepare(context);
    core::parallel_for(ready - done, context, [&](std::size_t k) {
      factors[done + k] = event_factor(traced[done + k], index, window, frames);
    });
    done = ready;
    window.drop_before(end - 2 * kReach);
  };
  const auto& info = source.info();
  const int batch = static_cast<int>(core::frames_at_once(info.width, info.height, info.channels));
  const int read = core::stream_frames(
      source, "events", frames, context,
      [&](int, const cv::Mat& frame) { return core::to_levels(frame, info); },
      [&](int t, cv::Mat levels) {
        window.push(std::move(levels));
        if ((t + 1) % batch == 0) measure(t + 1);
      });
  if (read != frames)
    throw core::InputError("events: the clip has " + std::to_string(read) + " frames, its graphs " +
                           std::to_string(frames));
  measure(frames);
  std::vector<graph::Event> events;
  for (const graph::TracedEvent& one : traced) events.push_back(one.event);
  set_probabilities(events, factors);
  return events;
}

}  // namespace emberfold::pipeline
