// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "graph/curves/frame_arcs.hpp"

namespace emberfold::graph::detail {

/// A place where one curve may go on or two may touch: between two neighbours of an arc, or two arms of a
/// knot.
struct JointSite {
  std::uint32_t arc = kNoIndex, index = 0;              ///< between path[index] and the next; or
  std::uint32_t knot = kNoIndex, arm_a = 0, arm_b = 0;  ///< two arms of a knot, arm_a < arm_b

  [[nodiscard]] bool at_knot() const { return knot != kNoIndex; }
  bool operator==(const JointSite&) const = default;
};

/// The two ways that leave a joint.
struct JointWays {
  std::vector<std::uint32_t> a, b;
};
/// Returns the ways from a joint along both of its sides, at most `reach` px far.
JointWays ways_from(const FrameArcs& frame, const JointSite& site, double reach);
/// Where the arcs of a frame are cut: by arc, ascending, the indices of the vertices before the cuts.
using ArcCuts = std::vector<std::vector<std::uint32_t>>;

/// Robust standard deviations of a property of patches, along curves and between curves.
struct Spread {
  double step = 0;     ///< of neighbouring patches
  double along = 0;    ///< of the means of 25 px before and behind a place on a curve, beyond that of steps
  double between = 0;  ///< of curves
};
/// Holds the spreads of a clip; contrast and width as logarithms.
struct JointScales {
  Spread contrast, width;
  double turn = 0.1;  ///< rad, of curves at a place
};
/// Measures the spreads in the frames of a clip.
JointScales measure_scales(std::span<const FrameArcs> frames);

/// Differences between the two sides of a joint.
struct JointLook {
  double stronger = 0, wider = 0;  ///< side a less side b, of the logarithms of contrast and width
  double patches = 0;              ///< 1 / n of either side, summed
  double turn = 0;                 ///< rad, 0: one line
  bool other_kind = false;         ///< a line and a step, or lines of different sign
};
/// Measures the sides of a joint; nothing beyond the cuts counts.
JointLook look_at_joint(const FrameArcs& frame, const JointSite& site, const ArcCuts& cuts);

/// Log likelihood ratio, nats, of one curve through a joint to two curves that end there.
struct JointEvidence {
  double properties = 0;  ///< from contrast and width
  double turn = 0;
  [[nodiscard]] double total() const { return properties + turn; }
};
JointEvidence joint_evidence(const JointLook& look, const JointScales& scales);

}  // namespace emberfold::graph::detail
