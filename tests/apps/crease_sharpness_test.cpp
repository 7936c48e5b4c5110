// SPDX-License-Identifier: Apache-2.0
#include "apps/crease_sharpness.hpp"

#include <cmath>
#include <numbers>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "sketch/render.hpp"
#include "tests/apps/clip_fixture.hpp"
#include "tests/apps/made_model.hpp"
#include "tests/catch.hpp"

using namespace emberfold;
using namespace emberfold::apps;
using namespace emberfold::tests;
using Catch::Matchers::WithinAbs;

namespace {

constexpr cv::Size kSize(96, 64);

graph::AttributeGraph wavy(double blur) {
  const auto shape = made_shape(14, 0.4, 60, {48, 32});
  std::vector<graph::Vertex> vertices(shape.vertices().begin(), shape.vertices().end());
  for (auto& vertex : vertices) vertex.patch.blur = blur;
  return {std::move(vertices), {shape.edges().begin(), shape.edges().end()}};
}

core::Clip clip_of(const graph::AttributeGraph& graph, int frames) {
  core::Clip clip{{kSize.width, kSize.height, 1, CV_8U, 25, 255, frames}, {}};
  const auto drawn = sketch::draw_fitted(graph, kSize, 1);
  cv::Mat frame(kSize, CV_32F, cv::Scalar(68));
  drawn.levels.copyTo(frame, drawn.mask);
  for (int t = 0; t < frames; ++t) clip.frames.push_back(core::to_bytes(frame));
  return clip;
}

}  // namespace

TEST_CASE("the sharpness of a step's crease is its gradient, whatever its direction") {
  for (const double theta : {0.0, 0.5, 2.0, -1.3}) {
    cv::Mat frame(kSize, CV_32F);
    const double s = std::sin(theta), c = std::cos(theta);
    for (int y = 0; y < frame.rows; ++y)
      for (int x = 0; x < frame.cols; ++x)
        frame.at<float>(y, x) = static_cast<float>(
            100 + 50 * std::erf((-(x - 48) * s + (y - 32) * c) / (2.5 * std::numbers::sqrt2)));
    graph::Patch patch;
    patch.type = graph::PatchType::step;
    patch.position = {48, 32}, patch.theta = theta, patch.width = 0, patch.blur = 2.5, patch.contrast = 100;
    const auto found = crease_sharpness(frame, {{{{0}, {}, patch}}, {}});
    CHECK(found.places == 2);
    // 100 levels blurred by 2.5 px, and by Sobel's own half a pixel or so.
    const double peak = 100 / (2.5 * std::sqrt(2 * std::numbers::pi));
    CHECK_THAT(found.mean(), WithinAbs(peak, 0.12 * peak));
    patch.position = {2, 2};
    CHECK(crease_sharpness(frame, {{{{0}, {}, patch}}, {}}).places == 0);
  }
}

TEST_CASE("a blurred picture's creases are less sharp") {
  const auto graph = wavy(1);
  cv::Mat frame, blurred;
  clip_of(graph, 1).frames[0].convertTo(frame, CV_32F);
  cv::GaussianBlur(frame, blurred, {}, 1.5);
  CHECK(crease_sharpness(blurred, graph).mean() < 0.75 * crease_sharpness(frame, graph).mean());
}

TEST_CASE("the share of blur is found that patches were blurred too much by, and 1 where they were not") {
  for (const double share : {0.5, 0.7, 0.9}) {
    const auto clip = clip_of(wavy(1.6 * share), 9);
    core::ClipSource source(clip);
    graph::SketchSequence sketch;
    for (int t = 0; t < 9; ++t) sketch.append(wavy(1.6));
    CHECK_THAT(fit_blur_share(source, sketch), WithinAbs(share, 0.06));
  }
  const auto clip = clip_of(wavy(2.5), 9);
  core::ClipSource source(clip);
  graph::SketchSequence sketch, empty;
  for (int t = 0; t < 9; ++t) sketch.append(wavy(1.6)), empty.append({});
  CHECK(fit_blur_share(source, sketch) == 1);
  CHECK(fit_blur_share(source, empty) == 1);
}
