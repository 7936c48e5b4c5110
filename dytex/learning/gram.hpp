// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include <Eigen/Core>

#include "core/context.hpp"

namespace emberfold::dytex::detail {

/// Values in a sum block. Sums run over blocks that begin at multiples of it, so that they have the same bits
/// however frames are cut, if the cuts are between blocks.
constexpr std::size_t kBlock = 256;

/// Points to the same `count` values of every frame, of one depth (CV_8U, CV_16U or CV_32F).
struct FrameValues {
  std::vector<const void*> frames;
  std::size_t count = 0;
  int depth = 0;

  template <class Value>
  [[nodiscard]] const Value* frame(std::size_t index) const {
    return static_cast<const Value*>(frames[index]);
  }
};

/// Adds Yᵀ Y to `gram` (τ × τ, lower half; the upper half is unchanged), Y having a frame's values in each
/// column. 8-bit values are summed in whole numbers: exact as long as entries stay below 2⁵³. Others in
/// double, block by block. The same bits at any thread count. O(τ² count / 2).
void add_gram(const FrameValues& values, Eigen::MatrixXd& gram, const core::Context& context);

/// Returns the Gram matrix of the frames less their mean: J G J with J = I − 1 1ᵀ/τ. Reads the lower half.
Eigen::MatrixXd centred(const Eigen::MatrixXd& gram);
/// Returns the Gram matrix of the frames less the mean of the first `first` of them.
Eigen::MatrixXd centred(const Eigen::MatrixXd& gram, Eigen::Index first);

}  // namespace emberfold::dytex::detail
