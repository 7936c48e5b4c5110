// SPDX-License-Identifier: Apache-2.0
#include "graph/curves/joint_finding.hpp"

#include <algorithm>
#include <tuple>
#include <utility>

namespace emberfold::graph::detail {

namespace {

constexpr std::uint32_t kLeastWay = 3;  // patches to each side of a place where properties are compared
constexpr std::uint32_t kGap = 6;       // patches without a partner that may lie between two sides
constexpr int kDetour = 4;              // edges that the way between their partners may be longer
constexpr int kRounds = 2;              // of looking for each change of an arc between the others

/// A place between two neighbours of an arc.
struct Change {
  std::uint32_t index = kNoIndex;
  double evidence = 0;
};

/// Returns the place in a part [begin, end) of an arc that looks least like one curve, if one does so.
Change strongest_change(const FrameArcs& frame, std::uint32_t arc, std::uint32_t begin, std::uint32_t end,
                        const JointScales& scales, const ArcCuts& cuts) {
  Change best;
  for (std::uint32_t k = begin + kLeastWay - 1; k + kLeastWay < end; ++k) {
    const double evidence =
        joint_evidence(look_at_joint(frame, {.arc = arc, .index = k}, cuts), scales).total();
    if (evidence < best.evidence) best = {k, evidence};
  }
  return best;
}

/// Finds the places of an arc where what lies on both sides differs more than one curve does: the place that
/// shows it most, then what the parts show, then each again between the others.
void add_changes(const FrameArcs& frame, std::uint32_t arc, const JointScales& scales, ArcCuts& cuts,
                 std::vector<TimedJoint>& joints) {
  const auto n = static_cast<std::uint32_t>(frame.arcs[arc].path.size());
  auto& found = cuts[arc];
  std::vector<std::pair<std::uint32_t, std::uint32_t>> parts{{0, n}};
  while (!parts.empty()) {
    const auto [begin, end] = parts.back();
    parts.pop_back();
    const Change best = strongest_change(frame, arc, begin, end, scales, cuts);
    if (best.index == kNoIndex) continue;
    found.insert(std::lower_bound(found.begin(), found.end(), best.index), best.index);
    parts.emplace_back(begin, best.index + 1);
    parts.emplace_back(best.index + 1, end);
  }
  for (int round = 0; round < kRounds; ++round) {
    for (std::size_t k = 0; k < found.size();) {
      found.erase(found.begin() + static_cast<std::ptrdiff_t>(k));
      const std::uint32_t begin = k == 0 ? 0 : found[k - 1] + 1, end = k == found.size() ? n : found[k] + 1;
      const Change best = strongest_change(frame, arc, begin, end, scales, cuts);
      if (best.index == kNoIndex) continue;
      found.insert(found.begin() + static_cast<std::ptrdiff_t>(k), best.index);
      ++k;
    }
  }
  for (const std::uint32_t k : found) {
    const JointSite site{.arc = arc, .index = k};
    joints.push_back(joint_at(frame, site, scales, cuts));
  }
}

/// Finds the places of an arc whose sides are apart in a neighbouring frame.
void add_meetings(const FrameArcs& frame, std::uint32_t arc, const FrameArcs& other, const Partners& partners,
                  std::vector<JointSite>& sites) {
  const auto& path = frame.arcs[arc].path;
  std::uint32_t last = kNoIndex;
  for (std::uint32_t k = 0; k < path.size(); ++k) {
    if (partners[path[k]] == kNoIndex) continue;
    if (last != kNoIndex && k - last <= kGap &&
        !other.near(partners[path[last]], partners[path[k]], static_cast<int>(k - last) + kDetour))
      sites.push_back({.arc = arc, .index = (last + k - 1) / 2});
    last = k;
  }
}

bool precedes_site(const TimedJoint& p, const TimedJoint& q) {
  const auto key = [](const JointSite& s) { return std::tuple(s.arc, s.index, s.knot, s.arm_a, s.arm_b); };
  return key(p.site) < key(q.site);
}

/// Keeps one joint of those that lie within two patches on an arc.
void thin_out(std::vector<TimedJoint>& joints) {
  std::sort(joints.begin(), joints.end(), precedes_site);
  std::vector<TimedJoint> kept;
  for (TimedJoint& joint : joints) {
    if (!kept.empty() && !joint.site.at_knot() && kept.back().site.arc == joint.site.arc &&
        joint.site.index - kept.back().site.index <= 2) {
      const bool lasting = joint.lasting || kept.back().lasting;
      if (joint.evidence < kept.back().evidence) kept.back() = joint;
      kept.back().lasting = lasting;
      continue;
    }
    kept.push_back(joint);
  }
  joints = std::move(kept);
}

}  // namespace

ClipArcs clip_arcs(const MotionGraph& motion, const core::Context& context) {
  const auto& frames = motion.sketch.frames;
  ClipArcs clip;
  for (const AttributeGraph& graph : frames) {
    context.check();
    clip.frames.emplace_back(graph);
    clip.before.emplace_back(graph.size(), kNoIndex);
    clip.after.emplace_back(graph.size(), kNoIndex);
  }
  for (std::size_t t = 1; t < frames.size(); ++t) {
    for (const Link& link : motion.links[t]) {
      const auto i = static_cast<std::uint32_t>(frames[t - 1].index_of(link.before));
      const auto j = static_cast<std::uint32_t>(frames[t].index_of(link.after));
      if (clip.after[t - 1][i] == kNoIndex) clip.after[t - 1][i] = j;
      if (clip.before[t][j] == kNoIndex) clip.before[t][j] = i;
    }
  }
  return clip;
}

TimedJoint joint_at(const FrameArcs& frame, const JointSite& site, const JointScales& scales,
                    const ArcCuts& cuts) {
  const JointLook look = look_at_joint(frame, site, cuts);
  return {.site = site, .look = look, .evidence = joint_evidence(look, scales).total(), .found = true};
}

std::vector<TimedJoint> find_joints_of(const ClipArcs& clip, std::size_t t, const JointScales& scales,
                                       ArcCuts& cuts) {
  const FrameArcs& frame = clip.frames[t];
  std::vector<TimedJoint> joints;
  cuts.resize(frame.arcs.size());
  for (std::uint32_t arc = 0; arc < frame.arcs.size(); ++arc) {
    add_changes(frame, arc, scales, cuts, joints);
    std::vector<JointSite> meetings;
    if (t > 0) add_meetings(frame, arc, clip.frames[t - 1], clip.before[t], meetings);
    if (t + 1 < clip.frames.size()) add_meetings(frame, arc, clip.frames[t + 1], clip.after[t], meetings);
    for (const JointSite& site : meetings) {
      joints.push_back(joint_at(frame, site, scales, cuts));
      joints.back().lasting = true;
    }
  }
  for (std::uint32_t knot = 0; knot < frame.knots.size(); ++knot) {
    const auto arms = static_cast<std::uint32_t>(frame.knots[knot].arms.size());
    for (std::uint32_t a = 0; a < arms; ++a) {
      for (std::uint32_t b = a + 1; b < arms; ++b) {
        const JointSite site{.knot = knot, .arm_a = a, .arm_b = b};
        joints.push_back(joint_at(frame, site, scales, cuts));
      }
    }
  }
  thin_out(joints);
  return joints;
}

}  // namespace emberfold::graph::detail
