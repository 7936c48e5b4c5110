// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>

#include "core/clip.hpp"
#include "core/context.hpp"

namespace emberfold::dytex {

/// A neighbour in space and time: `lag` frames back, to the right by x, down by y.
struct StarTerm {
  int x = 0, y = 0, lag = 0;
  bool operator==(const StarTerm&) const = default;
};

/// Spatio-temporal auto-regression (STAR: Szummer, Picard 1996): every value, less its pixel's mean, is the
/// sum of neighbours' in the frames before times fixed coefficients, plus a disturbance,
///   s(x, y, t) = Σ_{lag > 0} φᵢ s(x + xᵢ, y + yᵢ, t − lagᵢ) + e(x, y, t),
///   e(x, y, t) = Σ_{lag = 0} φᵢ e(x + xᵢ, y + yᵢ, t) + a(x, y, t),   a white,
/// the same everywhere. Neighbours of the same frame come before the pixel in raster order; outside the frame
/// s and e are 0. Channels share the coefficients, and `noise` correlates their a's. (The paper, eq. 1, has
/// the neighbours of the same frame in the first line, too. Separated, the first line alone gives the
/// expected value and whether the model is stable, and the second only how disturbances look. The paper has
/// grey clips and one mean; a mean for every pixel lets STAR show clips whose background differs from place
/// to place.)
struct Star {
  core::ClipInfo info;           ///< of the clip it was learned from; `frames` is its length
  Eigen::VectorXf mean;          ///< width · height · channels values in the order of a frame's memory
  std::vector<StarTerm> terms;   ///< sorted as star_terms() gives them
  Eigen::VectorXd coefficients;  ///< one for each term
  Eigen::MatrixXd noise;         ///< channels × channels, lower triangular: a = noise · N(0, I)

  /// Returns the largest lag of the terms, frames.
  [[nodiscard]] int lags() const;
};

struct StarOptions {
  int reach = 1;  ///< px, 1 … 4: neighbours up to this far across and down
  int lags = 2;   ///< frames, 1 … 2

  /// Throws InputError naming the field, its value and what is allowed.
  void validate() const;
};

/// Lists the neighbours: those before the pixel in its frame, in raster order, and all of `lags` frames
/// before it; (2 reach + 1) reach + reach + lags (2 reach + 1)² of them.
std::vector<StarTerm> star_terms(const StarOptions& options);

/// Throws InputError, naming the part, where shapes disagree, a term is not an earlier neighbour or is
/// farther than 16 px or 2 frames, or a number is not finite.
void validate(const Star& star);

/// Returns the growth of the slowest wave in an endless frame from frame to frame, below 1 where the model is
/// stable. It is the largest root of λ² = f₁(ω) λ + f₂(ω) over 64 × 64 frequencies ω in space, f the
/// transforms of the coefficients of each lag.
double spectral_radius(const Star& star);

struct StarResult {
  Star star;
  double least_squares_radius = 0;  ///< as fitted; scaled from 0.999 on
  std::vector<std::string> notes;   ///< a line for everything not kept as fitted
};

/// Learns by least squares over pixels with all their neighbours in the frame: all of them, or 2^16 drawn
/// evenly; first on the frames before, then on the residual. The source is read three times, some frames at a
/// time. Where the fit is not stable its coefficients of lag l are scaled by γˡ, which scales every λ by γ,
/// to a radius of 0.998, and the noise so that clips vary as the source does. Throws InputError where there
/// are too few frames (lags + 2) or the frame is too small (4 reach + 2).
StarResult learn_star(core::FrameSource& source, const StarOptions& options = {},
                      const core::Context& context = {});

/// Predicts the frames 1 … steps after `past`, whose last frame is the newest. `past`: at least lags() frames
/// of CV_32F, of the model's size and channels, white = 255; not clipped. InputError where they do not fit.
/// O(pixels · terms) a step.
std::vector<cv::Mat> predict(const Star& star, std::span<const cv::Mat> past, int steps);

/// An endless clip drawn from a model; it starts at the mean and runs for 64 frames that are not shown. Frame
/// t depends on the model, the seed and t alone. O(pixels · terms) a frame.
class StarSynthesis {
 public:
  /// `star` must outlive the synthesis. Throws InputError where it is not valid, or not stable (with its
  /// radius).
  StarSynthesis(const Star& star, std::uint64_t seed);
  StarSynthesis(Star&&, std::uint64_t) = delete;

  /// Draws the next frame: CV_8U, of the model's size and channels, white = 255.
  cv::Mat next();

 private:
  const Star& star_;
  std::uint64_t seed_;
  std::uint32_t frame_ = 0;
  std::vector<cv::Mat> past_;  // less the mean, the newest last
};

}  // namespace emberfold::dytex
