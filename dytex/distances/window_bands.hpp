// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>

/// Parts that the window spectra of clips and of models share.
namespace emberfold::dytex::detail {

constexpr int kWindow = 16;       // px, a side
constexpr int kSegment = 32;      // frames
constexpr int kTimeBands = 4;     // octaves from 1 cycle in a segment
constexpr int kPatterns = 4 * 7;  // widths times slants and directions
constexpr int kWindowBands = kTimeBands * kPatterns;

/// Transforms of a window's pixels and of a segment's frames, each under a Hann window; the latter ignore
/// constants.
struct WindowTransforms {
  Eigen::MatrixXf space;             ///< 2K × 256: the cosines of K frequencies, then their sines
  Eigen::MatrixXf time_cosine;       ///< 32 × 15, of 1 … 15 cycles in a segment
  Eigen::MatrixXf time_sine;         ///< 32 × 15
  std::vector<int> pattern, turned;  ///< K: the pattern of a wave exp(i(kx + ωt)), and of exp(i(kx − ωt))
};
/// Returns the transforms, made once.
const WindowTransforms& window_transforms();
/// Returns the octave of 1 … 15 cycles in a segment.
int time_band(int cycles);

/// Returns the upper left corners of the windows along a side of `length` px: `step` apart, in the middle.
std::vector<int> window_starts(int length, int step);
/// Returns the distance between windows, px: the window's side, or the multiple of it that keeps them at
/// 1024.
int window_step(int width, int height);

/// Returns the mean over moving windows of 10 log₁₀ of each band's share (energies: bands × windows). A
/// window moves if it has more than `least` energy and at least a tenth of the energy that one window in
/// twenty exceeds. Nothing where none moves.
std::optional<Eigen::VectorXd> mean_shares(const Eigen::MatrixXd& energies, double least);
/// Returns the energy in a window and segment of white noise of variance 1e-4 levels²: float's rounding.
double least_energy();

}  // namespace emberfold::dytex::detail
