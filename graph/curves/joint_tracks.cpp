// SPDX-License-Identifier: Apache-2.0
#include "graph/curves/joint_tracks.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <tuple>

#include "core/math/robust.hpp"
#include "core/parallel.hpp"

namespace emberfold::graph::detail {

namespace {

constexpr double kFollowReach = 40;   // px to each side within which patches are followed
constexpr std::uint32_t kSnap = 3;    // patches: joints of neighbouring frames so near are one
constexpr std::uint32_t kGrowth = 6;  // patches that the way between followed ones may grow by
constexpr int kUnseen = 5;            // frames that a joint is carried on for where nothing shows it
constexpr int kApartFrames = 10;      // frames before and after a joint that tell whether its sides are apart
constexpr double kApartGrowth = 8;    // px that the sides have to part for a frame to count in full
constexpr double kLeastApart = 0.2;   // of a frame whose sides are apart at all, nats
constexpr double kPriorInside = 5;    // nats: at a place on an arc one curve is likely
constexpr double kChange = 0.1;       // of log contrasts that counts as one patch away
constexpr double kMostChange = 4;     // patches
constexpr double kNotFound = 1;       // patches: a joint found for one carried on
constexpr double kPriorAtKnot = -2;   // nats: at a knot most pairs of arms are two
constexpr double kMostTurns = 2;      // frames that a turn of an arc counts for at most: corners last
constexpr double kDependence = 0.3;   // correlation of the evidence of frames
constexpr std::array<std::size_t, 6> kFollowed = {2, 1, 3, 0, 4, 5};  // patches of a way, by preference

/// A joint followed into a neighbouring frame.
struct Followed {
  enum class Kind { lost, apart, joined } kind = Kind::lost;
  JointSite site;       ///< joined: a place between its sides
  bool turned = false;  ///< joined: side a of the one is side b of the other
  double apart = 0;     ///< nats
};

/// A patch that is followed, in the other frame, and how many patches it is away from its joint.
struct FollowedPatch {
  std::uint32_t vertex = kNoIndex;
  double away = 0;
};

FollowedPatch partner_of(const FrameArcs& to, const Partners& partners, std::span<const std::uint32_t> way) {
  FollowedPatch other;
  for (const std::size_t k : kFollowed) {
    if (k >= way.size() || partners[way[k]] == kNoIndex) continue;
    const FollowedPatch found{partners[way[k]], static_cast<double>(k) + 0.5};
    if (to.arc_of[found.vertex] != kNoIndex) return found;
    if (other.vertex == kNoIndex) other = found;
  }
  return other;
}

/// Returns the arms at which two patches of different arcs meet a knot, if they do.
std::optional<JointSite> meeting_arms(const FrameArcs& to, std::uint32_t a, std::uint32_t b) {
  std::optional<JointSite> best;
  std::uint32_t least = kNoIndex;
  const auto ends = [&](std::uint32_t v) {
    const std::uint32_t arc = to.arc_of[v];
    const auto last = static_cast<std::uint32_t>(to.arcs[arc].path.size() - 1);
    return std::array{std::tuple(Arm{arc, true}, to.arcs[arc].front_knot, to.index_of[v]),
                      std::tuple(Arm{arc, false}, to.arcs[arc].back_knot, last - to.index_of[v])};
  };
  const auto number = [&](std::uint32_t knot, const Arm& arm) {
    const auto& arms = to.knots[knot].arms;
    const auto at = std::find_if(arms.begin(), arms.end(),
                                 [&](const Arm& x) { return x.arc == arm.arc && x.front == arm.front; });
    return static_cast<std::uint32_t>(at - arms.begin());
  };
  for (const auto& [arm_a, knot_a, far_a] : ends(a)) {
    for (const auto& [arm_b, knot_b, far_b] : ends(b)) {
      if (knot_a == kNoIndex || knot_a != knot_b || far_a + far_b >= least) continue;
      const std::uint32_t p = number(knot_a, arm_a), q = number(knot_b, arm_b);
      if (p == q) continue;
      least = far_a + far_b;
      best = JointSite{.knot = knot_a, .arm_a = std::min(p, q), .arm_b = std::max(p, q)};
    }
  }
  return least <= 2 * kGrowth + 4 ? best : std::nullopt;
}

Followed follow_pair(const FrameArcs& to, const FollowedPatch& from_a, const FollowedPatch& from_b,
                     double apart_now) {
  const std::uint32_t a = from_a.vertex, b = from_b.vertex;
  Followed result;
  if (a == kNoIndex || b == kNoIndex || a == b) return result;
  const std::uint32_t arc_a = to.arc_of[a], arc_b = to.arc_of[b];
  const double growth = distance(to.at(a), to.at(b)) - apart_now;
  if (arc_a != kNoIndex && arc_a == arc_b) {
    const auto [low, high] = std::minmax(to.index_of[a], to.index_of[b]);
    if (high - low <= 2 * kGrowth) {
      const double from_low = to.index_of[a] == low ? from_a.away : from_b.away;
      const double place = from_low * (high - low) / (from_a.away + from_b.away) - 0.5;
      result.kind = Followed::Kind::joined;
      result.turned = to.index_of[a] != low;
      result.site = {.arc = arc_a,
                     .index = std::clamp(low + static_cast<std::uint32_t>(std::max(0.0, std::round(place))),
                                         low, high - 1)};
      return result;
    }
  } else if (arc_a != kNoIndex && arc_b != kNoIndex) {
    if (const auto site = meeting_arms(to, a, b)) {
      result.kind = Followed::Kind::joined;
      result.site = *site;
      result.turned = to.knots[site->knot].arms[site->arm_a].arc != arc_a;
      return result;
    }
  }
  if (to.near(a, b, 2 * kGrowth)) return result;
  result.kind = Followed::Kind::apart;
  result.apart = std::clamp(growth / kApartGrowth, kLeastApart, 1.0);
  return result;
}

/// Follows a joint into a neighbouring frame.
Followed follow(const FrameArcs& from, const FrameArcs& to, const Partners& partners, const JointSite& site) {
  const JointWays ways = ways_from(from, site, kFollowReach);
  const double apart = distance(from.at(ways.a[std::min<std::size_t>(2, ways.a.size() - 1)]),
                                from.at(ways.b[std::min<std::size_t>(2, ways.b.size() - 1)]));
  return follow_pair(to, partner_of(to, partners, ways.a), partner_of(to, partners, ways.b), apart);
}

std::uint32_t away(const JointSite& p, const JointSite& q) {
  return std::max(p.index, q.index) - std::min(p.index, q.index);
}

/// Joins the joints of neighbouring frames, in one sense of time; carries on those that are not there.
class Linking {
 public:
  Linking(const ClipArcs& clip, const JointScales& scales, const std::vector<ArcCuts>& cuts,
          std::vector<std::vector<TimedJoint>>& joints)
      : clip_(clip), scales_(scales), cuts_(cuts), joints_(joints) {}

