// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "graph/patch.hpp"
#include "mcmc/inference/change_posterior.hpp"
#include "pipeline/inference/frame_window.hpp"

namespace emberfold::pipeline {

/// Measures the similarity of a place in successive frames and in frames 6 to 10 apart.
/// Both before and after a change in frame `at` (of a clip of `frames`), never only across it. Windows of 26
/// px are compared, searched for up to 10 px to each side, at half the resolution: the median of the best
/// correlation coefficients. `window` must hold the frames at − 10 to at + 9, as far as the clip has them.
/// Nothing where the frames are too small or too few or show nothing there. The reversed clip gives the same.
/// O(1).
std::optional<mcmc::FrameLikeness> measure_likeness(const FrameWindow& window, int at, graph::Point place,
                                                    int frames);

}  // namespace emberfold::pipeline
