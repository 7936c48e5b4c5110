// SPDX-License-Identifier: Apache-2.0
// The parameters and rest shapes of fire, cloth and river. Inner header of the built-in clips.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "apps/builtin/scene.hpp"
#include "core/rng.hpp"

namespace emberfold::apps {

/// The purposes of a scene's random streams.
enum class Purpose : std::uint32_t { wind = 1, body, gap, bridge, ground, noise };

/// The parameters of a scene, chosen visually so that its strokes look like fire, cloth or water.
struct Style {
  double area_per_body;        ///< px² of background per visible body
  double births;               ///< per visible body, in 100 frames
  double gaps, bridges;        ///< attempted, per visible body, in 100 frames
  double life;                 ///< frames, typical
  double pole_radius, period;  ///< of the modes; period in frames
  std::array<double, 3> sway;  ///< standard deviation of the modes, px
  double contrast_low, contrast_high;
  double sigma_low, sigma_high;                  ///< px
  double valleys;                                ///< share of valleys
  double flicker, flicker_wave, flicker_period;  ///< amplitude, px, frames (positive: runs along the line)
};

/// Returns the parameters of a scene.
const Style& style_of(BuiltinScene scene);

/// Draws a new body: its rest curves, direction, contrast and width; without curves where its place does not
/// fit. `flow`: four phases that all bodies of a clip share. `beside`: a nearby point.
Body draw_body(const BuiltinOptions& options, const std::array<double, 4>& flow,
               std::optional<cv::Point2d> beside, core::Rng& rng);

}  // namespace emberfold::apps
