// SPDX-License-Identifier: Apache-2.0
#include "pipeline/inference/event_posterior.hpp"

#include <algorithm>
#include <compare>
#include <cstdlib>
#include <numeric>
#include <string>
#include <utility>

#include "core/clip/frame_stream.hpp"
#include "core/error.hpp"
#include "core/parallel.hpp"
#include "graph/events/event_clusters.hpp"
#include "mcmc/inference/change_posterior.hpp"
#include "pipeline/inference/event_paths.hpp"
#include "sketch/refinement/amplitude.hpp"

namespace emberfold::pipeline {

namespace {

constexpr int kReach = 10;               // frames to each side of an event
constexpr double kSlipAcross = 1.5;      // px across, of a patch that is carried along
constexpr int kLevelFrames = 4;          // in which what appears is taken to be there in full
constexpr double kLeastLevel = 0.15;     // of a patch's own amplitude
constexpr double kMostMeasurements = 3;  // independent ones in a frame, of a stroke
constexpr double kMeasurementsOfJoint = 2;
constexpr std::size_t kFollowed = 3;  // frames in which what joins two strokes can be told apart from them
constexpr int kSameFrames = 2;        // between two readings of one event
constexpr double kSamePlace = 10;     // px
constexpr double kInOneReading = 6;   // nats against an event that another reading lacks
constexpr std::size_t kWeakest = 3;   // one in so many patches of a joint decides whether it is open

bool is_of_stroke(graph::EventType type) {
  return type == graph::EventType::birth || type == graph::EventType::death;
}

/// How strongly a path shows: a stroke on average, a joint at its weakest.
double path_amplitude(const cv::Mat& levels, const Path& path, bool of_stroke) {
  std::vector<double> all;
  for (const graph::Patch& patch : path) all.push_back(sketch::measure_amplitude(levels, patch, kSlipAcross));
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

/// An event and its log Bayes factor.
struct Weighed {
  graph::TracedEvent traced;
  double factor = 0;
};

/// The events of one motion graph, measured in order of their frames.
class Reading {
 public:
  explicit Reading(const graph::MotionGraph& motion)
      : index_(motion), frames_(static_cast<int>(motion.sketch.frames.size())) {
    for (graph::TracedEvent& traced : graph::trace_stroke_events(motion))
      events_.push_back({std::move(traced)});
  }
  /// Measures all events whose frames come before `end` and are in the window.
  void measure(const FrameWindow& window, int end, const core::Context& context) {
    std::size_t ready = done_;
    while (ready < events_.size() && std::min(frames_, events_[ready].traced.event.frame + kReach) <= end)
      ++ready;
    core::parallel_for(ready - done_, context, [&](std::size_t k) {
      Weighed& event = events_[done_ + k];
      event.factor = event_factor(event.traced, index_, window, frames_);
    });
    done_ = ready;
  }
  [[nodiscard]] const std::vector<Weighed>& events() const { return events_; }

 private:
  MotionIndex index_;
  int frames_;
  std::vector<Weighed> events_;
  std::size_t done_ = 0;
};

/// Adds the events of another reading. One that both have is kept once, with the smaller factor; one that
/// either lacks is doubtful.
void add_events(const std::vector<Weighed>& others, std::vector<Weighed>& events) {
  struct Pair {
    double apart = 0;
    std::size_t known = 0, other = 0;
    auto operator<=>(const Pair&) const = default;
  };
  std::vector<Pair> pairs;
  for (std::size_t i = 0; i < events.size(); ++i)
    for (std::size_t k = 0; k < others.size(); ++k) {
      const graph::Event &a = events[i].traced.event, &b = others[k].traced.event;
      const double apart = distance(a.position, b.position);
      if (graph::detail::family(a.type) == graph::detail::family(b.type) &&
          std::abs(a.frame - b.frame) <= kSameFrames && apart <= kSamePlace)
        pairs.push_back({apart, i, k});
    }
  std::ranges::sort(pairs);
  std::vector<bool> is_taken(events.size(), false), is_known(others.size(), false);
  for (const Pair& pair : pairs) {
    if (is_taken[pair.known] || is_known[pair.other]) continue;
    is_taken[pair.known] = is_known[pair.other] = true;
    events[pair.known].factor = std::min(events[pair.known].factor, others[pair.other].factor);
  }
  for (std::size_t i = 0; i < is_taken.size(); ++i)
    if (!is_taken[i]) events[i].factor -= kInOneReading;
  for (std::size_t k = 0; k < others.size(); ++k) {
    if (is_known[k]) continue;
    events.push_back(others[k]);
    events.back().factor -= kInOneReading;
    events.back().traced.event.before.clear(), events.back().traced.event.after.clear();
  }
}

/// Returns the events with their probabilities: of the events of strokes, and of those of joints.
std::vector<graph::Event> believed(const std::vector<Weighed>& weighed) {
  std::vector<graph::Event> events;
  for (const bool of_stroke : {true, false}) {
    std::vector<double> factors;
    const std::size_t first = events.size();
    for (const Weighed& one : weighed)
      if (is_of_stroke(one.traced.event.type) == of_stroke)
        events.push_back(one.traced.event), factors.push_back(one.factor);
    const auto probabilities = mcmc::change_probabilities(factors);
    for (std::size_t k = 0; k < probabilities.size(); ++k) events[first + k].probability = probabilities[k];
  }
  graph::sort_events(events);
  return events;
}

}  // namespace

std::vector<graph::Event> event_posterior(core::FrameSource& source,
                                          std::span<const graph::MotionGraph> readings,
                                          const core::Context& context) {
  if (readings.empty()) throw core::InputError("events: no reading of the clip");
  const std::size_t frames = readings.front().sketch.frames.size();
  std::vector<Reading> all;
  for (const graph::MotionGraph& motion : readings) all.emplace_back(motion);
  FrameWindow window;
  const auto measure = [&](int end) {
    window.prepare(context);
    for (Reading& reading : all) reading.measure(window, end, context);
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
  for (const graph::MotionGraph& motion : readings)
    if (motion.sketch.frames.size() != static_cast<std::size_t>(read))
      throw core::InputError("events: the clip has " + std::to_string(read) + " frames, its graphs " +
                             std::to_string(motion.sketch.frames.size()));
  measure(read);
  std::vector<Weighed> events = all.front().events();
  for (std::size_t k = 1; k < all.size(); ++k) add_events(all[k].events(), events);
  return believed(events);
}

}  // namespace emberfold::pipeline
