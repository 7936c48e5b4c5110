// SPDX-License-Identifier: Apache-2.0
#include "mcmc/learning/curve_tracks.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>

namespace emberfold::mcmc::detail {

namespace {

using graph::AttributeGraph;
using graph::Point;
using Index = std::uint32_t;

constexpr double farthest_step = 16;  // px: beyond what matching links
constexpr double crowded = 2;         // px: two tracks closer than this are one
constexpr double bare = 3;            // px: a patch with none as near begins one
constexpr double side_by_side = 12;   // px

Point direction(double theta) {
  return {std::cos(theta), std::sin(theta)};
}

Point normal_of(Point d) {
  return {-d.y, d.x};
}

double cross(Point a, Point b) {
  return a.x * b.y - a.y * b.x;
}

Point unit(Point v) {
  const double length = graph::norm(v);
  return length > 0 ? v * (1 / length) : Point{1, 0};
}

double log_contrast(const graph::Patch& patch) {
  return std::log(std::max(std::abs(patch.contrast), 1e-3));
}

// A patch's direction, turned so that it runs with `along`.
Point tangent(const graph::Patch& patch, Point along) {
  const Point d = direction(patch.theta);
  return graph::dot(d, along) < 0 ? d * -1 : d;
}

// Intersection of the curve through two neighbouring patches with the line p + s n.
std::optional<TrackSample> meet(const AttributeGraph& graph, Index a, Index b, Point p, Point n) {
  const Point from = graph.patch(a).position, chord = graph.patch(b).position - from;
  const double length = graph::norm(chord), slope = cross(chord, n);
  if (length < 1e-9 || std::abs(slope) < 0.2 * length) return {};
  const double u = cross(p - from, n) / slope;
  if (u < -0.02 || u > 1.02) return {};
  // Between its patches the curve deviates from the chord in proportion to its turn.
  const Point along = chord * (1 / length), ta = tangent(graph.patch(a), along),
              tb = tangent(graph.patch(b), along);
  const double turn = std::clamp(std::atan2(cross(ta, tb), graph::dot(ta, tb)), -1.0, 1.0);
  const Point bulge = normal_of(along) * (-turn / 2 * length * u * (1 - u));
  const Point on_chord = from + chord * u;
  const double s = graph::dot(on_chord + bulge - p, n);
  TrackSample sample;
  sample.position = p + n * s;
  const Point middle = unit(ta * (1 - u) + tb * u);
  sample.normal = normal_of(middle);
  if (graph::dot(sample.normal, n) < 0) sample.normal = sample.normal * -1;
  sample.normal_displacement = s;
  sample.contrast = log_contrast(graph.patch(a)) * (1 - u) + log_contrast(graph.patch(b)) * u;
  sample.vertex = u < 0.5 ? a : b;
  return sample;
}

// Lists for each vertex of the frame before the vertices that continue it.
std::vector<std::vector<Index>> successors(const AttributeGraph& before, const AttributeGraph& after,
                                           const std::vector<graph::Link>& links) {
  std::vector<std::vector<Index>> next(before.size());
  for (const auto& link : links)
    next[before.index_of(link.before)].push_back(static_cast<Index>(after.index_of(link.after)));
  return next;
}

std::vector<Index> within_two_edges(const AttributeGraph& graph, std::vector<Index> from) {
  for (int hop = 0; hop < 2; ++hop) {
    const auto reached = from;
    for (const Index v : reached)
      for (const Index w : graph.neighbours(v)) from.push_back(w);
    std::ranges::sort(from);
    from.erase(std::unique(from.begin(), from.end()), from.end());
  }
  return from;
}

// The track's place in the next frame: the intersection of its normal with the curve that continues its
// patch, or that continues the patch's neighbours where it ends itself.
std::optional<TrackSample> step(const AttributeGraph& before, const AttributeGraph& after,
                                const std::vector<std::vector<Index>>& next, const TrackSample& at) {
  std::vector<Index> targets = next[at.vertex];
  if (targets.empty())
    for (const Index w : before.neighbours(at.vertex))
      targets.insert(targets.end(), next[w].begin(), next[w].end());
  if (targets.empty()) return {};
  double expected = 0;
  for (const Index w : targets) expected += graph::dot(after.patch(w).position - at.position, at.normal);
  expected /= static_cast<double>(targets.size());
  const auto reachable = within_two_edges(after, std::move(targets));
  std::optional<TrackSample> best;
  for (const Index a : reachable)
    for (const Index b : after.neighbours(a)) {
      if (b < a && std::ranges::binary_search(reachable, b)) continue;
      const auto found = meet(after, a, b, at.position, at.normal);
      if (!found || std::abs(found->normal_displacement) > farthest_step) continue;
      if (!best ||
          std::abs(found->normal_displacement - expected) < std::abs(best->normal_displacement - expected))
        best = found;
    }
  return best;
}

using Lists = std::vector<std::vector<Index>>;  // for each vertex the tracks at it

// All tracks at a vertex or its neighbours.
template <class Visit>
void visit_near(const AttributeGraph& graph, const Lists& at, Index vertex, Visit visit) {
  for (const Index i : at[vertex]) visit(i);
  for (const Index w : graph.neighbours(vertex))
    for (const Index i : at[w]) visit(i);
}

// Ends the younger of two tracks that came together and takes back its newest sample.
void thin_out(const AttributeGraph& graph, std::vector<CurveTrack>& all, std::vector<Index>& alive,
              Lists& at) {
  std::vector<Index> kept;
  for (const Index i : alive) {  // older ones first
    const auto& mine = all[i].samples.back();
    bool free = true;
    visit_near(graph, at, mine.vertex, [&](Index j) {
      free = free && graph::distance(all[j].samples.back().position, mine.position) >= crowded;
    });
    if (free) {
      kept.push_back(i);
      at[mine.vertex].push_back(i);
    } else {
      all[i].samples.pop_back();
    }
  }
  alive = std::move(kept);
}

void begin_new(const AttributeGraph& graph, int frame, std::vector<CurveTrack>& all,
               std::vector<Index>& alive, Lists& at) {
  for (Index v = 0; v < graph.size(); ++v) {
    if (graph.degree(v) != 2) continue;
    const auto& patch = graph.patch(v);
    bool covered = false;
    visit_near(graph, at, v, [&](Index j) {
      covered = covered || graph::distance(all[j].samples.back().position, patch.position) < bare;
    });
    if (covered) continue;
    const auto index = static_cast<Index>(all.size());
    all.push_back({frame, {{patch.position, normal_of(direction(patch.theta)), 0, log_contrast(patch), v}}});
    alive.push_back(index);
    at[v].push_back(index);
  }
}

// Means over a vertex and its neighbours, some rounds; vertices without a value of their own take their
// neighbours'.
void smooth(const AttributeGraph& graph, std::vector<Point>& values, std::vector<bool> known) {
  for (int round = 0; round < 3; ++round) {
    const auto before = values;
    const auto were = known;
    for (Index v = 0; v < graph.size(); ++v) {
      Point sum = were[v] ? before[v] * 2 : Point{};
      double weight = were[v] ? 2 : 0;
      for (const Index w : graph.neighbours(v))
        if (were[w]) sum = sum + before[w], weight += 1;
      if (weight > 0) values[v] = sum * (1 / weight), known[v] = true;
    }
  }
}

}  // namespace

std::vector<CurveTrack> track_curves(const graph::MotionGraph& motion) {
  std::vector<CurveTrack> all;
  std::vector<Index> alive;
  const auto& frames = motion.sketch.frames;
  for (std::size_t t = 0; t < frames.size(); ++t) {
    if (t > 0) {
      const auto next = successors(frames[t - 1], frames[t], motion.links[t]);
      std::vector<Index> going;
      for (const Index i : alive) {
        auto sample = step(frames[t - 1], frames[t], next, all[i].samples.back());
        if (!sample) {
          all[i].samples.shrink_to_fit();
          continue;
        }
        sample->normal_displacement += all[i].samples.back().normal_displacement;
        all[i].samples.push_back(*sample);
        going.push_back(i);
      }
      alive = std::move(going);
    }
    Lists at(frames[t].size());
    thin_out(frames[t], all, alive, at);
    begin_new(frames[t], static_cast<int>(t), all, alive, at);
  }
  return all;
}

void visit_frames(const std::vector<CurveTrack>& tracks, std::size_t frames,
                  const std::function<void(std::size_t, std::span<const Index>)>& visit) {
  std::vector<Index> by_first(tracks.size()), there;
  std::iota(by_first.begin(), by_first.end(), Index{0});
  std::ranges::stable_sort(by_first, {}, [&](Index i) { return tracks[i].first; });
  auto next = by_first.begin();
  for (std::size_t t = 0; t < frames; ++t) {
    std::erase_if(there, [&](Index i) { return tracks[i].last() < static_cast<int>(t); });
    for (; next != by_first.end() && tracks[*next].first <= static_cast<int>(t); ++next)
      if (tracks[*next].last() >= static_cast<int>(t)) there.push_back(*next);
    std::ranges::sort(there);
    visit(t, there);
  }
}

void visit_track_neighbours(
    const graph::MotionGraph& motion, const std::vector<CurveTrack>& all,
    const std::function<void(std::size_t, const std::vector<TrackNeighbours::Pair>&)>& visit) {
  const auto& frames = motion.sketch.frames;
  visit_frames(all, frames.size(), [&](std::size_t t, std::span<const Index> there) {
    const auto sample = [&](Index i) -> const TrackSample& {
      return all[i].samples[t - static_cast<std::size_t>(all[i].first)];
    };
    Lists at(frames[t].size());
    for (const Index i : there) at[sample(i).vertex].push_back(i);
    std::vector<TrackNeighbours::Pair> pairs;
    for (Index v = 0; v < frames[t].size(); ++v)
      for (const Index i : at[v]) {
        const auto& mine = sample(i);
        const Point along = {mine.normal.y, -mine.normal.x};
        // The nearest one ahead and the nearest one behind.
        for (const double side : {1.0, -1.0}) {
          double nearest = side_by_side;
          std::optional<Index> found;
          int sense = 1;
          visit_near(frames[t], at, v, [&](Index j) {
            const auto& other = sample(j);
            const Point offset = other.position - mine.position;
            const double distance = graph::norm(offset);
            if (j == i || distance >= nearest || side * graph::dot(offset, along) < 0.5 * distance) return;
            nearest = distance;
            found = j;
            sense = graph::dot(mine.normal, other.normal) < 0 ? -1 : 1;
          });
          if (found) pairs.push_back({i, *found, sense});
        }
      }
    visit(t, pairs);
  });
}

TrackNeighbours find_track_neighbours(const graph::MotionGraph& motion, const std::vector<CurveTrack>& all) {
  TrackNeighbours result;
  visit_track_neighbours(motion, all, [&](std::size_t, const std::vector<TrackNeighbours::Pair>& pairs) {
    result.frames.push_back(pairs);
  });
  return result;
}

std::vector<Point> smooth_over_patches(const AttributeGraph& graph,
                                       const std::vector<TrackValue>& track_values) {
  std::vector<Point> values(graph.size());
  std::vector<int> count(graph.size());
  for (const auto& [vertex, value] : track_values) values[vertex] = values[vertex] + value, ++count[vertex];
  std::vector<bool> known(graph.size());
  for (std::size_t v = 0; v < values.size(); ++v) {
    known[v] = count[v] > 0;
    if (known[v]) values[v] = values[v] * (1.0 / count[v]);
  }
  smooth(graph, values, std::move(known));
  return values;
}

}  // namespace emberfold::mcmc::detail
