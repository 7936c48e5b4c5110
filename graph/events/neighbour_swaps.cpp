// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <tuple>

#include "graph/events/topology_changes.hpp"

namespace emberfold::graph {

namespace {

constexpr double kShortEdge = 24;               // px, longest edge between two forks that may swap
constexpr double kOpenEdge = 10;                // px that it has before and after, at its longest
constexpr double kArmReach = 14;                // px from a fork, where an arm's direction is taken
constexpr double kSamePlace = 15;               // px between sights of one place
constexpr double kSameArm = 40;                 // °, mean turn of the arms between sights
constexpr int kMostGap = 10, kLeastSights = 2;  // frames
constexpr std::size_t kArms = 4;

/// Two forks with a short edge between them; arms in the order of their directions.
struct Knot {
  Point place;
  double length = 0;
  std::array<double, kArms> angle{};  ///< rad
  std::array<int, kArms> fork{};      ///< at which of the two forks each arm ends
};

/// Returns the direction of an arm from the knot's place: where it has gone kArmReach from its fork.
double arm_angle(const AttributeGraph& graph, Point place, std::uint32_t fork, std::uint32_t first) {
  std::uint32_t last = fork, here = first;
  double way = distance(graph.patch(fork).position, graph.patch(first).position);
  while (way < kArmReach && graph.degree(here) == 2) {
    const auto near = graph.neighbours(here);
    const std::uint32_t next = near[0] == last ? near[1] : near[0];
    way += distance(graph.patch(here).position, graph.patch(next).position);
    last = here, here = next;
    if (here == fork) break;
  }
  const Point out = graph.patch(here).position - place;
  return std::atan2(out.y, out.x);
}

std::optional<Knot> knot_of(const AttributeGraph& graph, const Curve& curve) {
  const std::array<std::uint32_t, 2> forks{curve.front(), curve.back()};
  if (curve.size() < 2 || forks[0] == forks[1] || graph.degree(forks[0]) != 3 || graph.degree(forks[1]) != 3)
    return std::nullopt;
  Knot knot;
  for (std::size_t k = 1; k < curve.size(); ++k)
    knot.length += distance(graph.patch(curve[k - 1]).position, graph.patch(curve[k]).position);
  if (knot.length > kShortEdge) return std::nullopt;
  knot.place = (graph.patch(forks[0]).position + graph.patch(forks[1]).position) * 0.5;
  const std::array<std::uint32_t, 2> inner{curve[1], curve[curve.size() - 2]};
  std::vector<std::pair<double, int>> arms;
  for (int side = 0; side < 2; ++side) {
    const auto at = static_cast<std::size_t>(side);
    for (const std::uint32_t w : graph.neighbours(forks[at]))
      if (w != inner[at] && w != forks[1 - at])
        arms.emplace_back(arm_angle(graph, knot.place, forks[at], w), side);
  }
  if (arms.size() != kArms) return std::nullopt;
  std::ranges::sort(arms);
  for (std::size_t k = 0; k < kArms; ++k) std::tie(knot.angle[k], knot.fork[k]) = arms[k];
  return knot;
}

/// A place that is followed, with its arms as they were first numbered.
struct Track {
  Point place;
  std::array<double, kArms> angle{};
  int last = 0;  ///< frame
  /// Present and previous state: which neighbouring arms meet (0: the first two; 1: the second
  /// two), in how many frames, and the longest edge.
  struct Run {
    int pairing = -1, sights = 0, first = 0, last = 0;
    double longest = 0;
    Point place;
    bool told = false;
  } now, before;
};

double turn_between(double a, double b) {
  return std::abs(std::remainder(a - b, 2 * std::numbers::pi));
}

/// Returns by how many places the knot's arms are numbered on from the track's, and the mean turn, °.
std::pair<std::size_t, double> fit_arms(const Track& track, const Knot& knot) {
  std::pair<std::size_t, double> best{0, 1e9};
  for (std::size_t shift = 0; shift < kArms; ++shift) {
    double sum = 0;
    for (std::size_t k = 0; k < kArms; ++k)
      sum += turn_between(track.angle[k], knot.angle[(k + shift) % kArms]);
    const double mean = sum / kArms * 180 / std::numbers::pi;
    if (mean < best.second) best = {shift, mean};
  }
  return best;
}

/// Returns which neighbouring arms meet; nothing where arms across do.
std::optional<int> pairing_of(const Knot& knot, std::size_t shift) {
  const auto fork = [&](std::size_t k) { return knot.fork[(k + shift) % kArms]; };
  if (fork(0) == fork(1) && fork(2) == fork(3)) return 0;
  if (fork(1) == fork(2) && fork(3) == fork(0)) return 1;
  return std::nullopt;
}

void see(Track& track, const Knot& knot, std::size_t shift, int pairing, int t,
         std::vector<TopologyChange>& swaps) {
  for (std::size_t k = 0; k < kArms; ++k) track.angle[k] = knot.angle[(k + shift) % kArms];
  track.place = knot.place, track.last = t;
  if (track.now.pairing != pairing) {
    // A run too short to count does not end the one before it.
    if (track.now.sights >= kLeastSights) track.before = track.now;
    track.now = {pairing, 0, t, t, 0, knot.place, false};
    if (track.before.pairing == pairing && t - track.before.last <= kMostGap) track.now = track.before;
  }
  auto& now = track.now;
  ++now.sights, now.last = t;
  now.longest = std::max(now.longest, knot.length);
  const auto& was = track.before;
  const bool swapped = !now.told && was.pairing >= 0 && was.pairing != pairing &&
                       now.sights >= kLeastSights && was.longest >= kOpenEdge && now.longest >= kOpenEdge &&
                       now.first - was.last <= kMostGap;
  if (!swapped) return;
  now.told = true;
  TopologyChange swap;
  swap.frame = now.first, swap.change = Change::t1, swap.position = now.place;
  swaps.push_back(swap);
}

}  // namespace

std::vector<TopologyChange> find_neighbour_swaps(const MotionGraph& motion) {
  std::vector<TopologyChange> swaps;
  std::vector<Track> tracks;
  for (int t = 0; t < static_cast<int>(motion.sketch.frames.size()); ++t) {
    const AttributeGraph& graph = motion.sketch.frames[static_cast<std::size_t>(t)];
    std::erase_if(tracks, [&](const Track& track) { return t - track.last > kMostGap; });
    for (const Curve& curve : curves(graph)) {
      const auto knot = knot_of(graph, curve);
      if (!knot) continue;
      Track* nearest = nullptr;
      for (Track& track : tracks) {
        const double apart = distance(track.place, knot->place);
        if (track.last == t || apart > kSamePlace || fit_arms(track, *knot).second > kSameArm) continue;
        if (nearest == nullptr || apart < distance(nearest->place, knot->place)) nearest = &track;
      }
      if (nearest == nullptr) {
        tracks.push_back({knot->place, knot->angle, t, {}, {}});
        nearest = &tracks.back();
      }
      const std::size_t shift = fit_arms(*nearest, *knot).first;
      if (const auto pairing = pairing_of(*knot, shift)) see(*nearest, *knot, shift, *pairing, t, swaps);
    }
  }
  return swaps;
}

}  // namespace emberfold::graph
