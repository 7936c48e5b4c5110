// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>

#include "core/clip.hpp"
#include "core/context.hpp"

namespace emberfold::dytex {

/// The power spectrum in time by Welch's method (Welch 1967) at every pixel of the luma, averaged over all
/// pixels. Segments of `segment` frames, half overlapping, each less its mean and under a Hann window; frames
/// after the last whole segment do not count. Scaled so that white noise of variance s² has the power s² at
/// every frequency but the first, from which subtracting the mean takes a sixth. A sinusoid of amplitude a at
/// frequency k has a² segment / 6 there, a quarter of that at its neighbours. Holds `segment` frames;
/// O(pixels · segment) a frame.
class TemporalSpectrum {
 public:
  /// Throws InputError unless segment is even, 4 … 1024, and the size is at least 1×1.
  TemporalSpectrum(cv::Size size, int segment);

  /// Adds the next frame: luma, CV_32F, white = 255. InputError for another size or type.
  void add(const cv::Mat& luma);
  /// Returns the number of complete segments.
  [[nodiscard]] int segments() const { return segments_; }
  /// Returns segment/2 values: the power, levels², at k/segment cycles a frame, k = 1 … segment/2. InputError
  /// where no segment is complete.
  [[nodiscard]] Eigen::VectorXd power() const;

 private:
  void close_segment();

  cv::Size size_;
  int segment_;
  int segments_ = 0;
  Eigen::MatrixXf transform_;    // segment × segment: cosines and sines under the window, of mean 0
  std::vector<cv::Mat> frames_;  // of the current segment
  Eigen::VectorXd sum_;
};

/// Returns the temporal spectrum of a whole source, from its first frame.
Eigen::VectorXd temporal_spectrum(core::FrameSource& source, int segment, const core::Context& context = {});

/// Returns the number of rings for frames of this size: half their shorter side, 1 … 64.
int ring_count(cv::Size size);

/// Returns the radial power spectrum: the 2-D power spectrum of a frame of luma (CV_32F, white = 255)
/// less its mean and under a Hann window, averaged over rings about frequency 0. Scaled so that white noise
/// of variance s² has the power s² in every ring but the first two, from which taking the mean takes a part.
/// Ring i of `rings` has frequencies above i / (2 rings), up to (i + 1) / (2 rings) cycles a pixel, whatever
/// their direction; a ring without any has 0. InputError for another type, or rings outside 1 … 4096.
/// O(pixels · log pixels).
Eigen::VectorXd radial_spectrum(const cv::Mat& luma, int rings);

/// Returns the mean radial spectrum of a source's frames, from its first. InputError where it has none.
Eigen::VectorXd radial_spectrum(core::FrameSource& source, int rings, const core::Context& context = {});

/// levels²: the power of rounding to whole grey levels, below which 8-bit frames show nothing.
constexpr double kRounding = 1.0 / 12;

/// Returns the log-spectral distance, dB: √mean (10 log₁₀ (p + floor)/(q + floor))². 0 for equals, symmetric.
/// InputError unless both have the same size ≥ 1 and finite values ≥ 0, and floor > 0.
double log_spectral_distance(const Eigen::Ref<const Eigen::VectorXd>& p,
                             const Eigen::Ref<const Eigen::VectorXd>& q, double floor = kRounding);

}  // namespace emberfold::dytex
