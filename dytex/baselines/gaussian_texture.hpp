// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include <opencv2/core/mat.hpp>

// A Gaussian texture that is stationary in space and time: it is given by the covariance of pixels a few px
// and a frame apart. As a linear dynamic texture its modes are waves, each with its own pole. (Xia,
// Ferradans, Peyré & Aujol 2014, "Synthesizing and mixing stationary Gaussian texture models".)
namespace emberfold::dytex {

/// Largest lag, px both ways. A table of lags is square, lag 0 in its middle.
constexpr int kTextureReach = 31;
constexpr int kTextureLags = 2 * kTextureReach + 1;

/// Covariances of a stationary Gaussian texture, one number a pixel, mean 0.
struct GaussianTexture {
  cv::Mat within;  ///< CV_32F, kTextureLags²: E[x(p) x(p + d)], d by row and column
  cv::Mat ahead;   ///< likewise, of the next frame: E[x_t(p) x_{t+1}(p + d)]
  [[nodiscard]] bool empty() const { return within.empty(); }
};

/// Learns a texture from pairs of neighbouring frames, of which pixels may be hidden.
class GaussianTextureLearner {
 public:
  explicit GaussianTextureLearner(cv::Size frame);
  /// Adds a pair of frames: CV_32F values and CV_8U masks (not 0: seen), of the frame's size. O(pixels log
  /// pixels).
  void add(const cv::Mat& now, const cv::Mat& seen_now, const cv::Mat& next, const cv::Mat& seen_next);
  /// Returns the means over all seen pairs of pixels at each lag. A Hann window brings them to 0 at the
  /// largest lags. 0 at lags that were never seen.
  [[nodiscard]] GaussianTexture learned() const;

 private:
  void sum_up(cv::Mat& sum, const cv::Mat& spectrum, const cv::Mat& other) const;

  cv::Size frame_, padded_;
  cv::Mat within_, within_count_, ahead_, ahead_count_;  // spectra, as cv::dft packs them
};

/// Draws frames of a texture without an end; the same at any number of threads. Wave k follows
/// z_{t+1} = ρ z_t + √(S (1 − |ρ|²)) w_t with w white, S and ρ S the transforms of `within` and `ahead`,
/// |ρ| ≤ 0.99; the angle of ρ is drift. Periodic in both directions. The first frame is stationary too.
class GaussianTextureFrames {
 public:
  /// `stream`: separates textures that are drawn with one seed. `speed`: factor of time, below 0 backwards: ρ
  /// becomes |ρ|^|speed| and turns by its angle times `speed`; the variance of a frame stays.
  GaussianTextureFrames(const GaussianTexture& texture, cv::Size frame, std::uint64_t seed,
                        std::uint32_t stream = 0, double speed = 1);
  /// Draws the next frame, CV_32F. O(pixels log pixels).
  cv::Mat next();

 private:
  [[nodiscard]] cv::Mat white();

  cv::Size frame_, padded_;
  cv::Mat pole_, force_, state_;  // spectra, as cv::dft packs them
  std::uint64_t seed_;
  std::uint32_t stream_, frames_ = 0;
};

}  // namespace emberfold::dytex
