// SPDX-License-Identifier: Apache-2.0
#include "pipeline/footage/footage.hpp"

#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include <opencv2/core.hpp>

#include "core/error.hpp"
#include "core/io/frame_bytes.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/messages.hpp"

using namespace emberfold;
using namespace emberfold::test;

namespace {

/// Frames of a soft disc that moves on; those in `repeated` show the frame before again.
core::Clip disc(int frames, int channels, const std::vector<int>& repeated = {}) {
  core::Clip clip{{48, 40, channels, CV_8U, 25, 255, frames}, {}};
  int place = 0;
  for (int t = 0; t < frames; ++t) {
    if (std::ranges::find(repeated, t) == repeated.end()) ++place;
    cv::Mat frame(40, 48, CV_8UC(channels));
    for (int y = 0; y < 40; ++y)
      for (int x = 0; x < 48; ++x) {
        const double level = 200 * std::exp(-(std::pow(x - 8 - place, 2) + std::pow(y - 20, 2)) / 40);
        for (int c = 0; c < channels; ++c)
          frame.ptr<std::uint8_t>(y)[x * channels + c] =
              cv::saturate_cast<std::uint8_t>(level * (c + 1) / channels);
      }
    clip.frames.push_back(frame);
  }
  return clip;
}

pipeline::Footage gather(const core::Clip& clip, std::size_t most = pipeline::kMostFootage) {
  core::ClipSource source(clip);
  return pipeline::gather_footage(source, {}, {}, most);
}

double rms(const cv::Mat& a, const cv::Mat& b) {
  return cv::norm(a, b) / std::sqrt(double(a.total()) * a.channels());
}

}  // namespace

TEST_CASE("footage: frames come back through the archive with little loss, colours at full resolution") {
  const int channels = GENERATE(1, 3);
  const auto clip = disc(9, channels);
  core::ModelArchive archive;
  pipeline::add_footage(archive, gather(clip));
  const auto footage = pipeline::read_footage(archive, {48, 40});
  CHECK(footage.channels == channels);
  const auto frames = pipeline::decode(footage);
  REQUIRE(frames.size() == clip.frames.size());
  for (std::size_t t = 0; t < frames.size(); ++t) CHECK(rms(frames[t], clip.frames[t]) < 2);
  core::ModelArchive again;
  pipeline::add_footage(again, footage);
  CHECK(again.arrays == archive.arrays);
}

TEST_CASE("footage: repeated frames are left out, and of a clip without change none") {
  const auto clip = disc(12, 1, {3, 7, 8});
  const auto frames = pipeline::decode(gather(clip));
  REQUIRE(frames.size() == 9);
  CHECK(rms(frames[3], clip.frames[4]) < 2);
  auto still = clip;
  for (auto& frame : still.frames) frame = clip.frames.front().clone();
  CHECK(gather(still).frames.size() == 12);
}

TEST_CASE("footage: no more frames are kept than asked for, and a warning says so") {
  const auto clip = disc(12, 1);
  std::string warned;
  core::ClipSource source(clip);
  const auto footage = pipeline::gather_footage(
      source, {}, core::Context({}, {}, [&](const std::string& text) { warned = text; }),
      std::size_t{5} * 48 * 40);
  CHECK(footage.frames.size() == 5);
  CHECK(warned == "new clips are made of the first 5 frames; 7 more take too much memory");
}

TEST_CASE("footage: arrays that are no frames are refused by name") {
  core::ModelArchive archive;
  pipeline::add_footage(archive, gather(disc(5, 3)));
  CHECK(pipeline::read_footage({}, {48, 40}).empty());
  CHECK_THROWS_AS(pipeline::read_footage(archive, {40, 48}), core::IoError);
  auto& ends = std::get<std::vector<std::int64_t>>(archive.arrays.at("footage_ends").data);
  SECTION("ends beyond the bytes") {
    ++ends.back();
    CHECK(message_of<core::IoError>([&] {
            pipeline::read_footage(archive, {48, 40});
          }) == "motion model: footage_ends.npy does not fit footage.npy");
  }
  SECTION("ends that go back") {
    std::swap(ends[1], ends[2]);
    CHECK_THROWS_AS(pipeline::read_footage(archive, {48, 40}), core::IoError);
  }
  SECTION("no ends") {
    archive.arrays.erase("footage_ends");
    CHECK(message_of<core::IoError>([&] {
            pipeline::read_footage(archive, {48, 40});
          }) == "motion model: footage_ends.npy is missing");
  }
  SECTION("a later frame is broken") {
    auto& bytes = std::get<std::vector<std::uint8_t>>(archive.arrays.at("footage").data);
    std::fill(bytes.begin() + ends[1], bytes.begin() + ends[1] + 40, std::uint8_t{0});
    const auto footage = pipeline::read_footage(archive, {48, 40});
    CHECK(message_of<core::IoError>([&] {
            pipeline::decode(footage);
          }).starts_with("motion model: footage.npy is broken at frame 2"));
  }
}

TEST_CASE("footage: bytes that are no frame are refused") {
  CHECK_THROWS_AS(io::decode_frame({}, {4, 4}, 1), core::IoError);
  CHECK_THROWS_AS(io::decode_frame(std::vector<std::uint8_t>(100, 7), {4, 4}, 1), core::IoError);
}
