// SPDX-License-Identifier: Apache-2.0
#include <vector>

#include <opencv2/core.hpp>

#include "apps/draw_graph_frames.hpp"
#include "apps/interrupt.hpp"
#include "core/rng.hpp"
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
  CHECK(same_pixels(draw_frame(graph::AttributeGraph{}, {.size = {9, 5}, .empty_level = 77}),
                    cv::Mat(5, 9, CV_8UC3, cv::Scalar::all(77))));
  // all of it lies outside
  CHECK(same_pixels(draw_frame(bar(20, -500), {.size = {48, 40}, .channels = 1, .empty_level = 77}),
                    cv::Mat(40, 48, CV_8UC1, cv::Scalar(77))));
}

TEST_CASE("a batch of graphs is drawn frame by frame as each alone, on a ground or without") {
  const FrameLook look{{48, 40}, 3, 7, {}};
  core::Rng rng(2);
  std::vector<FrameParts> parts;
  for (int t = 0; t < 19; ++t) {
    parts.push_back({bar(5 + t), {}});
    if (t % 2 == 0) continue;
    parts.back().ground = cv::Mat(40, 48, CV_8UC3);
    for (auto& pixel : cv::Mat_<cv::Vec3b>(parts.back().ground))
      pixel = cv::Vec3b::all(static_cast<unsigned char>(100 + rng.below(20)));
  }
  const auto frames = draw_batch(parts, look, {});
  REQUIRE(frames.size() == 19);
  for (std::size_t t = 0; t < frames.size(); ++t) CHECK(same_pixels(frames[t], draw_frame(parts[t], look)));
  std::stop_source stop;
  stop.request_stop();
  CHECK_THROWS_AS(draw_batch(parts, look, core::Context(stop.get_token())), Interrupted);
}

TEST_CASE("strokes are joined into a ground: theirs beside them, its own away from them") {
  const FrameLook look{{96, 40}, 1, 7, {}};
  core::Rng rng(2);
  cv::Mat ground(40, 96, CV_8U);
  for (auto& value : cv::Mat_<unsigned char>(ground)) value = static_cast<unsigned char>(100 + rng.below(20));
  const cv::Mat frame = draw_frame({bar(20), ground}, look), plain = draw_frame(bar(20), look);
  const auto drawn = sketch::draw_fitted(bar(20), look.size, 1);
  for (int y = 0; y < 40; ++y)
    for (int x = 0; x < 96; ++x)
      if (drawn.mask.at<unsigned char>(y, x) != 0)
        CHECK(frame.at<unsigned char>(y, x) == plain.at<unsigned char>(y, x));
  const cv::Rect away(72, 0, 24, 40);
  CHECK(cv::norm(frame(away), ground(away), cv::NORM_INF) <= 1);
  // Its texture stays where its level gives way.
  cv::Mat lifted = cv::Mat(ground - frame)(cv::Rect(26, 8, 4, 24));
  cv::Scalar mean, spread;
  cv::meanStdDev(lifted, mean, spread);
  CHECK(mean[0] > 10);
}
