// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "core/context.hpp"
#include "dytex/measures/autocorrelation.hpp"
#include "dytex/measures/flow_histograms.hpp"
#include "dytex/measures/lbp_top.hpp"
#include "dytex/measures/spectra.hpp"
#include "pipeline/comparison/comparison_results.hpp"

namespace emberfold::pipeline {

/// Returns the scale for clips of at least `frames` frames and at least this size.
MeasureScale measure_scale(std::int64_t frames, cv::Size size);

/// Returns CV_8U frames as levels, CV_32F.
std::vector<cv::Mat> bytes_to_levels(std::span<const cv::Mat> bytes);
/// Returns the luma of frames of levels (CV_32F, 1 or 3 channels).
std::vector<cv::Mat> levels_to_luma(std::span<const cv::Mat> levels);

/// Gathers all pixel measures of a clip, frame by frame.
/// Frames above 2^18 pixels are subsampled for the spectrum in time and the autocorrelation, every second,
/// third … pixel each way, to bound the memory. Optical flow and crease sharpness are measured at about fifty
/// frames at most, spread over the announced `frames`.
class ClipMeasures {
 public:
  ClipMeasures(cv::Size size, const MeasureScale& scale, int frames);

  /// Adds the next frames' luma, CV_32F. Throws core::Cancelled.
  void add(std::span<const cv::Mat> luma, const core::Context& context);

  [[nodiscard]] Eigen::VectorXd temporal() const { return time_.power(); }
  [[nodiscard]] Eigen::VectorXd radial() const { return space_ / frames_; }
  [[nodiscard]] Eigen::VectorXd autocorrelation() const { return memory_.values(); }
  [[nodiscard]] const dytex::BinaryPatterns& patterns() const { return patterns_; }
  [[nodiscard]] const dytex::FlowHistograms& flow() const { return flow_; }
  [[nodiscard]] PixelFigures figures() const;
  [[nodiscard]] MeasureCurves curves() const;

 private:
  struct RunningMean {
    double sum = 0, largest = 0;
    int count = 0;
    void add(double value) { sum += value, largest = std::max(largest, value), ++count; }
    [[nodiscard]] double mean() const { return count > 0 ? sum / count : 0; }
  };
  struct FrameMeasures;
  [[nodiscard]] FrameMeasures measure(const cv::Mat& luma, const cv::Mat& before, bool closely) const;

  int stride_, every_, rings_, frames_ = 0;
  dytex::TemporalSpectrum time_;
  dytex::Autocorrelation memory_;
  dytex::BinaryPatterns patterns_;
  dytex::FlowHistograms flow_;
  Eigen::VectorXd space_;
  RunningMean sharpness_, gradient_, si_, ti_;
  cv::Mat last_;
};

/// Gathers the measures of a clip and those of its first and second half, whose distance is the noise floor.
struct SourceMeasures {
  ClipMeasures all, first, second;
  int frames = 0, added = 0;

  SourceMeasures(cv::Size size, const MeasureScale& scale, int frame_count);
  /// Adds the next frames' luma. Throws core::Cancelled.
  void add(std::span<const cv::Mat> luma, const core::Context& context);
};

/// Describes a distance for display; `key` is its name in measures.json.
struct MeasureDescription {
  const char *key, *name, *unit, *about;
};
/// Returns the distances of PixelDistances, in the order of its fields.
std::span<const MeasureDescription> pixel_measures();

/// Measures the distances of a clip from a reference gathered on the same scale.
PixelDistances pixel_distances(const ClipMeasures& clip, const ClipMeasures& reference);

}  // namespace emberfold::pipeline
