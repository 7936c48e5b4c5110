// SPDX-License-Identifier: Apache-2.0
#include "apps/clip_spectra.hpp"

#include <cmath>
#include <vector>

#include "apps/interrupt.hpp"
#include "core/parallel.hpp"

namespace emberfold::apps {

using Json = nlohmann::ordered_json;

namespace {
double rounded(double value) {
  return std::round(value * 1000) / 1000;
}
int stride_of(cv::Size size) {
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
}  // namespace

ClipSpectra::ClipSpectra(cv::Size size, int segment, int rings)
    : stride_(stride_of(size)), time_(thinned(size, stride_), segment), rings_(rings) {}

void ClipSpectra::add(std::span<const cv::Mat> luma, const core::Context& context) {
  std::vector<Eigen::VectorXd> each(luma.size());
  const auto status = core::parallel_for(
      luma.size(), context, [&](std::size_t i) { each[i] = dytex::radial_spectrum(luma[i], rings_); });
  if (status == core::Status::cancelled) throw Interrupted{};
  for (std::size_t i = 0; i < luma.size(); ++i) {
    space_ = frames_++ == 0 ? each[i] : (space_ + each[i]).eval();
    time_.add(thinned(luma[i], stride_));
  }
}

int segment_length(std::int64_t frames) {
  for (const int length : {32, 16, 8, 4})
    if (length <= frames) return length;
  return 0;
}

Json distances_json(const ClipSpectra& a, const ClipSpectra& b) {
  return {{"temporal_db", rounded(dytex::log_spectral_distance(a.temporal(), b.temporal()))},
          {"radial_db", rounded(dytex::log_spectral_distance(a.radial(), b.radial()))}};
}

Json decibels_json(const Eigen::VectorXd& power) {
  Json out = Json::array();
  for (const double p : power) out.push_back(rounded(10 * std::log10(p + dytex::kRounding)));
  return out;
}

}  // namespace emberfold::apps
