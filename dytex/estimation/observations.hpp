// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/clip.hpp"
#include "core/context.hpp"
#include "dytex/estimation/kalman.hpp"
#include "dytex/estimation/missing_pixels.hpp"
#include "dytex/linear_dynamic_texture.hpp"

namespace emberfold::dytex {

/// Returns the texture's state space, begun from its stationary distribution.
StateSpace state_space(const LinearDynamicTexture& texture);

/// Reads the observations of a texture's states from a clip's frames, for filter() and smooth(). States have
/// N numbers, of which frames show the first n. `missing`: hidden pixels. Noise variances below `least_noise`
/// (levels², > 0) count as that. Reads the source once from its beginning, eight frames at a time; the same
/// bytes at any thread count. InputError where the texture is not valid, sizes disagree, there is no frame,
/// or a value that is seen is not finite. O(m n) a frame and O(m n²), with hidden pixels as
/// maximise_likelihood().
Observations observe(const LinearDynamicTexture& texture, core::FrameSource& source,
                     const Missing& missing = {}, const core::Context& context = {},
                     double least_noise = 1.0 / 12);

/// A Gaussian belief about a state: N(mean, F Fᵀ).
struct StateGuess {
  Eigen::VectorXd mean;    ///< N
  Eigen::MatrixXd factor;  ///< N × any
};
/// Returns the state of the last frame that was filtered.
StateGuess last_state(const Filtered& filtered);
/// Returns the state of the last frame that a texture was learned from, as uncertain as after a filter over
/// the same number of frames. Throws InputError where the texture is not valid. O(m n²).
StateGuess last_training_state(const LinearDynamicTexture& texture, double least_noise = 1.0 / 12);

}  // namespace emberfold::dytex
