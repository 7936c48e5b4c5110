// SPDX-License-Identifier: Apache-2.0
#include "pipeline/inference/event_paths.hpp"

#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include <opencv2/core.hpp>

#include "core/clip.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/sketch_scene.hpp"

using namespace emberfold;
using namespace emberfold::test;

namespace {

constexpr int kPathFrames = 12, kPathFrame = 5;
const Point kPathStep{2, -1};  // px a frame

/// Frames of spots that all move by `kPathStep` a frame.
pipeline::FrameWindow moving_window() {
  pipeline::FrameWindow window;
  core::ClipInfo info;
  info.width = 160, info.height = 120, info.channels = 1, info.frames = kPathFrames;
  for (int t = 0; t < kPathFrames; ++t) {
    const cv::Mat1f levels = draw({160, 120}, [&](Point p) {
      const Point q = p - kPathStep * t;
      return 128 + 50 * std::sin(0.31 * q.x + 0.07 * q.y) * std::cos(0.23 * q.y - 0.11 * q.x);
    });
    cv::Mat bytes;
    levels.convertTo(bytes, CV_8U);
    window.push(pipeline::make_window_frame(bytes, info));
  }
  window.prepare({});
  return window;
}

graph::AttributeGraph two_patches() {
  std::vector<graph::Vertex> vertices(2);
  for (std::uint32_t i = 0; i < 2; ++i) {
    vertices[i].id = graph::VertexId{i};
    vertices[i].patch.position = {70, 50 + 15.0 * i};
    vertices[i].patch.theta = std::acos(-1.0) / 2;
  }
  return {std::move(vertices), {{graph::VertexId{0}, graph::VertexId{1}}}};
}

std::vector<pipeline::Path> paths_of(graph::EventType type, std::size_t of_each) {
  graph::TracedEvent traced;
  traced.event.type = type;
  traced.path_frame = kPathFrame;
  traced.path = {graph::VertexId{0}, graph::VertexId{1}};
  graph::MotionGraph motion;
  motion.sketch = {160, 120, 25, std::vector<graph::AttributeGraph>(kPathFrames)};
  motion.sketch.frames[kPathFrame] = two_patches();
  motion.links.resize(kPathFrames);
  pipeline::MotionIndex index(motion);
  index.hold(0, kPathFrames);
  std::vector<pipeline::Path> paths;
  for (auto& guesses : pipeline::follow_event(traced, index, moving_window(), 1, 10)) {
    REQUIRE(guesses.size() == of_each);
    for (auto& path : guesses) paths.push_back(std::move(path));
  }
  return paths;
}

}  // namespace

TEST_CASE("event paths: a stroke's patches go with the picture, forwards and backwards in time") {
  const auto paths = paths_of(graph::EventType::birth, 1);
  REQUIRE(paths.size() == 10);
  for (int t = 1; t <= 10; ++t) {
    const pipeline::Path& path = paths[static_cast<std::size_t>(t - 1)];
    REQUIRE(path.size() == 2);
    for (std::size_t i = 0; i < 2; ++i) {
      const Point expected = Point{70, 50 + 15.0 * static_cast<double>(i)} + kPathStep * (t - kPathFrame);
      CHECK(distance(path[i].position, expected) < 1);
    }
  }
}

TEST_CASE("event paths: a joint's path has patches between its own, at most 6 px apart, in every frame") {
  for (const pipeline::Path& path : paths_of(graph::EventType::connect, 2)) {
    REQUIRE(path.size() == 7);
    for (std::size_t i = 0; i + 1 < path.size(); ++i) {
      const double apart = distance(path[i].position, path[i + 1].position);
      CHECK((apart > 0.5 && apart <= 6));
    }
  }
}
