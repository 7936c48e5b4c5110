// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "core/context.hpp"
#include "dytex/estimation/em.hpp"
#include "dytex/estimation/kalman.hpp"
#include "dytex/estimation/level_blocks.hpp"
#include "dytex/learning/frame_blocks.hpp"

namespace emberfold::dytex::detail {

/// The part of EM that reads pixels: C, the mean and the noise.
class Appearance {
 public:
  virtual ~Appearance() = default;
  /// Returns the clip's observations of the states under the present parameters.
  virtual Observations observe() = 0;
  /// Makes C and the noise most likely given the states, then returns observe().
  virtual Observations maximise(const Smoothed& smoothed) = 0;
  /// Returns Cᵀ C, n × n.
  [[nodiscard]] virtual Eigen::MatrixXd products() const = 0;
  /// Sets the texture's mean, C = C · right, and noise.
  virtual void write(const Eigen::MatrixXd& right, LinearDynamicTexture& texture) = 0;
  /// Returns the noise variance, the mean one where each value has its own.
  [[nodiscard]] virtual double r() const = 0;
  /// Returns the factor that removes the fit's bias from r; 1 where no frame is left over.
  [[nodiscard]] virtual double r_correction() const = 0;
  [[nodiscard]] virtual std::vector<std::string> notes() const { return {}; }
};

/// The input of both appearances. All must outlive the appearance.
struct AppearanceInput {
  FrameBlocks& frame_blocks;
  const Missing& missing;
  const LinearDynamicTexture& start;
  const EmOptions& options;
  const core::Context& context;
  LevelScale scale;
};

/// Makes the appearance of one noise variance and frames all seen or all hidden: it needs Yᵀ Y alone.
std::unique_ptr<Appearance> gram_appearance(const AppearanceInput& input);
/// Makes the appearance of a noise variance for each value, or of hidden pixels.
std::unique_ptr<Appearance> value_appearance(const AppearanceInput& input);

/// C = Y W and r, of frames Y (m × τ, less their mean) that are known by G = Yᵀ Y alone.
struct GramModel {
  Eigen::MatrixXd W;  ///< τ × n
  double r = 0;
};
/// Maximises the likelihood over C and r: W = X̂ᵀ S⁻¹, S = Σ E x xᵀ; r = (tr G − ⟨G X̂ᵀ, W⟩)/(m τ), at least
/// `least_noise`. `seen`: the frames of the smoothed states that Y has, ascending.
GramModel maximise_gram(const Eigen::MatrixXd& gram, Eigen::Index m, const std::vector<Eigen::Index>& seen,
                        const Smoothed& smoothed, double least_noise);
/// Makes the observations of all `frames` from Cᵀ C, Cᵀ Y and ‖y‖² of those seen.
Observations gram_observations(const Eigen::MatrixXd& products, const Eigen::MatrixXd& projections,
                               const Eigen::VectorXd& squares, Eigen::Index m, double r,
                               const std::vector<Eigen::Index>& seen, Eigen::Index frames);

}  // namespace emberfold::dytex::detail
