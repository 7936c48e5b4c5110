// SPDX-License-Identifier: Apache-2.0
#include <fstream>

#include <opencv2/imgcodecs.hpp>

#include "core/error.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/clip_fixture.hpp"
#include "tests/support/messages.hpp"
#include "tests/support/read_clip.hpp"
#include "tests/support/stored_video.hpp"

using namespace emberfold;
using namespace emberfold::test;

namespace {

std::string video_warnings(const fs::path& path) {
  std::string all;
  read_clip(path, {}, [&](const std::string& line) { all += line + "\n"; });
  return all;
}

}  // namespace

TEST_CASE("a video of full range has every level as it was stored, whatever its format says") {
  const TempFolder temp;
  const auto range = GENERATE(AVCOL_RANGE_JPEG, AVCOL_RANGE_MPEG);
  write_stored_video(temp / "clip.mkv", {.format = AV_PIX_FMT_YUV420P, .range = range},
                     [](AVFrame& frame, int) {
                       for (int y = 0; y < 16; ++y)
                         for (int x = 0; x < 32; ++x) set_value(frame, 0, x, y, 8 * x + y % 8);
                       for (const int plane : {1, 2})
                         for (int y = 0; y < 8; ++y)
                           for (int x = 0; x < 16; ++x) set_value(frame, plane, x, y, 128);
                     });
  const core::Clip clip = read_clip(temp / "clip.mkv");
  REQUIRE(clip.frames.size() == 2);
  REQUIRE(clip.info.depth == CV_8U);
  for (int y = 0; y < 16; ++y)
    for (int x = 0; x < 32; ++x) {
      const int stored = 8 * x + y % 8;
      // ITU-R BT.601: limited levels are from 16 to 235.
      const double right =
          range == AVCOL_RANGE_JPEG ? stored : std::clamp((stored - 16) * 255.0 / 219, 0.0, 255.0);
      for (const int c : {0, 1, 2}) CHECK(std::abs(clip.frames[0].at<cv::Vec3b>(y, x)[c] - right) <= 1);
    }
}

TEST_CASE("grey video of more than 8 bits keeps its depth") {
  const TempFolder temp;
  const auto [format, bits] = GENERATE(
      table<AVPixelFormat, int>({{AV_PIX_FMT_GRAY16, 16}, {AV_PIX_FMT_GRAY10, 10}, {AV_PIX_FMT_GRAY12, 12}}));
  const int white = (1 << bits) - 1;
  const auto stored = [&](int x, int y, int t) { return (x * 517 + y * 91 + t * 1001) % (white + 1); };
  write_stored_video(temp / "clip.mkv", {.format = format}, [&](AVFrame& frame, int t) {
    for (int y = 0; y < 16; ++y)
      for (int x = 0; x < 32; ++x) set_value(frame, 0, x, y, stored(x, y, t), true);
  });
  const core::Clip clip = read_clip(temp / "clip.mkv");
  REQUIRE(clip.frames.size() == 2);
  REQUIRE(clip.frames[0].type() == CV_16UC1);
  for (int t = 0; t < 2; ++t)
    for (int y = 0; y < 16; ++y)
      for (int x = 0; x < 32; ++x)
        CHECK(std::abs(clip.frames[static_cast<std::size_t>(t)].at<std::uint16_t>(y, x) * double(white) /
                           65535 -
                       stored(x, y, t)) <= 1);
}

TEST_CASE("colour video of 10 bits is read with 16 bits a channel") {
  const TempFolder temp;
  write_stored_video(temp / "clip.mkv", {.format = AV_PIX_FMT_YUV444P10, .range = AVCOL_RANGE_JPEG},
                     [](AVFrame& frame, int) {
                       for (int y = 0; y < 16; ++y)
                         for (int x = 0; x < 32; ++x) {
                           set_value(frame, 0, x, y, 33 * x, true);
                           set_value(frame, 1, x, y, 512, true);
                           set_value(frame, 2, x, y, 512, true);
                         }
                     });
  const core::Clip clip = read_clip(temp / "clip.mkv");
  REQUIRE(clip.frames[0].type() == CV_16UC3);
  for (int x = 0; x < 32; ++x)
    for (const int c : {0, 1, 2})
      CHECK(std::abs(clip.frames[0].at<cv::Vec<std::uint16_t, 3>>(5, x)[c] - 33 * x * 65535.0 / 1023) <= 130);
}

