// SPDX-License-Identifier: Apache-2.0
#include "sketch/rendering/morph_frames.hpp"

#include <vector>

#include <opencv2/core.hpp>

#include "core/clip.hpp"
#include "core/error.hpp"
#include "sketch/inpainting/fill.hpp"
#include "sketch/rendering/render.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/graphs.hpp"

using namespace emberfold;

namespace {

graph::AttributeGraph lit_line(graph::Point a, graph::Point b, float level) {
  test::Frame frame;
  frame.line(test::segment(a, b, 7));
  for (auto& v : frame.vertices) {
    v.patch.left.fill(level), v.patch.right.fill(level), v.patch.middle.fill(level + 40);
  }
  return frame.graph();
}

std::vector<cv::Mat> draw(const graph::Morph& morph, const sketch::MorphLook& look) {
  std::vector<cv::Mat> frames;
  sketch::draw_morph(morph, look, [&](const cv::Mat& frame) { frames.push_back(frame.clone()); });
  return frames;
}

cv::Mat drawn_alone(const graph::AttributeGraph& graph) {
  const auto part = sketch::draw_fitted(graph, {80, 60}, 1);
  return core::to_bytes(sketch::fill(part.levels, part.mask).levels);
}

}  // namespace

TEST_CASE("a morph is drawn from one sketch to the other, flat regions with it") {
  const auto a = lit_line({20, 20}, {50, 20}, 60), b = lit_line({30, 30}, {30, 55}, 180);
  const auto morph = graph::morph(a, b, 80, 60, 25, {.frames = 9});
  REQUIRE(morph.moved == 1);
  const auto frames = draw(morph, {.channels = 1});
  REQUIRE(frames.size() == 9);
  CHECK(cv::norm(frames.front(), drawn_alone(a), cv::NORM_INF) == 0);
  CHECK(cv::norm(frames.back(), drawn_alone(b), cv::NORM_INF) == 0);
  for (int t = 0; t < 9; ++t)  // far from both lines, whose tips shine a little
    CHECK(static_cast<double>(frames[static_cast<std::size_t>(t)].at<unsigned char>(58, 78)) ==
          Approx(60 + 15 * t).margin(8));
}

TEST_CASE("strokes that have no partner fade into what is around them") {
  const auto a = lit_line({20, 20}, {50, 20}, 100);
  const auto morph = graph::morph(a, {}, 80, 60, 25, {.frames = 9});
  const auto frames = draw(morph, {.channels = 1, .level_from = 100, .level_to = 40});
  int before = 255;
  for (int t = 0; t < 5; ++t) {
    const int now = frames[static_cast<std::size_t>(t)].at<unsigned char>(20, 35);
    CHECK(now < before);
    before = now;
  }
  CHECK(cv::norm(frames.back(), cv::Mat(60, 80, CV_8U, cv::Scalar(40)), cv::NORM_INF) == 0);
}

TEST_CASE("a morph is drawn in one or three channels") {
  const auto morph = graph::morph({}, {}, 8, 8, 25, {.frames = 3});
  CHECK(draw(morph, {.channels = 3}).front().type() == CV_8UC3);
  CHECK_THROWS_AS(draw(morph, {.channels = 2}), core::InputError);
}
