// SPDX-License-Identifier: Apache-2.0
#include "graph/curves/curve_pieces.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include <boost/pending/disjoint_sets.hpp>

namespace emberfold::graph::detail {

namespace {

constexpr std::size_t kMostArms = 8;     // of a knot whose arms are paired
constexpr double kMostOdds = 30;         // nats
constexpr std::size_t kNearFound = 2;    // patches: cuts that a frame shows are farther apart,
constexpr std::size_t kNearCarried = 5;  // and those that other frames tell of

using ArmPair = std::pair<std::uint32_t, std::uint32_t>;

/// All ways to pair the arms of a knot.
class Pairings {
 public:
  explicit Pairings(std::size_t arms)
      : odds_(arms, std::vector<double>(arms, 0)), weight_(odds_), used_(arms, false) {}

  void set(std::uint32_t a, std::uint32_t b, double odds) {
    odds_[a][b] = std::clamp(odds, -kMostOdds, kMostOdds);
  }
  void search() { search(0, 1); }

  std::vector<ArmPair> best;  ///< after search()
  [[nodiscard]] double probability(std::uint32_t a, std::uint32_t b) const {
    return total_ > 0 ? weight_[a][b] / total_ : 0;
  }

 private:
  void search(std::uint32_t arm, double weight) {
    while (arm < used_.size() && used_[arm]) ++arm;
    if (arm == used_.size()) {
      total_ += weight;
      for (const auto& [a, b] : now_) weight_[a][b] += weight;
      if (weight > best_weight_) best = now_, best_weight_ = weight;
      return;
    }
    search(arm + 1, weight);
    for (std::uint32_t other = arm + 1; other < used_.size(); ++other) {
      if (used_[other]) continue;
      used_[other] = true;
      now_.emplace_back(arm, other);
      search(arm + 1, weight * std::exp(odds_[arm][other]));
      now_.pop_back();
      used_[other] = false;
    }
  }

  std::vector<std::vector<double>> odds_, weight_;
  std::vector<bool> used_;
  std::vector<ArmPair> now_;
  double total_ = 0, best_weight_ = 0;
};

/// The vertices of a frame, joined to pieces.
class Joining {
 public:
  explicit Joining(const FrameArcs& frame)
      : frame_(frame), rank_(frame.graph->size()), parent_(frame.graph->size()), placed_(rank_.size(), true) {
    for (std::size_t v = 0; v < rank_.size(); ++v) sets_.make_set(v);
    for (const Knot& knot : frame.knots)
      for (const std::uint32_t v : knot.vertices) placed_[v] = false;
  }
  void join(std::uint32_t a, std::uint32_t b) { sets_.union_set(std::size_t{a}, std::size_t{b}); }

  /// Joins the ends of two arms, and what lies between them in their knot.
  void join_through(std::uint32_t knot, std::uint32_t a, std::uint32_t b) {
    join(a, b);
    std::map<std::uint32_t, std::uint32_t> from{{a, a}};
    std::vector<std::uint32_t> reached{a};
    for (std::size_t k = 0; k < reached.size() && !from.contains(b); ++k) {
      for (const std::uint32_t w : frame_.graph->neighbours(reached[k]))
        if ((frame_.knot_of[w] == knot || w == b) && from.emplace(w, reached[k]).second) reached.push_back(w);
    }
    if (!from.contains(b)) return;
    for (std::uint32_t v = from[b]; v != a; v = from[v]) {
      if (!placed_[v]) join(v, a);
      placed_[v] = true;
    }
  }

  /// Gives what is left of the knots to the nearest pieces.
  void place_rest() {
    std::vector<ArmPair> joins;
    do {
      joins.clear();
      for (const Knot& knot : frame_.knots) {
        for (const std::uint32_t v : knot.vertices) {
          if (placed_[v]) continue;
          const auto near = frame_.graph->neighbours(v);
          const auto at = std::find_if(near.begin(), near.end(), [&](std::uint32_t w) { return placed_[w]; });
          if (at != near.end()) joins.emplace_back(v, *at);
        }
      }
      for (const auto& [v, w] : joins) join(v, w), placed_[v] = true;
    } while (!joins.empty());
    for (std::uint32_t v = 0; v < placed_.size(); ++v)
      for (const std::uint32_t w : frame_.graph->neighbours(v))
        if (!placed_[v]) join(v, w);
  }

