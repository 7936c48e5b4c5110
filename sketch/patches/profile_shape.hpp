// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>

#include "graph/patch.hpp"

namespace emberfold::sketch {

inline constexpr double kLeastBlur = 0.2;  ///< px: a pixel does not show less

/// Returns Φ(d): the share of a blurred unit step that is reached at `d` SD.
inline double blurred_step(double d) {
  return 0.5 * (1 + std::erf(d / std::numbers::sqrt2));
}

/// Holds where the profile across a line or a step changes (graph::Patch), whatever its levels.
struct ProfileShape {
  double half_width = 0, blur = 1;  ///< px

  ProfileShape() = default;
  explicit ProfileShape(const graph::Patch& patch)
      : half_width(std::max(patch.width, 0.0) / 2), blur(std::max(patch.blur, kLeastBlur)) {}

  /// Holds the shares of two changes of the levels, each 0…1: from left to middle, and from middle to right.
  struct Reached {
    double enter, leave;
    [[nodiscard]] double level(double left, double middle, double right) const {
      return left + enter * (middle - left) + leave * (right - middle);
    }
  };
  /// Returns the changes reached at a distance from the curve, px, positive to the right. `step`: Φ.
  template <class Step>
  [[nodiscard]] Reached at(double distance, const Step& step) const {
    const double enter = step((distance + half_width) / blur);
    const double leave = half_width > 0 ? step((distance - half_width) / blur) : enter;
    return {enter, leave};
  }
  [[nodiscard]] Reached at(double distance) const { return at(distance, blurred_step); }
};

}  // namespace emberfold::sketch
