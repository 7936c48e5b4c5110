// SPDX-License-Identifier: Apache-2.0
#include "sketch/detection/half_discs.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <span>

#include <opencv2/imgproc.hpp>

#include "core/math/simd_clones.hpp"

namespace emberfold::sketch {

namespace {

// Pixels of a half disc in one row: from the middle's row and column on.
struct Run {
  int row, first, end;
};

// The pixels of a disc to the right of a way through its middle, those on the way left out. The other half is
// this one turned by half a circle.
std::vector<Run> half_disc(int radius, int way) {
  constexpr double kOnWay = 1e-9;
  const double angle = way * std::numbers::pi / kDiscWays, reach = (radius + 0.5) * (radius + 0.5);
  std::vector<Run> runs;
  for (int y = -radius; y <= radius; ++y) {
    std::optional<Run> run;
    for (int x = -radius; x <= radius; ++x)
      if (x * x + y * y <= reach && y * std::cos(angle) - x * std::sin(angle) > kOnWay) {
        if (!run) run = {y, x, x};
        run->end = x + 1;
      }
    if (run) runs.push_back(*run);
  }
  return runs;
}

// Returns, for a bin with a mirrored margin of `radius` px, the sums of all pixels to the left in each row.
cv::Mat1i sums_of_rows(const cv::Mat1b& bin, int radius) {
  cv::Mat1b wide;
  cv::copyMakeBorder(bin, wide, radius, radius, radius, radius, cv::BORDER_REFLECT);
  cv::Mat1i sums(wide.rows, wide.cols + 1);
  for (int y = 0; y < wide.rows; ++y) {
    int sum = 0;
    const std::uint8_t* from = wide[y];
    int* to = sums[y];
    to[0] = 0;
    for (int x = 0; x < wide.cols; ++x) to[x + 1] = sum += from[x];
  }
  return sums;
}

EMBERFOLD_SIMD_CLONES void add_run(const int* first, const int* end, int width, int* __restrict sum) {
  for (int x = 0; x < width; ++x) sum[x] += end[x] - first[x];
}

EMBERFOLD_SIMD_CLONES void add_distance(const int* a, const int* b, int width, float share,
                                        float* __restrict to) {
  for (int x = 0; x < width; ++x) {
    const auto difference = static_cast<float>(a[x] - b[x]), both = static_cast<float>(a[x] + b[x]);
    to[x] += share * difference * difference / std::max(both, 1.0F);
  }
}

int pixels(std::span<const Run> runs) {
  int count = 0;
  for (const Run& run : runs) count += run.end - run.first;
  return count;
}

}  // namespace

SoftBins soft_bins(const cv::Mat1f& values, double low, double high, int bins, double spread) {
  constexpr int kSteps = 1024;  // between `low` and `high`
  const auto count = static_cast<std::size_t>(bins);
  std::vector<std::array<std::uint8_t, kSteps + 1>> shares(count);
  for (std::size_t i = 0; i <= kSteps; ++i) {
    const double at = static_cast<double>(i) / kSteps * (bins - 1);
    const auto weight = [&](std::size_t bin) {
      return std::exp(-0.5 * std::pow((at - static_cast<double>(bin)) / spread, 2));
    };
    double sum = 0;
    for (std::size_t bin = 0; bin < count; ++bin) sum += weight(bin);
    for (std::size_t bin = 0; bin < count; ++bin)
      shares[bin][i] = static_cast<std::uint8_t>(std::lround(255 * weight(bin) / sum));
  }
  SoftBins maps;
  for (std::size_t bin = 0; bin < count; ++bin) maps.emplace_back(values.size());
  const double scale = kSteps / (high - low);
  for (int y = 0; y < values.rows; ++y)
    for (int x = 0; x < values.cols; ++x) {
      const double at = std::clamp((double{values(y, x)} - low) * scale, 0.0, double{kSteps});
      const auto step = static_cast<std::size_t>(std::lround(at));
      for (std::size_t bin = 0; bin < count; ++bin) maps[bin](y, x) = shares[bin][step];
    }
  return maps;
}

void add_half_disc_distances(const SoftBins& bins, int radius, float weight, std::vector<cv::Mat1f>& maps) {
  std::array<std::vector<Run>, kDiscWays> halves;
  for (int way = 0; way < kDiscWays; ++way) halves[static_cast<std::size_t>(way)] = half_disc(radius, way);
  const int width = maps.front().cols, height = maps.front().rows;
  std::vector<int> right(static_cast<std::size_t>(width)), left(right.size());
  for (const cv::Mat1b& bin : bins) {
    const cv::Mat1i sums = sums_of_rows(bin, radius);
    for (std::size_t way = 0; way < kDiscWays; ++way) {
      const float share = 0.5F * weight / static_cast<float>(255 * pixels(halves[way]));
      for (int y = 0; y < height; ++y) {
        std::ranges::fill(right, 0), std::ranges::fill(left, 0);
        for (const Run& run : halves[way]) {
          const int *to_right = sums[y + radius + run.row] + radius,
                    *to_left = sums[y + radius - run.row] + radius + 1;
          add_run(to_right + run.first, to_right + run.end, width, right.data());
          add_run(to_left - run.end, to_left - run.first, width, left.data());
        }
        add_distance(right.data(), left.data(), width, share, maps[way][y]);
      }
    }
  }
}

}  // namespace emberfold::sketch
