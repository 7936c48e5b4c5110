// SPDX-License-Identifier: Apache-2.0
#include "sketch/candidates/curve_pixels.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <numeric>

namespace emberfold::sketch {

namespace {

// The points of a section and some of its neighbours', single precision for vectors.
struct NearPoints {
  static constexpr std::size_t kMost = 48;  // sections have some 15 points
  std::array<float, kMost> x, y, nx, ny;
  std::size_t count = 0, first = 0, last = 0;  // the section's own
  bool start = false, end = false;             // the curve ends freely there
  float left = 1e9F, right = -1e9F, top = 1e9F, bottom = -1e9F;
};

NearPoints near_points(const Chain& chain, const CurveSection& section) {
  constexpr std::ptrdiff_t kAround = 4;
  NearPoints near{};
  const auto all = std::ssize(chain.points), first = std::ptrdiff_t{section.first},
             last = std::ptrdiff_t{section.last};
  near.start = first == 0 && !chain.closed;
  near.end = last == all && !chain.closed;
  const auto most = static_cast<std::ptrdiff_t>(NearPoints::kMost);
  const std::ptrdiff_t from = chain.closed ? first - kAround : std::max<std::ptrdiff_t>(first - kAround, 0),
                       to = std::min(chain.closed ? last + kAround : std::min(last + kAround, all),
                                     from + most);
  for (std::ptrdiff_t i = from; i < to; ++i) {
    const CreasePoint& p = chain.points[static_cast<std::size_t>((i + all) % all)];
    const std::size_t k = near.count++;
    near.x[k] = static_cast<float>(p.position.x), near.y[k] = static_cast<float>(p.position.y);
    near.nx[k] = static_cast<float>(-std::sin(p.theta)), near.ny[k] = static_cast<float>(std::cos(p.theta));
    if (i < first) near.first = k + 1;
    if (i < last) near.last = k + 1;
    if (i < first || i >= last) continue;
    near.left = std::min(near.left, near.x[k]), near.right = std::max(near.right, near.x[k]);
    near.top = std::min(near.top, near.y[k]), near.bottom = std::max(near.bottom, near.y[k]);
  }
  return near;
}

// Which of the points is nearest along a row of pixels: the lower envelope of their parabolas (Felzenszwalb &
// Huttenlocher 2012, algorithm 1).
class NearestInRow {
 public:
  explicit NearestInRow(const NearPoints& near) : near_(near) {
    std::iota(order_.begin(), order_.begin() + static_cast<std::ptrdiff_t>(near.count), std::size_t{0});
    std::sort(order_.begin(), order_.begin() + static_cast<std::ptrdiff_t>(near.count),
              [&](std::size_t i, std::size_t j) { return near.x[i] < near.x[j]; });
  }

  // visit(point, from, to) for the stretches from ≤ x < to of row y, left to right.
  template <class Visit>
  void visit(float y, const Visit& visit) {
    std::size_t count = 0;
    const auto meet = [&](std::size_t i, std::size_t j) {  // where j, further right, becomes the nearer one
      const float xi = near_.x[i], xj = near_.x[j], dy = y - near_.y[i], ey = y - near_.y[j];
      return xj > xi ? 0.5F * (xi + xj + (ey - dy) * (ey + dy) / (xj - xi))
                     : (ey * ey < dy * dy ? -kFar : kFar);
    };
    for (std::size_t k = 0; k < near_.count; ++k) {
      const std::size_t j = order_[k];
      float from = -kFar;
      while (count > 0) {
        from = meet(nearest_[count - 1], j);
        if (from > from_[count - 1]) break;
        from = -kFar;
        --count;
      }
      if (from >= kFar) continue;
      nearest_[count] = j;
      from_[count++] = from;
    }
    for (std::size_t k = 0; k < count; ++k) visit(nearest_[k], from_[k], k + 1 < count ? from_[k + 1] : kFar);
  }

 private:
  static constexpr float kFar = 1e9F;
  const NearPoints& near_;
  std::array<std::size_t, NearPoints::kMost> order_{}, nearest_{};
  std::array<float, NearPoints::kMost> from_{};
};

}  // namespace

void begin_at_strongest(Chain& chain) {
  std::vector<CreasePoint>& points = chain.points;
  std::rotate(points.begin(), std::ranges::max_element(points, {}, &CreasePoint::contrast), points.end());
}

std::vector<CurveSection> cut_into_sections(Chain& chain, double length) {
  std::vector<CreasePoint>& points = chain.points;
  if (chain.closed) begin_at_strongest(chain);
  std::vector<double> s = arc_lengths(chain);
  const double total =
      s.back() + (chain.closed ? distance(points.back().position, points.front().position) : 0);
  const auto parts = static_cast<std::size_t>(std::max(1.0, std::round(total / length)));
  const double of_part = total / static_cast<double>(parts);
  if (chain.closed) {  // the strongest point is to be the middle of the first section
    const auto first = std::ranges::lower_bound(s, total - 0.5 * of_part) - s.begin();
    for (double& at : s) at += 0.5 * of_part;
    std::transform(s.begin() + first, s.end(), s.begin() + first, [&](double at) { return at - total; });
    std::rotate(s.begin(), s.begin() + first, s.end());
    std::rotate(points.begin(), points.begin() + first, points.end());
  }
  std::vector<CurveSection> sections;
  std::uint32_t i = 0;
  for (std::size_t k = 1; k <= parts; ++k) {
    const std::uint32_t first = i;
    while (i < s.size() && (s[i] <= of_part * static_cast<double>(k) || k == parts)) ++i;
    if (i > first) sections.push_back({first, i});
  }
  return sections;
}

void add_section_pixels(const Chain& chain, const CurveSection& section, double reach, cv::Size frame,
                        std::vector<CurvePixel>& pixels) {
  const NearPoints near = near_points(chain, section);
  const auto r = static_cast<float>(reach);
  const int left = std::max(0, static_cast<int>(std::ceil(near.left - r))),
            right = std::min(frame.width - 1, static_cast<int>(std::floor(near.right + r))),
            top = std::max(0, static_cast<int>(std::ceil(near.top - r))),
            bottom = std::min(frame.height - 1, static_cast<int>(std::floor(near.bottom + r)));
  NearestInRow nearest(near);
  for (int y = top; y <= bottom; ++y)
    nearest.visit(static_cast<float>(y), [&](std::size_t best, float from, float to) {
      if (best < near.first || best >= near.last) return;
      const float dy = static_cast<float>(y) - near.y[best], half = r * r - dy * dy;
      if (half < 0) return;
      const float low = std::max(from, near.x[best] - std::sqrt(half)),
                  high = std::min(to, near.x[best] + std::sqrt(half));
      for (int x = std::max(left, static_cast<int>(std::ceil(low)));
           x <= right && static_cast<float>(x) <= high && static_cast<float>(x) < to; ++x) {
        const float dx = static_cast<float>(x) - near.x[best];
        const float across = dx * near.nx[best] + dy * near.ny[best], least = dx * dx + dy * dy;
        const bool aside = least - across * across > 1;  // beyond an end, or outside a bend
        if (aside && ((near.start && best == near.first) || (near.end && best + 1 == near.last))) continue;
        pixels.push_back({y * frame.width + x, aside ? std::copysign(std::sqrt(least), across) : across});
      }
    });
}

}  // namespace emberfold::sketch
