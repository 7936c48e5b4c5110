// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <utility>
#include <vector>

#include "sketch/detection/creases.hpp"

namespace emberfold::sketch {

/// Builds the map of one kind of crease: of the points found in a pixel the strongest stays. Their theta
/// comes last, as most give way to others.
class CreaseMapBuilder {
 public:
  CreaseMapBuilder(const ScaleSpace& space, CreaseKind kind) {
    constexpr std::size_t kUsualShare = 8;  // of all pixels, one in so many has a point of a kind, or fewer
    const cv::Mat1f& smooth = space.front().smooth;
    map_ = {kind, {}, make_empty_index({smooth.cols - 2, smooth.rows - 2})};
    map_.points.reserve(map_.index.total() / kUsualShare);
    normals_.reserve(map_.points.capacity());
  }

  [[nodiscard]] cv::Size size() const { return map_.index.size(); }

  /// Returns whether a point of this strength would be kept.
  [[nodiscard]] bool beats(int x, int y, double strength) const {
    const int slot = map_.index(y, x);
    return slot < 0 || strength > map_.points[static_cast<std::size_t>(slot)].strength;
  }

  void put(int x, int y, const CreasePoint& point, graph::Point normal) {
    int& slot = map_.index(y, x);
    if (slot < 0) {
      slot = static_cast<int>(map_.points.size());
      map_.points.push_back(point);
      normals_.push_back(normal);
    } else if (const auto i = static_cast<std::size_t>(slot); point.strength > map_.points[i].strength) {
      map_.points[i] = point;
      normals_[i] = normal;
    }
  }

  CreaseMap finish() {
    for (std::size_t i = 0; i < normals_.size(); ++i)
      map_.points[i].theta = std::atan2(-normals_[i].x, normals_[i].y);
    return std::move(map_);
  }

 private:
  CreaseMap map_;
  std::vector<graph::Point> normals_;  // of the map's points
};

/// Returns whether a place lies in the frame. The frame is mirrored at its border, which makes a line there
/// of any slope: a line must show both its sides.
inline bool lies_inside(cv::Size frame, graph::Point p) {
  return p.x >= 0 && p.y >= 0 && p.x <= frame.width - 1 && p.y <= frame.height - 1;
}

/// Largest distance of the subpixel place from the pixel's centre (Steger: 0.5; a margin keeps lines
/// connected).
inline constexpr double kPixelReach = 0.6;

/// Returns the contrast of a Gaussian line that responds best at this scale, for a second derivative of 1. A
/// line of SD s and height h responds with h·s / (s² + σ²)^{3/2}; the normalised response σ^{3/2}·λ is
/// greatest at σ = s, where h = 2^{3/2} σ² λ.
inline double line_contrast(double sigma) {
  return 2.8284271247461903 * sigma * sigma;
}

/// Returns the height of a step that is blurred by σ and has the gradient 1 seen at scale σ.
inline double step_contrast(double sigma) {
  return 3.5449077018110318 * sigma;  // √(2π)·√2
}

/// SD that a response reaches in some direction where there is nothing.
inline constexpr double kUsualResponse = 2.4;

/// Returns the nats by which a response of z SD speaks for a crease. The tails of texture's responses fall
/// off exponentially; points within the length over which a Gaussian of SD `smoothed` px averages along the
/// crease speak together.
inline double point_evidence(double z, double smoothed) {
  constexpr double kSqrtPi = 1.7724538509055159;
  return std::numbers::sqrt2 / (2 * kSqrtPi * smoothed) * std::max(0.0, z - kUsualResponse);
}

}  // namespace emberfold::sketch
