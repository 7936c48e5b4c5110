// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "core/context.hpp"
#include "graph/motion_graph.hpp"

namespace emberfold::graph {

/// A place in one frame where two patches or arms of a junction may be one curve or two that touch.
struct CurveJoint {
  int frame = 0;
  Point position;          ///< px
  CurveId a, b;            ///< the curves of its sides, a ≤ b; equal: one goes on
  double probability = 0;  ///< that one curve goes on through it
  bool at_junction = false;
  bool operator==(const CurveJoint&) const = default;
};

/// Holds a motion graph with its curves.
struct CurveGrouping {
  MotionGraph motion;              ///< every vertex has its curve
  std::vector<CurveJoint> joints;  ///< by frame
};

/// Groups the patches of a motion graph into curves that keep their identity where they touch and cross.
/// A curve is a path through junctions. At each junction, and where contrast, width or direction change, one
/// curve or two are decided from these over all frames in which the place is followed, and from whether its
/// sides are apart before or after (docs/method/curves.md). Identities count from 1 in order of appearance.
/// Throws InputError as validate() does, Cancelled. O(n log n) in patches.
CurveGrouping identify_curves(MotionGraph motion, const core::Context& context = {});

}  // namespace emberfold::graph
