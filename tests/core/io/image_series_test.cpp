// SPDX-License-Identifier: Apache-2.0
#include "core/io/reading/image_series.hpp"

#include <functional>
#include <string>
#include <vector>

#include <opencv2/imgcodecs.hpp>
#include <zlib.h>

#include "core/error.hpp"
#include "core/io/clip_reader.hpp"
#include "core/io/reading/animated_image.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/clip_fixture.hpp"
#include "tests/support/messages.hpp"
#include "tests/support/tiff_writer.hpp"

using namespace emberfold;
using namespace emberfold::test;

namespace {

core::Clip read(const fs::path& path, const io::ReadOptions& options = {}) {
  return core::read_all(*io::open_video(path.string(), options));
}

std::vector<fs::path> names(const std::vector<std::string>& heads, int count, const std::string& tail) {
  std::vector<fs::path> found;
  for (const auto& head : heads)
    for (int i = 0; i < count; ++i) {
      std::string name = "dir/";
      name.append(head).append(std::to_string(i)).append(tail);
      found.emplace_back(name);
    }
  return found;
}

std::string refusal(const std::vector<fs::path>& files) {
  try {
    io::refuse_several_series(files);
    return {};
  } catch (const core::InputError& error) {
    return error.what();
  }
}

std::string big_endian(std::uint32_t value) {
  std::string text;
  for (int shift = 24; shift >= 0; shift -= 8) text += static_cast<char>(value >> shift & 0xFFU);
  return text;
}

std::string chunk(const std::string& name, const std::string& data) {
  const std::string body = name + data;
  const auto sum = ::crc32(0, reinterpret_cast<const Bytef*>(body.data()), static_cast<uInt>(body.size()));
  return big_endian(static_cast<std::uint32_t>(data.size())) + body +
         big_endian(static_cast<std::uint32_t>(sum));
}

/// The pixels of a PNG as OpenCV compresses them, without the heads.
std::string packed_pixels(const std::string& png) {
  std::string data;
  for (std::size_t at = 8; at + 12 <= png.size();) {
    std::size_t length = 0;
    for (std::size_t i = 0; i < 4; ++i) length = length << 8 | static_cast<std::uint8_t>(png[at + i]);
    if (png.compare(at + 4, 4, "IDAT") == 0) data += png.substr(at + 8, length);
    at += length + 12;
  }
  return data;
}

/// Writes an animated PNG, 10 frames a second, as its specification lays it out.
void write_apng(const fs::path& path, const std::vector<cv::Mat>& frames) {
  std::string text;
  std::uint32_t number = 0;
  for (const auto& frame : frames) {
    std::vector<std::uint8_t> bytes;
    cv::imencode(".png", frame, bytes);
    const std::string png(bytes.begin(), bytes.end());
    if (text.empty())
      text = png.substr(0, 33) +
             chunk("acTL", big_endian(static_cast<std::uint32_t>(frames.size())) + big_endian(0));
    const std::string no_offset(8, '\0');
    text += chunk("fcTL", big_endian(number++) + big_endian(static_cast<std::uint32_t>(frame.cols)) +
                              big_endian(static_cast<std::uint32_t>(frame.rows)) + no_offset +
                              std::string("\0\1\0\x0A\0\0", 6));
    text += frame.data == frames.front().data ? chunk("IDAT", packed_pixels(png))
                                              : chunk("fdAT", big_endian(number++) + packed_pixels(png));
  }
  std::ofstream(path, std::ios::binary) << text + chunk("IEND", "");
}

}  // namespace

TEST_CASE("two series of images in one folder are refused by their patterns") {
  const std::string both = refusal(names({"a_", "b_"}, 26, ".png"));
  CHECK(contains(both, "a_*.png (26 files), b_*.png (26 files)"));
  CHECK(contains(both, "'dir/a_*.png'"));
  CHECK(refusal(names({"img"}, 12, ".png")).empty());
  auto strangers = names({"img"}, 25, ".png");
  strangers.emplace_back("dir/preview.jpg");
  strangers.emplace_back("dir/overview1.jpg");
  CHECK(refusal(strangers).empty());
  CHECK(refusal(names({"2024-01-01 at 1.", "2024-01-01 at 2."}, 8, ".png")).empty());
  CHECK(refusal({"3fa9.png", "b2c1.png", "77d0.png", "b8c4.png", "e1.png", "f9ae.png", "d3f.png"}).empty());

  CHECK(contains(io::repeated_numbers(names({"img_c0_", "img_c1_"}, 9, ".png")),
                 "the numbers 0 to 8 occur in 2 series of images, of which the first is img_c0_*.png"));
  CHECK(io::repeated_numbers(names({"img"}, 12, ".png")).empty());
  CHECK(io::repeated_numbers({"1.58.png", "1.59.png", "2.0.png", "2.1.png"}).empty());

  const TempFolder temp;
  for (const std::string name : {"a_0.png", "a_1.png", "b_0.png", "b_1.png"})
    cv::imwrite((temp / name).string(), cv::Mat(8, 8, CV_8UC1, cv::Scalar(name[0] == 'a' ? 20 : 40)));
  CHECK_THROWS_AS(read(temp.path()), core::InputError);
  CHECK(read(temp / "b_*.png").frames.size() == 2);
}

TEST_CASE("--channel of a clip that is grey is refused") {
  const TempFolder temp;
  const std::vector<cv::Mat> pages(2, cv::Mat(8, 8, CV_16UC1, cv::Scalar(300)));
  write_tiff(temp / "grey.tif", pages);
  cv::imwrite((temp / "grey.png").string(), cv::Mat(8, 8, CV_8UC1, cv::Scalar(30)));
  write_tiff(temp / "two.tif", pages, {"ImageJ=1.54f\nimages=2\nchannels=2\n"});
  io::ReadOptions options;
  options.channel = 1;
  for (const char* name : {"grey.tif", "grey.png"}) {
    const auto message = message_of<core::InputError>([&] { read(temp / name, options); });
    CHECK(contains(message, std::string("channel 1 of ") + (temp / name).string()));
    CHECK(contains(message, "grey"));
  }
  CHECK(read(temp / "two.tif", options).frames.size() == 1);
}

TEST_CASE("an animated PNG is read frame by frame, an animated WebP is called what it is") {
  const TempFolder temp;
  std::vector<cv::Mat> frames;
  for (std::uint64_t t = 0; t < 5; ++t) frames.push_back(noise_frame({16, 12}, CV_8UC1, t + 1));
  write_apng(temp / "moving.png", frames);
  CHECK(io::read_animation(temp / "moving.png").frames == 5);
  const auto clip = read(temp / "moving.png");
  REQUIRE(clip.frames.size() == 5);
  CHECK(clip.info.fps == Approx(10));
  for (std::size_t t = 0; t < 5; ++t) {
    cv::Mat grey;
    cv::extractChannel(clip.frames[t], grey, 0);
    CHECK(same_pixels(grey, frames[t]));
  }
  cv::imwrite((temp / "still.png").string(), frames[0]);
  CHECK(io::read_animation(temp / "still.png").kind == io::Animation::Kind::none);

  std::string webp = "WEBP";
  for (const std::string name : {"VP8X", "ANIM", "ANMF", "ANMF", "ANMF"})
    webp += name + std::string("\5\0\0\0abcde\0", 10);
  std::ofstream(temp / "moving.webp", std::ios::binary) << "RIFF" << std::string("\x50\0\0\0", 4) << webp;
  const auto message = message_of<core::IoError>([&] { read(temp / "moving.webp"); });
  CHECK(contains(message, "animated WebP of 3 frames"));
  CHECK(contains(message, "convert it"));
}
