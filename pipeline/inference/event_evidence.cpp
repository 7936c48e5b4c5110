// SPDX-License-Identifier: Apache-2.0
#include "pipeline/inference/event_evidence.hpp"

#include <algorithm>
#include <cmath>
#include <compare>
#include <cstdint>
#include <cstdlib>
#include <iterator>
#include <numeric>
#include <optional>
#include <span>
#include <string>
#include <tuple>
#include <utility>

#include "core/clip/frame_stream.hpp"
#include "core/error.hpp"
#include "core/parallel.hpp"
#include "graph/events/event_family.hpp"
#include "pipeline/inference/event_paths.hpp"
#include "pipeline/inference/event_strokes.hpp"
#include "pipeline/inference/frame_likeness.hpp"
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
constexpr std::size_t kFollowed = 3;  // frames in which a joint differs from the strokes that it joins
constexpr int kSameFrames = 2;        // between two interpretations of one event
constexpr double kSamePlace = 10;     // px
constexpr double kSameJoint = 15;     // px between opposite events of one place
constexpr double kMost = 0.5;         // share of the interpretations
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
double path_contrast(const graph::TracedEvent& traced, const MotionIndex& motion, double white) {
  const graph::AttributeGraph& graph = motion.graph(traced.path_frame);
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
  series.followed = of_stroke ? 0 : kFollowed;
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

/// One interpretation of the clip: a motion graph, its events, and an index of its patches.
struct Reading {
  explicit Reading(const graph::MotionGraph& motion)
      : index(motion), traced(graph::trace_stroke_events(motion)), of_frame(motion.sketch.frames.size()) {
    for (std::size_t k = 0; k < traced.size(); ++k)
      of_frame[static_cast<std::size_t>(traced[k].event.frame)].push_back(k);
  }
  /// Visits the number of each event at most `reach` frames from a frame.
  template <class Visit>
  void each_near(int frame, int reach, const Visit& visit) const {
    const int last = std::min(frame + reach, static_cast<int>(of_frame.size()) - 1);
    for (int t = std::max(0, frame - reach); t <= last; ++t)
      for (const std::size_t k : of_frame[static_cast<std::size_t>(t)]) visit(k);
  }
  MotionIndex index;
  std::vector<graph::TracedEvent> traced;
  std::vector<std::vector<std::size_t>> of_frame;  // numbers of their events
};

/// An event with its members: pairs of an interpretation's number and the event's number in it.
struct PooledEvent {
  WeighedEvent weighed;
  std::vector<std::pair<std::size_t, std::size_t>> members;
};

/// Returns whether the shorter of two strokes that appear or vanish is on the longer: a part of it that one
/// interpretation shows a frame earlier or later than the rest.
bool is_part(const Reading& a, const graph::TracedEvent& of_a, const Reading& b,
             const graph::TracedEvent& of_b) {
  constexpr double kBeside = 5, kShare = 0.5;  // px; of the patches
  const bool is_longer = of_a.path.size() > of_b.path.size();
  const auto& [shorter, of_shorter] = is_longer ? std::tie(b, of_b) : std::tie(a, of_a);
  const auto& [longer, of_longer] = is_longer ? std::tie(a, of_a) : std::tie(b, of_b);
  const auto path_of = [](const Reading& reading, const graph::TracedEvent& traced) {
    const graph::AttributeGraph& graph = reading.index.graph(traced.path_frame);
    Path path;
    for (const graph::VertexId id : traced.path)
      path.push_back(graph.patch(static_cast<std::uint32_t>(graph.index_of(id))));
    return path;
  };
  const Path whole = path_of(longer, of_longer), part = path_of(shorter, of_shorter);
  const auto on_whole = std::ranges::count_if(part, [&](const graph::Patch& patch) {
    return std::ranges::any_of(whole, [&](const graph::Patch& other) {
      return same_kind(patch, other) && distance(patch.position, other.position) <= kBeside;
    });
  });
  return static_cast<double>(on_whole) >= kShare * static_cast<double>(part.size());
}

/// Adds an interpretation's events as members of known events; if it `brings_events`, the others become new
/// ones, unless they are parts of strokes that appear or vanish in another interpretation.
void add_events(std::span<const Reading> readings, std::size_t number, bool brings_events,
                std::vector<PooledEvent>& events) {
  const Reading& reading = readings[number];
  struct Pair {
    double apart = 0;
    std::size_t known = 0, other = 0;
    auto operator<=>(const Pair&) const = default;
  };
  std::vector<Pair> pairs;
  for (std::size_t i = 0; i < events.size(); ++i)
    reading.each_near(events[i].weighed.event.frame, kSameFrames, [&](std::size_t k) {
      const graph::Event &a = events[i].weighed.event, &b = reading.traced[k].event;
      if (graph::detail::family(a.type) != graph::detail::family(b.type)) return;
      const double apart = distance(a.position, b.position);
      if (apart <= kSamePlace) pairs.push_back({apart, i, k});
    });
  std::ranges::sort(pairs);
  std::vector<bool> is_taken(events.size(), false), is_known(reading.traced.size(), false);
  for (const Pair& pair : pairs) {
    if (is_taken[pair.known] || is_known[pair.other]) continue;
    is_taken[pair.known] = is_known[pair.other] = true;
    events[pair.known].members.emplace_back(number, pair.other);
  }
  if (!brings_events) return;
  const std::size_t known = events.size();
  for (std::size_t i = 0; i < known; ++i) {
    if (!events[i].weighed.evidence.of_stroke) continue;
    const std::size_t first = events[i].members.front().first;
    const graph::TracedEvent& whole = readings[first].traced[events[i].members.front().second];
    reading.each_near(events[i].weighed.event.frame, kSameFrames, [&](std::size_t k) {
      const graph::TracedEvent& part = reading.traced[k];
      if (!is_known[k] && part.event.type == whole.event.type &&
          is_part(readings[first], whole, reading, part))
        is_known[k] = true;
    });
  }
  for (std::size_t k = 0; k < is_known.size(); ++k) {
    if (is_known[k]) continue;
    PooledEvent& added = events.emplace_back();
    added.weighed.event = reading.traced[k].event;
    added.weighed.evidence.of_stroke = is_of_stroke(added.weighed.event.type);
    added.members.emplace_back(number, k);
    if (number > 0) name_strokes(added.weighed.event, reading.index, readings.front().index);
  }
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

/// Finds the number of frames between each event and opposite ones in its place, bounded by the clip.
/// Opposite events are those of the sketches without flicker removal, and those that most interpretations
/// have. A pooled opposite in the same frame counts as one frame apart, since some interpretation has it one
/// frame off.
void find_opposites(std::span<PooledEvent> events, std::span<const Reading> unsteadied, int frames) {
  std::vector<std::vector<std::size_t>> common(static_cast<std::size_t>(frames));
  for (std::size_t k = 0; k < events.size(); ++k)
    if (events[k].weighed.evidence.agreement > kMost)
      common[static_cast<std::size_t>(events[k].weighed.event.frame)].push_back(k);
  for (PooledEvent& pooled : events) {
    WeighedEvent& weighed = pooled.weighed;
    const int frame = weighed.event.frame;
    weighed.evidence.since = frame, weighed.evidence.until = frames - frame;
    for (const Reading& reading : unsteadied)
      reading.each_near(frame, mcmc::kFramesUntilLong,
                        [&](std::size_t k) { note_opposite(reading.traced[k].event, weighed); });
    bool is_undone = false;
    const int last = std::min(frame + mcmc::kFramesUntilLong, frames - 1);
    for (int t = std::max(0, frame - mcmc::kFramesUntilLong); t <= last; ++t)
      for (const std::size_t k : common[static_cast<std::size_t>(t)])
        is_undone |= note_opposite(events[k].weighed.event, weighed);
    double& nearer =
        weighed.evidence.since < weighed.evidence.until ? weighed.evidence.since : weighed.evidence.until;
    if (is_undone) nearer = std::min(nearer, 1.0);
  }
}

/// A pooled event, to be measured in some of its members.
struct Measurement {
  int frame = 0;  // of the last member
  std::size_t pooled = 0;
  std::vector<std::pair<std::size_t, std::size_t>> members = {};  // in order of their frames
};

/// Lists the measurements, in order of the frames: each event in the interpretations with flicker removed
/// that have it, otherwise in the others. Events that no image could make likely are left out.
std::vector<Measurement> plan_measurements(std::span<const PooledEvent> events,
                                           std::span<const Reading> readings, std::size_t steadied,
                                           std::size_t own) {
  const auto frame_of = [&](const std::pair<std::size_t, std::size_t>& member) {
    return readings[member.first].traced[member.second].event.frame;
  };
  std::vector<Measurement> result;
  for (std::size_t i = 0; i < events.size(); ++i) {
    mcmc::ChangeEvidence best = events[i].weighed.evidence;
    best.log_factor = mcmc::kMostChangeFactor;
    if (mcmc::change_log_odds(best) < kLeastLogOdds) continue;
    Measurement one{0, i};
    const bool is_steadied = events[i].members.front().first < steadied;
    std::ranges::copy_if(events[i].members, std::back_inserter(one.members),
                         [&](const auto& member) { return member.first < (is_steadied ? steadied : own); });
    std::ranges::stable_sort(one.members, {}, frame_of);
    one.frame = frame_of(one.members.back());
    result.push_back(std::move(one));
  }
  std::ranges::stable_sort(result, {}, &Measurement::frame);
  return result;
}

/// Measures one event: the mean factor of its members, while they could still make it likely.
void measure(const Measurement& one, std::span<const Reading> readings, const FrameWindow& window, int frames,
             mcmc::ChangeEvidence& evidence) {
  evidence.log_factor = mcmc::kMostChangeFactor;
  for (const auto& [reading, event] : one.members) {
    const double factor =
        measure_factor(readings[reading].traced[event], readings[reading].index, window, frames);
    evidence.log_factor += (factor - mcmc::kMostChangeFactor) / static_cast<double>(one.members.size());
    if (mcmc::change_log_odds(evidence) < kLeastLogOdds) break;
  }
  const auto& [reading, event] = one.members.back();
  evidence.likeness =
      measure_likeness(window, one.frame, readings[reading].traced[event].event.position, frames);
}

/// Measures all events in one pass over the clip.
void measure_all(core::FrameSource& source, std::span<Reading> readings, int frames,
                 std::span<const Measurement> measurements, std::span<PooledEvent> events,
                 const core::Context& context) {
  FrameWindow window;
  std::size_t done = 0;
  const auto measure_ready = [&](int end) {
    window.prepare(context);
    std::size_t ready = done;
    while (ready < measurements.size() && std::min(frames, measurements[ready].frame + kReach) <= end)
      ++ready;
    core::parallel_for(readings.size(), context,
                       [&](std::size_t k) { readings[k].index.hold(window.first(), std::min(frames, end)); });
    core::parallel_for(ready - done, context, [&](std::size_t k) {
      const Measurement& one = measurements[done + k];
      measure(one, readings, window, frames, events[one.pooled].weighed.evidence);
    });
    done = ready;
    window.drop_before(end - 2 * kReach - 2 * kSameFrames);  // members are at most this far apart
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

std::vector<WeighedEvent> weigh_events(core::FrameSource& source, const ClipReadings& readings,
                                       const core::Context& context) {
  if (readings.steadied.empty()) throw core::InputError("events: no reading of the clip");
  std::vector<Reading> all;
  const std::size_t frames = readings.steadied.front().sketch.frames.size();
  for (const auto* some : {&readings.steadied, &readings.unsteadied, &readings.in_noise})
    for (const graph::MotionGraph& motion : *some) {
      if (motion.sketch.frames.size() != frames)
        throw core::InputError("events: readings of " + std::to_string(frames) + " and " +
                               std::to_string(motion.sketch.frames.size()) + " frames");
      all.emplace_back(motion);
    }
  const std::size_t steadied = readings.steadied.size(), own = steadied + readings.unsteadied.size();
  const double white = brightest_patch(readings.steadied.front().sketch);
  std::vector<PooledEvent> pooled;
  for (std::size_t k = 0; k < all.size(); ++k) add_events(all, k, k < own, pooled);
  for (PooledEvent& event : pooled) {
    auto& evidence = event.weighed.evidence;
    evidence.log_factor = -mcmc::kMostChangeFactor;  // until it is measured
    evidence.contrast = 0;
    for (const auto& [reading, number] : event.members)
      if (reading < own)
        evidence.contrast = std::max(evidence.contrast,
                                     path_contrast(all[reading].traced[number], all[reading].index, white));
    evidence.agreement = static_cast<double>(event.members.size()) / static_cast<double>(all.size());
  }
  find_opposites(pooled, std::span<const Reading>(all).subspan(steadied, own - steadied),
                 static_cast<int>(frames));
  const auto measurements = plan_measurements(pooled, all, steadied, own);
  measure_all(source, all, static_cast<int>(frames), measurements, pooled, context);
  std::vector<WeighedEvent> result;
  for (PooledEvent& event : pooled) result.push_back(std::move(event.weighed));
  return result;
}

}  // namespace emberfold::pipeline
