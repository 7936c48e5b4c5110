// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "core/context.hpp"
#include "dytex/learning/gram.hpp"

namespace emberfold::dytex::detail {

/// sums (m) += the values' sums over all frames from value `first` on. 8-bit values exactly; others frame by
/// frame.
void add_sums(const FrameValues& values, std::size_t first, Eigen::VectorXd& sums,
              const core::Context& context);

/// Frames are taken so many at a time wherever C is summed: the same bytes however they come.
constexpr std::size_t kBatch = 64;

/// Adds (Y − mean 1ᵀ) · weights to C's rows from `first` on, Y being the values of some frames, whole batches
/// of the clip and perhaps its last one. `mean`: m, of the clip; `weights`: frames × n, the rows of these
/// frames. In single precision. O(count · frames · n).
void add_components(const FrameValues& values, std::size_t first, const Eigen::VectorXd& mean,
                    const Eigen::MatrixXd& weights, Eigen::MatrixXf& C, const core::Context& context);
/// The same in double, rounded at the end: for frames whose directions differ much in size. Y holds all
/// frames of the clip.
void make_components(const FrameValues& values, std::size_t first, const Eigen::VectorXd& mean,
                     const Eigen::MatrixXd& weights, Eigen::MatrixXf& C, const core::Context& context);

/// Sets C to 0 where a row is not of its column's channel.
void keep_channels(const Eigen::VectorXi& channels, int of_channels, Eigen::MatrixXf& C,
                   const core::Context& context);

/// C ← C L⁻ᵀ with CᵀC = L Lᵀ: what rounding took from the columns' right angles and lengths. NumericalError
/// where columns depend on each other. O(m n²).
void orthonormalise(Eigen::MatrixXf& C, const core::Context& context);

}  // namespace emberfold::dytex::detail