TEST_CASE("pixels that are not square are warned of, and stay where they are in the file") {
  const TempFolder temp;
  const auto column = [](AVFrame& frame, int) {
    for (int y = 0; y < 48; ++y)
      for (int x = 0; x < 45; ++x) set_value(frame, 0, x, y, x == 12 ? 200 : 20);
  };
  const StoredVideo wide{.width = 45, .height = 48, .aspect = {64, 45}, .times = {0, 40, 80, 120}};
  write_stored_video(temp / "wide.mkv", wide, column);
  CHECK(contains(video_warnings(temp / "wide.mkv"), "its pixels are 64:45 wide to high"));
  const core::Clip clip = read_clip(temp / "wide.mkv");
  REQUIRE(clip.frames[1].size() == cv::Size(45, 48));
  CHECK(clip.frames[1].at<std::uint8_t>(20, 12) > 180);
  CHECK(clip.frames[1].at<std::uint8_t>(20, 11) < 40);
  StoredVideo square = wide;
  square.aspect = {1, 1};
  write_stored_video(temp / "square.mkv", square, column);
  CHECK(video_warnings(temp / "square.mkv").empty());
}

TEST_CASE("each frame of a video has the time of its own time stamp") {
  const TempFolder temp;
  const auto plain = [](AVFrame& frame, int t) {
    for (int y = 0; y < 16; ++y)
      for (int x = 0; x < 32; ++x) set_value(frame, 0, x, y, 10 * t + x);
  };
  write_stored_video(temp / "even.mkv", {.times = {0, 33, 67, 100, 133, 167, 200}}, plain);  // 30 a second
  CHECK(video_warnings(temp / "even.mkv").empty());
  CHECK(read_clip(temp / "even.mkv").info.times.empty());

  const auto path = temp / "uneven.mkv";
  write_stored_video(path, {.times = {80, 113, 146, 179, 279, 379, 479}}, plain);
  CHECK(contains(video_warnings(path), "not evenly spaced in time (0.033 to 0.1 s apart)"));
  const auto close = [](const std::vector<double>& found, const std::vector<double>& expected) {
    REQUIRE(found.size() == expected.size());
    for (std::size_t i = 0; i < found.size(); ++i) CHECK(found[i] == Approx(expected[i]).margin(1e-9));
  };
  const core::Clip clip = read_clip(path);
  CHECK(clip.frames.size() == 7);
  close(clip.info.times, {0, 0.033, 0.066, 0.099, 0.199, 0.299, 0.399});
  CHECK(clip.info.fps == Approx(6 / 0.399));

  io::ReadOptions part;
  part.first = 2, part.every = 2;
  const auto source = read_clip(path, part).info;
  close(source.times, {0.066, 0.199, 0.399});
  CHECK(source.fps == Approx(2 / 0.333));
  CHECK(source.origin.seconds == Approx(0.066));
  CHECK(source.origin.counted_from == "source");
  part.counts_from_part = true;
  const auto own = read_clip(path, part).info;
  close(own.times, {0, 0.133, 0.333});
  CHECK(own.origin == core::ClipOrigin{0, 0, 0, "part"});
  part.fps = 10;  // whatever the file says
  CHECK(read_clip(path, part).info.times.empty());
}

TEST_CASE("a stream whose pictures change their size is refused at the frame where they do") {
  const TempFolder temp;
  std::ofstream file(temp / "clip.mjpeg", std::ios::binary);
  for (int t = 0; t < 6; ++t) {
    std::vector<std::uint8_t> bytes;
    cv::imencode(".jpg", noise_frame(t < 4 ? cv::Size(64, 48) : cv::Size(48, 48), CV_8UC1, 1), bytes);
    file.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  }
  file.close();
  const std::string message = message_of<core::IoError>([&] { read_clip(temp / "clip.mjpeg"); });
  CHECK(contains(message, "frame 4"));
  CHECK(contains(message, "48x48"));
}
