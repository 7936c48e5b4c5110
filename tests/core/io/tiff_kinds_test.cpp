// SPDX-License-Identifier: Apache-2.0
// TIFF files whose numbers mean something else than brightness from black: palettes, inverted values, planes,
// samples and alpha; pages in tifffile's and MetaMorph's order; files that end early.
#include <algorithm>
#include <fstream>

#include <opencv2/imgproc.hpp>

#include "core/error.hpp"
#include "core/io/clip_reader.hpp"
#include "core/io/image_files.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/clip_fixture.hpp"
#include "tests/support/messages.hpp"
#include "tests/support/tiff_writer.hpp"

using namespace emberfold;
using namespace emberfold::test;

namespace {

struct WarnedClip {
  core::Clip clip;
  std::vector<std::string> warnings;
  [[nodiscard]] std::ptrdiff_t mentions(const std::string& words) const {
    return std::ranges::count_if(warnings, [&](const auto& line) { return contains(line, words); });
  }
};

WarnedClip read_warned(const fs::path& path, const io::ReadOptions& options = {}) {
  WarnedClip found;
  found.clip = core::read_all(*io::open_video(
      path.string(), options, [&](const std::string& line) { found.warnings.push_back(line); }));
  return found;
}

WarnedClip read_channel(const fs::path& path, int channel) {
  io::ReadOptions options;
  options.channel = channel;
  return read_warned(path, options);
}

std::string refused(const fs::path& path, const io::ReadOptions& options = {}) {
  return message_of<std::exception>([&] { read_warned(path, options); });
}

cv::Mat noise(int type, std::uint64_t seed) {
  if (CV_MAT_DEPTH(type) != CV_32F) return noise_frame({7, 5}, type, seed, type == CV_8U ? 256 : 65536);
  cv::Mat frame;
  noise_frame({7, 5}, CV_16UC(CV_MAT_CN(type)), seed, 65536).convertTo(frame, CV_32F, 1. / 65535);
  return frame;
}

std::vector<cv::Mat> noises(int type, int count) {
  std::vector<cv::Mat> frames;
  for (int i = 0; i < count; ++i) frames.push_back(noise(type, static_cast<std::uint64_t>(i) + 1));
  return frames;
}

void expect_frames(const core::Clip& clip, const std::vector<cv::Mat>& frames) {
  REQUIRE(clip.frames.size() == frames.size());
  for (std::size_t i = 0; i < frames.size(); ++i) CHECK(same_pixels(clip.frames[i], frames[i]));
}

/// Samples in their order of the file, red first.
std::vector<cv::Mat> joined(const std::vector<std::vector<cv::Mat>>& samples) {
  std::vector<cv::Mat> pages(samples[0].size());
  for (std::size_t i = 0; i < pages.size(); ++i) {
    std::vector<cv::Mat> page;
    for (const auto& sample : samples) page.push_back(sample[i]);
    cv::merge(page, pages[i]);
  }
  return pages;
}

/// Frames in blue, green, red from pages in red, green, blue and what follows.
std::vector<cv::Mat> colours(const std::vector<cv::Mat>& pages) {
  std::vector<cv::Mat> frames;
  for (const auto& page : pages) {
    std::vector<cv::Mat> samples;
    cv::split(page, samples);
    frames.emplace_back();
    cv::merge(std::vector{samples[2], samples[1], samples[0]}, frames.back());
  }
  return frames;
}

TiffHead head_of(std::uint64_t photometric, bool separate = false, std::vector<std::uint64_t> extra = {}) {
  TiffHead head;
  head.photometric = photometric, head.separate = separate, head.extra = std::move(extra);
  return head;
}

std::string shaped(const std::string& shape, const std::string& axes = "") {
  return R"({"shape": [)" + shape + "]" + (axes.empty() ? "" : R"(, "axes": ")" + axes + '"') + "}";
}

/// The number that a page of one value has.
std::vector<int> values(const core::Clip& clip) {
  std::vector<int> found;
  for (const auto& frame : clip.frames) found.push_back(frame.at<std::uint16_t>(0, 0));
  return found;
}

std::vector<cv::Mat> numbered(int count) {
  std::vector<cv::Mat> pages;
  for (int i = 0; i < count; ++i) pages.emplace_back(5, 7, CV_16UC1, cv::Scalar(1000 + i));
  return pages;
}

}  // namespace

TEST_CASE("a palette is not applied: the stored values are read, with a note") {
  const TempFolder temp;
  const auto frames = noises(CV_8UC1, 3);
  for (const int count : {3, 1}) {
    const std::vector pages(frames.begin(), frames.begin() + count);
    write_tiff(temp / "lut.tif", pages, head_of(3));
    const auto found = read_warned(temp / "lut.tif");
    expect_frames(found.clip, pages);
    CHECK(found.mentions("palette") == 1);
  }
  CHECK(io::read_image(temp / "lut.tif").notes.size() == 1);
}

