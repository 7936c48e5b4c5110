// SPDX-License-Identifier: Apache-2.0
#include "sketch/patches/sections.hpp"

#include <algorithm>

#include "core/math/simd_clones.hpp"

namespace emberfold::sketch {

namespace {

// Positions of a rib's samples: the upper left pixel, as an offset from the frame's first, and the fractions.
struct Spots {
  std::array<int, kMostSamples> pixel;
  Samples fx, fy;
};

// A frame's size and how its pixels follow each other in memory; at its border those next to them are not
// read.
struct Layout {
  int width, height, step, stride;
  [[nodiscard]] int right() const { return width > 1 ? step : 0; }
  [[nodiscard]] int below() const { return height > 1 ? stride : 0; }
};

// Beyond the frame at its border.
EMBERFOLD_SIMD_CLONES void place_spots(const Rib& rib, int count, Layout frame, Spots& __restrict spots) {
  const double first = 0.5 * static_cast<double>(count - 1);
  const double px = rib.position.x, py = rib.position.y, ax = rib.across.x, ay = rib.across.y;
  const double right_end = frame.width - 1.0, lower_end = frame.height - 1.0;
  const int last_x = std::max(frame.width - 2, 0), last_y = std::max(frame.height - 2, 0);
  for (int i = 0; i < count; ++i) {
    const double d = kSampleStep * (static_cast<double>(i) - first);
    const auto x = static_cast<float>(std::min(std::max(px + ax * d, 0.0), right_end)),
               y = static_cast<float>(std::min(std::max(py + ay * d, 0.0), lower_end));
    const int x0 = std::min(static_cast<int>(x), last_x), y0 = std::min(static_cast<int>(y), last_y);
    const auto at = static_cast<std::size_t>(i);
    spots.pixel[at] = y0 * frame.stride + x0 * frame.step;
    spots.fx[at] = x - static_cast<float>(x0);
    spots.fy[at] = y - static_cast<float>(y0);
  }
}

// Between four pixels each; `right` and `below` are how far on those to the right and below lie.
EMBERFOLD_SIMD_CLONES void add_spots(const float* __restrict frame, const Spots& spots, int count, int right,
                                     int below, float weight, float* __restrict level) {
  for (int i = 0; i < count; ++i) {
    const auto at = static_cast<std::size_t>(i);
    const float* pixel = frame + spots.pixel[at];
    const float fx = spots.fx[at], fy = spots.fy[at];
    const float upper = (1 - fx) * pixel[0] + fx * pixel[right];
    const float lower = (1 - fx) * pixel[below] + fx * pixel[below + right];
    level[i] += weight * ((1 - fy) * upper + fy * lower);
  }
}

// Adds the levels along a rib; beyond the frame those of its border.
void add_rib(const cv::Mat& levels, const Rib& rib, float weight, std::span<Section> sections) {
  const Layout frame{levels.cols, levels.rows, static_cast<int>(sections.size()),
                     static_cast<int>(levels.step1())};
  const int count = static_cast<int>(sections[0].count);
  const auto* first = levels.ptr<float>();
  Spots spots;  // written as far as it is read
  place_spots(rib, count, frame, spots);
  for (Section& section : sections)
    add_spots(first++, spots, count, frame.right(), frame.below(), weight, section.level.data());
}

}  // namespace

double section_variance(std::span<const Rib> ribs, double noise) {
  double sum = 0, squares = 0;
  for (const Rib& rib : ribs) {
    sum += rib.weight;
    squares += rib.weight * rib.weight;
  }
  return 2 * noise * noise * squares / (sum * sum);
}

Sections sample_sections(const cv::Mat& levels, std::span<const Rib> ribs, std::size_t count,
                         const std::array<float, 3>& axis) {
  const auto channels = static_cast<std::size_t>(levels.channels());
  double total = 0;
  for (const Rib& rib : ribs) total += rib.weight;
  Sections sections;
  for (Section& section : sections.channel) section.count = count;
  for (const Rib& rib : ribs)
    add_rib(levels, rib, static_cast<float>(rib.weight / total), std::span(sections.channel).first(channels));
  sections.seen = sections.channel[0];
  if (channels == 1) return sections;
  for (std::size_t i = 0; i < count; ++i) {
    const auto level = [&](std::size_t c) { return sections.channel[c].level[i]; };
    sections.seen.level[i] = axis[0] * level(0) + axis[1] * level(1) + axis[2] * level(2);
  }
  return sections;
}

}  // namespace emberfold::sketch
