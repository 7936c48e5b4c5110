// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>

#include "graph/motion_graph.hpp"

namespace emberfold::pipeline {

/// Reads the motion graph of a finished run, the one that analyze() returned, from its stored stages.
/// Nothing where the folder has no such stage. `least_probability`: of its events, where they were those of
/// strokes, weighed by the images and not reviewed. O(patches).
std::optional<graph::MotionGraph> read_kept_motion(const std::filesystem::path& run,
                                                   std::optional<double> least_probability);

}  // namespace emberfold::pipeline
