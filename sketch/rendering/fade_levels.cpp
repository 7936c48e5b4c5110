// SPDX-License-Identifier: Apache-2.0
#include "sketch/rendering/fade_levels.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "core/math/cell_grid.hpp"
#include "sketch/inpainting/fill.hpp"

namespace emberfold::sketch {

namespace {

constexpr int coarse = 4;      // of the fill that patches fade into: a cell is so many px
constexpr int fade_steps = 6;  // a fade's, as in fade_in_out.hpp

/// Ranks of the pixels that patches cover: 1 + the number of opacity steps reached; 0 elsewhere. A pixel that
/// has reached the k-th step has a rank above k.
cv::Mat ranks_of(const cv::Mat& mask, const cv::Mat& opacity) {
  std::array<float, fade_steps + 1> shares{};
  for (int k = 0; k <= fade_steps; ++k)
    shares[static_cast<std::size_t>(k)] =
        (k < fade_steps ? (static_cast<float>(k) + 0.5F) / fade_steps : 1) - (1 - kOpaque);
  cv::Mat ranks = cv::Mat::zeros(mask.size(), CV_8U);
  for (int y = 0; y < mask.rows; ++y) {
    const auto* shown = mask.ptr(y);
    const auto* present = opacity.ptr<float>(y);
    auto* rank = ranks.ptr(y);
    for (int x = 0; x < mask.cols; ++x) {
      if (shown[x] == 0) continue;
      const auto passed = std::ranges::count_if(shares, [&](float share) { return present[x] >= share; });
      rank[x] = static_cast<uchar>(1 + passed);
    }
  }
  return ranks;
}

/// Fills the patches of at least a rank in coarse cells: good enough for levels to begin from.
class CoarseFill {
 public:
  CoarseFill(const sketch::Sketchable& part, const cv::Mat& ranks, const BackgroundImage& background)
      : part_(part), ranks_(ranks), ground_(background) {
    if (!background.empty()) near_ = spread_maximum(ranks);
  }
  /// Fills from the pixels of a higher rank.
  [[nodiscard]] cv::Mat above(int rank, float empty_level) const {
    const cv::Mat left = ranks_ > rank;
    cv::Mat held = left, weight, weights, levels, seen;
    part_.levels.copyTo(seen, left);
    if (!ground_.empty()) {
      cv::Mat still = ground_.still & (near_ <= rank);
      if (!ground_.fixed.empty()) still |= ground_.fixed;
      ground_.levels.copyTo(seen, still);
      held = left | still;
    }
    held.convertTo(weight, CV_32F, 1 / 255.0);
    cv::resize(weight, weight, core::count_cells(held.size(), coarse), 0, 0, cv::INTER_AREA);
    cv::resize(seen, levels, weight.size(), 0, 0, cv::INTER_AREA);
    cv::merge(std::vector<cv::Mat>(static_cast<std::size_t>(levels.channels()), cv::max(weight, 1e-3)),
              weights);
    levels /= weights;
    const cv::Mat known = weight > 0.05;
    if (cv::countNonZero(known) == 0)
      return {levels.size(), levels.type(), cv::Scalar::all(static_cast<double>(empty_level))};
    return sketch::fill(levels, known).levels;
  }

 private:
  const sketch::Sketchable& part_;
  const cv::Mat& ranks_;
  const BackgroundImage& ground_;
  cv::Mat near_;
};

/// Blends pixels that are not opaque: `from`, plus their opacity times the difference of their levels from
/// `beyond`.
void blend(sketch::Sketchable& part, const cv::Mat& opacity, const cv::Mat& from, const cv::Mat& beyond) {
  const int channels = part.levels.channels();
  for (int y = 0; y < part.mask.rows; ++y) {
    const auto* drawn = part.mask.ptr(y);
    const auto *share = opacity.ptr<float>(y), *begin = from.ptr<float>(y), *own = beyond.ptr<float>(y);
    auto* levels = part.levels.ptr<float>(y);
    for (int x = 0; x < part.mask.cols; ++x)
      for (int c = x * channels; drawn[x] != 0 && share[x] < kOpaque && c < (x + 1) * channels; ++c)
        levels[c] = begin[c] + share[x] * (levels[c] - own[c]);
  }
}

}  // namespace

void blend_with_fill(sketch::Sketchable& part, const cv::Mat& opacity, const BackgroundImage& background,
                     float empty_level) {
  const cv::Mat ranks = ranks_of(part.mask, opacity);
  const CoarseFill fill(part, ranks, background);
  std::array<std::size_t, fade_steps + 3> counts{};
  std::for_each(ranks.begin<uchar>(), ranks.end<uchar>(), [&](uchar rank) { ++counts[rank]; });
  const cv::Mat all = fill.above(0, empty_level);
  cv::Mat sum = cv::Mat::zeros(all.size(), all.type()), level = all;
  for (int k = 0; k <= fade_steps; ++k) {  // between the shares that a fade goes through
    const int rank = k + 1;
    if (counts[static_cast<std::size_t>(rank)] > 0) level = fill.above(rank, empty_level);
    sum += level * (k == 0 || k == fade_steps ? 0.5 / fade_steps : 1.0 / fade_steps);
  }
  cv::Mat from, whole;
  cv::resize(sum, from, part.mask.size(), 0, 0, cv::INTER_LINEAR);
  cv::resize(all, whole, part.mask.size(), 0, 0, cv::INTER_LINEAR);
  blend(part, opacity, from, whole);
}

}  // namespace emberfold::sketch
