// SPDX-License-Identifier: Apache-2.0
#include "pipeline/strokes/stroke_strips.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>

#include <opencv2/imgproc.hpp>

namespace emberfold::pipeline {

namespace {

constexpr float kOwnCore = 3;    // px from a curve: no gap is opened there
constexpr int kFraction = 4;     // bits of a pixel's fraction in coordinates of drawn lines
constexpr float kFarAway = 1e6;  // px

cv::Point fixed_point(graph::Point p, cv::Point origin) {
  constexpr double kScale = 1 << kFraction;
  return {static_cast<int>(std::lround((p.x - origin.x) * kScale)),
          static_cast<int>(std::lround((p.y - origin.y) * kScale))};
}

/// Distances of pixels to the curves of a stroke.
struct CurveDistance {
  cv::Rect area;  // of the frame
  cv::Mat1f distance;
};

CurveDistance curve_distance(const graph::AttributeGraph& graph, const std::vector<std::uint32_t>& patches,
                             graph::Point offset, double reach, cv::Size frame) {
  cv::Rect2d box;
  for (const auto v : patches) {
    const auto p = graph.patch(v).position + offset;
    const cv::Rect2d one(p.x - reach, p.y - reach, 2 * reach, 2 * reach);
    box = box.empty() ? one : box | one;
  }
  const int pad = 2;  // px of curves outside of the frame that are near it
  const cv::Rect whole =
      cv::Rect(cv::Point(static_cast<int>(std::floor(box.x)), static_cast<int>(std::floor(box.y))),
               cv::Point(static_cast<int>(std::ceil(box.br().x)) + 1,
                         static_cast<int>(std::ceil(box.br().y)) + 1)) &
      cv::Rect(-pad, -pad, frame.width + 2 * pad, frame.height + 2 * pad);
  CurveDistance result;
  result.area = whole & cv::Rect({}, frame);
  if (result.area.empty()) return result;
  cv::Mat1b curves(whole.size(), 255);
  for (const auto v : patches) {
    const auto a = graph.patch(v).position + offset;
    cv::line(curves, fixed_point(a, whole.tl()), fixed_point(a, whole.tl()), 0, 1, cv::LINE_8, kFraction);
    for (const auto w : graph.neighbours(v))
      if (v < w && std::ranges::binary_search(patches, w))
        cv::line(curves, fixed_point(a, whole.tl()),
                 fixed_point(graph.patch(w).position + offset, whole.tl()), 0, 1, cv::LINE_8, kFraction);
  }
  cv::Mat1f distance;
  cv::distanceTransform(curves, distance, cv::DIST_L2, 5, CV_32F);
  result.distance = distance(result.area - whole.tl());
  return result;
}

/// Opens the pixels that are next to those of another source, except near their own curve.
void open_gaps(const cv::Mat1i& source, const cv::Mat1f& nearest, cv::Mat1b& mask) {
  cv::Mat1b border(source.size(), std::uint8_t{0});
  const auto differ = [&](cv::Point a, cv::Point b) {
    if (source(a) != source(b)) border(a) = border(b) = 255;
  };
  for (int y = 0; y < source.rows; ++y)
    for (int x = 0; x < source.cols; ++x) {
      if (source(y, x) == 0) continue;
      if (x + 1 < source.cols && source(y, x + 1) != 0) differ({x, y}, {x + 1, y});
      if (y + 1 < source.rows && source(y + 1, x) != 0) differ({x, y}, {x, y + 1});
    }
  cv::dilate(border, border, cv::Mat());
  for (int y = 0; y < source.rows; ++y)
    for (int x = 0; x < source.cols; ++x)
      if (border(y, x) != 0 && nearest(y, x) > kOwnCore) mask(y, x) = 0;
}

}  // namespace

StrokeStrips draw_strips(const SeenClip& clip, const StrokeFamilies& families, const StrokeMoment& moment,
                         const cv::Mat& head) {
  const cv::Size frame = head.size();
  StrokeStrips strips{cv::Mat(frame, head.type(), cv::Scalar::all(0)), cv::Mat1b(frame, std::uint8_t{0})};
  cv::Mat1f nearest(frame, kFarAway);
  cv::Mat1i source(frame, 0);
  std::map<std::tuple<int, int, int>, int> sources;
  for (const auto& stroke : moment.strokes) {
    const auto& life = families.lives[stroke.family];
    const double reach = kStripReach * stroke.share;
    const auto [area, distance] = curve_distance(
        clip.graph(stroke.frame), life.patches[static_cast<std::size_t>(stroke.frame - life.first)],
        stroke.offset, reach, frame);
    const cv::Point offset(static_cast<int>(stroke.offset.x), static_cast<int>(stroke.offset.y));
    const bool lasts = stroke.frame == shown_frame(moment.shown) && offset == cv::Point();
    const cv::Mat& pixels = lasts ? head : clip.frame(stroke.frame);
    const int number =
        sources.try_emplace({stroke.frame, offset.x, offset.y}, static_cast<int>(sources.size()) + 1)
            .first->second;
    const auto bytes = static_cast<std::size_t>(pixels.channels());
    for (int y = 0; y < area.height; ++y)
      for (int x = 0; x < area.width; ++x) {
        const cv::Point at = area.tl() + cv::Point(x, y);
        const float d = distance(y, x);
        if (d > reach || d >= nearest(at)) continue;
        const cv::Point from(std::clamp(at.x - offset.x, 0, frame.width - 1),
                             std::clamp(at.y - offset.y, 0, frame.height - 1));
        nearest(at) = d, source(at) = number, strips.mask(at) = 255;
        std::copy_n(pixels.ptr(from.y) + static_cast<std::size_t>(from.x) * bytes, bytes,
                    strips.levels.ptr(at.y) + static_cast<std::size_t>(at.x) * bytes);
      }
  }
  open_gaps(source, nearest, strips.mask);
  return strips;
}

}  // namespace emberfold::pipeline
