// SPDX-License-Identifier: Apache-2.0
#include "dytex/surface/polygon.hpp"

#include <numeric>

namespace emberfold::dytex::detail {

namespace {

double turn(const cv::Point2d& a, const cv::Point2d& b, const cv::Point2d& c) {
  return (b - a).cross(c - a);
}

double twice_area(std::span<const cv::Point2d> corners) {
  double sum = 0;
  for (std::size_t i = 1; i + 1 < corners.size(); ++i) sum += turn(corners[0], corners[i], corners[i + 1]);
  return sum;
}

// Returns whether the remaining corner at `i` can be cut off: it turns outward, and contains no other.
bool is_ear(std::span<const cv::Point2d> corners, const std::vector<std::size_t>& left, std::size_t i,
            double side) {
  const std::size_t n = left.size();
  const auto &a = corners[left[(i + n - 1) % n]], &b = corners[left[i]], &c = corners[left[(i + 1) % n]];
  if (side * turn(a, b, c) <= 0) return false;
  for (const std::size_t other : left) {
    const auto& p = corners[other];
    if (p == a || p == b || p == c) continue;
    if (side * turn(a, b, p) >= 0 && side * turn(b, c, p) >= 0 && side * turn(c, a, p) >= 0) return false;
  }
  return true;
}

}  // namespace

std::vector<std::array<std::size_t, 3>> cut_polygon(std::span<const cv::Point2d> corners) {
  std::vector<std::array<std::size_t, 3>> triangles;
  std::vector<std::size_t> left(corners.size());
  std::iota(left.begin(), left.end(), std::size_t{0});
  const double side = twice_area(corners) < 0 ? -1 : 1;
  for (std::size_t n = left.size(); n > 3; --n) {
    std::size_t ear = 1;
    for (std::size_t i = 0; i < n; ++i)
      if (is_ear(corners, left, (1 + i) % n, side)) {
        ear = (1 + i) % n;
        break;
      }
    triangles.push_back({left[(ear + n - 1) % n], left[ear], left[(ear + 1) % n]});
    left.erase(left.begin() + static_cast<std::ptrdiff_t>(ear));
  }
  triangles.push_back({left[0], left[1], left[2]});
  return triangles;
}

}  // namespace emberfold::dytex::detail
