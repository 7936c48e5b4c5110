// SPDX-License-Identifier: Apache-2.0
#include "sketch/detection/boundaries.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "core/clip.hpp"
#include "sketch/detection/colour.hpp"
#include "sketch/detection/half_discs.hpp"

namespace emberfold::sketch {

namespace {

constexpr int kSmall = 3, kColour = 5, kMiddle = 10, kLarge = 20;  // px: radii of the discs

// Nats for a boundary where the histograms have nothing in common, and for one where they are the same.
constexpr float kOfSmall = 3.2F, kOfMiddle = 4, kOfTexture = 3, kOfColour = 2, kOfCrowd = -4;
constexpr float kOfNothing = -2.8F, kOfNoColour = -1.3F;

std::vector<cv::Mat1f> make_maps(cv::Size frame) {
  std::vector<cv::Mat1f> maps;
  for (int way = 0; way < kDiscWays; ++way) maps.emplace_back(frame, 0.0F);
  return maps;
}

cv::Mat1f greatest(const std::vector<cv::Mat1f>& maps) {
  cv::Mat1f most = maps.front().clone();
  for (const cv::Mat1f& map : maps)
    for (int y = 0; y < most.rows; ++y)
      std::transform(most[y], most[y] + most.cols, map[y], most[y],
                     [](float a, float b) { return std::max(a, b); });
  return most;
}

SoftBins bins_of_brightness(const cv::Mat1f& luma) {
  constexpr double kWhite = 255, kSpread = 1;
  constexpr int kBins = 16;
  return soft_bins(luma, 0, kWhite, kBins, kSpread);
}

SoftBins bins_of_colour(const cv::Mat1f& axis) {
  constexpr double kMost = 60, kSpread = 1;  // levels, bins
  constexpr int kBins = 16;
  return soft_bins(axis, -kMost, kMost, kBins, kSpread);
}

// Texture: doublings of the slope, seen at 1 px.
SoftBins bins_of_roughness(const cv::Mat1f& luma) {
  constexpr double kSeenAt = 1, kDoublings = 5, kSpread = 0.7;  // px, –, bins
  constexpr int kBins = 8;
  cv::Mat1f smooth, wide, rough(luma.size());
  cv::GaussianBlur(luma, smooth, {}, kSeenAt, kSeenAt, cv::BORDER_REFLECT);
  cv::copyMakeBorder(smooth, wide, 1, 1, 1, 1, cv::BORDER_REFLECT);
  for (int y = 0; y < rough.rows; ++y)
    for (int x = 0; x < rough.cols; ++x) {
      const float dx = 0.5F * (wide(y + 1, x + 2) - wide(y + 1, x)),
                  dy = 0.5F * (wide(y + 2, x + 1) - wide(y, x + 1));
      rough(y, x) = std::log2(1 + std::sqrt(dx * dx + dy * dy));
    }
  return soft_bins(rough, 0, kDoublings, kBins, kSpread);
}

}  // namespace

cv::Mat1f find_boundaries(const cv::Mat& levels) {
  const cv::Mat1f luma = core::luma(levels);
  const SoftBins brightness = bins_of_brightness(luma);
  std::vector<cv::Mat1f> maps = make_maps(luma.size());
  add_half_disc_distances(brightness, kSmall, kOfSmall, maps);
  // Where many small things differ, one more means less.
  cv::Mat1f crowd;
  cv::GaussianBlur(greatest(maps), crowd, {}, kLarge, kLarge, cv::BORDER_REFLECT);
  add_half_disc_distances(brightness, kMiddle, kOfMiddle, maps);
  add_half_disc_distances(bins_of_roughness(luma), kLarge, kOfTexture, maps);
  float nothing = kOfNothing;
  if (levels.channels() == 3) {
    nothing += kOfNoColour;
    for (const cv::Mat1f& axis : compute_opponent_colours(levels)) {
      const SoftBins colour = bins_of_colour(axis);
      add_half_disc_distances(colour, kColour, kOfColour, maps);
      add_half_disc_distances(colour, kMiddle, kOfColour, maps);
    }
  }
  cv::Mat1f probability = greatest(maps);
  for (int y = 0; y < probability.rows; ++y)
    for (int x = 0; x < probability.cols; ++x) {
      const float nats = nothing + probability(y, x) + kOfCrowd / kOfSmall * crowd(y, x);
      probability(y, x) = 1 / (1 + std::exp(-nats));
    }
  return probability;
}

}  // namespace emberfold::sketch
