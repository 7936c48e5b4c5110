// SPDX-License-Identifier: Apache-2.0
#include "sketch/patches/sections.hpp"

#include <vector>

#include "tests/support/catch.hpp"

using namespace emberfold;
using namespace emberfold::test;

TEST_CASE("A section of a plane of levels is the plane along its ribs, in the middle the place itself") {
  cv::Mat3f levels(50, 60);
  for (int y = 0; y < levels.rows; ++y)
    for (int x = 0; x < levels.cols; ++x)
      levels(y, x) = {static_cast<float>(2 * x + 3 * y), static_cast<float>(5 * x - y), 7};
  const std::vector<sketch::Rib> ribs{{{20.25, 24.5}, {0.6, 0.8}, 1}, {{22.25, 23}, {0.6, 0.8}, 3}};
  const auto sections = sketch::sample_sections(levels, ribs, 16, {0.5F, -1, 2});
  const double x = (20.25 + 3 * 22.25) / 4, y = (24.5 + 3 * 23) / 4;  // the ribs' weighted mean
  REQUIRE(sections.seen.count == 16);
  for (std::size_t i = 0; i < 16; ++i) {
    const double d = sections.seen.place(i), at_x = x + 0.6 * d, at_y = y + 0.8 * d;
    const double blue = 2 * at_x + 3 * at_y, green = 5 * at_x - at_y;
    CHECK_THAT(double{sections.channel[0].level[i]}, WithinAbs(blue, 1e-3));
    CHECK_THAT(double{sections.channel[1].level[i]}, WithinAbs(green, 1e-3));
    CHECK_THAT(double{sections.seen.level[i]}, WithinAbs(0.5 * blue - green + 14, 1e-3));
  }
  CHECK_THAT(sections.seen.place(0) + sections.seen.place(15), WithinAbs(0, 1e-12));
}

TEST_CASE("Beyond the frame a section goes on as at its border") {
  const cv::Mat1f levels = (cv::Mat1f(2, 3) << 10, 20, 30, 40, 50, 60);
  const std::vector<sketch::Rib> ribs{{{1, 0}, {1, 0}, 1}};
  const auto seen = sketch::sample_sections(levels, ribs, 9, {1, 0, 0}).seen;
  CHECK_THAT(double{seen.level[0]}, WithinAbs(10, 1e-6));
  CHECK_THAT(double{seen.level[4]}, WithinAbs(20, 1e-6));
  CHECK_THAT(double{seen.level[5]}, WithinAbs(25, 1e-6));
  CHECK_THAT(double{seen.level[8]}, WithinAbs(30, 1e-6));
}

TEST_CASE("The noise of a section is twice that of independent samples, by the ribs' weights") {
  const std::vector<sketch::Rib> one{{{0, 0}, {1, 0}, 5}};
  CHECK_THAT(sketch::section_variance(one, 3), WithinAbs(2 * 9, 1e-12));
  const std::vector<sketch::Rib> two{{{0, 0}, {1, 0}, 1}, {{0, 0}, {1, 0}, 3}};
  CHECK_THAT(sketch::section_variance(two, 2), WithinAbs(2 * 4 * 10 / 16.0, 1e-12));
}
