// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "core/clip.hpp"
#include "core/context.hpp"
#include "dytex/estimation/missing_pixels.hpp"
#include "dytex/learn.hpp"
#include "dytex/linear_dynamic_texture.hpp"

namespace emberfold::dytex {

struct EmOptions {
  int iterations = 50;      ///< at most, 1 … 100000
  double tolerance = 1e-7;  ///< 0 … 1: stops once the log-likelihood grows by less than this share of it
  bool noise_per_value = false;   ///< a noise variance for each value of a frame, not one for all
  double least_noise = 1.0 / 12;  ///< levels², > 0: no noise variance below this, that of rounding to levels
  std::size_t memory = std::size_t{1} << 30;  ///< bytes, ≥ 1 MiB: for frames held at a time

  /// Throws InputError naming the field, its value and what is allowed.
  void validate() const;
};

struct EmResult {
  LinearDynamicTexture texture;
  std::vector<double> log_likelihood;  ///< of the start and after each iteration, never falling
  bool converged = false;              ///< stopped by the tolerance
  double likelihood_r = 0;             ///< r as likelihood has it, before its bias was taken out
  int passes = 0;                      ///< over the source
  std::vector<std::string> notes;      ///< a line for everything not as requested or measured
};

/// Finds the most likely model by EM (Shumway, Stoffer 1982), from the model `start` of the same clip: filter
/// and smoother in n dimensions, then A, B, x(0), C and the noise that make the smoothed states most likely.
/// - With one noise variance and whole frames, C stays in the span of the frames, C = Y W: after one pass
/// over
///   the pixels an iteration takes O(τ² n + τ n² + n³), whatever their number.
/// - With a noise variance for each value, or hidden pixels, an iteration reads all values: O(m n τ), for
/// hidden
///   pixels another O(n²) for each value that is hidden (or seen, where those are fewer), frame by frame.
///   C is held in double, 8 m n bytes. A mean is estimated with C; values seen in fewer than n + 2 frames
///   keep their initial values, which a note reports.
/// Hidden frames and pixels are ignored; the texture has states for all frames, so that FilledSource shows
/// what was hidden. C comes out orthonormal, by falling variance. r is the likelihood's, times τ/(τ − 1 − n)
/// for the C and the mean that were fitted with it (values seen over those less what was fitted). Where the A
/// found is not stable, Yule–Walker on the same smoothed states replaces it, with a note.
///
/// Throws InputError where `start` is of another size or number of frames, `missing` too, or a value that is
/// seen is not finite. The same bytes at any thread count.
EmResult maximise_likelihood(core::FrameSource& source, const LinearDynamicTexture& start,
                             const EmOptions& options = {}, const Missing& missing = {},
                             const core::Context& context = {});

/// Learns from a clip of which part is hidden: in closed form, with each hidden pixel held at its last seen
/// value, then by maximise_likelihood().
EmResult learn_missing(core::FrameSource& source, const Missing& missing, const LearnOptions& learning = {},
                       const EmOptions& options = {}, const core::Context& context = {});

}  // namespace emberfold::dytex
