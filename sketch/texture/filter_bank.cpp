// SPDX-License-Identifier: Apache-2.0
#include "sketch/texture/filter_bank.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>
#include <numbers>
#include <utility>

#include <opencv2/core.hpp>

namespace emberfold::sketch {

namespace {

/// Samples `kernel`, rounds it to whole numbers, and lets the middle tap make up for what rounding did to the
/// sum.
TextureFilter sampled(std::string_view name, int radius,
                      const std::function<double(double, double)>& kernel) {
  TextureFilter filter{name, radius, {}};
  double sum = 0;
  for (int dy = -radius; dy <= radius; ++dy)
    for (int dx = -radius; dx <= radius; ++dx) sum += std::abs(kernel(dx, dy));
  int total = 0;
  for (int dy = -radius; dy <= radius; ++dy)
    for (int dx = -radius; dx <= radius; ++dx) {
      const int weight = static_cast<int>(std::lround(kernel(dx, dy) * kTextureLevel / sum));
      total += weight;
      if (weight != 0) filter.taps.push_back({dx, dy, weight});
    }
  for (auto& tap : filter.taps)
    if (tap.dx == 0 && tap.dy == 0) tap.weight -= total;
  return filter;
}

double bell(double x, double y, double s) {
  return std::exp(-(x * x + y * y) / (2 * s * s));
}

TextureFilter laplacian(std::string_view name, int radius, double s) {
  return sampled(name, radius,
                 [s](double x, double y) { return (2 - (x * x + y * y) / (s * s)) * bell(x, y, s); });
}

TextureFilter second_derivative(std::string_view name, double degrees) {
  const double angle = degrees * std::numbers::pi / 180, c = std::cos(angle), n = std::sin(angle);
  constexpr double s = 1.2;
  return sampled(name, 3, [=](double x, double y) {
    const double d = c * x + n * y;
    return (1 - d * d / (s * s)) * bell(x, y, s);
  });
}

}  // namespace

std::array<TextureFilter, kTextureFilters> make_texture_filters() {
  return {TextureFilter{"level", 0, {{0, 0, kTextureLevel}}},
          laplacian("fine Laplacian", 2, 0.7),
          sampled("slope along x", 2, [](double x, double y) { return x * bell(x, y, 1); }),
          sampled("slope along y", 2, [](double x, double y) { return y * bell(x, y, 1); }),
          second_derivative("bend at 0 degrees", 0),
          second_derivative("bend at 45 degrees", 45),
          second_derivative("bend at 90 degrees", 90),
          second_derivative("bend at 135 degrees", 135),
          laplacian("Laplacian", 3, 1.2),
          TextureFilter{"difference along x", 1, {{0, 0, -kTextureLevel / 2}, {1, 0, kTextureLevel / 2}}},
          TextureFilter{"difference along y", 1, {{0, 0, -kTextureLevel / 2}, {0, 1, kTextureLevel / 2}}}};
}

cv::Mat filter_responses(const cv::Mat& bytes, const TextureFilter& filter) {
  cv::Mat padded;
  cv::copyMakeBorder(bytes, padded, filter.radius, filter.radius, filter.radius, filter.radius,
                     cv::BORDER_REPLICATE);
  cv::Mat result(bytes.size(), CV_32S, cv::Scalar(0));
  for (int y = 0; y < bytes.rows; ++y) {
    int* __restrict row = result.ptr<int>(y);
    for (const auto& tap : filter.taps) {
      const auto* levels = padded.ptr(y + filter.radius + tap.dy) + filter.radius + tap.dx;
      for (int x = 0; x < bytes.cols; ++x) row[x] += tap.weight * levels[x];
    }
  }
  return result;
}

BinEdges make_bin_edges(std::vector<int> responses) {
  constexpr std::array<double, kTextureBins - 3> kBelow{0.005, 0.03, 0.12, 0.28, 0.43,
                                                        0.57,  0.72, 0.88, 0.97, 0.995};
  constexpr int kGap = kTextureLevel / 4;
  BinEdges edges{};
  std::ranges::sort(responses);
  if (!responses.empty()) {
    edges.front() = responses.front();
    for (std::size_t i = 0; i < kBelow.size(); ++i)
      edges[i + 1] =
          responses[static_cast<std::size_t>(kBelow[i] * static_cast<double>(responses.size() - 1))];
    edges.back() = responses.back() + 1;
  }
  constexpr std::size_t kMiddle = edges.size() / 2;
  for (std::size_t i = kMiddle; i < edges.size(); ++i) edges[i] = std::max(edges[i], edges[i - 1] + kGap);
  for (std::size_t i = kMiddle - 1; i-- > 0;) edges[i] = std::min(edges[i], edges[i + 1] - kGap);
  return edges;
}

int find_bin(const BinEdges& edges, int response) {
  return static_cast<int>(std::ranges::upper_bound(edges, response) - edges.begin());
}

double histogram_distance(const FilterHistograms& a, const FilterHistograms& b) {
  double sum = 0;
  for (std::size_t f = 0; f < a.size(); ++f)
    for (std::size_t i = 0; i < a[f].size(); ++i) sum += std::abs(a[f][i] - b[f][i]);
  return sum / (2 * static_cast<double>(a.size()));
}

}  // namespace emberfold::sketch
