// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "core/clip/masked_source.hpp"
#include "core/error.hpp"
#include "core/io/clip_reader.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/clip_fixture.hpp"
#include "tests/support/messages.hpp"
#include "tests/support/tiff_writer.hpp"

using namespace emberfold;
using namespace emberfold::test;

namespace {

constexpr float kNone = std::numeric_limits<float>::quiet_NaN();

struct Read {
  core::Clip clip;
  std::vector<cv::Mat> masks;
  std::vector<std::string> told;
};

Read read(const fs::path& path, io::ReadOptions options = {}) {
  Read found;
  options.fps = 10;
  const auto source =
      io::open_video(path.string(), options, [&](const std::string& line) { found.told.push_back(line); });
  found.clip.info = source->info();
  for (cv::Mat frame = source->next(); !frame.empty(); frame = source->next()) {
    found.clip.frames.push_back(frame);
    found.masks.push_back(core::mask_of(*source).clone());
  }
  return found;
}

/// Pages that rise from `low` on the left to `high` on the right.
std::vector<cv::Mat> ramps(double low, double high, int depth) {
  cv::Mat page(30, 61, CV_32FC1);
  for (int x = 0; x < page.cols; ++x) page.col(x) = cv::Scalar(low + (high - low) * x / (page.cols - 1));
  page.convertTo(page, depth);
  return {page.clone(), page.clone(), page.clone()};
}

/// The level, 0 to 255, of a pixel.
double level(const Read& found, int x, std::size_t t = 0) {
  return double{core::to_levels(found.clip.frames.at(t), found.clip.info).at<float>(15, x)};
}

}  // namespace

TEST_CASE("one hot pixel changes nothing but itself, with a warning") {
  const TempFolder temp;
  const auto path = temp / "stack.tif";
  for (const int depth : {CV_16U, CV_32F}) {
    INFO(depth);
    auto pages = ramps(200, 500, depth);
    write_tiff(path, pages);
    const auto cold = read(path);
    cv::Mat hot(1, 1, depth, cv::Scalar(65535));
    hot.copyTo(pages[1](cv::Rect(50, 3, 1, 1)));
    write_tiff(path, pages);
    const auto found = read(path);
    CHECK(found.clip.info.white == 511);
    CHECK(same_pixels(found.clip.frames[0], cold.clip.frames[0]));
    double most = 0;
    cv::minMaxLoc(found.clip.frames[1], nullptr, &most);
    CHECK(most == 511);
    REQUIRE(found.told.size() == 1);
    CHECK(contains(found.told[0], "single pixels reach 65535, all others at most 500"));
  }
  // a line of one pixel's width is no stray value
  auto pages = ramps(200, 500, CV_16U);
  pages[1].row(3) = cv::Scalar(60000);
  write_tiff(path, pages);
  CHECK(read(path).clip.info.white == 65535);
}

TEST_CASE("values in a small part of the range, and those around 0, are spread") {
  const TempFolder temp;
  const auto path = temp / "stack.tif";
  for (const auto& [low, high, depth] : {std::tuple{10000., 10600., CV_16U},
                                         {0., 0.016, CV_32F},
                                         {-2.5, 4.5, CV_32F},
                                         {-0.5, 0.4, CV_32F},
                                         {-32000., -20000., CV_32F},
                                         {0., 1.5, CV_32F}}) {
    INFO(low << " to " << high);
    write_tiff(path, ramps(low, high, depth));
    const auto found = read(path);
    CHECK(found.clip.info.white == Approx(high - low));
    CHECK(level(found, 0) == Approx(0).margin(1e-3));
    CHECK(level(found, 60) == Approx(255));
    CHECK(level(found, 30) == Approx(127.5).margin(0.3));
    REQUIRE(found.told.size() == 1);
    CHECK(contains(found.told[0], "levels auto spreads"));
  }
  // what uses its range is read unchanged: small undershoots of floats, a dark clip of 16 bits
  write_tiff(path, ramps(-0.01, 1, CV_32F));
  const auto undershoot = read(path);
  CHECK(undershoot.clip.info.white == 1);
  CHECK(undershoot.clip.frames[0].at<float>(0, 0) == -0.01F);
  CHECK(undershoot.told.empty());
  write_tiff(path, ramps(0, 1000, CV_16U));
  CHECK(read(path).clip.info.white == 1023);
}

TEST_CASE("signed numbers and floats of 16 bits are read by their values") {
  const TempFolder temp;
  const auto path = temp / "stack.tif";
  struct Case {
    int depth;
    double low, high, white;
  };
  for (const auto& one :
       {Case{CV_16S, -32000, -20000, 12000}, Case{CV_16S, 4000, 20000, 32767}, Case{CV_8S, -88, 72, 160},
        Case{CV_32S, 0, 100000, 131071}, Case{CV_16F, 0.25, 0.75, 1}, Case{CV_64F, -4, 4, 8}}) {
    INFO(one.depth << ": " << one.low);
    write_tiff(path, ramps(one.low, one.high, one.depth));
    const auto found = read(path);
    CHECK(found.clip.info.white == Approx(one.white).epsilon(1e-3));
    CHECK(level(found, 60) - level(found, 0) == Approx(255 * (one.high - one.low) / one.white).epsilon(1e-3));
  }
}

TEST_CASE("floats that are no numbers are masked, and no edge arises at them") {
  const TempFolder temp;
  const auto path = temp / "stack.tif";
  auto pages = ramps(0, 1, CV_32F);
  pages[1].colRange(0, 5) = cv::Scalar(kNone);
  pages[2].at<float>(7, 30) = std::numeric_limits<float>::infinity();
  write_tiff(path, pages);
  const auto found = read(path);
  REQUIRE(found.clip.frames.size() == 3);
  CHECK(found.clip.info.white == 1);
  CHECK(cv::countNonZero(found.masks[0]) == 61 * 30);
  CHECK(cv::countNonZero(found.masks[1]) == 56 * 30);
  CHECK(found.masks[1].at<std::uint8_t>(9, 4) == 0);
  CHECK(found.masks[1].at<std::uint8_t>(9, 5) == 255);
  CHECK(cv::countNonZero(found.masks[2]) == 61 * 30 - 1);
  for (int x = 0; x < 5; ++x) CHECK(found.clip.frames[1].at<float>(9, x) == pages[0].at<float>(9, 5));
  CHECK(std::isfinite(found.clip.frames[2].at<float>(7, 30)));
  REQUIRE(found.told.size() == 1);
  CHECK(contains(found.told[0], "no finite numbers"));
  write_tiff(path, {cv::Mat(8, 8, CV_32FC1, cv::Scalar(kNone)), cv::Mat(8, 8, CV_32FC1, cv::Scalar(kNone))});
  CHECK(contains(message_of<core::InputError>([&] { read(path); }), "holds no finite number"));
}

TEST_CASE("levels outside of what a clip holds give a warning") {
  const TempFolder temp;
  const auto path = temp / "stack.tif";
  write_tiff(path, ramps(200, 500, CV_16U));
  io::ReadOptions options;
  options.levels = io::parse_levels("1000:2000");
  const auto dark = read(path, options);
  REQUIRE(dark.told.size() == 1);
  CHECK(contains(dark.told[0], "--levels 1000:2000 makes all of its first frame black"));
  CHECK(contains(dark.told[0], "200 to 500"));
  options.levels = io::parse_levels("10:200");
  CHECK(contains(read(path, options).told.at(0), "white"));
  options.levels = io::parse_levels("200:500");
  CHECK(read(path, options).told.empty());
}
