// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>
#include <opencv2/core/types.hpp>

#include "core/clip.hpp"
#include "core/context.hpp"
#include "dytex/linear_dynamic_texture.hpp"

/// Descriptions of textures that are independent of where in a frame the texture is, and of the frame's size:
/// the same water elsewhere has nearly the same. The space-time spectrum of small windows (oriented energies:
/// Derpanis, Wildes 2012), without order of place (bags of small windows: Ravichandran, Chaudhry, Vidal
/// 2009).
namespace emberfold::dytex {

/// The mean over moving windows of the shares, dB, that 112 bands have of a window's energy: four octaves in
/// time, four widths in space, seven slants and directions (up and down are separate, left and right are
/// not). Nothing where frames are below 16×16, there are fewer than 32, or nothing moves.
using WindowSpectrum = std::optional<Eigen::VectorXd>;

/// Measures a clip's windows of 16×16 px, at most 1024, adjacent or evenly spaced, in segments of 32 frames,
/// half overlapping (Welch 1967), each pixel less its mean. Independent of brightness; of contrast, too, down
/// to shares of −50 dB. Holds 32 frames' coefficients; O(pixels) a frame, some 200 operations each. The same
/// bytes at any thread count.
class WindowEnergies {
 public:
  /// Throws InputError unless the size is at least 1×1.
  explicit WindowEnergies(cv::Size size);

  /// Adds the next frame: luma, CV_32F, white = 255. InputError for another size or type.
  void add(const cv::Mat& luma);
  /// Returns the description of the frames so far; frames after the last whole segment do not count.
  [[nodiscard]] WindowSpectrum spectrum() const;

 private:
  void close_segment();

  cv::Size size_;
  std::vector<cv::Point> windows_;       // upper left corners
  std::vector<Eigen::MatrixXf> frames_;  // coefficients × windows, of the current segment
  int segments_ = 0;
  Eigen::MatrixXd energies_;  // bands × windows
};

/// Describes a whole source, from its first frame.
WindowSpectrum window_spectrum(core::FrameSource& source, const core::Context& context = {});

/// Computes the description of endless clips of the model, exactly but for the order of mean and logarithm,
/// from its parameters alone: windows' covariances at lags 0 … 31. The noise r counts, the mean does not.
/// Components leave fine structure out, so compare models with models. O(m n) and some O(windows n²).
WindowSpectrum window_spectrum(const LinearDynamicTexture& texture);
/// Describes many models.
std::vector<WindowSpectrum> window_spectra(std::span<const LinearDynamicTexture> models,
                                           const core::Context& context = {});

/// Returns the root mean square by which the shares of two descriptions differ, dB. Symmetric, 0 for equals.
/// Throws InputError for different sizes.
double window_distance(const Eigen::Ref<const Eigen::VectorXd>& p,
                       const Eigen::Ref<const Eigen::VectorXd>& q);

}  // namespace emberfold::dytex
