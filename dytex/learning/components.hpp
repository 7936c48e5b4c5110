// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "core/context.hpp"
#include "dytex/learning/gram.hpp"

namespace emberfold::dytex::detail {

/// Adds the values' sums over all frames to `sums` (m), from entry `first` on. 8-bit values are summed
/// exactly, others frame by frame.
void add_sums(const FrameValues& values, std::size_t first, Eigen::VectorXd& sums,
              const core::Context& context);

/// Frames that C is summed from at a time; fixed, so that the bytes do not depend on how frames come.
constexpr std::size_t kBatch = 64;

/// Adds (Y − mean 1ᵀ) · weights to C's rows from `first` on, Y being the values of some frames, whole batches
/// of the clip and perhaps its last one. `mean`: m, of the clip; `weights`: frames × n, the rows of these
/// frames. In single precision. O(count · frames · n).
void add_components(const FrameValues& values, std::size_t first, const Eigen::VectorXd& mean,
                    const Eigen::MatrixXd& weights, Eigen::MatrixXf& C, const core::Context& context);
/// Sets C's rows to (Y − mean 1ᵀ) · weights in double, rounded at the end. For frames whose directions differ
/// much in size; Y holds all frames of the clip.
void make_components(const FrameValues& values, std::size_t first, const Eigen::VectorXd& mean,
                     const Eigen::MatrixXd& weights, Eigen::MatrixXf& C, const core::Context& context);

/// Makes C's columns orthonormal again after rounding: C ← C L⁻ᵀ with CᵀC = L Lᵀ. NumericalError
/// where columns depend on each other. O(m n²).
void orthonormalise(Eigen::MatrixXf& C, const core::Context& context);

}  // namespace emberfold::dytex::detail
