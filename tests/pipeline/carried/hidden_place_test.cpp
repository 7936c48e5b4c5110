// SPDX-License-Identifier: Apache-2.0
#include "pipeline/carried/hidden_place.hpp"

#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include <opencv2/core.hpp>

#include "tests/support/catch.hpp"
#include "tests/support/graphs.hpp"

using namespace emberfold;
using pipeline::HiddenPlace;
using pipeline::SeenClip;

namespace {

/// A level stroke of five patches at (40 … 64, 40) in all frames, over ground that brightens to the right and
/// from frame to frame.
SeenClip ramps(int frames) {
  std::vector<cv::Mat> pictures;
  std::vector<graph::AttributeGraph> graphs;
  std::vector<std::vector<std::pair<std::uint32_t, std::uint32_t>>> links;
  for (int t = 0; t < frames; ++t) {
    cv::Mat1b picture(80, 100);
    for (int y = 0; y < picture.rows; ++y)
      for (int x = 0; x < picture.cols; ++x) picture(y, x) = static_cast<std::uint8_t>(x + y / 2 + 10 * t);
    pictures.push_back(picture);
    test::Frame frame;
    frame.line(test::segment({40, 40}, {64, 40}, 5));
    graphs.push_back(frame.graph());
    if (t > 0) links.push_back({{0, 0}, {1, 1}, {2, 2}, {3, 3}, {4, 4}});
  }
  auto motion = graph::identify(test::motion(graphs, links));
  motion.sketch.width = 100, motion.sketch.height = 80;
  return {std::move(pictures), std::move(motion)};
}

std::vector<graph::Patch> patches_from(double x, double y) {
  std::vector<graph::Patch> patches;
  for (int i = 0; i < 4; ++i) patches.push_back(test::vertex(0, x + 6 * i, y).patch);
  return patches;
}

}  // namespace

TEST_CASE("hidden place: a frame at another time is one of a clip that goes to and fro") {
  for (const int size : {2, 3, 7}) {
    std::vector<int> course;  // of a clip to and fro: 0 … size − 1 … 1
    for (int t = 0; t < size; ++t) course.push_back(t);
    for (int t = size - 2; t > 0; --t) course.push_back(t);
    for (int t = 0; t < size; ++t)
      for (int later = -20; later <= 20; ++later) {
        const int period = static_cast<int>(course.size());
        const int at = ((t + later) % period + period) % period;
        CHECK(HiddenPlace{{}, later, 0}.frame(t, size) == course[static_cast<std::size_t>(at)]);
      }
  }
}

TEST_CASE("hidden place: strokes show where a quarter of the patches lies on one there") {
  const auto clip = ramps(3);
  // Of four patches 6 px apart none to four lie within 5 px of the stroke, which ends at 64.
  CHECK(!shows_strokes(clip, 0, patches_from(70, 40), {{}, 0, 0}));
  CHECK(!shows_strokes(clip, 0, patches_from(64, 40), {{}, 0, 0}));
  CHECK(shows_strokes(clip, 0, patches_from(58, 40), {{}, 0, 0}));
  CHECK(shows_strokes(clip, 0, patches_from(40, 40), {{}, 1, 0}));
  CHECK(!shows_strokes(clip, 0, patches_from(40, 40), {{0, 20}, 1, 0}));
}

TEST_CASE("hidden place: places are unlike by the levels on both sides of a patch") {
  const auto clip = ramps(3);
  const auto patch = test::vertex(0, 50, 40).patch;
  CHECK_THAT(unlikeness_around(clip, patch, {50, 40}, 0, {}, 0), test::WithinAbs(0, 1e-12));
  CHECK_THAT(unlikeness_around(clip, patch, {50, 40}, 0, {9, 0}, 0), test::WithinAbs(9, 1e-12));
  CHECK_THAT(unlikeness_around(clip, patch, {50, 40}, 0, {-6, 0}, 0), test::WithinAbs(6, 1e-12));
  CHECK_THAT(unlikeness_around(clip, patch, {50, 40}, 0, {}, 2), test::WithinAbs(20, 1e-12));
  CHECK_THAT(unlikeness_around(clip, patch, {50, 40}, 0, {-20, 0}, 2), test::WithinAbs(0, 1e-12));
}

TEST_CASE("hidden place: what hides a patch is looked for beside it, where no stroke lies") {
  const auto clip = ramps(3);
  const auto patches = patches_from(44, 40);
  const auto place = find_hidden_place(clip, 0, patches);
  CHECK(place.later == 0);
  CHECK(std::hypot(place.beside.x, place.beside.y) > 5);
  for (const auto& patch : patches) CHECK(!clip.occupied(0, patch.position + place.beside));
  CHECK(!shows_strokes(clip, 0, patches, place));
}
