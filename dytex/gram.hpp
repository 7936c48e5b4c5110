// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include <Eigen/Core>

#include "core/context.hpp"

namespace emberfold::dytex::detail {

/// Values of frames are summed in blocks of so many, begun at multiples of it: sums are the same bits however
/// frames are cut into bands, if bands begin at blocks.
constexpr std::size_t kBlock = 256;

/// The same `count` values of every frame, of one depth (CV_8U, CV_16U or CV_32F).
struct FrameValues {
  std::vector<const void*> frames;
  std::size_t count = 0;
  int depth = 0;
};

/// Adds Yᵀ Y to `gram` (τ × τ, lower half; the upper half is left alone), Y having a frame's values in each
/// column. 8-bit values are summed in whole numbers: exact as long as entries stay below 2⁵³. Others in
/// double, block by block. The same bits at any thread count. O(τ² count / 2).
core::Status add_gram(const FrameValues& values, Eigen::MatrixXd& gram, const core::Context& context);

/// J G J with J = I − 1 1ᵀ/τ: the Gram matrix of the frames less their mean. Reads the lower half.
Eigen::MatrixXd centred(const Eigen::MatrixXd& gram);

}  // namespace emberfold::dytex::detail
