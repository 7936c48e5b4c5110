// SPDX-License-Identifier: Apache-2.0
#include "apps/reconstruct.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>

#include "apps/draw_graph_frames.hpp"
#include "core/clip.hpp"

namespace emberfold::apps {

Reconstruction reconstruct(const cv::Mat& levels, const graph::AttributeGraph& graph, PatchDrawing drawing,
                           const sketch::FillOptions& options) {
  return reconstruct(levels,
                     drawing == PatchDrawing::fitted
                         ? sketch::draw_fitted(graph, levels.size(), levels.channels())
                         : sketch::draw_pixels(graph, levels),
                     options);
}

Reconstruction reconstruct(const cv::Mat& levels, const sketch::Sketchable& part,
                           const sketch::FillOptions& options) {
  Reconstruction result;
  const auto drawn = draw_around(part, cv::mean(levels), options);
  result.share = drawn.share;
  result.converged = drawn.converged;
  result.bytes = core::to_bytes(drawn.levels);
  cv::Mat shown;
  result.bytes.convertTo(shown, CV_32F);
  result.psnr = psnr(shown, levels);
  return result;
}

double psnr(const cv::Mat& a, const cv::Mat& b) {
  const double distance = cv::norm(a, b, cv::NORM_L2);
  const double mse =
      distance * distance / static_cast<double>(a.total() * static_cast<std::size_t>(a.channels()));
  if (mse <= 0) return kMostPsnr;
  return std::min(kMostPsnr, 10 * std::log10(255.0 * 255.0 / mse));
}

nlohmann::ordered_json spread_json(std::span<const double> values) {
  if (values.empty()) return nullptr;
  const auto [low, high] = std::ranges::minmax_element(values);
  const auto rounded = [](double v) { return std::round(v * 1000) / 1000; };
  return {{"mean", rounded(std::accumulate(values.begin(), values.end(), 0.0) / double(values.size()))},
          {"min", rounded(*low)},
          {"max", rounded(*high)},
          {"frames", values.size()}};
}

}  // namespace emberfold::apps
