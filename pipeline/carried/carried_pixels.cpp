// SPDX-License-Identifier: Apache-2.0
#include "pipeline/carried/carried_pixels.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include <opencv2/core.hpp>

#include "core/math/bilinear.hpp"

namespace emberfold::pipeline {

namespace {

constexpr float kFaint = 0.75, kOpaque = 1;  // thresholds of contrast / fitted difference
constexpr float kDark = 16;  // grey levels, added before taking gains: black has no colour to scale

/// Maps pixels to the levels next to a patch: brighter ones are scaled down, so that none becomes negative
/// and tints, darker ones are raised, so that none is blown up.
struct Fit {
  std::array<float, 3> gain{1, 1, 1}, added{};
  std::array<float, 3> seen{};  // levels next to the patch in its source frame
};

/// Weighted sums over the patches that cover one pixel.
struct PixelSource {
  float share = 0;      // of the transferred pixel
  float weight = 0;     // sum
  Fit fit{{}, {}, {}};  // sums
  float opacity = 0;    // sum, per grey level of difference from the patch's surroundings
  float x = 0, y = 0;   // sums: place in the source frame, less the pixel's own
};

/// Returns the mean levels of the 5×5 pixels about a place, of those within the frame.
std::array<float, 3> mean_levels(const cv::Mat& frame, graph::Point at) {
  std::array<float, 3> sum{};
  const int cx = static_cast<int>(std::lround(std::clamp(at.x, 0.0, double(frame.cols - 1))));
  const int cy = static_cast<int>(std::lround(std::clamp(at.y, 0.0, double(frame.rows - 1))));
  int count = 0;
  for (int y = std::max(0, cy - 2); y <= std::min(frame.rows - 1, cy + 2); ++y)
    for (int x = std::max(0, cx - 2); x <= std::min(frame.cols - 1, cx + 2); ++x, ++count)
      for (int c = 0; c < frame.channels(); ++c)
        sum[static_cast<std::size_t>(c)] +=
            static_cast<float>(frame.ptr<std::uint8_t>(y)[frame.channels() * x + c]);
  for (auto& level : sum) level /= static_cast<float>(count);
  return sum;
}

/// Levels at `across` px to the left and to the right of a patch's curve.
struct Sides {
  Fit left, right;
  double across = 1;
  float opacity = 0;  // of a patch's pixels, per grey level of difference from its surroundings
};

/// Returns bilinear levels at a place; beyond the border those of the nearest pixel.
template <int Channels>
std::array<float, Channels> levels_at(const cv::Mat& frame, float x, float y) {
  const core::BilinearPlace place(x, y, frame.size());
  const auto *upper = frame.ptr<std::uint8_t>(place.top), *lower = frame.ptr<std::uint8_t>(place.bottom);
  std::array<float, Channels> levels{};
  for (int c = 0; c < Channels; ++c)
    levels[static_cast<std::size_t>(c)] = place.between(
        upper, lower,
        [&](const std::uint8_t* row, int column) { return static_cast<float>(row[Channels * column + c]); });
  return levels;
}

/// Returns the opacity of a patch's pixels per grey level of difference from its surroundings.
/// A patch whose contrast exceeds the fitted difference is opaque: its middle has a colour of its own, which
/// the background must not tint. Fainter patches are transparent: 0.
float opacity_of(const CarriedPatch& patch, const Sides& sides, float lacking, const cv::Mat& source) {
  const auto x = static_cast<float>(patch.from.x), y = static_cast<float>(patch.from.y);
  const auto channels = static_cast<std::size_t>(source.channels());
  const auto middle =
      channels == 3 ? levels_at<3>(source, x, y) : std::array<float, 3>{levels_at<1>(source, x, y)[0]};
  float contrast = 0;
  for (std::size_t c = 0; c < channels; ++c)
    contrast = std::max(contrast, std::abs(middle[c] - (sides.left.seen[c] + sides.right.seen[c]) / 2));
  const float times = contrast / std::max(1.F, lacking);
  return times > kFaint ? std::min(1.F, (times - kFaint) / (kOpaque - kFaint)) / contrast : 0;
}

Sides fit_sides(const CarriedStroke& stroke, const CarriedPatch& patch, const cv::Mat& frame,
                const cv::Mat& source) {
  Sides sides;
  if (stroke.fit <= 0) return sides;
  sides.across = patch.reach + stroke.feather / 2;
  const auto most = static_cast<float>(stroke.fit);
  float largest = 0;
  const auto fit = [&](double side) {
    const double there = patch.theta + patch.turn;
    const graph::Point to{-std::sin(patch.theta) * side, std::cos(patch.theta) * side},
        from{-std::sin(there) * side, std::cos(there) * side};
    const auto levels = mean_levels(frame, patch.to + to), seen = mean_levels(source, patch.from + from);
    Fit found;
    found.seen = seen;
    float asked = 0;
    for (std::size_t c = 0; c < 3; ++c) asked = std::max(asked, std::abs(levels[c] - seen[c]));
    largest = std::max(largest, std::min(asked, most));
    // All channels by one share: a partial fit has a colour between the two.
    const float share = asked > most ? most / asked : 1;
    for (std::size_t c = 0; c < 3; ++c) {
      const float lacking = share * (levels[c] - seen[c]);
      found.gain[c] = (seen[c] + std::min(0.F, lacking) + kDark) / (seen[c] + kDark);
      found.added[c] = std::max(0.F, lacking);
    }
    return found;
  };
  sides.left = fit(-sides.across), sides.right = fit(sides.across);
  if (!stroke.hides) sides.opacity = opacity_of(patch, sides, largest, source);
  return sides;
}

/// The part of a frame that patches reach.
class Window {
 public:
  Window(const CarriedStroke& stroke, const cv::Mat& base, const cv::Mat& source) : feather_(stroke.feather) {
    const cv::Size frame = base.size();
    double left = frame.width, top = frame.height, right = -1, bottom = -1;
    for (const auto& patch : stroke.patches) {
      const double radius = patch.reach + feather_;
      left = std::min(left, patch.to.x - radius), right = std::max(right, patch.to.x + radius);
      top = std::min(top, patch.to.y - radius), bottom = std::max(bottom, patch.to.y + radius);
    }
    const auto clamped = [](double value, int end) {
      return static_cast<int>(std::clamp(value, 0.0, static_cast<double>(end)));
    };
    area_ = {
        {clamped(std::floor(left), frame.width), clamped(std::floor(top), frame.height)},
        cv::Point(clamped(std::ceil(right) + 1, frame.width), clamped(std::ceil(bottom) + 1, frame.height))};
    if (area_.empty()) return;
    pixels_.resize(static_cast<std::size_t>(area_.width) * static_cast<std::size_t>(area_.height));
    for (const auto& patch : stroke.patches) add(patch, fit_sides(stroke, patch, base, source));
  }
  [[nodiscard]] const cv::Rect& area() const { return area_; }
  [[nodiscard]] const PixelSource* row(int y) const { return &pixels_[at(y)]; }