  void link(std::size_t from, std::size_t to) {
    const bool forward = to > from;
    const Partners& partners = forward ? clip_.after[from] : clip_.before[from];
    onward_ = forward ? &TimedJoint::next : &TimedJoint::previous;
    back_ = forward ? &TimedJoint::previous : &TimedJoint::next;
    std::vector<Followed> seen(joints_[from].size());
    std::vector<Pair> pairs;
    for (std::uint32_t k = 0; k < seen.size(); ++k) {
      if (joints_[from][k].*onward_ != kNoIndex) continue;
      seen[k] = follow(clip_.frames[from], clip_.frames[to], partners, joints_[from][k].site);
      if (seen[k].kind == Followed::Kind::joined) add_pairs(from, to, k, seen[k], pairs);
    }
    std::stable_sort(pairs.begin(), pairs.end(),
                     [](const Pair& p, const Pair& q) { return p.cost < q.cost; });
    for (const Pair& pair : pairs) join(from, to, pair, seen[pair.from].turned);
    for (std::uint32_t k = 0; k < seen.size(); ++k) {
      if (seen[k].kind != Followed::Kind::joined || joints_[from][k].*onward_ != kNoIndex) continue;
      const std::uint32_t there = carry(to, seen[k], joints_[from][k]);
      if (there != kNoIndex) join(from, to, {k, there}, seen[k].turned);
    }
  }

 private:
  /// A joint and what it may be in the neighbouring frame.
  struct Pair {
    std::uint32_t from = 0, to = 0;
    double cost = 0;
  };

  void add_pairs(std::size_t from, std::size_t to, std::uint32_t k, const Followed& seen,
                 std::vector<Pair>& pairs) const {
    const TimedJoint& here = joints_[from][k];
    for (std::uint32_t m = 0; m < joints_[to].size(); ++m) {
      const TimedJoint& there = joints_[to][m];
      if (there.*back_ != kNoIndex) continue;
      if (seen.site.at_knot()) {
        if (there.site == seen.site) pairs.push_back({k, m, 0});
        continue;
      }
      if (there.site.arc != seen.site.arc || away(there.site, seen.site) > kSnap) continue;
      const double change = std::abs(there.look.stronger - (seen.turned ? -1 : 1) * here.look.stronger);
      pairs.push_back({k, m,
                       away(there.site, seen.site) + std::min(kMostChange, change / kChange) +
                           (there.found == here.found ? 0 : kNotFound)});
    }
  }
  void join(std::size_t from, std::size_t to, const Pair& pair, bool turned) {
    TimedJoint &here = joints_[from][pair.from], &there = joints_[to][pair.to];
    if (here.*onward_ != kNoIndex || there.*back_ != kNoIndex) return;
    here.*onward_ = pair.to;
    there.*back_ = pair.from;
    (to > from ? there : here).turned = turned;
    if (here.lasting) there.lasting = true;
  }
  /// Adds the followed joint to a frame in which nothing shows it.
  std::uint32_t carry(std::size_t t, const Followed& seen, const TimedJoint& joint) {
    if (seen.site.at_knot() || (!joint.lasting && joint.unseen >= kUnseen)) return kNoIndex;
    const auto near = [&](const TimedJoint& other) {
      return other.site.arc == seen.site.arc && away(other.site, seen.site) <= 1;
    };
    if (std::any_of(joints_[t].begin(), joints_[t].end(), near)) return kNoIndex;
    joints_[t].push_back(joint_at(clip_.frames[t], seen.site, scales_, cuts_[t]));
    joints_[t].back().found = false;
    joints_[t].back().unseen = joint.unseen + 1;
    return static_cast<std::uint32_t>(joints_[t].size() - 1);
  }

