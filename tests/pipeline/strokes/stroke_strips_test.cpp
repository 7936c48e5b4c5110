// SPDX-License-Identifier: Apache-2.0
#include "pipeline/strokes/stroke_strips.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include <opencv2/core.hpp>

#include "tests/support/catch.hpp"
#include "tests/support/graphs.hpp"

using namespace emberfold;
using namespace emberfold::test;

namespace {

/// Two level lines in frames whose pixels tell their place and their frame.
struct Scene {
  std::vector<cv::Mat> frames;
  graph::MotionGraph strokes;
};
Scene scene() {
  Scene made;
  for (int t = 0; t < 4; ++t) {
    cv::Mat1b frame(100, 120);
    for (int y = 0; y < 100; ++y)
      for (int x = 0; x < 120; ++x) frame(y, x) = static_cast<std::uint8_t>((7 * x + 13 * y + 50 * t) % 256);
    made.frames.push_back(frame);
  }
  Frame lines;
  lines.line({{30, 20}, {35, 20}, {40, 20}, {45, 20}});
  lines.line({{30, 60}, {35, 60}, {40, 60}, {45, 60}});
  std::vector<std::pair<std::uint32_t, std::uint32_t>> all;
  for (std::uint32_t i = 0; i < 8; ++i) all.push_back({i, i});
  made.strokes =
      graph::identify(motion({lines.graph(), lines.graph(), lines.graph(), lines.graph()}, {all, all, all}));
  return made;
}

pipeline::RepeatedStroke stroke(std::size_t family, int frame, graph::Point offset, double share = 1) {
  return {family, frame, offset, share};
}

}  // namespace

TEST_CASE("stroke strips: the clip's pixels within 16 px of a curve, at the stroke's offset") {
  const auto made = scene();
  const pipeline::SeenClip clip(made.frames, made.strokes);
  const auto families = pipeline::stroke_families(clip);
  REQUIRE(families.lives.size() == 2);
  pipeline::StrokeMoment moment;
  moment.strokes = {stroke(0, 2, {10, 5})};  // at y = 25 from x = 40 to 55
  const auto strips = draw_strips(clip, families, moment, made.frames[0]);
  for (int y = 0; y < 100; ++y)
    for (int x = 0; x < 120; ++x) {
      const double beyond = std::max({0, 40 - x, x - 55}), away = std::hypot(beyond, y - 25);
      if (away > 15.5 && away < 16.5) continue;  // distances are within .2 px
      INFO(x << ", " << y);
      CHECK(strips.mask(y, x) == (away < 16 && y >= 5 && x >= 10 ? 255 : 0));
      if (strips.mask(y, x) != 0)
        CHECK(strips.levels.at<std::uint8_t>(y, x) == made.frames[2].at<std::uint8_t>(y - 5, x - 10));
    }
}

TEST_CASE("stroke strips: the nearest curve's pixels are seen, with a gap between moments") {
  const auto made = scene();
  const pipeline::SeenClip clip(made.frames, made.strokes);
  const auto families = pipeline::stroke_families(clip);
  pipeline::StrokeMoment moment;
  moment.strokes = {stroke(0, 1, {0, 0}), stroke(1, 3, {0, -20})};  // at y = 20 and 40
  const auto strips = draw_strips(clip, families, moment, made.frames[0]);
  const auto level = [&](int y) { return strips.levels.at<std::uint8_t>(y, 38); };
  CHECK(strips.mask(27, 38) == 255);
  CHECK(level(27) == made.frames[1].at<std::uint8_t>(27, 38));
  CHECK(strips.mask(33, 38) == 255);
  CHECK(level(33) == made.frames[3].at<std::uint8_t>(53, 38));
  CHECK(strips.mask(30, 38) == 0);  // half way
  CHECK(strips.mask(20, 38) == 255);
  // Strips of one moment have no gap between them.
  moment.strokes[1] = stroke(1, 1, {0, 0});
  moment.strokes[0] = stroke(0, 1, {0, 0});
  const auto same = draw_strips(clip, families, moment, made.frames[0]);
  CHECK(same.mask(35, 38) == 255);
  CHECK(same.mask(45, 38) == 255);
}

TEST_CASE("stroke strips: a strip is narrower by its share, and what lasts is drawn from the head") {
  const auto made = scene();
  const pipeline::SeenClip clip(made.frames, made.strokes);
  const auto families = pipeline::stroke_families(clip);
  const cv::Mat1b head(100, 120, std::uint8_t{9});
  pipeline::StrokeMoment moment;
  moment.shown.frame = 2;
  moment.strokes = {stroke(0, 1, {0, 0}, 0.5), stroke(1, 2, {0, 0})};
  const auto strips = draw_strips(clip, families, moment, head);
  CHECK(strips.mask(13, 38) == 255);
  CHECK(strips.mask(11, 38) == 0);
  CHECK(strips.levels.at<std::uint8_t>(13, 38) == made.frames[1].at<std::uint8_t>(13, 38));
  CHECK(strips.levels.at<std::uint8_t>(60, 38) == 9);
  // Strokes outside of the frame show nothing.
  moment.strokes = {stroke(0, 1, {500, 0}), stroke(0, 1, {-300, -300})};
  CHECK(cv::countNonZero(draw_strips(clip, families, moment, head).mask) == 0);
}
