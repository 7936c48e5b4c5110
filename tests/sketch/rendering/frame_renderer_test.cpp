// SPDX-License-Identifier: Apache-2.0
#include "sketch/rendering/frame_renderer.hpp"

#include <utility>
#include <vector>

#include <opencv2/core.hpp>

#include "core/context.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/clip_fixture.hpp"

using namespace emberfold;
using namespace emberfold::test;

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
    const cv::Mat frame =
        sketch::render_frame(bar(20), {.size = {48, 40}, .channels = channels, .empty_level = 7});
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
  CHECK(same_pixels(sketch::render_frame(graph::AttributeGraph{}, {.size = {9, 5}, .empty_level = 77}),
                    cv::Mat(5, 9, CV_8UC3, cv::Scalar::all(77))));
  // all of it lies outside
  CHECK(same_pixels(sketch::render_frame(bar(20, -500), {.size = {48, 40}, .channels = 1, .empty_level = 77}),
                    cv::Mat(40, 48, CV_8UC1, cv::Scalar(77))));
}

TEST_CASE("a batch of graphs is drawn frame by frame as each alone") {
  const sketch::RenderOptions look{{48, 40}, 3, 7, {}};
  std::vector<sketch::FrameContent> parts;
  for (int t = 0; t < 19; ++t) parts.push_back({bar(5 + t)});
  const auto frames = sketch::render_frames(parts, look, {});
  REQUIRE(frames.size() == 19);
  for (std::size_t t = 0; t < frames.size(); ++t)
    CHECK(same_pixels(frames[t], sketch::render_frame(parts[t], look)));
  std::stop_source stop;
  stop.request_stop();
  CHECK_THROWS_AS(sketch::render_frames(parts, look, core::Context(stop.get_token())), core::Cancelled);
}

TEST_CASE("a patch that is there in part lies between its own levels and what is there without it") {
  const sketch::RenderOptions look{{96, 64}, 3, 7, {}};
  // A bar that comes, another that stays.
  std::vector<graph::Vertex> vertices;
  std::vector<graph::Edge> edges;
  for (const auto& [x, first] : {std::pair{70.0, 0U}, {30.0, 100U}}) {
    const auto one = bar(x);
    for (auto vertex : one.vertices()) {
      vertex.id.value += first;
      if (first == 0) vertex.patch.left = vertex.patch.right = {80, 90, 100};
      vertices.push_back(vertex);
    }
    for (auto edge : one.edges()) edges.push_back({{edge.a.value + first}, {edge.b.value + first}});
  }
  const graph::AttributeGraph both(vertices, edges);
  const auto share = [&](float value) {
    sketch::FrameContent parts{both, std::vector<float>(12, 1)};
    for (std::size_t i = 6; i < 12; ++i) parts.opacity[i] = value;
    cv::Mat levels;
    sketch::render_frame(parts, look).convertTo(levels, CV_32F);
    return levels;
  };
  cv::Mat whole, none;
  sketch::render_frame(both, look).convertTo(whole, CV_32F);
  vertices.resize(6), edges.resize(5);
  sketch::render_frame(graph::AttributeGraph(vertices, edges), look).convertTo(none, CV_32F);
  CHECK(cv::norm(share(1), whole, cv::NORM_INF) == 0);
  CHECK(cv::norm(share(0), none, cv::NORM_INF) <= 3);
  CHECK(cv::norm(share(0.25F), 0.75 * none + 0.25 * whole, cv::NORM_INF) <= 4);
  CHECK(cv::norm(whole, none, cv::NORM_INF) > 50);
}

TEST_CASE("an anchor of a drawn graph is a fixed pixel, whatever the strokes are drawn with") {
  const auto with_anchor = [](const graph::AttributeGraph& strokes) {
    std::vector<graph::Vertex> vertices(strokes.vertices().begin(), strokes.vertices().end());
    vertices.push_back({{99}, {}, graph::make_anchor({36, 12}, {200, 150, 100})});
    return graph::AttributeGraph(std::move(vertices), {strokes.edges().begin(), strokes.edges().end()});
  };
  sketch::RenderOptions plain{.size = {48, 40}};
  auto sharpened = plain;
  sharpened.blur_share = 0.5, sharpened.contrast_gain = 1.5;
  auto placed = sharpened;
  placed.new_places = true;
  for (const auto& options : {plain, sharpened, placed}) {
    sketch::FrameContent content{with_anchor(bar(20))};
    const cv::Mat frame = sketch::render_frame(content, options),
                  bare = sketch::render_frame(bar(20), options);
    CHECK(frame.at<cv::Vec3b>(12, 36) == cv::Vec3b(200, 150, 100));
    CHECK(frame.at<cv::Vec3b>(12, 37)[0] > bare.at<cv::Vec3b>(12, 37)[0] + 5);  // the fill goes on from it
    CHECK(frame.at<cv::Vec3b>(22, 20) == bare.at<cv::Vec3b>(22, 20));           // the stroke does not change
    content.opacity.assign(content.graph.size(), 1);
    content.opacity[0] = 0.5F;
    CHECK(sketch::render_frame(content, options).at<cv::Vec3b>(12, 36) == cv::Vec3b(200, 150, 100));
  }
}
