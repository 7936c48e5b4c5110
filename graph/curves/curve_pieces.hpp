// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "graph/curves/joint_finding.hpp"

namespace emberfold::graph::detail {

/// The pieces of curves in one frame: paths through knots, cut where two curves touch.
struct FramePieces {
  std::vector<std::uint32_t> of_vertex;  ///< piece of each vertex, numbered by lowest vertex
  std::uint32_t count = 0;
  std::vector<double> probability;  ///< of each joint, that one curve goes on through it
};
/// Divides a frame into pieces at its joints: arcs are cut where the odds are against one curve; of the arms
/// of a knot those pairs are joined whose odds together are the greatest, each arm with at most one other.
FramePieces divide_frame(const FrameArcs& frame, const std::vector<TimedJoint>& joints);

/// Returns the last vertex of an arm, at its knot.
std::uint32_t end_of(const FrameArcs& frame, const Arm& arm);

}  // namespace emberfold::graph::detail
