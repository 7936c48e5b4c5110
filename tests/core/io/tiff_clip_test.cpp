// SPDX-License-Identifier: Apache-2.0
#include <fstream>
#include <limits>

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "core/error.hpp"
#include "core/io/clip_reader.hpp"
#include "core/io/image_files.hpp"
#include "core/io/tiff_pages.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/clip_fixture.hpp"
#include "tests/support/messages.hpp"
#include "tests/support/read_clip.hpp"

using namespace emberfold;
using namespace emberfold::test;

namespace {

cv::Mat float_frame(cv::Size size, int channels, std::uint64_t seed, double most = 1) {
  cv::Mat frame;
  noise_frame(size, CV_16UC(channels), seed, 65536).convertTo(frame, CV_32F, most / 65535);
  return frame;
}

std::vector<cv::Mat> write_stack(const fs::path& path, const std::vector<cv::Mat>& pages,
                                 int compression = 1) {
  REQUIRE(cv::imwritemulti(path.string(), pages, {cv::IMWRITE_TIFF_COMPRESSION, compression}));
  return pages;
}

std::vector<cv::Mat> noise_pages(cv::Size size, int type, int count, std::uint32_t limit = 256) {
  std::vector<cv::Mat> pages;
  for (int i = 0; i < count; ++i)
    pages.push_back(CV_MAT_DEPTH(type) == CV_32F
                        ? float_frame(size, CV_MAT_CN(type), static_cast<std::uint64_t>(i) + 1)
                        : noise_frame(size, type, static_cast<std::uint64_t>(i) + 1, limit));
  return pages;
}

void check_frames(const core::Clip& clip, const std::vector<cv::Mat>& pages) {
  REQUIRE(clip.frames.size() == pages.size());
  for (std::size_t i = 0; i < pages.size(); ++i) CHECK(same_pixels(clip.frames[i], pages[i]));
}

std::string refusal(const fs::path& path) {
  return message_of<core::IoError>([&] { read_clip(path); });
}

}  // namespace

TEST_CASE("the pages of a TIFF are the frames of a clip, to the last bit") {
  const TempFolder temp;
  const auto path = temp / "stack.tif";
  for (const int type : {CV_8UC1, CV_8UC3, CV_16UC1, CV_16UC3, CV_32FC1, CV_32FC3})
    for (const int compression : {1, 5}) {  // none, LZW
      INFO("type " << type << ", compression " << compression);
      const auto pages = write_stack(path, noise_pages({13, 7}, type, 9, 1000), compression);
      const auto clip = read_clip(path);
      check_frames(clip, pages);
      const double white = CV_MAT_DEPTH(type) == CV_8U ? 255 : CV_MAT_DEPTH(type) == CV_16U ? 1023 : 1;
      CHECK(clip.info == core::ClipInfo{13, 7, CV_MAT_CN(type), CV_MAT_DEPTH(type), 25, white, 9, false});
    }
}

TEST_CASE("a stack is read from any page, again and again, in grey and scaled") {
  const TempFolder temp;
  const auto pages = write_stack(temp / "stack.tiff", noise_pages({16, 12}, CV_8UC3, 2100));
  io::ReadOptions options;
  options.first = 1020, options.last = 1030;
  const auto source = io::open_video((temp / "stack.tiff").string(), options);
  CHECK(source->info().frames == 10);
  for (int pass = 0; pass < 2; ++pass) {
    const auto part = core::read_all(*source);
    check_frames(part, {pages.begin() + 1020, pages.begin() + 1030});
    source->rewind();
  }
  options.grey = true, options.scale = 0.5;
  const auto small = read_clip(temp / "stack.tiff", options);
  CHECK(small.info.channels == 1);
  CHECK(small.frames.at(9).size() == cv::Size(8, 6));
  io::ReadOptions late;
  late.first = 2100;
  CHECK(message_of<core::InputError>([&] { read_clip(temp / "stack.tiff", late); }).find("2100 frames") !=
        std::string::npos);
}

TEST_CASE("white of floats is 1, or all ones in the bits of the largest value") {
  const TempFolder temp;
  const auto path = temp / "float.tif";
  for (const auto& [most, white] : {std::pair{0.25F, 1.0},
                                    {1.0F, 1.0},
                                    {255.0F, 255.0},
                                    {255.5F, 511.0},
                                    {4095.0F, 4095.0},
                                    {70000.0F, 131071.0}}) {
    std::vector<cv::Mat> pages{cv::Mat(4, 5, CV_32FC1, cv::Scalar(most)),
                               cv::Mat(4, 5, CV_32FC1, cv::Scalar(most > 1 ? -0.5 : 0))};
    write_stack(path, pages);
    const auto clip = read_clip(path);
    CHECK(clip.info.white == white);
    check_frames(clip, pages);
    const cv::Mat levels = core::to_levels(clip.frames[0], clip.info);
    CHECK(levels.at<float>(0, 0) == Approx(double{most} * 255 / white));
  }
  // one page of floats is a clip of one frame, of doubles too
  cv::imwrite(path.string(), float_frame({6, 5}, 1, 3));
  CHECK(read_clip(path).info.depth == CV_32F);
  write_stack(path, {cv::Mat(4, 5, CV_64FC1, cv::Scalar(0.5)), cv::Mat(4, 5, CV_64FC1, cv::Scalar(0.25))});
  CHECK(read_clip(path).frames.at(1).at<float>(3, 4) == 0.25F);
}

