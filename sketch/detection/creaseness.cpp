// SPDX-License-Identifier: Apache-2.0
#include "sketch/detection/creaseness.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace emberfold::sketch {

using graph::Point;

namespace {

// Sampled Gaussian of SD 1 px over ±2 px: the tensor's own smoothing, beside the level's.
constexpr std::array<double, 5> kWindow = {0.135335, 0.606531, 1, 0.606531, 0.135335};

struct Direction {
  Point unit;             // along the gradient
  double confidence = 0;  // 0…1
};

Direction direction_at(const ScaleLevel& level, int x, int y, double flat) {
  const int width = level.smooth.cols - 2, height = level.smooth.rows - 2;
  const auto gradient = [&](int u, int v) {
    return level.gradient(std::clamp(u, 0, width - 1), std::clamp(v, 0, height - 1));
  };
  double xx = 0, xy = 0, yy = 0, total = 0;
  for (int dy = -2; dy <= 2; ++dy)
    for (int dx = -2; dx <= 2; ++dx) {
      const double w = kWindow[static_cast<std::size_t>(dx + 2)] * kWindow[static_cast<std::size_t>(dy + 2)];
      const Point g = gradient(x + dx, y + dy);
      xx += w * g.x * g.x;
      xy += w * g.x * g.y;
      yy += w * g.y * g.y;
      total += w;
    }
  const double apart = std::hypot(xx - yy, 2 * xy) / total;  // λ₁ − λ₂
  const double angle = 0.5 * std::atan2(2 * xy, xx - yy);
  Direction d{{std::cos(angle), std::sin(angle)}, 1 - std::exp(-0.5 * std::pow(apart / (flat * flat), 2))};
  const double along = graph::dot(d.unit, gradient(x, y));
  if (along < 0) d.unit = d.unit * -1;
  if (along == 0) d.unit = {};
  return d;
}

}  // namespace

double creaseness(const ScaleLevel& level, Point p, double flat) {
  const int x = static_cast<int>(std::lround(p.x)), y = static_cast<int>(std::lround(p.y));
  const Direction right = direction_at(level, x + 1, y, flat), left = direction_at(level, x - 1, y, flat),
                  below = direction_at(level, x, y + 1, flat), above = direction_at(level, x, y - 1, flat);
  const double divergence = 0.5 * ((right.unit.x - left.unit.x) + (below.unit.y - above.unit.y));
  const double confidence =
      0.25 * ((right.confidence + left.confidence) + (below.confidence + above.confidence));
  return -divergence * confidence;
}

}  // namespace emberfold::sketch