TEST_CASE("where 0 is white, values are inverted at every depth, with one note") {
  const TempFolder temp;
  const auto path = temp / "white.tif";
  for (const auto& [type, white] : {std::pair{CV_8UC1, 255.0}, {CV_16UC1, 65535.0}, {CV_32FC1, 1.0}})
    for (const bool big_endian : {false, true})
      for (const bool one_head : {false, true}) {
        const auto stored = noises(type, 3);
        TiffHead head = head_of(0);
        head.big_endian = big_endian, head.one_head = one_head;
        head.description = "ImageJ=1.54f\nimages=3\n";
        write_tiff(path, stored, head);
        const auto found = read_warned(path);
        std::vector<cv::Mat> bright;
        for (const auto& page : stored) bright.emplace_back(cv::Mat(cv::Scalar(white) - page));
        expect_frames(found.clip, bright);
        CHECK(found.mentions("0 is white") == 1);
      }
  // a part of the bits
  for (const int depth : {CV_16U, CV_32F}) {
    const cv::Mat stored(5, 7, depth, cv::Scalar(3000));
    write_tiff(path, {stored, stored}, head_of(0));
    expect_frames(read_warned(path).clip, {cv::Mat(4095 - stored), cv::Mat(4095 - stored)});
  }
}

TEST_CASE("samples in separate planes are those of pixels stored together") {
  const TempFolder temp;
  const auto path = temp / "rgb.tif";
  for (const int type : {CV_8UC3, CV_16UC3, CV_32FC3})
    for (const bool big_endian : {false, true})
      for (const bool separate : {false, true}) {
        const auto pages = noises(type, 3);
        TiffHead head = head_of(2, separate);
        head.big_endian = big_endian;
        head.description = shaped("3, 3, 5, 7");
        write_tiff(path, pages, head);
        const auto found = read_warned(path);
        expect_frames(found.clip, colours(pages));
        CHECK(found.mentions("planes") == 0);
      }
}

TEST_CASE("planes of one page that its head lists as pages are frames") {
  const TempFolder temp;
  const auto path = temp / "three.tif";
  for (const int type : {CV_8UC1, CV_16UC1})
    for (const int count : {3, 4}) {
      const auto frames = noises(type, count);
      std::vector<std::vector<cv::Mat>> samples;
      for (const auto& frame : frames) samples.push_back({frame});
      TiffHead head = head_of(2, true, std::vector<std::uint64_t>(count == 4 ? 1 : 0, 2));
      head.description = shaped(std::to_string(count) + ", 5, 7");
      write_tiff(path, joined(samples), head);
      const auto found = read_warned(path);
      expect_frames(found.clip, frames);
      CHECK(found.mentions(std::to_string(count) + " separate planes of") == 1);
      CHECK(found.mentions("alpha") == 0);
      CHECK(io::read_image(path).pages == count);
      // with their axes they are channels
      head.description = shaped(std::to_string(count) + ", 5, 7", "CYX");
      write_tiff(path, joined(samples), head);
      expect_frames(read_channel(path, 1).clip, {frames[1]});
    }
  // a picture in colour, by its head
  const auto pages = noises(CV_16UC3, 1);
  write_tiff(path, pages, head_of(2, true));
  const auto found = read_warned(path);
  expect_frames(found.clip, colours(pages));
  CHECK(found.mentions("3 separate planes of 16 bits are taken as the colours") == 1);
  TiffHead untagged = head_of(2, true);
  untagged.without_photometric = true;
  write_tiff(path, pages, untagged);
  CHECK(read_warned(path).mentions("separate planes") == 1);
}

TEST_CASE("several grey samples a pixel are channels of their own") {
  const TempFolder temp;
  const auto path = temp / "samples.tif";
  for (const int type : {CV_8UC1, CV_16UC1, CV_32FC1})
    for (const bool separate : {false, true}) {
      const auto first = noises(type, 3);
      auto second = noises(type, 6);
      second.erase(second.begin(), second.begin() + 3);
      write_tiff(path, joined({first, second}), head_of(1, separate, {0}));
      const auto usual = read_warned(path);
      expect_frames(usual.clip, first);
      CHECK(usual.mentions("2 channels, of which the first") == 1);
      expect_frames(read_channel(path, 0).clip, first);
      const auto chosen = read_channel(path, 1);
      expect_frames(chosen.clip, second);
      CHECK(chosen.mentions("channels") == 0);
      io::ReadOptions options;
      options.channel = 2;
      CHECK(contains(refused(path, options), "channel 2 is out of range: 0 to 1"));
    }
  // a file a frame
  fs::create_directory(temp / "frames");
  const auto first = noises(CV_16UC1, 2);
  const std::vector second{first[1], first[0]};
  const auto pages = joined({first, second});
  for (std::size_t i = 0; i < 2; ++i)
    write_tiff(temp / "frames" / ("f" + std::to_string(i) + ".tif"), {pages[i]}, head_of(1, false, {0}));
  expect_frames(read_channel(temp / "frames", 1).clip, second);
  CHECK(read_warned(temp / "frames").mentions("2 channels") == 1);
}

