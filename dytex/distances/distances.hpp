// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "core/context.hpp"
#include "dytex/distances/window_spectra.hpp"
#include "dytex/linear_dynamic_texture.hpp"

/// Exact distances between linear dynamic textures: no sum is truncated after some number of frames. All but
/// the windows' compare pixel by pixel. Both models must have frames of equal size and channels, else
/// InputError. Pixels are visited once, for the products of the components, O(m n²); the rest is O(n³) for
/// each doubling.
namespace emberfold::dytex {

/// Returns whether the noise variance is above 0 in all of the frame's values, so that there are KL rates.
bool has_noise(const LinearDynamicTexture& texture);

/// Returns the KL divergence rate of clips of `p` from clips of `q`: lim KL(p_T ‖ q_T) / T of the densities
/// of T frames, nats a frame, ≥ 0. Not symmetric. Means count. A rate below the rounding of its terms is 0.
/// Throws InputError where a model's noise r is 0, since the rate is then infinite.
double kl_rate(const LinearDynamicTexture& p, const LinearDynamicTexture& q);

/// Returns KL(p_T ‖ q_T) of clips of T = 1 … length frames that begin in the stationary state, nats (Soatto,
/// Doretto, Wu 2001, section 4.4 and Fig. 3). length is 1 … 100,000. As kl_rate() else. O(length n³).
Eigen::VectorXd kl_growth(const LinearDynamicTexture& p, const LinearDynamicTexture& q, int length,
                          const core::Context& context = {});

/// Returns the angles between the observability spaces of two models, the columns of [C; C A; C A²; …] (De
/// Cock, De Moor 2002): rad, 0 … π/2, rising, one for each observable state of the smaller model. Angles
/// below some 1e-6 rad, the rounding, are 0. Means and noise do not count. Throws InputError where a model
/// has no components.
Eigen::VectorXd subspace_angles(const LinearDynamicTexture& p, const LinearDynamicTexture& q);

/// Returns Martin's distance √(−2 Σ log cos θ) over these angles (Martin 2000; De Cock, De Moor 2002, eq.
/// 16); infinite where one is right.
double martin_distance(const Eigen::Ref<const Eigen::VectorXd>& angles);
/// Returns the Grassmann distance √(Σ θ²), rad: the length of the geodesic from one space to the other.
double grassmann_distance(const Eigen::Ref<const Eigen::VectorXd>& angles);

/// All distances of one pair.
struct Distances {
  std::optional<double> kl, kl_back;  ///< KL rates of p from q and of q from p; none where a noise r is 0
  Eigen::VectorXd angles;             ///< none where a model has no components
  /// window_distance(), dB; none where a model has no window_spectrum().
  std::optional<double> windows;
};

enum class Measure { kl, martin, angles, windows };
constexpr Measure kMeasures[] = {Measure::kl, Measure::martin, Measure::angles, Measure::windows};
/// Returns "kl", "martin", "angles" or "windows".
const char* name(Measure measure);

/// Returns whether the pair has such a distance.
bool has(const Distances& distances, Measure measure);
/// Returns one distance: the KL rate of p from q, Martin's distance, the Grassmann distance, or
/// the windows' distance. 0 for equals. InputError where `distances` has no such number.
double distance(const Distances& distances, Measure measure);

/// Computes all distances of one pair.
Distances distances(const LinearDynamicTexture& p, const LinearDynamicTexture& q);

/// Computes the distances of every pair i ≤ j, row by row: (0, 0), (0, 1) … (0, K − 1), (1, 1) …. The same
/// bytes at any thread count; InputError names the model ("model 3: …", from 0) that does not fit the first.
/// `windows`: descriptions of the clips that the models are of, one each; without them, the models' own.
std::vector<Distances> all_distances(std::span<const LinearDynamicTexture> models,
                                     const core::Context& context = {},
                                     std::span<const WindowSpectrum> windows = {});

/// Makes the K × K matrix of one measure from the pairs of all_distances(): entry (i, j) is the distance of i
/// from j, NaN where the pair has none.
Eigen::MatrixXd distance_matrix(std::span<const Distances> pairs, Measure measure);

}  // namespace emberfold::dytex
