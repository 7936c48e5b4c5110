// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "core/context.hpp"
#include "graph/curves/joint_finding.hpp"

namespace emberfold::graph::detail {

/// Measurements of a joint in many frames.
struct JointRecord {
  std::vector<double> stronger, wider, patches, turn;
  double inside = 0,
         other_kind = 0;  ///< frames in which it lies on an arc, and in which its sides are of other kinds

  /// Adds a frame. `sense`: −1 where its side a is side b of the record.
  void add(const TimedJoint& joint, double sense);
  /// Returns the odds that its sides are one curve, nats: from its usual look, which counts more the longer
  /// it lasts. At least one frame.
  [[nodiscard]] double odds(const JointScales& scales) const;
};

/// Finds the joints of all frames and follows them through time; each gets the odds of its whole track.
/// O(n log n) in patches.
std::vector<std::vector<TimedJoint>> follow_joints(const ClipArcs& clip, const JointScales& scales,
                                                   const core::Context& context);

}  // namespace emberfold::graph::detail
