// SPDX-License-Identifier: Apache-2.0
#include "pipeline/inference/event_paths.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <optional>
#include <utility>

namespace emberfold::pipeline {

using graph::Patch;
using graph::Point;

namespace {

constexpr double kSlip = 9;          // px along the curve of tolerance for a link
constexpr double kSameEnds = 4;      // px between propagated and followed ends
constexpr double kPatchesApart = 6;  // px between patches of a refined path

Point tangent(const Patch& patch) {
  return {std::cos(patch.theta), std::sin(patch.theta)};
}

/// Returns the direction of a curve, turned to the side of `like`.
double turn_like(double theta, double like) {
  return std::cos(theta - like) < 0 ? theta + std::numbers::pi : theta;
}

/// A patch followed through the frames.
struct Followed {
  Patch patch;
  std::optional<std::uint32_t> vertex;  // vertex that shows it
};

Followed step_on(const Followed& from, int frame, int step, const MotionIndex& motion,
                 const FrameWindow& window) {
  Followed to{from.patch, from.vertex ? motion.linked(frame, *from.vertex, step) : std::nullopt};
  to.patch.position = window.carry(from.patch.position, frame, step);
  const bool is_linked = to.vertex.has_value();
  if (!is_linked) to.vertex = motion.coinciding(frame + step, to.patch);
  if (!to.vertex) return to;
  const Patch& found = motion.graph(frame + step).patch(*to.vertex);
  if (is_linked) to.patch.theta = turn_like(found.theta, to.patch.theta);
  const Point off = found.position - to.patch.position, along = tangent(to.patch);
  const double slip = dot(off, along);
  const bool is_far = is_linked && std::abs(slip) > kSlip;
  to.patch.position = is_far ? found.position : to.patch.position + (off - along * slip);
  return to;
}

/// Values in frames first…last, propagated from the one in which they begin.
template <class T>
class Course {
 public:
  template <class Step>
  Course(T start, int frame, int first, int last, const Step& step)
      : first_(first), at_(static_cast<std::size_t>(last - first + 1)) {
    const auto at = [&](int t) -> T& { return at_[static_cast<std::size_t>(t - first)]; };
    at(frame) = std::move(start);
    for (int t = frame; t < last; ++t) at(t + 1) = step(at(t), t, 1);
    for (int t = frame; t > first; --t) at(t - 1) = step(at(t), t, -1);
  }
  [[nodiscard]] const T& operator[](int frame) const { return at_[static_cast<std::size_t>(frame - first_)]; }

 private:
  int first_;
  std::vector<T> at_;
};

/// Follows the patches of one event.
class EventFollower {
 public:
  EventFollower(const MotionIndex& motion, const FrameWindow& window, int first, int last)
      : motion_(motion), window_(window), first_(first), last_(last) {}

  [[nodiscard]] Course<Followed> follow(std::uint32_t vertex, int frame) const {
    return {Followed{motion_.graph(frame).patch(vertex), vertex}, frame, first_, last_,
            [&](const Followed& from, int t, int step) { return step_on(from, t, step, motion_, window_); }};
  }
  [[nodiscard]] Course<Path> carry(Path path, int frame) const {
    return {std::move(path), frame, first_, last_, [&](Path carried, int t, int step) {
              for (Patch& patch : carried) patch.position = window_.carry(patch.position, t, step);
              return carried;
            }};
  }

 private:
  const MotionIndex& motion_;
  const FrameWindow& window_;
  int first_, last_;
};

/// Interpolates a patch between two neighbours, at a share of the way from a to b.
Patch between(const Patch& a, const Patch& b, double share) {
  Patch result = share <= 0.5 ? a : b;
  const Point way = b.position - a.position;
  result.position = a.position + way * share;
  if (norm(way) > 0) result.theta = turn_like(std::atan2(way.y, way.x), result.theta);
  return result;
}

/// Subdivides a path, so that its patches are at most kPatchesApart apart, with one between any two.
Path refine(const Path& path) {
  Path result;
  for (std::size_t i = 0; i + 1 < path.size(); ++i) {
    result.push_back(path[i]);
    const int parts =
        2 * (static_cast<int>(distance(path[i].position, path[i + 1].position) / kPatchesApart) + 1);
    for (int k = 1; k < parts; ++k) result.push_back(between(path[i], path[i + 1], double(k) / parts));
  }
  result.push_back(path.back());
  return result;
}

/// Moves the ends of a path, and the patches between in proportion.
Path move_ends(Path path, Point front, Point back) {
  double length = 0;
  std::vector<double> from_front{0};
  for (std::size_t i = 1; i < path.size(); ++i)
    from_front.push_back(length += distance(path[i].position, path[i - 1].position));
  for (std::size_t i = 0; i < path.size(); ++i) {
    const double share = length > 0 ? from_front[i] / length : 0.5;
    path[i].position = path[i].position + front * (1 - share) + back * share;
  }
  return path;
}

}  // namespace

std::vector<std::vector<Path>> follow_event(const graph::TracedEvent& traced, const MotionIndex& motion,
                                            const FrameWindow& window, int first, int last) {
  using enum graph::EventType;
  const graph::EventType type = traced.event.type;
  const int frame = traced.path_frame;
  const graph::AttributeGraph& graph = motion.graph(frame);
  const auto vertex = [&](graph::VertexId id) { return static_cast<std::uint32_t>(graph.index_of(id)); };
  Path path;
  for (const graph::VertexId id : traced.path) path.push_back(graph.patch(vertex(id)));
  const EventFollower follower(motion, window, first, last);
  std::vector<std::vector<Path>> guesses(static_cast<std::size_t>(last - first + 1));
  const auto guesses_of = [&](int t) -> std::vector<Path>& {
    return guesses[static_cast<std::size_t>(t - first)];
  };

  const Course<Path> whole = follower.carry(path, frame);
  if (type == birth || type == death) {
    for (int t = first; t <= last; ++t) guesses_of(t) = {whole[t]};
    return guesses;
  }
  // The path between two parts: propagated, if its ends agree with those followed, and fitted to them.
  const auto fronts = follower.follow(vertex(traced.path.front()), frame),
             backs = follower.follow(vertex(traced.path.back()), frame);
  for (int t = first; t <= last; ++t) {
    const Path& carried = whole[t];
    const Point front = fronts[t].patch.position - carried.front().position,
                back = backs[t].patch.position - carried.back().position;
    if (norm(front) < kSameEnds && norm(back) < kSameEnds) guesses_of(t).push_back(refine(carried));
    guesses_of(t).push_back(refine(move_ends(carried, front, back)));
  }
  return guesses;
}

}  // namespace emberfold::pipeline