 private:
  [[nodiscard]] std::size_t at(int y) const {
    return static_cast<std::size_t>(y - area_.y) * static_cast<std::size_t>(area_.width);
  }

  void add(const CarriedPatch& patch, const Sides& sides) {
    const double radius = patch.reach + feather_;
    const double c = std::cos(patch.turn), s = std::sin(patch.turn);
    const graph::Point normal{-std::sin(patch.theta), std::cos(patch.theta)};
    const int top = std::max(area_.y, static_cast<int>(std::ceil(patch.to.y - radius)));
    const int bottom =
        std::min(area_.y + area_.height - 1, static_cast<int>(std::floor(patch.to.y + radius)));
    for (int y = top; y <= bottom; ++y) {
      const double dy = y - patch.to.y, half = std::sqrt(std::max(0.0, radius * radius - dy * dy));
      const int first = std::max(area_.x, static_cast<int>(std::ceil(patch.to.x - half)));
      const int last = std::min(area_.x + area_.width - 1, static_cast<int>(std::floor(patch.to.x + half)));
      PixelSource* const pixels = &pixels_[at(y)];
      for (int x = first; x <= last; ++x) {
        const double dx = x - patch.to.x, d = std::sqrt(dx * dx + dy * dy);
        const double u = std::clamp((radius - d) / feather_, 0.0, 1.0);
        const double weight = (radius - d) * (radius - d) + 1e-3;
        auto& pixel = pixels[x - area_.x];
        pixel.share = std::max(pixel.share, static_cast<float>(u * u * (3 - 2 * u)));
        pixel.weight += static_cast<float>(weight);
        const double aside = normal.x * dx + normal.y * dy;
        const auto right = static_cast<float>(std::clamp(0.5 + aside / (2 * sides.across), 0.0, 1.0));
        for (std::size_t k = 0; k < 3; ++k) {
          const auto between = [&](const std::array<float, 3>& a, const std::array<float, 3>& b) {
            return static_cast<float>(weight) * (a[k] + right * (b[k] - a[k]));
          };
          pixel.fit.gain[k] += between(sides.left.gain, sides.right.gain);
          pixel.fit.added[k] += between(sides.left.added, sides.right.added);
          pixel.fit.seen[k] += between(sides.left.seen, sides.right.seen);
        }
        pixel.opacity += static_cast<float>(weight) * sides.opacity;
        pixel.x += static_cast<float>(weight * (patch.from.x - patch.to.x + (c - 1) * dx - s * dy));
        pixel.y += static_cast<float>(weight * (patch.from.y - patch.to.y + s * dx + (c - 1) * dy));
      }
    }
  }