  /// Numbers the pieces.
  void number(FramePieces& pieces) {
    std::vector<std::uint32_t> number(placed_.size(), kNoIndex);
    for (std::uint32_t v = 0; v < placed_.size(); ++v) {
      std::uint32_t& of = number[sets_.find_set(std::size_t{v})];
      if (of == kNoIndex) of = pieces.count++;
      pieces.of_vertex.push_back(of);
    }
  }

 private:
  const FrameArcs& frame_;
  std::vector<std::size_t> rank_, parent_;
  boost::disjoint_sets<std::size_t*, std::size_t*> sets_{rank_.data(), parent_.data()};
  std::vector<bool> placed_;
};

/// Joins the neighbours on the arcs, but for those between which two curves touch: of joints against one
/// curve that lie close together, those that this frame shows come first.
void join_arcs(const FrameArcs& frame, const std::vector<TimedJoint>& joints, Joining& joining) {
  std::vector<const TimedJoint*> apart;
  for (const TimedJoint& joint : joints)
    if (!joint.site.at_knot() && joint.odds < 0) apart.push_back(&joint);
  std::stable_sort(apart.begin(), apart.end(), [](const TimedJoint* p, const TimedJoint* q) {
    return std::pair(!p->found, p->odds) < std::pair(!q->found, q->odds);
  });
  std::vector<std::vector<bool>> cut(frame.arcs.size());
  for (std::size_t a = 0; a < cut.size(); ++a) cut[a].resize(frame.arcs[a].path.size(), false);
  for (const TimedJoint* joint : apart) {
    auto& of_arc = cut[joint->site.arc];
    const std::size_t i = joint->site.index, reach = joint->found ? kNearFound : kNearCarried;
    const auto from = of_arc.begin() + static_cast<std::ptrdiff_t>(i < reach ? 0 : i - reach);
    const auto to = of_arc.begin() + static_cast<std::ptrdiff_t>(std::min(of_arc.size(), i + reach + 1));
    if (std::find(from, to, true) == to) of_arc[i] = true;
  }
  for (std::size_t a = 0; a < cut.size(); ++a) {
    const auto& path = frame.arcs[a].path;
    for (std::size_t i = 0; i < path.size(); ++i) {
      if (!cut[a][i] && (i + 1 < path.size() || frame.arcs[a].closed))
        joining.join(path[i], path[(i + 1) % path.size()]);
    }
  }
}

}  // namespace

std::uint32_t end_of(const FrameArcs& frame, const Arm& arm) {
  const auto& path = frame.arcs[arm.arc].path;
  return arm.front ? path.front() : path.back();
}

FramePieces divide_frame(const FrameArcs& frame, const std::vector<TimedJoint>& joints) {
  Joining joining(frame);
  join_arcs(frame, joints, joining);
  std::vector<Pairings> pairings;
  for (const Knot& knot : frame.knots) pairings.emplace_back(knot.arms.size());
  for (const TimedJoint& joint : joints)
    if (joint.site.at_knot()) pairings[joint.site.knot].set(joint.site.arm_a, joint.site.arm_b, joint.odds);
  for (std::uint32_t k = 0; k < frame.knots.size(); ++k) {
    const auto& arms = frame.knots[k].arms;
    if (arms.size() > kMostArms) continue;
    pairings[k].search();
    for (const auto& [a, b] : pairings[k].best)
      joining.join_through(k, end_of(frame, arms[a]), end_of(frame, arms[b]));
  }
  joining.place_rest();
  FramePieces pieces;
  joining.number(pieces);
  for (const TimedJoint& joint : joints) {
    pieces.probability.push_back(
        joint.site.at_knot() ? pairings[joint.site.knot].probability(joint.site.arm_a, joint.site.arm_b)
                             : 1 / (1 + std::exp(-std::clamp(joint.odds, -kMostOdds, kMostOdds))));
  }
  return pieces;
}

}  // namespace emberfold::graph::detail
