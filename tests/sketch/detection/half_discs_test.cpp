// SPDX-License-Identifier: Apache-2.0
#include "sketch/detection/half_discs.hpp"

#include <cmath>
#include <numbers>

#include <opencv2/core.hpp>

#include "core/rng.hpp"
#include "tests/support/catch.hpp"

using namespace emberfold;
using sketch::kDiscWays;
using sketch::SoftBins;

namespace {

const cv::Size kHalfDiscsSize{37, 29};

std::vector<cv::Mat1f> distances(const SoftBins& bins, int radius, float weight = 1) {
  std::vector<cv::Mat1f> maps;
  for (int way = 0; way < kDiscWays; ++way) maps.emplace_back(kHalfDiscsSize, 0.0F);
  sketch::add_half_disc_distances(bins, radius, weight, maps);
  return maps;
}

cv::Mat1f random_levels() {
  core::Rng rng(5, {});
  cv::Mat1f levels(kHalfDiscsSize);
  for (float& level : levels) level = static_cast<float>(255 * rng.uniform());
  return levels;
}

/// The same by its definition, for one pixel.
double distance_at(const SoftBins& bins, int radius, int way, int x, int y) {
  const double angle = way * std::numbers::pi / kDiscWays;
  double sum = 0;
  int pixels = 0;
  for (const cv::Mat1b& bin : bins) {
    double right = 0, left = 0;
    pixels = 0;
    for (int v = -radius; v <= radius; ++v)
      for (int u = -radius; u <= radius; ++u) {
        const double side = v * std::cos(angle) - u * std::sin(angle);
        if (std::hypot(u, v) > radius + 0.5 || std::abs(side) < 1e-9) continue;
        (side > 0 ? right : left) += bin(cv::borderInterpolate(y + v, bin.rows, cv::BORDER_REFLECT),
                                         cv::borderInterpolate(x + u, bin.cols, cv::BORDER_REFLECT));
        pixels += side > 0 ? 1 : 0;
      }
    if (right + left > 0) sum += (right - left) * (right - left) / (right + left);
  }
  return 0.5 * sum / (255.0 * pixels);
}

}  // namespace

TEST_CASE("A pixel's shares in the bins of a histogram sum to one", "[sketch]") {
  const SoftBins bins = sketch::soft_bins(random_levels(), 20, 200, 9, 0.8);
  for (int y = 0; y < kHalfDiscsSize.height; ++y)
    for (int x = 0; x < kHalfDiscsSize.width; ++x) {
      int sum = 0;
      for (const cv::Mat1b& bin : bins) sum += bin(y, x);
      CHECK(std::abs(sum - 255) <= 4);
    }
}

TEST_CASE("Half discs differ by the chi-square distance of their histograms", "[sketch]") {
  const SoftBins bins = sketch::soft_bins(random_levels(), 0, 255, 6, 0.5);
  for (const int radius : {1, 3, 7}) {
    const auto maps = distances(bins, radius, 2);
    for (int way = 0; way < kDiscWays; ++way)
      for (const cv::Point p : {cv::Point(0, 0), cv::Point(18, 14), cv::Point(36, 3)}) {
        INFO("radius " << radius << ", way " << way << ", " << p);
        CHECK(double{maps[static_cast<std::size_t>(way)](p)} ==
              Approx(2 * distance_at(bins, radius, way, p.x, p.y)).margin(1e-5));
      }
  }
}

TEST_CASE("A mirrored frame has mirrored distances, bit by bit", "[sketch]") {
  const cv::Mat1f levels = random_levels();
  cv::Mat1f turned;
  cv::flip(levels, turned, 1);
  const auto maps = distances(sketch::soft_bins(levels, 0, 255, 6, 1), 4),
             others = distances(sketch::soft_bins(turned, 0, 255, 6, 1), 4);
  for (std::size_t way = 0; way < kDiscWays; ++way) {
    cv::Mat1f back;
    cv::flip(others[(kDiscWays - way) % kDiscWays], back, 1);
    CHECK(cv::norm(maps[way], back, cv::NORM_INF) == 0);
  }
}