TEST_CASE("alpha is dropped and never multiplied in") {
  const TempFolder temp;
  const auto path = temp / "alpha.tif";
  for (const int type : {CV_8UC4, CV_16UC4, CV_32FC4})
    for (const std::uint64_t kind : {0, 1, 2}) {
      const auto pages = noises(type, 2);
      write_tiff(path, pages, head_of(2, false, {kind}));
      const auto found = read_warned(path);
      expect_frames(found.clip, colours(pages));
      CHECK(found.mentions(kind == 0 ? "--channel 3 reads the next" : "alpha channel is dropped") == 1);
      cv::Mat last;
      cv::extractChannel(pages[1], last, 3);
      CHECK(same_pixels(read_channel(path, 3).clip.frames.at(1), last));
    }
  // grey
  const auto grey = noises(CV_16UC1, 2);
  write_tiff(path, joined({grey, {grey[1], grey[0]}}), head_of(1, false, {2}));
  const auto found = read_warned(path);
  expect_frames(found.clip, grey);
  CHECK(found.mentions("alpha channel is dropped") == 1);
  CHECK(found.mentions("channels") == 0);
}

TEST_CASE("axes in tifffile's description are honoured") {
  const TempFolder temp;
  const auto path = temp / "axes.tif";
  const auto read_as = [&](int pages, const std::string& shape, const std::string& axes, int channel = -1,
                           int slice = -1) {
    TiffHead head;
    head.description = shaped(shape + ", 5, 7", axes);
    write_tiff(path, numbered(pages), head);
    io::ReadOptions options;
    if (channel >= 0) options.channel = channel;
    if (slice >= 0) options.slice = slice;
    return read_warned(path, options);
  };
  const std::vector even{1000, 1002, 1004}, odd{1001, 1003, 1005}, first{1000, 1001, 1002},
      last{1003, 1004, 1005};
  const auto usual = read_as(6, "3, 2", "TCYX");
  CHECK(values(usual.clip) == even);
  CHECK(usual.mentions("2 channels, of which the first") == 1);
  CHECK(values(read_as(6, "3, 2", "TCYX", 1).clip) == odd);
  CHECK(values(read_as(6, "3, 2", "TZYX", -1, 1).clip) == odd);
  CHECK(read_as(6, "3, 2", "TZYX").mentions("2 slices, of which the middle one") == 1);
  CHECK(values(read_as(6, "2, 3", "CTYX").clip) == first);
  CHECK(values(read_as(6, "2, 3", "CTYX", 1).clip) == last);
  CHECK(values(read_as(6, "2, 3", "ZTYX", -1, 0).clip) == first);
  CHECK(values(read_as(12, "3, 2, 2", "TZCYX", 1, 0).clip) == std::vector{1001, 1005, 1009});
  CHECK(values(read_as(6, "1, 3, 2", "ZTCYX", 1).clip) == odd);
  CHECK(values(read_as(6, "3, 2", "QCYX", 1).clip) == odd);  // an axis of another name is time
  CHECK(values(read_as(6, "2", "CYX", 1).clip) == odd);      // one series after the other
  CHECK(values(read_as(3, "3", "ZYX").clip) == first);
  CHECK(read_as(3, "3", "ZYX").mentions("slices by its head") == 1);
  CHECK(read_as(6, "6", "").mentions("pages") == 0);
  CHECK(read_as(6, "3, 2", "").mentions("3 x 2 pages without naming these axes") == 1);
  CHECK(read_as(7, "3, 2", "TCYX").mentions("3 x 2 pages, which are not the 7") == 1);
  const auto message = message_of<core::IoError>([&] { read_as(6, "3, 2", "TRYX"); });
  CHECK(contains(message, "axis \"R\" of size 2"));
  CHECK(contains(message_of<core::IoError>([&] { read_as(6, "3, 2", "CCYX"); }), "axis \"C\""));
  // channels that are the samples of each pixel
  TiffHead head = head_of(1, false, {0});
  head.description = shaped("3, 5, 7, 2", "TYXC");
  const auto pages = numbered(6);
  write_tiff(path, joined({{pages[0], pages[1], pages[2]}, {pages[3], pages[4], pages[5]}}), head);
  CHECK(values(read_channel(path, 1).clip) == last);
  // no description of axes
  for (const char* text :
       {"{", "{}", "{\"shape\": 3}", "{\"shape\": [-3, 5, 7]}", "{\"shape\": [], \"axes\": 1}",
        "{\"shape\": [9000000000, 9000000000, 9000000000, 5, 7], \"axes\": \"TCZYX\"}"}) {
    write_tiff(path, numbered(3), {text});
    CHECK(values(read_warned(path).clip) == first);
  }
}

