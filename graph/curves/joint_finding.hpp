// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "core/context.hpp"
#include "graph/curves/joint_evidence.hpp"
#include "graph/motion_graph.hpp"

namespace emberfold::graph::detail {

/// The partner in a neighbouring frame of each vertex, by index; kNoIndex: none.
using Partners = std::vector<std::uint32_t>;

/// The frames of a clip as arcs, with the partners of their vertices.
struct ClipArcs {
  std::vector<FrameArcs> frames;
  std::vector<Partners> before, after;  ///< of each frame's vertices in the frame before and after
};
/// Splits the frames of a motion graph, which has to outlive the result.
ClipArcs clip_arcs(const MotionGraph& motion, const core::Context& context);

/// A joint in one frame, and the odds that one curve goes on through it.
struct TimedJoint {
  JointSite site;
  JointLook look;
  double evidence = 0;   ///< nats, of this frame alone
  bool turned = false;   ///< its side a is side b in the frame before
  double odds = 0;       ///< nats, of all frames in which the joint is followed
  bool found = false;    ///< by this frame's own patches, or by what becomes of them
  bool lasting = false;  ///< its sides are apart in another frame
  int unseen = 0;        ///< frames since it was found
  std::uint32_t previous = kNoIndex, next = kNoIndex;  ///< the same joint in the frames before and after
};

/// Measures the joint at a site.
TimedJoint joint_at(const FrameArcs& frame, const JointSite& site, const JointScales& scales,
                    const ArcCuts& cuts);

/// Finds the joints of a frame, ordered by site: all pairs of arms of a knot, places on arcs where contrast,
/// width or direction change, and places on arcs whose sides are apart in the frame before or after.
/// `cuts`: gets the places of changes.
std::vector<TimedJoint> find_joints_of(const ClipArcs& clip, std::size_t t, const JointScales& scales,
                                       ArcCuts& cuts);

}  // namespace emberfold::graph::detail
