// SPDX-License-Identifier: Apache-2.0
#include "graph/curves/curve_union.hpp"

#include <algorithm>
#include <iterator>
#include <map>
#include <tuple>
#include <utility>

#include "graph/curves/curve_pieces.hpp"

namespace emberfold::graph::detail {

namespace {

constexpr double kMostApart = 20;  // nats against two identities, one for each frame that has them apart

using Pair = std::pair<std::uint32_t, std::uint32_t>;  // of identities, the lower first

/// The joint of two identities in a frame.
struct PairJoint {
  const TimedJoint* joint = nullptr;
  double sense = 1;  ///< −1: its side a is the higher identity
};

/// Returns whether more arms of a knot belong to two identities than the two that they would join.
bool goes_on_elsewhere(const FrameArcs& frame, const std::vector<std::uint32_t>& identity, std::uint32_t knot,
                       const Pair& pair) {
  const auto of_pair = [&](const Arm& arm) {
    const std::uint32_t i = identity[end_of(frame, arm)];
    return i == pair.first || i == pair.second;
  };
  return std::ranges::count_if(frame.knots[knot].arms, of_pair) > 2;
}

/// Returns the joint of each two identities that meet in a frame, of several the likeliest.
std::map<Pair, PairJoint> joints_of_pairs(const FrameArcs& frame, const std::vector<TimedJoint>& joints,
                                          const std::vector<std::uint32_t>& identity) {
  std::map<Pair, PairJoint> best;
  for (const TimedJoint& joint : joints) {
    const auto ways = ways_from(frame, joint.site, 0);
    const std::uint32_t a = identity[ways.a.front()], b = identity[ways.b.front()];
    const Pair pair = std::minmax(a, b);
    if (a == b || (joint.site.at_knot() && goes_on_elsewhere(frame, identity, joint.site.knot, pair)))
      continue;
    const PairJoint here{&joint, a < b ? 1.0 : -1.0};
    const auto [at, added] = best.try_emplace(pair, here);
    if (!added && joint.evidence > at->second.joint->evidence) at->second = here;
  }
  return best;
}

/// Returns the odds of each two identities that ever meet.
std::map<Pair, double> odds_of_pairs(const ClipArcs& clip, const std::vector<std::vector<TimedJoint>>& joints,
                                     const JointScales& scales, const Identities& identity) {
  std::map<Pair, JointRecord> records;
  std::map<std::uint32_t, std::vector<std::size_t>> frames_of;
  for (std::size_t t = 0; t < identity.size(); ++t) {
    for (const std::uint32_t i : identity[t]) {
      auto& frames = frames_of[i];
      if (frames.empty() || frames.back() != t) frames.push_back(t);
    }
    for (const auto& [pair, here] : joints_of_pairs(clip.frames[t], joints[t], identity[t]))
      records[pair].add(*here.joint, here.sense);
  }
  std::map<Pair, double> odds;
  for (const auto& [pair, record] : records) {
    const auto &a = frames_of[pair.first], &b = frames_of[pair.second];
    std::vector<std::size_t> both;
    std::ranges::set_intersection(a, b, std::back_inserter(both));
    const auto apart = static_cast<double>(both.size() - record.turn.size());
    odds[pair] = record.odds(scales) - std::min(kMostApart, apart);
  }
  return odds;
}

}  // namespace

void unite_identities(const ClipArcs& clip, const std::vector<std::vector<TimedJoint>>& joints,
                      const JointScales& scales, Identities& identity) {
  const std::map<Pair, double> odds = odds_of_pairs(clip, joints, scales, identity);
  std::vector<std::tuple<double, Pair>> order;
  for (const auto& [pair, nats] : odds)
    if (nats > 0) order.emplace_back(-nats, pair);
  std::sort(order.begin(), order.end());

  std::map<std::uint32_t, std::vector<std::uint32_t>> members;  // of each united curve, by its lowest
  std::map<std::uint32_t, std::uint32_t> curve_of;
  const auto curve = [&](std::uint32_t i) {
    if (curve_of.try_emplace(i, i).second) members[i] = {i};
    return curve_of[i];
  };
  for (const auto& [less, pair] : order) {
    const Pair both = std::minmax({curve(pair.first), curve(pair.second)});
    const auto [a, b] = both;
    if (a == b) continue;
    double sum = -less;
    for (const std::uint32_t p : members[a]) {
      for (const std::uint32_t q : members[b]) {
        const auto at = odds.find(std::minmax(p, q));
        if (at != odds.end()) sum += std::min(0.0, at->second);
      }
    }
    if (sum <= 0) continue;
    for (const std::uint32_t q : members[b]) curve_of[q] = a, members[a].push_back(q);
  }
  for (auto& frame : identity) {
    for (std::uint32_t& i : frame) {
      const auto at = curve_of.find(i);
      if (at != curve_of.end()) i = at->second;
    }
  }
}

}  // namespace emberfold::graph::detail
