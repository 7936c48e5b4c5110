// SPDX-License-Identifier: Apache-2.0
#include "sketch/detection/half_resolution.hpp"

#include <cmath>
#include <numbers>

#include <opencv2/core.hpp>

#include "tests/support/catch.hpp"
#include "tests/support/sketch_scene.hpp"

using namespace emberfold;
using namespace emberfold::test;
using graph::Point;
using sketch::HalfResolution;
using sketch::ScaleSpace;

namespace {

ScaleSpace halved(const cv::Mat1f& frame) {
  return HalfResolution(frame.size()).halved(sketch::scale_space(frame, 1.2, 4));
}

}  // namespace

TEST_CASE("A slope keeps its place and its size at half the resolution", "[sketch][weak]") {
  for (const cv::Size size : {cv::Size{80, 61}, cv::Size{81, 60}}) {
    const ScaleSpace half = halved(draw(size, [](Point p) { return 3 * p.x - 2 * p.y; }));
    const HalfResolution halving(size);
    for (const sketch::ScaleLevel& level : half) {
      REQUIRE(level.smooth.size() == cv::Size((size.width + 1) / 2 + 2, (size.height + 1) / 2 + 2));
      // Away from the border, where the frame is mirrored.
      const Point place =
          halving.to_frame({sketch::CreaseKind::ridge, {{{20, 15}}}, false}).points[0].position;
      CHECK_THAT(level.value_at({20, 15}), WithinAbs(3 * place.x - 2 * place.y, 1e-3));
      const Point slope = level.gradient(20, 15);
      CHECK_THAT(slope.x, WithinAbs(6, 1e-3));
      CHECK_THAT(slope.y, WithinAbs(-4, 1e-3));
    }
  }
}

TEST_CASE("A mirrored frame is halved to its mirror image, bit by bit", "[sketch][weak]") {
  for (const cv::Size size : {cv::Size{80, 61}, cv::Size{81, 60}, cv::Size{1, 2}}) {
    const cv::Mat1f frame = with_noise(cv::Mat1f(size, 100.0F), 9, 5);
    for (const int way : {0, 1}) {
      cv::Mat1f mirrored, back;
      cv::flip(frame, mirrored, way);
      const ScaleSpace one = halved(frame), other = halved(mirrored);
      for (std::size_t k = 0; k < one.size(); ++k) {
        cv::flip(other[k].smooth, back, way);
        CHECK(cv::norm(one[k].smooth, back, cv::NORM_INF) == 0);
      }
    }
  }
}

TEST_CASE("A curve goes to half the resolution and back, with points between", "[sketch][weak]") {
  const HalfResolution halving({80, 61});
  sketch::CreasePoint point;
  point.position = {31.5, 17}, point.strength = 4, point.contrast = 7;
  const sketch::CreasePoint half = halving.halved(point);
  sketch::CreasePoint next = half;
  next.position = half.position + Point{1, 0};
  const sketch::Chain chain = halving.to_frame({sketch::CreaseKind::valley, {half, next}, false});
  REQUIRE(chain.points.size() == 3);
  CHECK(chain.kind == sketch::CreaseKind::valley);
  for (std::size_t i = 0; i < 3; ++i) {
    CHECK_THAT(chain.points[i].position.x, WithinAbs(31.5 + static_cast<double>(i), 1e-12));
    CHECK_THAT(chain.points[i].position.y, WithinAbs(17, 1e-12));
    CHECK_THAT(chain.points[i].strength, WithinAbs(4, 1e-12));
    CHECK(chain.points[i].contrast == 7);
  }
  CHECK(halving.to_frame({sketch::CreaseKind::valley, {half, next}, true}).points.size() == 4);
}
