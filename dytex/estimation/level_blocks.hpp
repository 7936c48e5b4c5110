// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>

#include <Eigen/Core>

#include "core/context.hpp"
#include "dytex/estimation/kalman.hpp"
#include "dytex/estimation/missing_pixels.hpp"
#include "dytex/learning/gram.hpp"

namespace emberfold::dytex::detail {

/// The scale of values that are read.
struct LevelScale {
  double to_levels = 1;      ///< white shows as 255
  std::size_t channels = 1;  ///< values next to each other that are one pixel
};

/// Reads `rows` values of every frame from entry `begin` on, in levels less their mean; 0 where hidden.
/// `first`: the frame block's first value, `first_frame`: of values.frames. `mean`: of the `rows` values.
/// InputError where a value that is seen is not finite.
Eigen::MatrixXd level_block(const FrameValues& values, std::size_t first, std::size_t begin,
                            Eigen::Index rows, std::size_t first_frame, const LevelScale& scale,
                            const Missing& missing, const Eigen::Ref<const Eigen::VectorXd>& mean);

/// Calls body(slab, first row, rows) for blocks of kBlock rows below m: those of a slab one after another,
/// slabs in parallel. Sums kept by slab and then added in order are the same at any thread count.
constexpr std::size_t kSumSlabs = 16;
void for_sum_blocks(Eigen::Index m, const core::Context& context,
                    const std::function<void(std::size_t, Eigen::Index, Eigen::Index)>& body);

/// A block of C's rows and the inverse noise variance of each.
struct WeightedRows {
  Eigen::MatrixXd C;        ///< rows × n
  Eigen::VectorXd inverse;  ///< rows
};
using RowsOf = std::function<WeightedRows(Eigen::Index row, Eigen::Index rows)>;

/// Sets the information and the constants of every frame, which do not depend on its values. `m`: values of a
/// frame. O(m n²), and O(n²) for each hidden value, or seen one where those are fewer, of frames that hide
/// other pixels than the one before.
void add_information(Eigen::Index m, Eigen::Index n, std::size_t frames, const LevelScale& scale,
                     const Missing& missing, const RowsOf& rows_of, Observations& result,
                     const core::Context& context);

}  // namespace emberfold::dytex::detail
