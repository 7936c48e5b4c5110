// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <utility>
#include <vector>

#include <Eigen/Core>

namespace emberfold::dytex::detail {

/// Singular values and right singular vectors of centred frames.
struct Spectrum {
  Eigen::VectorXd singular;  ///< τ, falling, in levels
  Eigen::MatrixXd V;         ///< τ × rank
  [[nodiscard]] Eigen::Index rank() const { return V.cols(); }
};

/// Decomposes the raw Gram matrix of frames, of which the lower half is read. `to_levels`: levels that a
/// value of 1 stands for; `values`: of a frame. InputError where an entry is not finite. O(τ³).
Spectrum spectrum(const Eigen::MatrixXd& gram, double to_levels, Eigen::Index values);

/// Counts the singular values that stand out of white noise of unknown strength: those above ω(β) times their
/// median (Gavish, Donoho 2014, "The optimal hard threshold for singular values is 4/√3", eq. 5), β = (τ − 1)
/// / m. Only the first τ − 1 values count: the last one is 0, since the mean is subtracted.
Eigen::Index gavish_donoho(const Eigen::Ref<const Eigen::VectorXd>& singular, Eigen::Index values);

/// Measures how well models of n components predict the last fifth of the frames, each from the one before
/// it, learned from the others: levels² a value, for rising n. Needs the raw Gram matrix alone: ‖y(t+1) − C A
/// Cᵀ y(t)‖² = ‖y(t+1)‖² − ‖x(t+1)‖² + ‖x(t+1) − A x(t)‖². Every n up to 60, further ones in steps of 5 %.
/// Empty where the clip is too short (fewer than 10 frames) or still. O(τ³) and O(n² τ) for each n.
std::vector<std::pair<int, double>> held_out_errors(const Eigen::MatrixXd& gram, double to_levels,
                                                    Eigen::Index values);

}  // namespace emberfold::dytex::detail
