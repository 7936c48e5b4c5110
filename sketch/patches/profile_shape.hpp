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
  double half_width = 0, half_hollow = 0, blur = 1;  ///< px

  ProfileShape() = default;
  explicit ProfileShape(const graph::Patch& patch)
      : half_width(std::max(patch.width, 0.0) / 2),
        half_hollow(std::clamp(patch.hollow / 2, 0.0, half_width)),
        blur(std::max(patch.blur, kLeastBlur)) {}

  /// Holds the shares of three changes of the levels, each 0…1.
  /// They are from left to middle, from middle to right, and from middle to between.
  struct Reached {
    double enter, leave, hollow;
    [[nodiscard]] double level(double left, double middle, double right, double between) const {
      return left + enter * (middle - left) + leave * (right - middle) + hollow * (between - middle);
    }
  };
  /// Returns the changes reached at a distance from the curve, px, positive to the right. `step`: Φ.
  template <class Step>
  [[nodiscard]] Reached at(double distance, const Step& step) const {
    const double enter = step((distance + half_width) / blur);
    const double leave = half_width > 0 ? step((distance - half_width) / blur) : enter;
    if (half_hollow <= 0) return {enter, leave, 0};
    return {enter, leave, step((distance + half_hollow) / blur) - step((distance - half_hollow) / blur)};
  }
  [[nodiscard]] Reached at(double distance) const { return at(distance, blurred_step); }
};

}  // namespace emberfold::sketch
