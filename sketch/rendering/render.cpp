// SPDX-License-Identifier: Apache-2.0
#include "sketch/rendering/render.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <span>
#include <string>

#include <opencv2/core.hpp>

#include "core/error.hpp"
#include "sketch/rendering/curve_bands.hpp"
#include "sketch/rendering/patch_colour.hpp"

namespace emberfold::sketch {

namespace {

using detail::colour, detail::Colour;

/// Profile of a band at one place of its curve; sides as seen along the curve.
struct Profile {
  Colour left{}, middle{}, right{};
  ProfileShape shape;
};

Profile profile(const graph::Patch& patch, bool backwards, int channels) {
  Profile p;
  p.left = colour(backwards ? patch.right : patch.left, channels);
  p.middle = colour(patch.middle, channels);
  p.right = colour(backwards ? patch.left : patch.right, channels);
  p.shape = ProfileShape(patch);
  return p;
}

ProfileShape shape_between(const ProfileShape& a, const ProfileShape& b, double s) {
  ProfileShape shape;
  shape.half_width = interpolate(a.half_width, b.half_width, s);
  shape.blur = interpolate(a.blur, b.blur, s);
  return shape;
}

void add(const Profile& a, const Profile& b, const Projection& at, double weight, int channels, float* sum) {
  const ProfileShape::Reached reached = shape_between(a.shape, b.shape, at.s).at(at.distance);
  for (std::size_t c = 0; c < static_cast<std::size_t>(channels); ++c) {
    const auto mixed = [&](const Colour Profile::*level) {
      return interpolate((a.*level)[c], (b.*level)[c], at.s);
    };
    sum[c] += static_cast<float>(
        weight * reached.level(mixed(&Profile::left), mixed(&Profile::middle), mixed(&Profile::right)));
  }
}

void add(const graph::Patch& blob, const BlobShape& shape, int x, int y, double weight, int channels,
         float* sum) {
  const BlobShape::Shares shares = shape.at(x - blob.position.x, y - blob.position.y);
  const Colour left = colour(blob.left, channels), middle = colour(blob.middle, channels),
               right = colour(blob.right, channels);
  for (std::size_t c = 0; c < static_cast<std::size_t>(channels); ++c)
    sum[c] += static_cast<float>(
        weight * (shares.left * left[c] + shares.middle * middle[c] + shares.right * right[c]));
}

using PatchValues = std::span<const std::array<float, 2>>;

void add(const std::array<float, 2>& a, const std::array<float, 2>& b, double s, double weight, float* sum) {
  for (std::size_t i = 0; i < 2; ++i)
    sum[i] += static_cast<float>(weight * interpolate(double{a[i]}, double{b[i]}, s));
}

void divide(cv::Mat& sums, const cv::Mat& weights) {
  const int channels = sums.channels();
  for (int y = 0; y < sums.rows; ++y) {
    float* sum = sums.ptr<float>(y);
    const float* weight = weights.ptr<float>(y);
    for (int x = 0; x < sums.cols; ++x)
      if (weight[x] > 0)
        for (int c = 0; c < channels; ++c) sum[x * channels + c] /= weight[x];
  }
}

/// Draws the patches; interpolates no values where none are given.
AttributedSketch draw(const graph::AttributeGraph& graph, cv::Size size, int channels, PatchValues values) {
  check_frame(size, channels);
  AttributedSketch result{
      {cv::Mat(size, CV_32FC(channels), cv::Scalar::all(0)), cv::Mat(size, CV_8U, cv::Scalar(0))},
      values.empty() ? cv::Mat{} : cv::Mat(size, CV_32FC2, cv::Scalar::all(0))};
  cv::Mat &levels = result.part.levels, weights(size, CV_32F, cv::Scalar(0));
  for (const Band& band : make_bands(graph)) {
    const Profile a = profile(graph.patch(band.a.vertex), band.a.backwards, channels);
    const Profile b = profile(graph.patch(band.b.vertex), band.b.backwards, channels);
    visit_band(band, size, [&](int x, int y, const Projection& at) {
      const double w = band_weight(band, at);
      add(a, b, at, w, channels, levels.ptr<float>(y) + x * channels);
      if (!values.empty())
        add(values[band.a.vertex], values[band.b.vertex], at.s, w, result.values.ptr<float>(y) + 2 * x);
      weights.at<float>(y, x) += static_cast<float>(w);
      result.part.mask.at<std::uint8_t>(y, x) = 255;
    });
  }
  visit_blobs(graph, size, [&](std::size_t i, const BlobShape& shape, int x, int y) {
    const graph::Patch& blob = graph.patch(i);
    const double w = blob_weight(shape, x - blob.position.x, y - blob.position.y);
    add(blob, shape, x, y, w, channels, levels.ptr<float>(y) + x * channels);
    if (!values.empty()) add(values[i], values[i], 0, w, result.values.ptr<float>(y) + 2 * x);
    weights.at<float>(y, x) += static_cast<float>(w);
    result.part.mask.at<std::uint8_t>(y, x) = 255;
  });
  divide(levels, weights);
  if (!values.empty()) divide(result.values, weights);
  result.part = hold_anchors(result.part, graph);
  if (!values.empty())
    visit_anchors(graph, size, [&](std::size_t i, int x, int y) {
      result.values.at<cv::Vec2f>(y, x) = {values[i][0], values[i][1]};
    });
  return result;
}

}  // namespace

double Sketchable::share() const {
  return mask.empty() ? 0 : static_cast<double>(cv::countNonZero(mask)) / static_cast<double>(mask.total());
}

AttributedSketch draw_fitted(const graph::AttributeGraph& graph, cv::Size size, int channels,
                             std::span<const std::array<float, 2>> values) {
  if (values.size() != graph.size())
    throw core::InputError("render: " + std::to_string(values.size()) + " numbers are told of " +
                           std::to_string(graph.size()) + " patches");
  return draw(graph, size, channels, values);
}

Sketchable draw_fitted(const graph::AttributeGraph& graph, cv::Size size, int channels) {
  return draw(graph, size, channels, {}).part;
}

Sketchable draw_pixels(const graph::AttributeGraph& graph, const cv::Mat& levels) {
  check_frame(levels.size(), levels.channels());
  if (levels.depth() != CV_32F)
    throw core::InputError("render: levels are " + cv::typeToString(levels.type()) +
                           "; allowed are CV_32FC1 and CV_32FC3");
  Sketchable result{cv::Mat(levels.size(), levels.type(), cv::Scalar::all(0)),
                    cv::Mat(levels.size(), CV_8U, cv::Scalar(0))};
  for (const Band& band : make_bands(graph))
    visit_band(band, levels.size(),
               [&](int x, int y, const Projection&) { result.mask.at<std::uint8_t>(y, x) = 255; });
  visit_blobs(graph, levels.size(),
              [&](std::size_t, const BlobShape&, int x, int y) { result.mask.at<std::uint8_t>(y, x) = 255; });
  levels.copyTo(result.levels, result.mask);
  return hold_anchors(result, graph);
}

Sketchable hold_anchors(const Sketchable& drawn, const graph::AttributeGraph& graph) {
  if (std::ranges::none_of(graph.vertices(), graph::is_anchor, &graph::Vertex::patch)) return drawn;
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
