// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include <nlohmann/json_fwd.hpp>

#include "graph/events/topology_changes.hpp"
#include "graph/motion_graph.hpp"

namespace emberfold::apps {

/// Returns {"gaps", "balanced", "changes": {change: {"count", "tips", "branches", "components", "loops"}},
/// "said", "measured"}: the number of pairs of neighbouring frames, the number of them in which the network's
/// figures change as the changes predict, and the sums of both over the clip.
nlohmann::ordered_json balance_json(const graph::MotionGraph& motion,
                                    std::span<const graph::TopologyChange> changes);

/// Returns the network's figures by frame for the report: {"step", "length", "tips", "junctions", "loops",
/// "components"}, means over `step` frames, so that a list has at most 1500 values.
nlohmann::ordered_json report_network(const graph::MotionGraph& motion);

}  // namespace emberfold::apps
