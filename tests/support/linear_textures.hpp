// SPDX-License-Identifier: Apache-2.0
// Small textures of known parameters, for tests that compare textures.
#pragma once

#include <cstdint>

#include <opencv2/core/hal/interface.h>

#include "tests/support/matrices.hpp"

namespace emberfold::test {

/// Makes a texture of width × height values that shows `components` of `order` numbers. A's spectral radius
/// is `radius`.
dytex::LinearDynamicTexture made_texture(int width, int height, Eigen::Index components, std::uint64_t seed,
                                         double radius = 0.8, Eigen::Index order = 0);

/// Returns the same process in other coordinates: states in reverse order, every second one negated. Exact.
dytex::LinearDynamicTexture in_other_coordinates(dytex::LinearDynamicTexture texture);

/// Returns C diag(weights), with columns of 0 for the numbers of the state that no frame shows.
Eigen::MatrixXd whole_C(const dytex::LinearDynamicTexture& texture);

}  // namespace emberfold::test
