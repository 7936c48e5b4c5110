// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>

#include "dytex/quilting/trajectories.hpp"

/// The rank-k basis in which trajectories are compared. Inner header of quilting.
namespace emberfold::dytex::detail {

/// Orthonormal directions of the trajectories of pixels, D × k, and their mean, D; D = course · chunks of
/// Trajectories. Without directions whole trajectories are compared.
struct Basis {
  Eigen::MatrixXf directions;
  Eigen::VectorXf mean;
  bool complete = false;  ///< there are no directions and no residual
};

/// Fits the basis to at most 4096 pixels drawn from all sources by randomised subspace iteration (Halko,
/// Martinsson & Tropp 2011), with 8 extra directions and two rounds. Fewer than `components` where the
/// trajectories have no more; complete where they have at most that number of values. Sources agree in all
/// but their size.
Basis fit_basis(std::span<const Trajectories* const> sources, int components, std::uint64_t seed);

/// Projects the sources onto the basis: for each its planes, CV_32F of its size. k coefficients a = Uᵀ(s − μ)
/// and, unless complete, the norm r of their residual, less a constant. As U is orthonormal, ‖Δa‖² + (r₁ −
/// r₂)² ≤ ‖s₁ − s₂‖² ≤ ‖Δa‖² + (r₁ + r₂)². O(pixels · D · k).
std::vector<std::vector<cv::Mat>> project_trajectories(std::span<const Trajectories* const> sources,
                                                       const Basis& basis, const core::Context& context);

}  // namespace emberfold::dytex::detail
