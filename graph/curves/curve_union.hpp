// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "graph/curves/joint_tracks.hpp"

namespace emberfold::graph::detail {

/// The identity of each frame's vertices, from 1.
using Identities = std::vector<std::vector<std::uint32_t>>;

/// Unites identities that all their joints together take for one curve.
/// A joint that is lost and found again in time has several tracks; this weighs them as one. The likeliest
/// first; not if what speaks against any two of the united curves outweighs it.
void unite_identities(const ClipArcs& clip, const std::vector<std::vector<TimedJoint>>& joints,
                      const JointScales& scales, Identities& identity);

}  // namespace emberfold::graph::detail
