// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <complex>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "dytex/linear_dynamic_texture.hpp"

namespace emberfold::apps {

/// A mode of a linear dynamic texture: an eigenvalue of A, a conjugate pair as one.
struct TextureMode {
  double radius = 0;  ///< of the eigenvalue: the share of a deflection that remains after a frame
  double angle = 0;   ///< rad per frame, 0…π
  bool pair = false;
  [[nodiscard]] double period() const;  ///< frames; infinite for angle 0
  [[nodiscard]] double decay() const;   ///< frames until 1/e remains; 0 for radius 0
};

/// Returns all eigenvalues of A, slowest decay first, each with positive imaginary part followed by its
/// conjugate.
std::vector<std::complex<double>> texture_eigenvalues(const dytex::LinearDynamicTexture& texture);
/// Returns the modes, slowest decay first.
std::vector<TextureMode> texture_modes(const dytex::LinearDynamicTexture& texture);

/// Returns the share of the clip's variance in the first `count` components, 0…1; 1 for a still clip.
double share_of_variance(const dytex::LinearDynamicTexture& texture, Eigen::Index count);

/// Writes order, sizes, share of variance, spectral radius, noise and all modes.
nlohmann::ordered_json texture_json(const dytex::LinearDynamicTexture& texture);
/// Writes the same as a table, with the `slowest` slowest modes.
std::string texture_table(const dytex::LinearDynamicTexture& texture, std::size_t slowest);

}  // namespace emberfold::apps
