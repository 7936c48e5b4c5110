// SPDX-License-Identifier: Apache-2.0
#include "pipeline/footage/between_frames.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "core/math/bilinear.hpp"

namespace emberfold::pipeline {

namespace {

constexpr float kMixFrom = 0.35F, kMixTo = 0.65F;  // share of a frame's time: the next one mixes in between
constexpr float kStill = 0.1F;                     // px: pixels that move less are copied

/// Samples a motion field of fewer vectors than the frame has pixels.
cv::Vec2f motion_at(const cv::Mat& motion, float x, float y) {
  const core::BilinearPlace place(x, y, motion.size());
  return place.between(motion.ptr<cv::Vec2f>(place.top), motion.ptr<cv::Vec2f>(place.bottom),
                       [](const cv::Vec2f* row, int column) { return row[column]; });
}

std::array<float, 4> catmull_rom(float t) {
  return {t * (-0.5F + t * (1 - 0.5F * t)), 1 + t * t * (-2.5F + 1.5F * t), t * (0.5F + t * (2 - 1.5F * t)),
          t * t * (-0.5F + 0.5F * t)};
}

/// Adds `weight` times the frame's levels at (x, y) to `sum`; border pixels are replicated.
template <int Channels>
void add_levels(const cv::Mat& frame, float x, float y, float weight, std::array<float, Channels>& sum) {
  const int left = static_cast<int>(std::floor(x)), top = static_cast<int>(std::floor(y));
  const auto across = catmull_rom(x - static_cast<float>(left)),
             down = catmull_rom(y - static_cast<float>(top));
  std::array<int, 4> columns{};
  for (int j = 0; j < 4; ++j)
    columns[static_cast<std::size_t>(j)] = Channels * std::clamp(left - 1 + j, 0, frame.cols - 1);
  for (int i = 0; i < 4; ++i) {
    const auto* const row = frame.ptr<std::uint8_t>(std::clamp(top - 1 + i, 0, frame.rows - 1));
    const float w = weight * down[static_cast<std::size_t>(i)];
    for (std::size_t j = 0; j < 4; ++j)
      for (std::size_t c = 0; c < Channels; ++c)
        sum[c] += w * across[j] * static_cast<float>(row[static_cast<std::size_t>(columns[j]) + c]);
  }
}

template <int Channels>
cv::Mat draw(std::span<const MovingFrame> frames, double begin, const cv::Mat1f& offsets) {
  cv::Mat out(offsets.size(), CV_8UC(Channels));
  const cv::Size size = offsets.size(), vectors = frames.front().motion->size();
  const float to_x = static_cast<float>(vectors.width) / static_cast<float>(size.width);
  const float to_y = static_cast<float>(vectors.height) / static_cast<float>(size.height);
  for (int y = 0; y < size.height; ++y) {
    auto* const row = out.ptr<std::uint8_t>(y);
    for (int x = 0; x < size.width; ++x) {
      const double time = begin + double{offsets(y, x)};
      const auto k = static_cast<std::size_t>(time);
      const float f = static_cast<float>(time - static_cast<double>(k));
      const auto px = static_cast<float>(x), py = static_cast<float>(y);
      const auto v = motion_at(*frames[k].motion, (px + 0.5F) * to_x - 0.5F, (py + 0.5F) * to_y - 0.5F);
      const float whole = std::round(f);
      const bool still = std::abs((f - whole) * v[0]) < kStill && std::abs((f - whole) * v[1]) < kStill;
      const float next = still ? whole : std::clamp((f - kMixFrom) / (kMixTo - kMixFrom), 0.F, 1.F);
      std::array<float, Channels> sum{};
      const auto add = [&](const cv::Mat& frame, float moved, float weight) {
        if (std::abs(moved * v[0]) < kStill && std::abs(moved * v[1]) < kStill) {
          for (int c = 0; c < Channels; ++c)
            sum[static_cast<std::size_t>(c)] +=
                weight * static_cast<float>(frame.ptr<std::uint8_t>(y)[Channels * x + c]);
        } else {
          add_levels<Channels>(frame, px - moved * v[0], py - moved * v[1], weight, sum);
        }
      };
      if (next < 1) add(*frames[k].frame, f, 1 - next);
      if (next > 0) add(*frames[k + 1].frame, f - 1, next);
      for (std::size_t c = 0; c < Channels; ++c)
        row[static_cast<std::size_t>(Channels * x) + c] = cv::saturate_cast<std::uint8_t>(sum[c]);
    }
  }
  return out;
}

}  // namespace

cv::Mat draw_between(std::span<const MovingFrame> frames, double begin, const cv::Mat1f& offsets) {
  return frames.front().frame->channels() == 3 ? draw<3>(frames, begin, offsets)
                                               : draw<1>(frames, begin, offsets);
}

}  // namespace emberfold::pipeline
