// SPDX-License-Identifier: Apache-2.0
#include "sketch/sections.hpp"

#include <algorithm>

#include "sketch/row_pass.hpp"

namespace emberfold::sketch {

using graph::Point;

namespace {

// Between four pixels: `right` and `below` are how far on those to the right and below lie.
inline float between(const float* pixel, std::ptrdiff_t right, std::ptrdiff_t below, float fx, float fy) {
  const float upper = (1 - fx) * pixel[0] + fx * pixel[right];
  const float lower = (1 - fx) * pixel[below] + fx * pixel[below + right];
  return (1 - fy) * upper + fy * lower;
}

// Where the samples of a rib lie: the pixel to their upper left, as a distance from the frame's first, and
// how far beyond it.
struct Spots {
  std::array<int, kMostSamples> pixel;
  Samples fx, fy;
};

EMBERFOLD_ROW_PASS void place_spots(const Rib& rib, int count, int step, int stride, Spots& spots) {
  const int last = count - 1;
  const double first = 0.5 * static_cast<double>(last);
  const double px = rib.position.x, py = rib.position.y, ax = rib.across.x, ay = rib.across.y;
  for (int i = 0; i < count; ++i) {
    const double d = kSampleStep * (static_cast<double>(std::min(i, last)) - first);
    const auto x = static_cast<float>(px + ax * d), y = static_cast<float>(py + ay * d);
    const int x0 = static_cast<int>(x), y0 = static_cast<int>(y);
    const auto at = static_cast<std::size_t>(i);
    spots.pixel[at] = y0 * stride + x0 * step;
    spots.fx[at] = x - static_cast<float>(x0);
    spots.fy[at] = y - static_cast<float>(y0);
  }
}

EMBERFOLD_ROW_PASS void add_spots(const float* __restrict frame, const Spots& spots, int count, int step,
                                  int stride, float weight, float* __restrict level) {
  for (int i = 0; i < count; ++i) {
    const auto at = static_cast<std::size_t>(i);
    level[i] += weight * between(frame + spots.pixel[at], step, stride, spots.fx[at], spots.fy[at]);
  }
}

// Adds the levels along a rib; beyond the frame those of its border.
void add_rib(const cv::Mat& levels, const Rib& rib, float weight, std::span<Section> sections) {
  const std::size_t count = sections[0].count;
  const auto channels = static_cast<std::ptrdiff_t>(sections.size());
  const auto stride = static_cast<std::ptrdiff_t>(levels.step1());
  const auto* first = levels.ptr<float>();
  const auto inside = [&](double d) {
    const Point q = rib.position + rib.across * d;
    return q.x >= 0 && q.y >= 0 && q.x < levels.cols - 1.001 && q.y < levels.rows - 1.001;
  };
  if (inside(sections[0].place(0)) && inside(sections[0].place(count - 1))) {
    const int samples = static_cast<int>(count), step = static_cast<int>(channels);
    Spots spots;  // written as far as it is read
    place_spots(rib, samples, step, static_cast<int>(stride), spots);
    for (Section& section : sections)
      add_spots(first++, spots, samples, step, static_cast<int>(stride), weight, section.level.data());
    return;
  }
  for (std::size_t i = 0; i < count; ++i) {
    const Point q = rib.position + rib.across * sections[0].place(i);
    const auto x = static_cast<float>(std::clamp(q.x, 0.0, levels.cols - 1.0)),
               y = static_cast<float>(std::clamp(q.y, 0.0, levels.rows - 1.0));
    const int x0 = static_cast<int>(x), y0 = static_cast<int>(y);
    const float* pixel = first + y0 * stride + x0 * channels;
    for (Section& section : sections)
      section.level[i] +=
          weight * between(pixel++, x0 + 1 < levels.cols ? channels : 0, y0 + 1 < levels.rows ? stride : 0,
                           x - static_cast<float>(x0), y - static_cast<float>(y0));
  }
}

}  // namespace

Sections cut_across(const cv::Mat& levels, std::span<const Rib> ribs, std::size_t count,
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
