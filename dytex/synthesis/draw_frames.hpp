// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include <Eigen/Core>

#include "dytex/learning/kernels.hpp"

namespace emberfold::dytex::detail {

constexpr Eigen::Index kBatch = 8;  ///< frames that one pass over C draws

/// The input of eight frames: mean + C · states.
struct Batch {
  const float* mean = nullptr;  ///< m
  const float* C = nullptr;     ///< m × n, column by column
  Eigen::Index values = 0;      ///< m
  Eigen::Index components = 0;  ///< n
  /// n × 8, a component's eight frames together: weights times states.
  const float* states = nullptr;
};

/// Draws values first … first + count − 1 of the eight frames, rounded (ties to even) and saturated to 0 …
/// 255, into frames[i] + first. The same bits with every instruction set: a value is a sum in the order of
/// the components, products and sums rounded one by one. A set that the machine lacks ends the process. O(8
/// count n).
void draw_bytes(const Batch& batch, Eigen::Index first, Eigen::Index count,
                const std::array<std::uint8_t*, kBatch>& frames, Isa isa);
/// Draws these values unrounded, into frames[i] (no offset).
void draw_levels(const Batch& batch, Eigen::Index first, Eigen::Index count,
                 const std::array<float*, kBatch>& frames, Isa isa);

/// Rounds a level to 8 bits: to the nearest, ties to even, saturated; 0 for a NaN.
std::uint8_t byte_of(float level);

}  // namespace emberfold::dytex::detail
