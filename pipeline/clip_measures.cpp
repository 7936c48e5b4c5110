// SPDX-License-Identifier: Apache-2.0
#include "pipeline/clip_measures.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/clip.hpp"
#include "core/context.hpp"
#include "core/parallel.hpp"
#include "dytex/measures/optical_flow.hpp"
#include "dytex/measures/sharpness_si_ti.hpp"

namespace emberfold::pipeline {

using Json = nlohmann::ordered_json;

namespace {

constexpr int kMostLags = 16, kMostCloseFrames = 50, kFlowStride = 3;

int thinning_of(cv::Size size) {
  constexpr double kMostPixels = 1 << 18;
  return static_cast<int>(std::ceil(std::sqrt(static_cast<double>(size.width) * size.height / kMostPixels)));
}

cv::Size thinned(cv::Size size, int stride) {
  return {(size.width + stride - 1) / stride, (size.height + stride - 1) / stride};
}

cv::Mat thinned(const cv::Mat& luma, int stride) {
  if (stride == 1) return luma;
  cv::Mat out(thinned(luma.size(), stride), CV_32F);
  for (int y = 0; y < out.rows; ++y)
    for (int x = 0; x < out.cols; ++x) out.at<float>(y, x) = luma.at<float>(y * stride, x * stride);
  return out;
}

// By what share a figure differs from the reference's, which is never taken for less than `least`.
double relative(double value, double reference, double least) {
  return std::abs(value - reference) / std::max(reference, least);
}

constexpr std::array<Measure, 8> kMeasures{{
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

}  // namespace

struct ClipMeasures::Frame {
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

std::vector<cv::Mat> levels_of(std::span<const cv::Mat> bytes) {
  std::vector<cv::Mat> levels(bytes.size());
  for (std::size_t i = 0; i < bytes.size(); ++i) bytes[i].convertTo(levels[i], CV_32F);
  return levels;
}

std::vector<cv::Mat> luma_of(std::span<const cv::Mat> levels) {
  std::vector<cv::Mat> luma;
  for (const auto& one : levels) luma.push_back(core::luma(one));
  return luma;
}

ClipMeasures::ClipMeasures(cv::Size size, const MeasureScale& scale, int frames)
    : thinning_(thinning_of(size)),
      every_(std::max(1, frames / kMostCloseFrames)),
      rings_(scale.rings),
      time_(thinned(size, thinning_), scale.segment),
      memory_(thinned(size, thinning_), scale.lags) {}

ClipMeasures::Frame ClipMeasures::measure(const cv::Mat& luma, const cv::Mat& before, bool closely) const {
  Frame made;
  made.radial = dytex::radial_spectrum(luma, rings_);
  made.si = dytex::spatial_information(luma);
  if (closely) made.sharpness = dytex::crease_sharpness(luma);
  if (before.empty()) return made;
  made.ti = dytex::temporal_information(luma, before);
  if (closely) made.flow = dytex::optical_flow(before, luma);
  return made;
}

void ClipMeasures::add(std::span<const cv::Mat> luma, const core::Context& context) {
  std::vector<Frame> each(luma.size());
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
    const cv::Mat thin = thinned(luma[i], thinning_);
    time_.add(thin);
    memory_.add(thin);
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

std::span<const Measure> pixel_measures() {
  return kMeasures;
}

Json pixel_distances(const ClipMeasures& a, const ClipMeasures& b) {
  constexpr double kLeastLevels = 0.5, kLeastSharpness = 1e-3;
  return {
      {"temporal_db", rounded(dytex::log_spectral_distance(a.temporal(), b.temporal()))},
      {"radial_db", rounded(dytex::log_spectral_distance(a.radial(), b.radial()))},
      {"autocorrelation", rounded(dytex::autocorrelation_distance(a.autocorrelation(), b.autocorrelation()))},
      {"patterns", rounded(dytex::chi_square_distance(a.patterns(), b.patterns()))},
      {"flow_px", rounded(dytex::flow_distance(a.flow(), b.flow()))},
      {"crease_sharpness", rounded(relative(a.crease_sharpness(), b.crease_sharpness(), kLeastSharpness))},
      {"si", rounded(relative(a.mean_si(), b.mean_si(), kLeastLevels))},
      {"ti", rounded(relative(a.mean_ti(), b.mean_ti(), kLeastLevels))},
  };
}

Json pixel_figures(const ClipMeasures& clip) {
  return {{"crease_sharpness", rounded(clip.crease_sharpness())},
          {"crease_gradient", rounded(clip.crease_gradient())},
          {"si", {{"most", rounded(clip.si())}, {"mean", rounded(clip.mean_si())}}},
          {"ti", {{"most", rounded(clip.ti())}, {"mean", rounded(clip.mean_ti())}}}};
}

Json decibels_json(const Eigen::VectorXd& power) {
  Json out = Json::array();
  for (const double p : power) out.push_back(rounded(10 * std::log10(p + dytex::kRounding)));
  return out;
}

double rounded(double value) {
  return std::round(value * 1000) / 1000;
}

}  // namespace emberfold::pipeline
