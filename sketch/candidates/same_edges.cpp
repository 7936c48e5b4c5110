// SPDX-License-Identifier: Apache-2.0
#include "sketch/candidates/same_edges.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <utility>

#include <opencv2/imgproc.hpp>

namespace emberfold::sketch {

std::vector<Chain> without_same_edges(std::vector<Chain> curves, const ScaleSpace& space,
                                      const std::vector<Chain>& others, cv::Size size) {
  if (others.empty()) return curves;
  constexpr double kSame = 3, kSameScale = 1.5;  // px, SD of the smoothing
  constexpr std::ptrdiff_t kFewest = 5;          // points
  const auto pixel_of = [&](const CreasePoint& p) {
    return cv::Point(std::clamp(cvRound(p.position.x), 0, size.width - 1),
                     std::clamp(cvRound(p.position.y), 0, size.height - 1));
  };
  cv::Mat1b free(size, std::uint8_t{255});
  for (const Chain& chain : others)
    for (const CreasePoint& p : chain.points) free(pixel_of(p)) = 0;
  cv::Mat1f away;
  cv::distanceTransform(free, away, cv::DIST_L2, cv::DIST_MASK_PRECISE);
  std::vector<Chain> left;
  for (Chain& chain : curves) {
    const double least = std::max(kSame, kSameScale * space[median_level(chain.points, space)].sigma);
    const auto is_near = [&](const CreasePoint& p) { return double{away(pixel_of(p))} <= least; };
    if (std::ranges::none_of(chain.points, is_near)) {
      left.push_back(std::move(chain));
      continue;
    }
    const auto end = chain.points.end();
    for (auto first = std::find_if_not(chain.points.begin(), end, is_near); first != end;) {
      const auto last = std::find_if(first, end, is_near);
      if (last - first >= kFewest) left.push_back({chain.kind, {first, last}, false, {0, 0}});
      first = std::find_if_not(last, end, is_near);
    }
  }
  return left;
}

}  // namespace emberfold::sketch
