// SPDX-License-Identifier: Apache-2.0
#include "core/clip.hpp"

#include <opencv2/core.hpp>

#include "core/clip/clip_range.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/clip_fixture.hpp"

using namespace emberfold;
using namespace emberfold::test;

namespace {

core::ClipInfo info(int channels, int depth, double white) {
  core::ClipInfo result;
  result.width = 2;
  result.height = 1;
  result.channels = channels;
  result.depth = depth;
  result.white = white;
  return result;
}

bool equal(const cv::Mat& a, const cv::Mat& b) {
  return a.size() == b.size() && a.type() == b.type() && cv::norm(a, b, cv::NORM_INF) == 0;
}

core::Clip three_frames() {
  core::Clip clip{info(1, CV_8U, 255), {}};
  for (int i = 0; i < 3; ++i) clip.frames.push_back((cv::Mat_<std::uint8_t>(1, 2) << i, 10 * i));
  return clip;
}

}  // namespace

TEST_CASE("Luma weighs the channels as Rec. 601 says", "[core][clip]") {
  const auto luma_of = [](cv::Vec3b bgr) {
    const cv::Mat frame(1, 2, CV_8UC3, cv::Scalar(bgr[0], bgr[1], bgr[2]));
    const cv::Mat grey = core::luma(frame, info(3, CV_8U, 255));
    CHECK(grey.type() == CV_32FC1);
    CHECK(grey.at<float>(0, 0) == grey.at<float>(0, 1));
    return static_cast<double>(grey.at<float>(0, 0));
  };
  CHECK_THAT(luma_of({200, 0, 0}), WithinAbs(0.114 * 200, 1e-3));
  CHECK_THAT(luma_of({0, 200, 0}), WithinAbs(0.587 * 200, 1e-3));
  CHECK_THAT(luma_of({0, 0, 200}), WithinAbs(0.299 * 200, 1e-3));
  CHECK_THAT(luma_of({255, 255, 255}), WithinAbs(255, 1e-3));
  CHECK_THAT(luma_of({10, 20, 30}), WithinAbs(0.114 * 10 + 0.587 * 20 + 0.299 * 30, 1e-3));
}

TEST_CASE("Levels are on the scale where white is 255, whatever the depth", "[core][clip]") {
  const cv::Mat bytes = (cv::Mat_<std::uint8_t>(1, 2) << 51, 255);
  const cv::Mat ten_bit = (cv::Mat_<std::uint16_t>(1, 2) << 341, 1023);
  const cv::Mat words = (cv::Mat_<std::uint16_t>(1, 2) << 13107, 65535);
  const cv::Mat floats = (cv::Mat_<float>(1, 2) << 0.2F, 1.5F);
  const auto check = [](const cv::Mat& levels, double first, double second) {
    CHECK(levels.type() == CV_32FC1);
    CHECK_THAT(static_cast<double>(levels.at<float>(0, 0)), WithinAbs(first, 1e-3));
    CHECK_THAT(static_cast<double>(levels.at<float>(0, 1)), WithinAbs(second, 1e-3));
  };
  check(core::to_levels(bytes, info(1, CV_8U, 255)), 51, 255);
  check(core::to_levels(ten_bit, info(1, CV_16U, 1023)), 85, 255);
  check(core::to_levels(words, info(1, CV_16U, 65535)), 51, 255);
  check(core::to_levels(floats, info(1, CV_32F, 1)), 51, 382.5);  // above white stays above it
  check(core::luma(ten_bit, info(1, CV_16U, 1023)), 85, 255);
}

TEST_CASE("Levels keep the channels and have their own memory", "[core][clip]") {
  cv::Mat frame(1, 2, CV_32FC3, cv::Scalar(10, 20, 30));
  cv::Mat levels = core::to_levels(frame, info(3, CV_32F, 255));
  CHECK(levels.type() == CV_32FC3);
  CHECK(levels.at<cv::Vec3f>(0, 1) == cv::Vec3f(10, 20, 30));
  levels = cv::Scalar::all(0);
  CHECK(frame.at<cv::Vec3f>(0, 0) == cv::Vec3f(10, 20, 30));
}

TEST_CASE("Bytes are levels rounded and kept in their range", "[core][clip]") {
  const cv::Mat levels = (cv::Mat_<float>(1, 6) << -3.0F, 0.4F, 1.6F, 127.0F, 254.6F, 400.0F);
  const cv::Mat expected = (cv::Mat_<std::uint8_t>(1, 6) << 0, 0, 2, 127, 255, 255);
  CHECK(equal(core::to_bytes(levels), expected));
  cv::Mat all(16, 16, CV_8U);
  for (int i = 0; i < 256; ++i) all.at<std::uint8_t>(i / 16, i % 16) = static_cast<std::uint8_t>(i);
  CHECK(equal(core::to_bytes(core::to_levels(all, info(1, CV_8U, 255))), all));
}

TEST_CASE("A clip's source gives deep copies, and again after a rewind", "[core][clip]") {
  const core::Clip clip = three_frames();
  core::ClipSource source(clip);
  CHECK(source.info() == clip.info);
  for (int pass = 0; pass < 2; ++pass) {
    for (std::size_t i = 0; i < 3; ++i) {
      cv::Mat frame = source.next();
      CHECK(equal(frame, clip.frames[i]));
      frame = cv::Scalar::all(99);
    }
    CHECK(source.next().empty());
    CHECK(source.next().empty());
    source.rewind();
  }
  CHECK(clip.frames[1].at<std::uint8_t>(0, 1) == 10);
  source.next();
  source.rewind();
  CHECK(source.next().at<std::uint8_t>(0, 1) == 0);
}

TEST_CASE("read_all takes what is left and counts it", "[core][clip]") {
  const core::Clip clip = three_frames();
  core::ClipSource source(clip);
  const core::Clip whole = core::read_all(source);
  REQUIRE(whole.frames.size() == 3);
  CHECK(whole.info.frames == 3);
  CHECK(whole.info.fps == clip.info.fps);
  for (std::size_t i = 0; i < 3; ++i) CHECK(equal(whole.frames[i], clip.frames[i]));

  source.rewind();
  source.next();
  const core::Clip rest = core::read_all(source);
  REQUIRE(rest.frames.size() == 2);
  CHECK(rest.info.frames == 2);
  CHECK(equal(rest.frames[0], clip.frames[1]));
  CHECK(core::read_all(source).frames.empty());
}

TEST_CASE("A part of a clip is its frames and can be read again") {
  core::Clip clip;
  clip.info.width = 5, clip.info.height = 4, clip.info.depth = CV_8U;
  for (std::uint64_t t = 0; t < 9; ++t) clip.frames.push_back(test::noise_frame({5, 4}, CV_8UC1, t));
  core::ClipSource source(clip);
  core::ClipRange part(source, 2, 6);
  for (int round = 0; round < 2; ++round) {
    const auto read = core::read_all(part);
    REQUIRE(read.frames.size() == 4);
    for (std::size_t t = 0; t < 4; ++t) CHECK(test::same_pixels(read.frames[t], clip.frames[t + 2]));
    part.rewind();
  }
  CHECK(part.info().frames == 4);
}
