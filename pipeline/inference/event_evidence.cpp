// SPDX-License-Identifier: Apache-2.0
#include "pipeline/inference/event_evidence.hpp"

#include <algorithm>
#include <compare>
#include <cstdlib>
#include <limits>
#include <numeric>
#include <span>
#include <string>
#include <utility>

#include "core/clip/frame_stream.hpp"
#include "core/error.hpp"
#include "core/parallel.hpp"
#include "graph/events/event_clusters.hpp"
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
constexpr double kSameJoint = 15;     // px between opposite events of one place
constexpr std::size_t kWeakest = 3;   // one in so many patches of a joint decides whether it is open

using graph::detail::Family;

bool is_of_stroke(graph::EventType type) {
  return type == graph::EventType::birth || type == graph::EventType::death;
}

bool appears(graph::EventType type) {
  using enum graph::EventType;
  return type == birth || type == merge || type == connect;
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

/// Returns the upper median of the amplitudes of the frames next to the change in which the path is there.
double level_beside(const mcmc::ChangeSeries& series) {
  std::vector<double> levels;
  for (std::size_t k = 0; k < kLevelFrames; ++k) {
    if (series.appears ? series.at + k >= series.amplitude.size() : k >= series.at) break;
    levels.push_back(series.amplitude[series.appears ? series.at + k : series.at - 1 - k]);
  }
  std::ranges::sort(levels);
  return std::max(kLeastLevel, levels[levels.size() / 2]);
}

/// Measures what the images show of an event whose frames are all in the window.
mcmc::ChangeEvidence measure_event(const graph::TracedEvent& traced, const MotionIndex& motion,
                                   const FrameWindow& window, int frames) {
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
    double most = -std::numeric_limits<double>::max();
    for (const Path& path : guesses[static_cast<std::size_t>(t - first)])
      most = std::max(most, path_amplitude(window.levels(t), path, of_stroke));
    series.amplitude.push_back(most);
  }
  series.level = level_beside(series);
  mcmc::ChangeEvidence evidence;
  evidence.of_stroke = of_stroke;
  evidence.log_factor = mcmc::log_change_factor(series);
  return evidence;
}

/// The events of one motion graph, measured in order of their frames.
class Reading {
 public:
  explicit Reading(const graph::MotionGraph& motion)
      : index_(motion), frames_(static_cast<int>(motion.sketch.frames.size())) {
    traced_ = graph::trace_stroke_events(motion);
    events_.resize(traced_.size());
    for (std::size_t i = 0; i < traced_.size(); ++i) events_[i].event = traced_[i].event;
  }
  /// Measures all events whose frames come before `end` and are in the window.
  void measure(const FrameWindow& window, int end, const core::Context& context) {
    std::size_t ready = done_;
    while (ready < traced_.size() && std::min(frames_, traced_[ready].event.frame + kReach) <= end) ++ready;
    core::parallel_for(ready - done_, context, [&](std::size_t k) {
      events_[done_ + k].evidence = measure_event(traced_[done_ + k], index_, window, frames_);
    });
    done_ = ready;
  }
  [[nodiscard]] const std::vector<WeighedEvent>& events() const { return events_; }

 private:
  MotionIndex index_;
  int frames_;
  std::vector<graph::TracedEvent> traced_;
  std::vector<WeighedEvent> events_;
  std::size_t done_ = 0;
};

/// Measures the events of all readings while the clip is read once.
void measure_readings(core::FrameSource& source, std::span<Reading> readings, std::size_t frames,
                      const core::Context& context) {
  FrameWindow window;
  const auto measure = [&](int end) {
    window.prepare(context);
    for (Reading& reading : readings) reading.measure(window, end, context);
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
  if (static_cast<std::size_t>(read) != frames)
    throw core::InputError("events: the clip has " + std::to_string(read) + " frames, its graphs " +
                           std::to_string(frames));
  measure(read);
}

/// An event of any reading, and in how many readings it was found.
struct Pooled {
  WeighedEvent weighed;
  int readings = 1;
};

/// Adds the events of another reading. One that was there already is kept once, with the smaller factor.
void add_events(const std::vector<WeighedEvent>& others, bool names_strokes, std::vector<Pooled>& events) {
  struct Pair {
    double apart = 0;
    std::size_t known = 0, other = 0;
    auto operator<=>(const Pair&) const = default;
  };
  std::vector<Pair> pairs;
  for (std::size_t i = 0; i < events.size(); ++i)
    for (std::size_t k = 0; k < others.size(); ++k) {
      const graph::Event &a = events[i].weighed.event, &b = others[k].event;
      if (graph::detail::family(a.type) != graph::detail::family(b.type) ||
          std::abs(a.frame - b.frame) > kSameFrames)
        continue;
      const double apart = distance(a.position, b.position);
      if (apart <= kSamePlace) pairs.push_back({apart, i, k});
    }
  std::ranges::sort(pairs);
  std::vector<bool> is_taken(events.size(), false), is_known(others.size(), false);
  for (const Pair& pair : pairs) {
    if (is_taken[pair.known] || is_known[pair.other]) continue;
    is_taken[pair.known] = is_known[pair.other] = true;
    auto& known = events[pair.known].weighed.evidence;
    const auto& other = others[pair.other].evidence;
    known.log_factor = std::min(known.log_factor, other.log_factor);
    events[pair.known].readings += 1;
  }
  for (std::size_t k = 0; k < others.size(); ++k) {
    if (is_known[k]) continue;
    events.push_back({others[k]});
    auto& event = events.back().weighed.event;
    if (!names_strokes) event.before.clear(), event.after.clear();
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

/// Finds how many frames lie between the event and opposite ones in its place.
void find_opposites(WeighedEvent& weighed, std::span<const Reading> readings) {
  const graph::Event& event = weighed.event;
  const Family sought = opposite(graph::detail::family(event.type));
  for (const Reading& reading : readings)
    for (const WeighedEvent& other : reading.events()) {
      if (graph::detail::family(other.event.type) != sought || other.event.frame == event.frame ||
          distance(other.event.position, event.position) > kSameJoint)
        continue;
      const double frames = std::abs(other.event.frame - event.frame);
      double& side = other.event.frame < event.frame ? weighed.evidence.since : weighed.evidence.until;
      side = std::min(side, frames);
    }
}

}  // namespace

std::vector<WeighedEvent> weigh_events(core::FrameSource& source, const ClipReadings& readings,
                                       const core::Context& context) {
  if (readings.steadied.empty()) throw core::InputError("events: no reading of the clip");
  std::vector<Reading> all;
  const std::size_t frames = readings.steadied.front().sketch.frames.size();
  for (const auto* some : {&readings.steadied, &readings.unsteadied})
    for (const graph::MotionGraph& motion : *some) {
      if (motion.sketch.frames.size() != frames)
        throw core::InputError("events: readings of " + std::to_string(frames) + " and " +
                               std::to_string(motion.sketch.frames.size()) + " frames");
      all.emplace_back(motion);
    }
  measure_readings(source, all, frames, context);
  std::vector<Pooled> pooled;
  for (std::size_t k = 0; k < all.size(); ++k) add_events(all[k].events(), k == 0, pooled);
  const auto unsteadied = std::span<const Reading>(all).subspan(readings.steadied.size());
  std::vector<WeighedEvent> result;
  for (Pooled& event : pooled) {
    event.weighed.evidence.agreement = event.readings / static_cast<double>(all.size());
    find_opposites(event.weighed, unsteadied);
    result.push_back(std::move(event.weighed));
  }
  return result;
}

}  // namespace emberfold::pipeline
