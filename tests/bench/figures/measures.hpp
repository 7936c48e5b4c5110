// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "tests/bench/figures/inputs.hpp"
#include "tests/bench/figures/table.hpp"

namespace emberfold::figures {

// Each throws Missing where it lacks what it reads.

/// Place and width of bars drawn by formula.
std::vector<Row> profiles(const Inputs& inputs);
/// Centre lines and junctions of scenes against their truth.
std::vector<Row> scenes(const Inputs& inputs);
/// Frames of clips from a fifth of their pixels, against a Canny band and random pixels.
std::vector<Row> reconstruction(const Inputs& inputs);
/// Strokes found in pure noise.
std::vector<Row> noise(const Inputs& inputs);
/// Measures the share of a sketch that is found again under another draw of noise.
std::vector<Row> steadiness(const Inputs& inputs);
/// Measures the effect of flips, a quarter turn, brightness and contrast on the graph.
std::vector<Row> symmetry(const Inputs& inputs);
/// CPU time of a frame on one thread.
std::vector<Row> speed(const Inputs& inputs);

}  // namespace emberfold::figures
