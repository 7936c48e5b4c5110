// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "core/clip.hpp"
#include "core/context.hpp"

namespace emberfold::dytex {

struct CurveOptions {
  int components = 20;  ///< n, ≥ 1: fixed, whatever the length
  int lengths = 32;     ///< 2 … 1000: number of lengths, evenly from n + 2 to the longest
  int targets = 8;      ///< 1 … 1000: frames predicted for each, evenly over the last quarter of the clip
  int longest = 600;    ///< ≥ 1: frames; longer windows are not tried
  double tolerance =
      0.05;  ///< > 0: of the plateau, within which the error must stay from the critical length on
  std::size_t memory = std::size_t{1} << 30;  ///< bytes, ≥ 1 MiB: for frames held at a time

  /// Throws InputError naming the field, its value and what is allowed.
  void validate() const;
};

struct CurvePoint {
  int length = 0;       ///< τ: frames that the model was learned from
  double error = 0;     ///< RMS per value, levels, of frame τ + 1; the mean over all targets
  double spread = 0;    ///< its standard deviation over targets
  double left_out = 0;  ///< the part that n components cannot show under any prediction; mean over targets
};

struct LearningCurve {
  std::vector<int> targets;        ///< predicted frames, from 0, rising
  std::vector<CurvePoint> points;  ///< by rising length
  double plateau = 0;              ///< mean error of the longest quarter of lengths
  std::optional<int>
      critical;  ///< the length from which on the error stays at the plateau; none: too short a clip
  double frame_before = 0;  ///< the same error where the prediction is the frame before
};

/// Measures how the prediction error of the next frame falls with the length τ of the training window
/// (Soatto, Doretto, Wu 2001, section 4.2 and Fig. 2). Every length predicts the same frames, each from the
/// window that ends just before it, so that lengths differ by length alone. The error follows from the Gram
/// matrix: with x = Cᵀ (y − ȳ), ‖y − ŷ‖² = ‖y − ȳ‖² − ‖x‖² + ‖x − A x(τ)‖²; pixels are read once. Throws
/// InputError where the clip is too short (⌊3/4 of its frames⌋ must be n + 3 at least) or too long (5000
/// frames) or has a value that is not finite. O(m τ²) once and O(τ³) for each length and target; the same
/// bytes at any thread count.
LearningCurve learning_curve(core::FrameSource& source, const CurveOptions& options = {},
                             const core::Context& context = {});

}  // namespace emberfold::dytex