  std::uint32_t TimedJoint::*onward_ = nullptr;
  std::uint32_t TimedJoint::*back_ = nullptr;
  const ClipArcs& clip_;
  const JointScales& scales_;
  const std::vector<ArcCuts>& cuts_;
  std::vector<std::vector<TimedJoint>>& joints_;
};

/// Sums how far apart the sides of a joint are in the frames beyond, up to the first in which they are
/// joined.
double apart_beyond(const ClipArcs& clip, std::size_t t, const JointSite& site, bool forward) {
  const JointWays ways = ways_from(clip.frames[t], site, kFollowReach);
  const double now = distance(clip.frames[t].at(ways.a[std::min<std::size_t>(2, ways.a.size() - 1)]),
                              clip.frames[t].at(ways.b[std::min<std::size_t>(2, ways.b.size() - 1)]));
  double sum = 0;
  FollowedPatch a, b;
  for (int k = 0; k < kApartFrames; ++k) {
    if (forward ? t + 1 == clip.frames.size() : t == 0) break;
    const Partners& partners = forward ? clip.after[t] : clip.before[t];
    t = forward ? t + 1 : t - 1;
    if (k == 0) {
      a = partner_of(clip.frames[t], partners, ways.a), b = partner_of(clip.frames[t], partners, ways.b);
    } else {
      a.vertex = partners[a.vertex], b.vertex = partners[b.vertex];
    }
    const Followed seen = follow_pair(clip.frames[t], a, b, now);
    if (a.vertex == kNoIndex || b.vertex == kNoIndex || seen.kind == Followed::Kind::joined) break;
    sum += seen.apart;
  }
  return sum;
}

/// Gives each joint the odds of all frames in which it is followed.
void sum_up(const ClipArcs& clip, const JointScales& scales, std::vector<std::vector<TimedJoint>>& joints) {
  for (std::size_t t = 0; t < joints.size(); ++t) {
    for (std::uint32_t first = 0; first < joints[t].size(); ++first) {
      if (joints[t][first].previous != kNoIndex) continue;
      JointRecord record;
      double sense = 1;
      std::size_t last_frame = t;
      std::uint32_t last = first;
      for (std::uint32_t k = first; k != kNoIndex; k = joints[last_frame][k].next, ++last_frame) {
        last = k;
        if (k != first || last_frame != t) sense *= joints[last_frame][k].turned ? -1 : 1;
        record.add(joints[last_frame][k], sense);
      }
      --last_frame;
      const double odds = record.odds(scales) - apart_beyond(clip, t, joints[t][first].site, false) -
                          apart_beyond(clip, last_frame, joints[last_frame][last].site, true);
      std::size_t frame = t;
      for (std::uint32_t k = first; k != kNoIndex; k = joints[frame][k].next, ++frame)
        joints[frame][k].odds = odds;
    }
  }
}

}  // namespace

void JointRecord::add(const TimedJoint& joint, double sense) {
  stronger.push_back(sense * joint.look.stronger), wider.push_back(sense * joint.look.wider);
  patches.push_back(joint.look.patches), turn.push_back(joint.look.turn);
  inside += joint.site.at_knot() ? 0 : 1;
  other_kind += joint.look.other_kind ? 1 : 0;
}

double JointRecord::odds(const JointScales& scales) const {
  const auto n = static_cast<double>(turn.size());
  const JointLook usual{core::median(stronger), core::median(wider), core::median(patches),
                        core::median(turn), 2 * other_kind > n};
  const JointEvidence evidence = joint_evidence(usual, scales);
  const double frames = n / (1 + kDependence * (n - 1));
  return (kPriorInside * inside + kPriorAtKnot * (n - inside)) / n + evidence.properties * frames +
         evidence.turn * (2 * inside > n ? std::min(frames, kMostTurns) : frames);
}

std::vector<std::vector<TimedJoint>> follow_joints(const ClipArcs& clip, const JointScales& scales,
                                                   const core::Context& context) {
  std::vector<std::vector<TimedJoint>> joints(clip.frames.size());
  std::vector<ArcCuts> cuts(clip.frames.size());
  core::parallel_for(clip.frames.size(), context,
                     [&](std::size_t t) { joints[t] = find_joints_of(clip, t, scales, cuts[t]); });
  Linking linking(clip, scales, cuts, joints);
  for (std::size_t t = 0; t + 1 < joints.size(); ++t) linking.link(t, t + 1);
  for (std::size_t t = joints.size(); t-- > 1;) linking.link(t, t - 1);
  sum_up(clip, scales, joints);
  return joints;
}

}  // namespace emberfold::graph::detail
