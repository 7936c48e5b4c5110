// SPDX-License-Identifier: Apache-2.0
// Inner header of the built-in clips.
#pragma once

#include <array>
#include <vector>

#include "apps/builtin/scene.hpp"
#include "core/rng.hpp"

namespace emberfold::apps {

/// Noise that is white in time and smooth in space; it drives neighbouring strokes alike.
class Wind {
 public:
  explicit Wind(const BuiltinOptions& options);

  /// Simulates the modes q of a body for frames first…last. Its auto-regression, started long before, is
  /// driven by the gusts at the middle of its first curve and, for a small part, by noise from `rng`. `sd`:
  /// stationary standard deviation of each mode, px.
  [[nodiscard]] std::vector<std::array<double, 3>> sway(const Body& body, int first, int last,
                                                        const std::array<double, 3>& sd, core::Rng rng) const;

 private:
  int columns_, rows_;
  std::vector<std::array<double, 3>>
      gusts_;  ///< by frame, from `settle` frames before the first, and by bump
};

}  // namespace emberfold::apps
