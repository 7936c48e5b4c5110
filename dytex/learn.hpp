// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>

#include "core/clip.hpp"
#include "core/context.hpp"
#include "dytex/linear_dynamic_texture.hpp"

namespace emberfold::dytex {

struct LearnOptions {
  int components = 50;           ///< n, 1 … τ − 1: order of the model
  std::optional<double> energy;  ///< (0, 1]: instead of n, the fewest components with this share of variance
  std::size_t memory = std::size_t{1} << 30;  ///< bytes, ≥ 1 MiB: for frames held at a time; more passes where they do not fit

  void validate() const;
};

/// How the transition matrix came about.
enum class Transition { least_squares, yule_walker };

struct LearnResult {
  LinearDynamicTexture texture;
  double least_squares_radius = 0;  ///< spectral radius of the least-squares A; at or above 1 it was not taken
  Transition transition = Transition::least_squares;
  int passes = 1;  ///< over the source
  core::Status status = core::Status::done;  ///< cancelled: the texture is empty
};

/// Closed form (Soatto, Doretto, Wu 2001, §4): … to be completed by the room
LearnResult learn(core::FrameSource& source, const LearnOptions& options, const core::Context& context = {});

}  // namespace emberfold::dytex