TEST_CASE("one page stays one image, and a folder of TIFFs one image a frame") {
  const TempFolder temp;
  fs::create_directory(temp / "frames");
  const auto pages = noise_pages({10, 8}, CV_16UC1, 3, 4096);
  for (std::size_t i = 0; i < 3; ++i)
    cv::imwrite((temp / "frames/f").string() + std::to_string(i) + ".tif", pages[i]);
  check_frames(read_clip(temp / "frames"), pages);
  check_frames(read_clip(temp / "frames/f*.tif"), pages);
  check_frames(read_clip(temp / "frames/f1.tif"), {pages[1]});
  CHECK(io::read_image(temp / "frames/f1.tif").pages == 1);

  // a stack among single images is a clip of its own
  write_stack(temp / "frames/f1.tif", {pages[1], pages[0]});
  for (const char* name : {"frames", "frames/f*.tif"}) {
    const auto message = message_of<core::InputError>([&] { read_clip(temp / name); });
    CHECK(contains(message, "f1.tif is a stack of 2 pages"));
    CHECK(contains(message, "batch"));
  }
}

TEST_CASE("pages that do not fit each other are refused before any is decoded") {
  const TempFolder temp;
  write_stack(temp / "sizes.tif", {noise_frame({8, 8}, CV_8UC1, 1), noise_frame({9, 8}, CV_8UC1, 2)});
  CHECK(contains(refusal(temp / "sizes.tif"), "page 1 is 9x8"));
  write_stack(temp / "kinds.tif", {noise_frame({8, 8}, CV_8UC1, 1), noise_frame({8, 8}, CV_8UC3, 2)});
  CHECK(contains(refusal(temp / "kinds.tif"), "page 1"));
  CHECK(contains(refusal(temp / "kinds.tif"), "kinds.tif"));
}

TEST_CASE(
    "a TIFF that is cut off at any byte, or has any byte changed, is refused or read, and never crashes") {
  // Of a cut file the whole pages are read, with a warning.
  const TempFolder temp;
  for (const int compression : {1, 5}) {
    const auto pages = write_stack(temp / "whole.tif", noise_pages({9, 6}, CV_16UC3, 4, 65536), compression);
    const std::string bytes = bytes_of(temp / "whole.tif");
    const auto path = temp / "hurt.tif";
    const auto put = [&](const std::string& text) { std::ofstream(path, std::ios::binary) << text; };
    for (std::size_t length = 4; length < bytes.size(); ++length) {
      put(bytes.substr(0, length));
      std::string warnings;
      core::Clip clip;
      const auto message = message_of<core::IoError>(
          [&] { clip = read_clip(path, {}, [&](const std::string& line) { warnings += line + '\n'; }); });
      INFO(length << ": " << message << warnings);
      CHECK(message.empty() == contains(warnings, "hurt.tif: it ends early"));
      CHECK((message.empty() || contains(message, "hurt.tif")));
      CHECK_FALSE(contains(message, "\n"));
      check_frames(clip, {pages.begin(), pages.begin() + static_cast<std::ptrdiff_t>(clip.frames.size())});
    }
    core::Rng rng(7);
    for (int i = 0; i < 400; ++i) {
      std::string hurt = bytes;
      hurt[rng.below(static_cast<std::uint32_t>(hurt.size()))] = static_cast<char>(rng.below(256));
      put(hurt);
      const auto message = message_of<std::exception>([&] { read_clip(path); });
      CHECK_FALSE(contains(message, "\n"));
      CHECK((message.empty() || contains(message, "hurt.tif")));
    }
  }
  // pages that follow each other in a circle
  std::string circle("II*\0\x08\0\0\0\0\0\x08\0\0\0", 14);
  std::ofstream(temp / "circle.tif", std::ios::binary) << circle;
  CHECK_FALSE(refusal(temp / "circle.tif").empty());
}

TEST_CASE("the heads of pages tell what is in the file") {
  const TempFolder temp;
  write_stack(temp / "stack.tif", noise_pages({13, 7}, CV_16UC3, 3));
  const auto pages = io::read_tiff_pages(temp / "stack.tif");
  REQUIRE(pages.size() == 3);
  CHECK(pages[2].index == 2);
  CHECK(pages[2].width == 13);
  CHECK(pages[2].height == 7);
  CHECK(pages[2].bits == 16);
  CHECK(pages[2].samples == 3);
  CHECK(pages[2].stored_bytes == 13 * 7 * 6);
  CHECK(io::is_tiff(temp / "stack.tif"));
  std::ofstream(temp / "text.tif") << "II";
  CHECK_FALSE(io::is_tiff(temp / "text.tif"));
}