TEST_CASE("a MetaMorph stack has one head and all its pictures") {
  const TempFolder temp;
  const auto frames = noises(CV_16UC1, 5);
  for (const bool big_endian : {false, true}) {
    TiffHead head;
    head.stacked = 5, head.one_head = true, head.big_endian = big_endian;
    write_tiff(temp / "clip.stk", frames, head);
    expect_frames(read_warned(temp / "clip.stk").clip, frames);
    head.stack_ms = {100, 600, 1100, 1600, 2100};
    write_tiff(temp / "clip.stk", frames, head);
    const auto even = read_warned(temp / "clip.stk").clip.info;
    CHECK(even.fps == Approx(2));
    CHECK(even.times.empty());
    head.stack_ms = {100, 600, 1100, 3100, 3600};
    write_tiff(temp / "clip.stk", frames, head);
    const auto uneven = read_warned(temp / "clip.stk").clip.info;
    REQUIRE(uneven.times.size() == 5);
    CHECK(uneven.times[2] == Approx(1));
    CHECK(uneven.times[3] == Approx(3));
    CHECK(uneven.fps == Approx(4 / 3.5));
  }
}

TEST_CASE("of a TIFF that ends early the whole frames are read, and the missing ones are counted") {
  const TempFolder temp;
  const auto path = temp / "cut.tif";
  const std::size_t page = 5 * 7 * 2;
  const auto cut = [&](const std::string& description, int pages, std::size_t lost) {
    TiffHead head;
    head.description = description, head.heads_are_lost = true;
    write_tiff(path, numbered(pages), head);
    const std::string bytes = bytes_of(path);
    std::ofstream(path, std::ios::binary) << bytes.substr(0, bytes.size() - lost);
    return read_warned(path);
  };
  const std::vector first{1000, 1001, 1002, 1003};
  for (const auto& text : {shaped("6, 5, 7"), std::string("ImageJ=1.54f\nimages=6\nslices=6\n"),
                           std::string("ImageJ=1.54f\nimages=6\n"),
                           std::string(R"(<OME><Image><Pixels SizeT="6"/></Image></OME>)")}) {
    INFO(text);
    CHECK(cut(text, 6, 0).clip.frames.size() == 6);
    const auto found = cut(text, 6, page + 3);
    CHECK(values(found.clip) == first);
    CHECK(found.mentions("4 of its 6 pages are whole and are read, 2 are missing") == 1);
  }
  // frames of several planes
  const std::vector even{1000, 1002};
  for (const auto& text :
       {shaped("4, 2, 5, 7", "TCYX"), std::string("ImageJ=1.54f\nimages=8\nchannels=2\nframes=4\n"),
        std::string(R"(<OME><Image><Pixels DimensionOrder="XYCZT" SizeC="2" SizeT="4"/></Image></OME>)")}) {
    INFO(text);
    const auto found = cut(text, 8, 3 * page);
    CHECK(values(found.clip) == even);
    CHECK(found.mentions("5 of its 8 pages are whole and are read, 3 are missing") == 1);
    CHECK(found.mentions("only 2 of the 4 frames") == 1);
  }
  TiffHead head;
  head.description = "long enough not to fit into its entry";
  head.heads_are_lost = head.description_is_lost = true;
  write_tiff(path, numbered(4), head);
  const std::string bytes = bytes_of(path);
  std::ofstream(path, std::ios::binary) << bytes.substr(0, bytes.size() - page);
  const auto lost = read_warned(path);
  CHECK(values(lost.clip) == std::vector{1000, 1001, 1002});
  CHECK(lost.mentions("3 of its 4 pages are whole") == 1);
  CHECK(lost.mentions("its description is cut off") == 1);
  const auto found = cut(shaped("2, 4, 5, 7", "CTYX"), 8, 3 * page);
  CHECK(values(found.clip) == std::vector{1000});
  CHECK(found.mentions("only 1 of the 4 frames") == 1);
}

TEST_CASE("numbers that are not read are refused by name") {
  const TempFolder temp;
  const auto path = temp / "odd.tif";
  write_tiff(path, noises(CV_16UC3, 2), head_of(6));
  CHECK(contains(refused(path), "colours are of kind 6 with 16 bits"));
  CHECK(contains(refused(path), "odd.tif"));
}
