// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "core/clip.hpp"
#include "core/context.hpp"
#include "dytex/linear_dynamic_texture.hpp"

namespace emberfold::dytex {

struct LearnOptions {
  int components = 50;           ///< n, 1 … τ − 1: order of the model
  std::optional<double> energy;  ///< (0, 1]: instead of n, the fewest components with this share of variance
  /// bytes, ≥ 1 MiB: for frames held at a time; more passes where they do not fit. At least 256 values of
  /// every frame are held.
  std::size_t memory = std::size_t{1} << 30;

  /// InputError naming the field, its value and what is allowed.
  void validate() const;
};

/// How the transition matrix came about.
enum class Transition { least_squares, yule_walker };

struct LearnResult {
  LinearDynamicTexture texture;
  double least_squares_radius =
      0;  ///< spectral radius of the least-squares A; at or above 1 it was not taken
  Transition transition = Transition::least_squares;
  int passes = 1;                  ///< over the source
  std::vector<std::string> notes;  ///< a line for everything that was not taken as asked or measured
  core::Status status = core::Status::done;  ///< cancelled: the texture is empty
};

/// Learns in closed form (Soatto, Doretto, Wu 2001, section 4; Doretto, Chiuso, Wu, Soatto 2003,
/// section 4.1): with Y the frames less their mean (m × τ) and Y = C S Vᵀ cut after n components, the states
/// are X = S Vᵀ, A is the least-squares fit of x(t+1) to x(t), B Bᵀ the covariance of what that leaves, and r
/// the variance of what n components leave of the frames, (‖Y‖² − ‖X‖²) / ((m − n)(τ − 1 − n)). The
/// decomposition goes by YᵀY = V S² Vᵀ (snapshots), which takes frames band by band.
///
/// Where the least-squares A is not stable, or leaves no noise at all, A = Σ x(t+1) x(t)ᵀ S⁻² is taken
/// (Yule–Walker), with the noise that makes the stationary covariance exactly the data's, S²/τ; a note says
/// so, as one does where clips drawn from the model would vary 1.5 times more or less than the clip. Frames
/// of fewer independent directions than n give fewer components, and a note.
///
/// The source is read from its beginning, as often as `memory` demands: once if all frames fit. The same
/// bytes at any thread count and any budget of memory. InputError where n is above τ − 1, where there are
/// fewer than 2 or more than 5000 frames, or where a value is not finite. O(m τ²) + O(τ³).
LearnResult learn(core::FrameSource& source, const LearnOptions& options = {},
                  const core::Context& context = {});

}  // namespace emberfold::dytex
