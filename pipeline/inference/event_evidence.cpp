// SPDX-License-Identifier: Apache-2.0
#include "pipeline/inference/event_evidence.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <numeric>
#include <optional>
#include <span>
#include <string>
#include <utility>

#include "core/clip/frame_stream.hpp"
#include "core/error.hpp"
#include "core/parallel.hpp"
#include "graph/events/event_family.hpp"
#include "pipeline/inference/event_paths.hpp"
#include "pipeline/inference/visible_contrast.hpp"
#include "sketch/refinement/amplitude.hpp"

namespace emberfold::pipeline {

namespace {

constexpr int kReach = 10;               // frames on each side of an event
constexpr double kSlipAcross = 1.5;      // px across the curve that are searched for a propagated patch
constexpr int kLevelFrames = 4;          // next to the change, in which the path counts as fully present
constexpr double kLeastLevel = 0.15;     // share of a patch's own amplitude
constexpr double kMostMeasurements = 3;  // independent ones per frame, for a stroke
constexpr double kMeasurementsOfJoint = 2;
constexpr double kSameJoint = 15;     // px between opposite events of one place
constexpr double kLeastLogOdds = -4;  // an event must exceed it under the most favourable images
constexpr std::size_t kWeakest = 3;   // one in this number of a joint's patches decides whether it is open
constexpr double kBorder = 10;        // px within the picture's border: patches this near may have left it

using graph::Point;
using graph::detail::Family;

bool is_of_stroke(graph::EventType type) {
  return type == graph::EventType::birth || type == graph::EventType::death;
}

bool appears(graph::EventType type) {
  using enum graph::EventType;
  return type == birth || type == merge || type == connect;
}

/// Amplitude of a path, and the share of its patches that are in view.
struct PathAmplitude {
  double amplitude = 0, in_view = 0;
};

bool is_in_view(const cv::Mat& levels, Point p) {
  return p.x >= kBorder && p.y >= kBorder && p.x < levels.cols - kBorder && p.y < levels.rows - kBorder;
}

/// Measures a path in a frame: a stroke by its mean, a joint by its weakest patches.
PathAmplitude measure_path(const cv::Mat& levels, const Path& path, bool of_stroke) {
  std::vector<double> all;
  for (const graph::Patch& patch : path)
    if (is_in_view(levels, patch.position))
      all.push_back(sketch::measure_amplitude(levels, patch, kSlipAcross).value);
  if (all.empty()) return {};
  const std::size_t count = of_stroke ? all.size() : std::max<std::size_t>(1, all.size() / kWeakest);
  std::ranges::sort(all);
  const double sum = std::accumulate(all.begin(), all.begin() + static_cast<std::ptrdiff_t>(count), 0.0);
  return {sum / static_cast<double>(count),
          static_cast<double>(all.size()) / static_cast<double>(path.size())};
}

/// Returns the upper median of the amplitudes in the frames next to the change where the path is present.
double level_beside(const mcmc::ChangeSeries& series) {
  std::vector<double> levels;
  for (std::size_t k = 0; k < kLevelFrames; ++k) {
    if (series.appears ? series.at + k >= series.amplitude.size() : k >= series.at) break;
    const std::size_t i = series.appears ? series.at + k : series.at - 1 - k;
    if (series.in_view[i] > 0) levels.push_back(series.amplitude[i]);
  }
  std::ranges::sort(levels);
  return levels.empty() ? kLeastLevel : std::max(kLeastLevel, levels[levels.size() / 2]);
}

/// Returns the mean visible contrast of an event's patches.
double path_contrast(const graph::TracedEvent& traced, const graph::MotionGraph& motion, double white) {
  const graph::AttributeGraph& graph = motion.sketch.frames[static_cast<std::size_t>(traced.path_frame)];
  double sum = 0;
  for (const graph::VertexId id : traced.path)
    sum += visible_contrast(graph.patch(static_cast<std::uint32_t>(graph.index_of(id))), white);
  return sum / static_cast<double>(traced.path.size());
}

/// Returns the log Bayes factor of an event whose frames are all in the window.
double measure_factor(const graph::TracedEvent& traced, const MotionIndex& motion, const FrameWindow& window,
                      int frames) {
  const graph::Event& event = traced.event;
  const bool of_stroke = is_of_stroke(event.type);
  const int first = std::max(0, event.frame - kReach), last = std::min(frames - 1, event.frame + kReach - 1);
  const auto guesses = follow_event(traced, motion, window, first, last);
  mcmc::ChangeSeries series;
  series.at = static_cast<std::size_t>(event.frame - first);
  series.appears = appears(event.type);
  series.weight =
      of_stroke ? std::min(kMostMeasurements, static_cast<double>(traced.path.size())) : kMeasurementsOfJoint;
  for (int t = first; t <= last; ++t) {
    std::optional<PathAmplitude> most;
    for (const Path& path : guesses[static_cast<std::size_t>(t - first)]) {
      const PathAmplitude one = measure_path(window.levels(t), path, of_stroke);
      if (!most || (one.in_view > 0 && (most->in_view <= 0 || one.amplitude > most->amplitude))) most = one;
    }
    series.amplitude.push_back(most->amplitude);
    series.in_view.push_back(most->in_view);
  }
  series.level = level_beside(series);
  return mcmc::log_change_factor(series);
}

Family opposite(Family family) {
  switch (family) {
    case Family::birth:
      return Family::death;
    case Family::death:
      return Family::birth;
    case Family::unite:
      return Family::separate;
    case Family::separate:
      return Family::unite;
  }
  return family;
}

/// Updates an event's distance in frames to an opposite one in its place, if `other` is one. Returns whether
/// both are in one frame.
bool note_opposite(const graph::Event& other, WeighedEvent& weighed) {
  const graph::Event& event = weighed.event;
  if (graph::detail::family(other.type) != opposite(graph::detail::family(event.type)) ||
      distance(other.position, event.position) > kSameJoint)
    return false;
  if (other.frame == event.frame) return true;
  double& side = other.frame < event.frame ? weighed.evidence.since : weighed.evidence.until;
  side = std::min(side, static_cast<double>(std::abs(other.frame - event.frame)));
  return false;
}

/// Finds the number of frames between each event and opposite ones in its place, bounded by the clip. Where
/// an opposite one is in the same frame, it is one.
void find_opposites(std::span<const graph::TracedEvent> traced, int frames, std::span<WeighedEvent> weighed) {
  std::vector<std::vector<std::size_t>> of_frame(static_cast<std::size_t>(frames));
  for (std::size_t k = 0; k < traced.size(); ++k)
    of_frame[static_cast<std::size_t>(traced[k].event.frame)].push_back(k);
  for (WeighedEvent& one : weighed) {
    const int frame = one.event.frame;
    one.evidence.since = frame, one.evidence.until = frames - frame;
    bool is_undone = false;
    const int last = std::min(frame + mcmc::kFramesUntilLong, frames - 1);
    for (int t = std::max(0, frame - mcmc::kFramesUntilLong); t <= last; ++t)
      for (const std::size_t k : of_frame[static_cast<std::size_t>(t)])
        is_undone |= note_opposite(traced[k].event, one);
    double& nearer = one.evidence.since < one.evidence.until ? one.evidence.since : one.evidence.until;
    if (is_undone) nearer = std::min(nearer, 1.0);
  }
}

/// Returns whether the most favourable images could make an event likely.
bool may_be_likely(mcmc::ChangeEvidence evidence) {
  evidence.log_factor = mcmc::kMostChangeFactor;
  return mcmc::change_log_odds(evidence) >= kLeastLogOdds;
}

/// Measures the events of these numbers, in the order of their frames, in one pass over the clip.
void measure_all(core::FrameSource& source, const graph::MotionGraph& motion,
                 std::span<const graph::TracedEvent> traced, std::span<const std::size_t> order,
                 std::span<WeighedEvent> weighed, const core::Context& context) {
  const int frames = static_cast<int>(motion.sketch.frames.size());
  MotionIndex index(motion);
  FrameWindow window;
  std::size_t done = 0;
  const auto measure_ready = [&](int end) {
    window.prepare(context);
    std::size_t ready = done;
    while (ready < order.size() && std::min(frames, traced[order[ready]].event.frame + kReach) <= end)
      ++ready;
    index.hold(window.first(), std::min(frames, end));
    core::parallel_for(ready - done, context, [&](std::size_t k) {
      const graph::TracedEvent& one = traced[order[done + k]];
      mcmc::ChangeEvidence& evidence = weighed[order[done + k]].evidence;
      evidence.log_factor = measure_factor(one, index, window, frames);
    });
    done = ready;
    window.drop_before(end - 2 * kReach);
  };
  const auto& info = source.info();
  const int batch = frames_at_once(info);
  const int read = core::stream_frames(
      source, "events", frames, context,
      [&](int, const cv::Mat& frame) { return make_window_frame(frame, info); },
      [&](int t, WindowFrame frame) {
        window.push(std::move(frame));
        if ((t + 1) % batch == 0) measure_ready(t + 1);
      });
  if (read != frames)
    throw core::InputError("events: the clip has " + std::to_string(read) + " frames, its graphs " +
                           std::to_string(frames));
  measure_ready(read);
}

}  // namespace

std::vector<WeighedEvent> weigh_events(core::FrameSource& source, const graph::MotionGraph& motion,
                                       const core::Context& context) {
  const auto traced = graph::trace_stroke_events(motion);
  const double white = brightest_patch(motion.sketch);
  std::vector<WeighedEvent> weighed;
  for (const graph::TracedEvent& one : traced) {
    mcmc::ChangeEvidence evidence;
    evidence.log_factor = -mcmc::kMostChangeFactor;  // until it is measured
    evidence.of_stroke = is_of_stroke(one.event.type);
    evidence.contrast = path_contrast(one, motion, white);
    weighed.push_back({one.event, evidence});
  }
  find_opposites(traced, static_cast<int>(motion.sketch.frames.size()), weighed);
  std::vector<std::size_t> order;
  for (std::size_t k = 0; k < weighed.size(); ++k)
    if (may_be_likely(weighed[k].evidence)) order.push_back(k);
  std::ranges::stable_sort(order, {}, [&](std::size_t k) { return traced[k].event.frame; });
  measure_all(source, motion, traced, order, weighed, context);
  return weighed;
}

}  // namespace emberfold::pipeline