  double feather_;
  cv::Rect area_;
  std::vector<PixelSource> pixels_;
};

template <int Channels>
void draw(cv::Mat& frame, const cv::Mat& source, const Window& window, float opacity) {
  const auto& area = window.area();
  for (int y = area.y; y < area.y + area.height; ++y) {
    const auto* const pixels = window.row(y);
    auto* const row = frame.ptr<std::uint8_t>(y);
    for (int x = area.x; x < area.x + area.width; ++x) {
      const auto& pixel = pixels[x - area.x];
      const float share = opacity * pixel.share;
      if (share <= 0) continue;
      const auto levels = levels_at<Channels>(source, static_cast<float>(x) + pixel.x / pixel.weight,
                                              static_cast<float>(y) + pixel.y / pixel.weight);
      float difference = 0;
      for (std::size_t k = 0; k < Channels; ++k)
        difference = std::max(difference, std::abs(levels[k] - pixel.fit.seen[k] / pixel.weight));
      const float own = std::min(1.F, difference * pixel.opacity / pixel.weight);
      for (int c = 0; c < Channels; ++c) {
        auto& level = row[Channels * x + c];
        const auto before = static_cast<float>(level);
        const auto k = static_cast<std::size_t>(c);
        const float fitted =
            ((levels[k] + kDark) * pixel.fit.gain[k] + pixel.fit.added[k]) / pixel.weight - kDark;
        const float shown = fitted + own * (levels[k] - fitted);
        level = cv::saturate_cast<std::uint8_t>(before + share * (shown - before));
      }
    }
  }
}

}  // namespace

double carried_reach(const graph::Patch& patch) {
  return std::clamp(patch.width / 2 + 2 * patch.blur, 2.0, 12.0);
}

void draw_carried(cv::Mat& frame, const std::vector<cv::Mat>& footage, const CarriedStroke& stroke) {
  if (stroke.patches.empty() || stroke.opacity <= 0) return;
  const auto& source = footage[static_cast<std::size_t>(stroke.frame)];
  const Window window(stroke, frame, source);
  if (window.area().empty()) return;
  const auto opacity = static_cast<float>(std::min(1.0, stroke.opacity));
  if (frame.channels() == 3)
    draw<3>(frame, source, window, opacity);
  else
    draw<1>(frame, source, window, opacity);
}

}  // namespace emberfold::pipeline
