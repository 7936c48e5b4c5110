// SPDX-License-Identifier: Apache-2.0
#include "sketch/rendering/relight.hpp"

#include <vector>

#include <opencv2/core.hpp>

#include "core/rng.hpp"
#include "sketch/rendering/frame_renderer.hpp"
#include "tests/support/catch.hpp"

using namespace emberfold;

namespace {

/// Upright, of levels left, middle, right; every other patch the other way round.
graph::AttributeGraph stroke(double x, float left, float middle, float right, bool turn = false) {
  std::vector<graph::Vertex> vertices;
  std::vector<graph::Edge> edges;
  for (std::uint32_t k = 0; k < 8; ++k) {
    graph::Patch patch;
    const bool up = !turn || k % 2 == 0;
    patch.position = {x, 5.0 + 5 * k};
    patch.theta = up ? -1.5707963267948966 : 1.5707963267948966;  // up: right is where x is greater
    patch.width = middle == (left + right) / 2 ? 0 : 4, patch.blur = 1;
    patch.left.fill(up ? left : right), patch.right.fill(up ? right : left), patch.middle.fill(middle);
    vertices.push_back({{k}, {}, patch});
    if (k > 0) edges.push_back({{k - 1}, {k}});
  }
  return {std::move(vertices), std::move(edges)};
}

/// 48 × 44, of one level to the left of x and another to the right.
cv::Mat sides(int x, float left, float right) {
  cv::Mat background(44, 48, CV_32F, cv::Scalar(double{right}));
  background.colRange(0, x).setTo(double{left});
  return background;
}

void check_levels(const graph::AttributeGraph& graph, float left, float middle, float right) {
  for (const auto& vertex : graph.vertices()) {
    const bool up = vertex.patch.theta < 0;
    const auto& patch = vertex.patch;
    for (std::size_t c = 0; c < 3; ++c) {
      CHECK_THAT(double{(up ? patch.left : patch.right)[c]}, Catch::Matchers::WithinAbs(double{left}, 1e-3));
      CHECK_THAT(double{patch.middle[c]}, Catch::Matchers::WithinAbs(double{middle}, 1e-3));
      CHECK_THAT(double{(up ? patch.right : patch.left)[c]}, Catch::Matchers::WithinAbs(double{right}, 1e-3));
    }
  }
}

}  // namespace

TEST_CASE("on the ground they come from strokes stay as they are") {
  for (const bool turn : {false, true}) {
    check_levels(sketch::relight(stroke(24, 50, 150, 70, turn), sides(24, 50, 70)), 50, 150, 70);
    check_levels(sketch::relight(stroke(24, 40, 90, 140, turn), sides(24, 40, 140)), 40, 90, 140);
  }
}

TEST_CASE("a line takes its sides from the ground and keeps its height above them") {
  for (const bool turn : {false, true})
    check_levels(sketch::relight(stroke(24, 50, 150, 50, turn), sides(24, 80, 120)), 80, 200, 120);
}

TEST_CASE("a step keeps its contrast, and both its sides are off by as much") {
  for (const bool turn : {false, true})
    check_levels(sketch::relight(stroke(24, 40, 90, 140, turn), sides(24, 160, 160)), 110, 160, 210);
}

TEST_CASE("a ground goes on through a line that rests on it, detail and all") {
  cv::Mat background(44, 48, CV_8U);
  core::Rng rng(4);
  for (auto& value : cv::Mat_<unsigned char>(background))
    value = static_cast<unsigned char>(80 + rng.below(40));
  sketch::RenderOptions look{{48, 44}, 1, 7, {}};
  const auto spread = [&](const cv::Mat& frame) {
    cv::Scalar mean, deviation;
    cv::meanStdDev(frame(cv::Rect(23, 10, 3, 24)), mean, deviation);
    return deviation[0];
  };
  const sketch::FrameContent parts{stroke(24, 100, 180, 100), background};
  const cv::Mat alone = sketch::render_frame(parts, look);
  look.new_places = true;
  const cv::Mat rests = sketch::render_frame(parts, look);
  CHECK(spread(rests) > 0.8 * spread(background));
  CHECK(spread(alone) < 0.5 * spread(background));
  CHECK(cv::mean(rests(cv::Rect(23, 10, 3, 24)))[0] > cv::mean(background)[0] + 60);
}
