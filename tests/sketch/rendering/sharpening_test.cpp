// SPDX-License-Identifier: Apache-2.0
#include "sketch/rendering/sharpening.hpp"

#include <cmath>
#include <numbers>
#include <vector>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "sketch/rendering/render.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/clip_fixture.hpp"
#include "tests/support/drawn_models.hpp"

using namespace emberfold;
using namespace emberfold::test;

namespace {

const cv::Size kSharpeningSize(96, 64);

graph::AttributeGraph wavy(double blur) {
  const auto shape = made_shape(14, 0.4, 60, {48, 32});
  std::vector<graph::Vertex> vertices(shape.vertices().begin(), shape.vertices().end());
  for (auto& vertex : vertices) vertex.patch.blur = blur;
  return {std::move(vertices), {shape.edges().begin(), shape.edges().end()}};
}

core::Clip clip_of(const graph::AttributeGraph& graph, int frames) {
  core::Clip clip{{kSharpeningSize.width, kSharpeningSize.height, 1, CV_8U, 25, 255, frames}, {}};
  const auto drawn = sketch::draw_fitted(graph, kSharpeningSize, 1);
  cv::Mat frame(kSharpeningSize, CV_32F, cv::Scalar(68));
  drawn.levels.copyTo(frame, drawn.mask);
  for (int t = 0; t < frames; ++t) clip.frames.push_back(core::to_bytes(frame));
  return clip;
}

}  // namespace

TEST_CASE("the flank gradient of a step is that on the step, whatever its direction") {
  for (const double theta : {0.0, 0.5, 2.0, -1.3}) {
    cv::Mat frame(kSharpeningSize, CV_32F);
    const double s = std::sin(theta), c = std::cos(theta);
    for (int y = 0; y < frame.rows; ++y)
      for (int x = 0; x < frame.cols; ++x)
        frame.at<float>(y, x) = static_cast<float>(
            100 + 50 * std::erf((-(x - 48) * s + (y - 32) * c) / (2.5 * std::numbers::sqrt2)));
    graph::Patch patch;
    patch.type = graph::PatchType::step;
    patch.position = {48, 32}, patch.theta = theta, patch.width = 0, patch.blur = 2.5, patch.contrast = 100;
    const auto found = sketch::measure_flank_gradient(frame, {{{{0}, {}, patch}}, {}});
    CHECK(found.places == 2);
    // 100 levels blurred by 2.5 px, and by Sobel's own half a pixel or so.
    const double peak = 100 / (2.5 * std::sqrt(2 * std::numbers::pi));
    CHECK_THAT(found.mean(), WithinAbs(peak, 0.12 * peak));
    patch.position = {2, 2};
    CHECK(sketch::measure_flank_gradient(frame, {{{{0}, {}, patch}}, {}}).places == 0);
  }
}

TEST_CASE("the flank gradient of a line is the mean of both flanks") {
  cv::Mat frame(kSharpeningSize, CV_32F);
  for (int y = 0; y < frame.rows; ++y) frame.row(y).setTo(y < 32 ? 100 : 100 + 10 * (y - 32));
  graph::Patch patch;
  patch.position = {48, 32}, patch.theta = 0, patch.width = 8, patch.blur = 1, patch.contrast = 40;
  const auto found = sketch::measure_flank_gradient(frame, {{{{0}, {}, patch}}, {}});
  CHECK(found.places == 2);
  CHECK_THAT(found.mean(), WithinAbs(5, 1e-3));  // none above, 10 below
}

TEST_CASE("a blurred picture's flanks are less steep") {
  const auto graph = wavy(1);
  cv::Mat frame, blurred;
  clip_of(graph, 1).frames[0].convertTo(frame, CV_32F);
  cv::GaussianBlur(frame, blurred, {}, 1.5);
  CHECK(sketch::measure_flank_gradient(blurred, graph).mean() <
        0.75 * sketch::measure_flank_gradient(frame, graph).mean());
}

TEST_CASE("the sharpening is found that patches need, less blur before more contrast") {
  const std::vector<sketch::FrameContent> parts(3, sketch::FrameContent{wavy(1.6)});
  const sketch::RenderOptions look{.size = kSharpeningSize, .channels = 1, .empty_level = 68};
  const auto gradient = [&](const sketch::Sharpening& sharpening) {
    cv::Mat levels;
    sketch::render_frame(parts[0], sketch::apply_sharpening(look, sharpening)).convertTo(levels, CV_32F);
    return sketch::measure_flank_gradient(levels, parts[0].graph).mean();
  };
  for (const double share : {0.5, 0.7, 0.9}) {
    const auto found = sketch::fit_sharpening(parts, look, gradient({share, 1}));
    CHECK_THAT(found.blur_share, WithinAbs(share, 0.06));
    CHECK(found.contrast_gain == 1);
  }
  const auto more = sketch::fit_sharpening(parts, look, gradient({0.25, 1.3}));
  CHECK(more.blur_share == 0.25);
  CHECK_THAT(more.contrast_gain, WithinAbs(1.3, 0.04));
  const auto enough = sketch::fit_sharpening(parts, look, 0.9 * gradient({}));
  CHECK(enough.blur_share == 1);
  CHECK(enough.contrast_gain == 1);
  CHECK(sketch::fit_sharpening(std::vector<sketch::FrameContent>(2), look, 10).blur_share == 1);
}

TEST_CASE("a clip's flank gradient is that of some of its frames") {
  const auto clip = clip_of(wavy(1.6), 9);
  core::ClipSource source(clip);
  graph::SketchSequence sketch;
  for (int t = 0; t < 9; ++t) sketch.append(wavy(1.6));
  cv::Mat levels;
  clip.frames[0].convertTo(levels, CV_32F);
  CHECK_THAT(sketch::measure_clip_flank_gradient(source, sketch).mean(),
             WithinAbs(sketch::measure_flank_gradient(levels, wavy(1.6)).mean(), 1e-9));
}
