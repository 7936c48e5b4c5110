// SPDX-License-Identifier: Apache-2.0
#include "pipeline/comparison/clip_measures.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/clip.hpp"
#include "core/context.hpp"
#include "core/parallel.hpp"
#include "dytex/measures/optical_flow.hpp"
#include "dytex/measures/sharpness_si_ti.hpp"

namespace emberfold::pipeline {

namespace {

// The lengths below were chosen for clips of some tens to some hundreds of frames.
constexpr int kMostLags = 16;            // frames
constexpr int kMostCloseFrames = 50;     // whose optical flow and crease sharpness are measured
constexpr int kFlowStride = 3;           // px between the flow vectors that are counted
constexpr double kMostPixels = 1 << 18;  // at which a spectrum in time is computed
// References below these are replaced by them, to avoid dividing by 0 for empty clips.
constexpr double kLeastLevels = 0.5;      // grey levels, of SI and TI
constexpr double kLeastSharpness = 1e-3;  // 1/px

int sampling_stride(cv::Size size) {
  return static_cast<int>(std::ceil(std::sqrt(static_cast<double>(size.width) * size.height / kMostPixels)));
}

cv::Size sampled_size(cv::Size size, int stride) {
  return {(size.width + stride - 1) / stride, (size.height + stride - 1) / stride};
}

cv::Mat sample_pixels(const cv::Mat& luma, int stride) {
  if (stride == 1) return luma;
  cv::Mat out(sampled_size(luma.size(), stride), CV_32F);
  for (int y = 0; y < out.rows; ++y)
    for (int x = 0; x < out.cols; ++x) out.at<float>(y, x) = luma.at<float>(y * stride, x * stride);
  return out;
}

// Returns the difference of a value from the reference, as a share of the reference or of `least` if that is
// greater.
double relative_difference(double value, double reference, double least) {
  return std::abs(value - reference) / std::max(reference, least);
}

constexpr std::array<MeasureDescription, 8> kMeasures{{
    {"temporal_db", "Spectrum in time", "dB", "how far the power at each frequency in time lies apart"},
    {"radial_db", "Spectrum in space", "dB", "the same of frequencies in space, whatever their direction"},
    {"autocorrelation", "Autocorrelation", "", "how alike frames up to 16 apart are, RMS difference"},
    {"patterns", "Binary patterns", "chi2", "local patterns in space and time (LBP-TOP), 0 to 1"},
    {"flow_px", "Optical flow", "px/frame",
     "Wasserstein distance of where pixels go and how fast, signs and all"},
    {"crease_sharpness", "Crease sharpness", "share",
     "steepness of the highest steps over their height; 0.1 is a tenth more or less than the source's"},
    {"si", "Spatial information", "share", "P.910 SI, mean of all frames, relative to the source's"},
    {"ti", "Temporal information", "share", "P.910 TI, mean of all frames, relative to the source's"},
}};

std::vector<double> to_decibels(const Eigen::VectorXd& power) {
  std::vector<double> out;
  for (const double p : power) out.push_back(10 * std::log10(p + dytex::kRounding));
  return out;
}

}  // namespace

struct ClipMeasures::FrameMeasures {
  Eigen::VectorXd radial;
  double si = 0, ti = 0;
  dytex::Sharpness sharpness;
  cv::Mat flow;
};

MeasureScale measure_scale(std::int64_t frames, cv::Size size) {
  MeasureScale scale;
  for (const int length : {32, 16, 8, 4})
    if (length <= frames) {
      scale.segment = length;
      break;
    }
  scale.lags = static_cast<int>(std::clamp<std::int64_t>(frames / 4, 1, kMostLags));
  scale.rings = dytex::ring_count(size);
  return scale;
}

std::vector<cv::Mat> bytes_to_levels(std::span<const cv::Mat> bytes) {
  std::vector<cv::Mat> levels(bytes.size());
  for (std::size_t i = 0; i < bytes.size(); ++i) bytes[i].convertTo(levels[i], CV_32F);
  return levels;
}

std::vector<cv::Mat> levels_to_luma(std::span<const cv::Mat> levels) {
  std::vector<cv::Mat> luma;
  for (const auto& one : levels) luma.push_back(core::luma(one));
  return luma;
}

ClipMeasures::ClipMeasures(cv::Size size, const MeasureScale& scale, int frames)
    : stride_(sampling_stride(size)),
      every_(std::max(1, frames / kMostCloseFrames)),
      rings_(scale.rings),
      time_(sampled_size(size, stride_), scale.segment),
      memory_(sampled_size(size, stride_), scale.lags) {}

ClipMeasures::FrameMeasures ClipMeasures::measure(const cv::Mat& luma, const cv::Mat& before,
                                                  bool closely) const {
  FrameMeasures made;
  made.radial = dytex::radial_spectrum(luma, rings_);
  made.si = dytex::spatial_information(luma);
  if (closely) made.sharpness = dytex::crease_sharpness(luma);
  if (before.empty()) return made;
  made.ti = dytex::temporal_information(luma, before);
  if (closely) made.flow = dytex::optical_flow(before, luma);
  return made;
}

void ClipMeasures::add(std::span<const cv::Mat> luma, const core::Context& context) {
  std::vector<FrameMeasures> each(luma.size());
  core::parallel_for(luma.size(), context, [&](std::size_t i) {
    const bool closely = (frames_ + static_cast<int>(i)) % every_ == 0;
    each[i] = measure(luma[i], i == 0 ? last_ : luma[i - 1], closely || frames_ + static_cast<int>(i) == 1);
  });
  for (std::size_t i = 0; i < luma.size(); ++i) {
    const auto& frame = each[i];
    space_ = frames_++ == 0 ? frame.radial : (space_ + frame.radial).eval();
    si_.add(frame.si);
    if (frames_ > 1) ti_.add(frame.ti);
    if (frame.sharpness.points > 0) {
      sharpness_.add(frame.sharpness.sharpness);
      gradient_.add(frame.sharpness.gradient);
    }
    if (!frame.flow.empty()) flow_.add(frame.flow, kFlowStride);
    const cv::Mat sampled = sample_pixels(luma[i], stride_);
    time_.add(sampled);
    memory_.add(sampled);
    patterns_.add(luma[i]);
  }
  if (!luma.empty()) last_ = luma.back();
}

SourceMeasures::SourceMeasures(cv::Size size, const MeasureScale& scale, int frame_count)
    : all(size, scale, frame_count), first(all), second(all), frames(frame_count) {}

void SourceMeasures::add(std::span<const cv::Mat> luma, const core::Context& context) {
  const auto count = static_cast<int>(luma.size());
  const auto in_first = static_cast<std::size_t>(std::clamp(frames / 2 - added, 0, count));
  all.add(luma, context);
  first.add(luma.first(in_first), context);
  second.add(luma.subspan(in_first), context);
  added += count;
}

PixelFigures ClipMeasures::figures() const {
  return {sharpness_.mean(), gradient_.mean(), si_.largest, si_.mean(), ti_.largest, ti_.mean()};
}

MeasureCurves ClipMeasures::curves() const {
  const Eigen::VectorXd correlation = autocorrelation();
  return {to_decibels(temporal()), to_decibels(radial()), {correlation.begin(), correlation.end()}};
}

std::span<const MeasureDescription> pixel_measures() {
  return kMeasures;
}

PixelDistances pixel_distances(const ClipMeasures& clip, const ClipMeasures& reference) {
  const PixelFigures own = clip.figures(), wanted = reference.figures();
  PixelDistances out;
  out.temporal_db = dytex::log_spectral_distance(clip.temporal(), reference.temporal());
  out.radial_db = dytex::log_spectral_distance(clip.radial(), reference.radial());
  out.autocorrelation = dytex::autocorrelation_distance(clip.autocorrelation(), reference.autocorrelation());
  out.patterns = dytex::chi_square_distance(clip.patterns(), reference.patterns());
  out.flow_px = dytex::flow_distance(clip.flow(), reference.flow());
  out.crease_sharpness = relative_difference(own.crease_sharpness, wanted.crease_sharpness, kLeastSharpness);
  out.si = relative_difference(own.mean_si, wanted.mean_si, kLeastLevels);
  out.ti = relative_difference(own.mean_ti, wanted.mean_ti, kLeastLevels);
  return out;
}

}  // namespace emberfold::pipeline
