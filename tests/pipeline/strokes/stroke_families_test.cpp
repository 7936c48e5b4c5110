// SPDX-License-Identifier: Apache-2.0
#include "pipeline/strokes/stroke_families.hpp"

#include <set>
#include <vector>

#include <opencv2/core.hpp>

#include "tests/pipeline/carried/carried_scene.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/merging_strokes.hpp"

using namespace emberfold;
using namespace emberfold::test;

TEST_CASE("stroke families: strokes that join are one family, with all its patches in every frame") {
  const pipeline::SeenClip clip(std::vector<cv::Mat>(4, cv::Mat1b(80, 60, std::uint8_t{0})),
                                two_become_one());
  const auto families = pipeline::stroke_families(clip);
  REQUIRE(families.lives.size() == 1);
  CHECK(families.lives[0].first == 0);
  REQUIRE(families.lives[0].patches.size() == 4);
  CHECK(families.lives[0].patches[1] == std::vector<std::uint32_t>{0, 1, 2, 3, 4, 5});
  CHECK(families.lives[0].patches[2].size() == 7);
  for (const auto& [stroke, family] : families.of_stroke) CHECK(family == 0);
}

TEST_CASE("stroke families: lines that never meet are families of their own, from birth to death") {
  const auto scene = carried_scene(60);
  const auto families = pipeline::stroke_families({scene.frames, scene.strokes});
  std::size_t expected = 0, patches = 0;
  std::multiset<int> firsts, found;
  for (const auto& line : scene_lines(60)) {
    const int first = std::max(line.first, 0), last = std::min(line.last, 59);
    if (last - first < 2) continue;  // shorter than three frames
    ++expected, patches += line.patches * static_cast<std::size_t>(last - first + 1);
    firsts.insert(first);
  }
  CHECK(families.lives.size() == expected);
  for (const auto& life : families.lives) {
    found.insert(life.first);
    for (const auto& of_frame : life.patches) patches -= of_frame.size();
  }
  CHECK(found == firsts);
  CHECK(patches == 0);
}
