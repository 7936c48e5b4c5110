// SPDX-License-Identifier: Apache-2.0
#include <vector>

#include <opencv2/core.hpp>

#include "apps/draw_graph_frames.hpp"
#include "apps/interrupt.hpp"
#include "tests/apps/clip_fixture.hpp"
#include "tests/catch.hpp"

using namespace emberfold;
using namespace emberfold::apps;
using namespace emberfold::tests;

namespace {

// A bright upright bar on dark ground.
graph::AttributeGraph bar(double x, double shift = 0) {
  std::vector<graph::Vertex> vertices;
  std::vector<graph::Edge> edges;
  for (std::uint32_t k = 0; k < 6; ++k) {
    graph::Patch patch;
    patch.position = {x, 10.0 + 5 * k + shift};
    patch.theta = 1.5707963267948966;
    patch.width = 4, patch.blur = 1, patch.contrast = 100;
    patch.left = patch.right = {50, 50, 50};
    patch.middle = {150, 150, 150};
    vertices.push_back({{k}, {}, patch});
    if (k > 0) edges.push_back({{k - 1}, {k}});
  }
  return {std::move(vertices), std::move(edges)};
}

}  // namespace

TEST_CASE("a frame drawn from a graph shows its strokes and the levels beside them") {
  for (const int channels : {1, 3}) {
    const cv::Mat frame = draw_frame(bar(20), {.size = {48, 40}, .channels = channels, .empty_level = 7});
    REQUIRE(frame.type() == CV_8UC(channels));
    REQUIRE(frame.size() == cv::Size(48, 40));
    const cv::Mat first = frame.reshape(1, 40);
    CHECK(first.at<unsigned char>(22, 20 * channels) > 135);
    CHECK(first.at<unsigned char>(22, 2 * channels) < 60);
    CHECK(first.at<unsigned char>(22, 45 * channels) < 60);
    CHECK(first.at<unsigned char>(22, 45 * channels) > 40);
  }
}

TEST_CASE("a frame without a stroke in it has the level that was asked for") {
  CHECK(same_pixels(draw_frame({}, {.size = {9, 5}, .empty_level = 77}),
                    cv::Mat(5, 9, CV_8UC3, cv::Scalar::all(77))));
  // all of it lies outside
  CHECK(same_pixels(draw_frame(bar(20, -500), {.size = {48, 40}, .channels = 1, .empty_level = 77}),
                    cv::Mat(40, 48, CV_8UC1, cv::Scalar(77))));
}

TEST_CASE("a clip of graphs is drawn in order and frame by frame as each alone") {
  const FrameLook look{{48, 40}, 3, 7, {}};
  std::vector<int> asked, taken;
  draw_frames(
      37, look, "draw", {},
      [&](int t) {
        asked.push_back(t);
        return bar(5 + t);
      },
      [&](int t, const cv::Mat& frame) {
        taken.push_back(t);
        if (t % 9 == 0) CHECK(same_pixels(frame, draw_frame(bar(5 + t), look)));
      });
  REQUIRE(taken.size() == 37);
  for (int t = 0; t < 37; ++t)
    CHECK((asked[static_cast<std::size_t>(t)] == t && taken[static_cast<std::size_t>(t)] == t));
  std::stop_source stop;
  stop.request_stop();
  CHECK_THROWS_AS(draw_frames(
                      3, look, "draw", core::Context(stop.get_token()), [](int) { return bar(9); },
                      [](int, const cv::Mat&) {}),
                  Interrupted);
}
