// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>
#include <opencv2/core/mat.hpp>

#include "core/context.hpp"
#include "dytex/measures/autocorrelation.hpp"
#include "dytex/measures/flow_histograms.hpp"
#include "dytex/measures/lbp_top.hpp"
#include "dytex/measures/spectra.hpp"

namespace emberfold::pipeline {

/// What is to be measured alike in clips that are held against each other.
struct MeasureScale {
  int segment = 4;  ///< frames, of the spectrum in time
  int lags = 1;     ///< frames, of the autocorrelation
  int rings = 1;    ///< of the spectrum in space
};
/// For clips of at least so many frames, of at least these sizes.
MeasureScale measure_scale(std::int64_t frames, cv::Size size);

/// Drawn frames, CV_8U, as levels, CV_32F.
std::vector<cv::Mat> levels_of(std::span<const cv::Mat> bytes);
/// Of each frame; levels are CV_32F, 1 or 3 channels.
std::vector<cv::Mat> luma_of(std::span<const cv::Mat> levels);

/// All that is measured of the pixels of a clip, gathered frame by frame. Of frames above 2^18 pixels the
/// spectrum in time and the autocorrelation are taken at every second, third … pixel each way, which bounds
/// the memory and not the truth. Of optical flow and crease sharpness at most some fifty frames are taken
/// where `frames` tells how many there will be.
class ClipMeasures {
 public:
  ClipMeasures(cv::Size size, const MeasureScale& scale, int frames);

  /// The next frames' luma, CV_32F. Throws core::Cancelled.
  void add(std::span<const cv::Mat> luma, const core::Context& context);

  [[nodiscard]] Eigen::VectorXd temporal() const { return time_.power(); }
  [[nodiscard]] Eigen::VectorXd radial() const { return space_ / frames_; }
  [[nodiscard]] Eigen::VectorXd autocorrelation() const { return memory_.values(); }
  [[nodiscard]] const dytex::BinaryPatterns& patterns() const { return patterns_; }
  [[nodiscard]] const dytex::FlowHistograms& flow() const { return flow_; }
  [[nodiscard]] double crease_sharpness() const { return sharpness_.mean(); }  ///< 1/px
  [[nodiscard]] double crease_gradient() const { return gradient_.mean(); }    ///< levels/px
  /// ITU-T P.910: the largest of a clip; and its mean, which one odd frame does not make.
  [[nodiscard]] double si() const { return si_.most; }
  [[nodiscard]] double ti() const { return ti_.most; }
  [[nodiscard]] double mean_si() const { return si_.mean(); }
  [[nodiscard]] double mean_ti() const { return ti_.mean(); }

 private:
  struct Figure {
    double sum = 0, most = 0;
    int count = 0;
    void add(double value) { sum += value, most = std::max(most, value), ++count; }
    [[nodiscard]] double mean() const { return count > 0 ? sum / count : 0; }
  };
  struct Frame;
  [[nodiscard]] Frame measure(const cv::Mat& luma, const cv::Mat& before, bool closely) const;

  int thinning_, every_, rings_, frames_ = 0;
  dytex::TemporalSpectrum time_;
  dytex::Autocorrelation memory_;
  dytex::BinaryPatterns patterns_;
  dytex::FlowHistograms flow_;
  Eigen::VectorXd space_;
  Figure sharpness_, gradient_, si_, ti_;
  cv::Mat last_;
};

/// A source's measures, and those of its first and second half, which are the noise floor.
struct SourceMeasures {
  ClipMeasures all, first, second;
  int frames = 0, added = 0;

  SourceMeasures(cv::Size size, const MeasureScale& scale, int frame_count);
  /// The next frames' luma. Throws core::Cancelled.
  void add(std::span<const cv::Mat> luma, const core::Context& context);
};

/// A measure of how far a clip lies from another.
struct Measure {
  const char *key, *name, *unit, *about;
};
/// In the order in which they are told.
std::span<const Measure> pixel_measures();

/// {key: distance of `a` from the reference `b`} for every pixel measure. Sharpness, SI and TI are told
/// relative to the reference's: 0.1 is a tenth more or less.
nlohmann::ordered_json pixel_distances(const ClipMeasures& a, const ClipMeasures& b);

/// The figures that a clip has for itself.
nlohmann::ordered_json pixel_figures(const ClipMeasures& clip);

/// 10 log₁₀ of power above the floor, rounded: a curve to draw.
nlohmann::ordered_json decibels_json(const Eigen::VectorXd& power);

/// To three digits behind the point.
double rounded(double value);

}  // namespace emberfold::pipeline
