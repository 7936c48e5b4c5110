// SPDX-License-Identifier: Apache-2.0
#include "sketch/rendering/render.hpp"

#include <algorithm>
#include <span>
#include <string>

#include <opencv2/core.hpp>

#include "core/error.hpp"
#include "sketch/rendering/curve_bands.hpp"
#include "sketch/rendering/draw_patches.hpp"
#include "sketch/rendering/patch_colour.hpp"

namespace emberfold::sketch {

namespace {

using detail::colour, detail::Colour;

bool holds_anchors(const graph::AttributeGraph& graph) {
  return std::ranges::any_of(graph.vertices(), graph::is_anchor, &graph::Vertex::patch);
}

/// Draws the patches; interpolates no values where none are given.
AttributedSketch draw(const graph::AttributeGraph& graph, cv::Size size, int channels, PatchValues values,
                      bool cores) {
  check_frame(size, channels);
  AttributedSketch result{
      {cv::Mat(size, CV_32FC(channels), cv::Scalar::all(0)), cv::Mat(size, CV_8U, cv::Scalar(0))},
      values.empty() ? cv::Mat{} : cv::Mat(size, CV_32F, cv::Scalar(0))};
  cv::Mat weights(size, CV_32F, cv::Scalar(0));
  draw_patches(graph, values,
               {size, channels, result.part.levels.ptr<float>(), weights.ptr<float>(), result.part.mask.ptr(),
                values.empty() ? nullptr : result.values.ptr<float>(), cores});
  result.part = hold_anchors(result.part, graph);
  if (!values.empty())
    visit_anchors(graph, size,
                  [&](std::size_t i, int x, int y) { result.values.at<float>(y, x) = values[i]; });
  return result;
}

}  // namespace

double Sketchable::share() const {
  return mask.empty() ? 0 : static_cast<double>(cv::countNonZero(mask)) / static_cast<double>(mask.total());
}

AttributedSketch draw_fitted(const graph::AttributeGraph& graph, cv::Size size, int channels,
                             std::span<const float> values) {
  if (values.size() != graph.size())
    throw core::InputError("render: " + std::to_string(values.size()) + " numbers are told of " +
                           std::to_string(graph.size()) + " patches");
  return draw(graph, size, channels, values, holds_anchors(graph));
}

Sketchable draw_fitted(const graph::AttributeGraph& graph, cv::Size size, int channels) {
  return draw(graph, size, channels, {}, holds_anchors(graph)).part;
}

Sketchable draw_cores(const graph::AttributeGraph& graph, cv::Size size, int channels) {
  return draw(graph, size, channels, {}, true).part;
}

Sketchable draw_pixels(const graph::AttributeGraph& graph, const cv::Mat& levels) {
  check_frame(levels.size(), levels.channels());
  if (levels.depth() != CV_32F)
    throw core::InputError("render: levels are " + cv::typeToString(levels.type()) +
                           "; allowed are CV_32FC1 and CV_32FC3");
  Sketchable result{cv::Mat(levels.size(), levels.type(), cv::Scalar::all(0)),
                    cv::Mat(levels.size(), CV_8U, cv::Scalar(0))};
  for (const Band& band : make_bands(graph, holds_anchors(graph)))
    visit_band(band, levels.size(),
               [&](int x, int y, const Projection&) { result.mask.at<std::uint8_t>(y, x) = 255; });
  levels.copyTo(result.levels, result.mask);
  return hold_anchors(result, graph);
}

Sketchable hold_anchors(const Sketchable& drawn, const graph::AttributeGraph& graph) {
  if (!holds_anchors(graph)) return drawn;
  Sketchable held{drawn.levels.clone(), drawn.mask.clone()};
  const int channels = held.levels.channels();
  visit_anchors(graph, held.levels.size(), [&](std::size_t i, int x, int y) {
    const Colour level = colour(graph.patch(i).middle, channels);
    for (int c = 0; c < channels; ++c)
      held.levels.ptr<float>(y)[x * channels + c] = static_cast<float>(level[static_cast<std::size_t>(c)]);
    held.mask.at<std::uint8_t>(y, x) = 255;
  });
  return held;
}

}  // namespace emberfold::sketch
