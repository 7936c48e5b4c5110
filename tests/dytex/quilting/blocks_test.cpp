// SPDX-License-Identifier: Apache-2.0
#include "dytex/quilting/blocks.hpp"

#include <algorithm>
#include <cstdint>
#include <utility>
#include <vector>

#include <opencv2/core.hpp>

#include "core/rng.hpp"
#include "dytex/quilting/block_courses.hpp"
#include "dytex/quilting/course_values.hpp"
#include "tests/support/catch.hpp"

using namespace emberfold;
using namespace emberfold::dytex::detail;

TEST_CASE("Blocks cover the canvas, which is larger than the output by less than a block's step",
          "[dytex][quilt]") {
  for (const int width : {10, 40, 41, 57, 58, 100})
    for (const int overlap : {1, 4, 8}) {
      const cv::Size size(width, 33), block(16, 20);
      const auto plan = plan_blocks(size, block, overlap, false);
      CAPTURE(width, overlap);
      const int across = plan.canvas.width - size.width, down = plan.canvas.height - size.height;
      CHECK((across >= 0 && down >= 0));
      CHECK((across < block.width - overlap || plan.columns == 1));
      CHECK((down < block.height - overlap || plan.rows == 1));
      cv::Mat1i covered(plan.canvas, 0);
      int blocks = 0;
      for (const auto& wave : plan.waves)
        for (const auto& one : wave) {
          ++blocks;
          cv::Mat1i there = covered(one.place);
          there += 1;
          CHECK(one.left == (one.column > 0 ? overlap : 0));
          CHECK(one.top == (one.row > 0 ? overlap : 0));
        }
      CHECK(blocks == plan.columns * plan.rows);
      CHECK(*std::ranges::min_element(covered) == 1);
    }
}

TEST_CASE("The runs of a block's overlap are the pixels of its strips, each once", "[dytex][quilt]") {
  for (int sides = 0; sides < 16; ++sides) {
    QuiltBlock block{1, 1, {0, 0, 11, 9}};
    block.left = (sides & 1) != 0 ? 3 : 0, block.top = (sides & 2) != 0 ? 2 : 0;
    block.right = (sides & 4) != 0 ? 4 : 0, block.bottom = (sides & 8) != 0 ? 3 : 0;
    cv::Mat1i by_run(9, 11, 0), by_box(9, 11, 0), strips(9, 11, 0);
    const auto mark = [](cv::Mat1i marked) { marked += 1; };
    for (const Run& run : overlap_runs(block)) mark(by_run(cv::Rect(run.x, run.y, run.length, 1)));
    for (const cv::Rect& box : run_boxes(overlap_runs(block))) mark(by_box(box));
    for (int y = 0; y < 9; ++y)
      for (int x = 0; x < 11; ++x)
        if (x < block.left || x >= 11 - block.right || y < block.top || y >= 9 - block.bottom)
          strips(y, x) = 1;
    CHECK(cv::countNonZero(by_run != strips) == 0);
    CHECK(cv::countNonZero(by_box != strips) == 0);
    CHECK(count_pixels(overlap_runs(block)) == cv::countNonZero(strips));
  }
}

TEST_CASE("On a torus a block goes on beyond its place by the way that is nearer", "[dytex][quilt]") {
  const cv::Size torus(20, 17);
  std::vector<PlacedBlock> placed{{{15, 2, 9, 12}, {0, 100, 200}}, {{3, 14, 4, 5}, {0, 300, 400}}};
  const BlockCourses courses(torus, true, placed, std::vector<std::int32_t>(340, 0));
  const auto beyond = [](int offset, int length) { return std::max({-offset, offset - length + 1, 0}); };
  for (std::int32_t k = 0; k < 2; ++k)
    for (int y = 0; y < torus.height; ++y)
      for (int x = 0; x < torus.width; ++x) {
        const auto& block = placed[static_cast<std::size_t>(k)];
        const auto from = courses.source_of(k, {x, y});
        const int across = from.x - block.from.x, down = from.y - block.from.y;
        CHECK((block.place.x + across - x) % torus.width == 0);
        CHECK((block.place.y + down - y) % torus.height == 0);
        for (const int turn : {-1, 1}) {  // the other ways are not nearer by more than rounding
          CHECK(beyond(across, block.place.width) <=
                beyond(across + turn * torus.width, block.place.width) + 1);
          CHECK(beyond(down, block.place.height) <=
                beyond(down + turn * torus.height, block.place.height) + 1);
        }
      }
}

TEST_CASE("A pixel's blocks are read at any moments as they were written, its map too", "[dytex][quilt]") {
  const std::vector<PlacedBlock> placed(3, {{0, 0, 4, 4}, {0, 0, 0}});
  BlockCourses courses({4, 4}, false, placed, std::vector<std::int32_t>(16, 0));
  const std::vector<int> begins{0, 5, 10, 15}, moments{0, 4, 5, 9, 10, 14, 15, 19};
  courses.write({2, 1}, begins, std::vector<std::int32_t>{1, 1, 2, 0});
  std::vector<std::int32_t> shown(moments.size());
  courses.read({2, 1}, moments, shown);
  CHECK(shown == std::vector<std::int32_t>{1, 1, 1, 1, 2, 2, 0, 0});
  courses.read({1, 1}, moments, shown);
  CHECK(std::ranges::all_of(shown, [](std::int32_t block) { return block == 0; }));
  const auto map = courses.map(20);
  REQUIRE(map.changes_of(map.index(2, 1)).size() == 2);
  CHECK(map.changes_of(map.index(2, 1))[0].frame == 10);
  CHECK(map.changes_of(map.index(1, 1)).empty());
}

TEST_CASE("Courses have one value for a level, whatever depth it is stored in", "[dytex][quilt]") {
  constexpr int kFrames = 21;  // more than a chunk
  for (const auto& [depth, white] : {std::pair(CV_8U, 255.0), {CV_16U, 65535.0}, {CV_32F, 1.0}}) {
    core::Clip clip{{5, 3, 3, depth, 25, white, kFrames}, {}};
    dytex::Trajectories held(clip.info);
    core::Rng rng(1);
    std::vector<cv::Mat> levels;
    for (int t = 0; t < kFrames; ++t) {
      cv::Mat bytes(3, 5, CV_8UC3), frame;
      for (auto& level : cv::Mat1b(bytes.reshape(1))) level = static_cast<std::uint8_t>(rng.below(256));
      bytes.convertTo(frame, depth, white / 255);
      levels.push_back(bytes);
      held.add(frame);
    }
    held.finish();
    cv::Mat1b forbidden(3, 5, std::uint8_t{0});
    forbidden(1, 2) = 1;
    const std::vector<dytex::QuiltSource> sources{{&held, forbidden, {}}};
    const CourseValues values(sources);
    std::vector<CourseValue> course(3 * (kFrames - 3));
    values.copy({0, 4, 2}, 2, kFrames - 1, course.data());
    for (int t = 2; t < kFrames - 1; ++t)
      for (int c = 0; c < 3; ++c)
        CHECK(course[static_cast<std::size_t>(3 * (t - 2) + c)] ==
              kValuesPerLevel * levels[static_cast<std::size_t>(t)].at<cv::Vec3b>(2, 4)[c]);
    for (int y = -1; y <= 3; ++y)
      for (int x = -1; x <= 5; ++x)
        CHECK(values.may_show({0, x, y}) == (x >= 0 && y >= 0 && x < 5 && y < 3 && !(x == 2 && y == 1)));
  }
}
