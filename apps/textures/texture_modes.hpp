// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <complex>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "dytex/linear_dynamic_texture.hpp"

namespace emberfold::apps {

/// One way in which a linear dynamic texture moves by itself: an eigenvalue of A, a conjugate pair as one.
struct TextureMode {
  double radius = 0;  ///< of the eigenvalue: what is left of a deflection after a frame
  double angle = 0;   ///< rad a frame, 0…π
  bool pair = false;
  [[nodiscard]] double period() const;  ///< frames; infinite for angle 0
  [[nodiscard]] double decay() const;   ///< frames until 1/e is left; 0 for radius 0
};

/// All eigenvalues of A, one above the real axis and its conjugate, slowest decay first.
std::vector<std::complex<double>> texture_eigenvalues(const dytex::LinearDynamicTexture& texture);
/// The modes, slowest decay first.
std::vector<TextureMode> texture_modes(const dytex::LinearDynamicTexture& texture);

/// The share of the clip's variance that the first `count` components hold, 0…1; 1 for a clip that stands
/// still.
double share_of_variance(const dytex::LinearDynamicTexture& texture, Eigen::Index count);

/// Order, sizes, share of variance, spectral radius, noise and all modes.
nlohmann::ordered_json texture_json(const dytex::LinearDynamicTexture& texture);
/// The same as a table to read, with the `slowest` first modes.
std::string texture_table(const dytex::LinearDynamicTexture& texture, std::size_t slowest);

}  // namespace emberfold::apps
