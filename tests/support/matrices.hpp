// SPDX-License-Identifier: Apache-2.0
// Clips and models for tests of dynamic textures.
#pragma once

#include <cmath>
#include <cstdint>
#include <vector>

#include <Eigen/Core>
#include <opencv2/core.hpp>

#include "core/clip.hpp"
#include "core/rng.hpp"
#include "dytex/learning/dynamics.hpp"
#include "dytex/linear_dynamic_texture.hpp"
#include "dytex/synthesize.hpp"

namespace emberfold::test {

/// Returns a matrix of independent standard normal numbers, drawn column by column.
Eigen::MatrixXd normals(Eigen::Index rows, Eigen::Index columns, std::uint64_t seed);

/// Returns a matrix of orthonormal columns, those of a random matrix orthonormalised.
Eigen::MatrixXd orthonormal(Eigen::Index rows, Eigen::Index columns, std::uint64_t seed);

/// Returns a clip whose frames are the columns of `levels` (white = 255), converted to `depth`. The channels
/// of a pixel lie together.
core::Clip clip_of(const Eigen::MatrixXd& levels, int width, int height, int channels, int depth);

/// Returns a clip's frames as columns, white = 255.
Eigen::MatrixXd levels_of(const core::Clip& clip);

/// Makes a clip of waves of random phase and grain: 128 ± 60.
core::Clip wavy_clip(int width, int height, int channels, int depth, int frames, std::uint64_t seed = 1);

/// Makes a clip of 8 × 6 px that flares up by 5 % a frame: least squares finds growth. `grain`: SD of the
/// noise.
core::Clip flaring_clip(double grain);

/// Principal axes of states: diag(s) Vᵀ = `turn` · (states less their mean).
struct PrincipalAxes {
  dytex::detail::UnitStates states;
  Eigen::MatrixXd turn;
};
/// Finds the principal axes of the columns of `states` (n × τ).
PrincipalAxes principal_axes(const Eigen::MatrixXd& states);

/// Draws the first `count` frames of a texture.
std::vector<cv::Mat> drawn_frames(const dytex::LinearDynamicTexture& texture,
                                  const dytex::SynthesisOptions& options, int count);

/// Tells whether two textures agree in every bit.
bool same(const dytex::LinearDynamicTexture& a, const dytex::LinearDynamicTexture& b);

}  // namespace emberfold::test
