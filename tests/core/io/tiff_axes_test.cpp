// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "core/error.hpp"
#include "core/io/clip_reader.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/clip_fixture.hpp"
#include "tests/support/messages.hpp"
#include "tests/support/tiff_writer.hpp"

using namespace emberfold;
using namespace emberfold::test;

namespace {

/// A page whose values tell its frame, slice and channel.
cv::Mat page(int t, int z, int c, int depth = CV_16U) {
  cv::Mat values(5, 6, CV_MAKETYPE(depth, 1), cv::Scalar(3000 + 100 * t + 10 * z + c));
  if (depth == CV_8U) values = cv::Scalar(20 * t + 5 * z + c);
  values.col(0) = cv::Scalar(0);
  return values;
}

struct Read {
  core::Clip clip;
  std::vector<std::string> told;
  [[nodiscard]] std::vector<int> values() const {
    std::vector<int> found;
    for (const auto& frame : clip.frames) {
      double most = 0;
      cv::minMaxLoc(frame, nullptr, &most);
      found.push_back(static_cast<int>(most) - 3000);
    }
    return found;
  }
  [[nodiscard]] int mentions(const std::string& word) const {
    return static_cast<int>(
        std::ranges::count_if(told, [&](const auto& line) { return contains(line, word); }));
  }
};

Read read(const fs::path& path, const io::ReadOptions& options = {}) {
  Read found;
  found.clip = core::read_all(
      *io::open_video(path.string(), options, [&](const std::string& line) { found.told.push_back(line); }));
  return found;
}

std::vector<cv::Mat> hyperstack(int frames, int slices, int channels, const std::string& order = "CZT",
                                int depth = CV_16U) {
  std::vector<cv::Mat> pages;
  const auto size = [&](char axis) { return axis == 'C' ? channels : axis == 'Z' ? slices : frames; };
  for (int k = 0; k < size(order[2]); ++k)
    for (int j = 0; j < size(order[1]); ++j)
      for (int i = 0; i < size(order[0]); ++i) {
        const auto at = [&](char axis) { return axis == order[0] ? i : axis == order[1] ? j : k; };
        pages.push_back(page(at('T'), at('Z'), at('C'), depth));
      }
  return pages;
}

std::string imagej(int images, const std::string& rest) {
  return "ImageJ=1.54f\nimages=" + std::to_string(images) + "\n" + rest;
}

std::string ome(const std::string& pixels, const std::string& inside = "") {
  return R"(<?xml version="1.0" encoding="UTF-8"?><!-- Pixels > here --><OME xmlns="http://x"><Image ID="Image:0"><Pixels ID="P" )" +
         pixels + ">" + inside + "</Pixels></Image></OME>";
}

}  // namespace

TEST_CASE("channels and slices of an ImageJ stack are told apart, in either order of bytes") {
  const TempFolder temp;
  const auto path = temp / "stack.tif";
  for (const bool big_endian : {false, true})
    for (const bool one_head : {false, true}) {
      INFO("big endian " << big_endian << ", one head " << one_head);
      TiffHead head{
          imagej(24, "channels=2\nslices=3\nframes=4\nhyperstack=true\nunit=\\u00B5m\nfinterval=0.5\n")};
      head.across = 200, head.down = 200, head.below = 13;
      head.big_endian = big_endian, head.one_head = one_head;
      write_tiff(path, hyperstack(4, 3, 2), head);
      const auto usual = read(path);
      CHECK(usual.values() == std::vector<int>{10, 110, 210, 310});
      CHECK(usual.mentions("2 channels, of which the first") == 1);
      CHECK(usual.mentions("3 slices, of which the middle one, 1,") == 1);
      CHECK(usual.clip.info.fps == Approx(2));
      CHECK(usual.clip.info.fps_is_known);
      CHECK(usual.clip.info.pixel_um.value() == Approx(0.065));
      io::ReadOptions options;
      options.channel = 1, options.slice = 2;
      const auto chosen = read(path, options);
      CHECK(chosen.values() == std::vector<int>{21, 121, 221, 321});
      CHECK(chosen.told.empty());
      options.slice.reset(), options.brightest_slice = true, options.first = 1, options.every = 2;
      const auto brightest = read(path, options);
      CHECK(brightest.values() == std::vector<int>{121, 321});
      CHECK(brightest.clip.info.fps == Approx(1));
    }
}

TEST_CASE("a stack whose frames are called slices is read as frames, with a word") {
  const TempFolder temp;
  write_tiff(temp / "z.tif", hyperstack(5, 1, 1), {imagej(5, "slices=5\nunit=pixel\n"), 1, 1});
  const auto found = read(temp / "z.tif");
  CHECK(found.values() == std::vector<int>{0, 100, 200, 300, 400});
  CHECK(found.mentions("slices by its head") == 1);
  CHECK_FALSE(found.clip.info.pixel_um.has_value());
  CHECK(found.mentions("frame rate is not known") == 1);
  io::ReadOptions options;
  options.slice = 3;
  CHECK(read(temp / "z.tif", options).values() == std::vector<int>{300});
}

TEST_CASE("an ImageJ head that does not fit the pages is told, and every page is a frame") {
  const TempFolder temp;
  write_tiff(temp / "odd.tif", hyperstack(5, 1, 1), {imagej(5, "channels=2\nframes=4\nfps=10\n")});
  const auto found = read(temp / "odd.tif");
  CHECK(found.clip.frames.size() == 5);
  CHECK(found.mentions("2 channels, 1 slices and 4 frames") == 1);
  CHECK(found.mentions("fps=10") == 1);
}

TEST_CASE("ImageJ's playback speed is no frame rate, and dots an inch are no scale") {
  const TempFolder temp;
  write_tiff(temp / "fps.tif", hyperstack(5, 1, 1), {imagej(5, "frames=5\nfps=7.0\nunit=inch\n"), 72, 72});
  const auto found = read(temp / "fps.tif");
  CHECK_FALSE(found.clip.info.fps_is_known);
  CHECK_FALSE(found.clip.info.pixel_um.has_value());
  CHECK(found.mentions("playback speed (fps=7)") == 1);
  CHECK(found.mentions("72 pixels an inch") == 1);
  write_tiff(temp / "both.tif", hyperstack(5, 1, 1), {imagej(5, "frames=5\nfps=7.0\nfinterval=30\n"), 1, 1});
  const auto both = read(temp / "both.tif");
  CHECK(both.clip.info.fps == Approx(1.0 / 30));
  CHECK(both.mentions("playback") == 0);
}

TEST_CASE("OME stacks are read in any order of their axes") {
  const TempFolder temp;
  const auto path = temp / "stack.ome.tif";
  for (const std::string order : {"CZT", "CTZ", "ZCT", "ZTC", "TCZ", "TZC"})
    for (const bool lists : {false, true}) {
      INFO(order << ", " << lists);
      std::string inside;
      for (int i = 0; lists && i < 12; ++i) {
        const auto size = [](char axis) { return axis == 'C' ? 2 : axis == 'Z' ? 2 : 3; };
        const int a = i % size(order[0]), b = i / size(order[0]) % size(order[1]),
                  c = i / size(order[0]) / size(order[1]);
        const auto at = [&](char axis) {
          return std::to_string(axis == order[0] ? a : axis == order[1] ? b : c);
        };
        inside += "<TiffData FirstC=\"" + at('C') + "\" FirstZ='" + at('Z') + "' FirstT=\"" + at('T') +
                  "\" IFD=\"" + std::to_string(i) + "\"/>";
      }
      write_tiff(path, hyperstack(3, 2, 2, order),
                 {ome("DimensionOrder=\"XY" + order +
                          R"(" SizeC="2" SizeZ="2" SizeT="3" PhysicalSizeX="108" )"
                          R"(PhysicalSizeXUnit="nm" TimeIncrement="250" TimeIncrementUnit="ms")",
                      inside)});
      io::ReadOptions options;
      options.channel = 1, options.slice = 0;
      const auto found = read(path, options);
      CHECK(found.values() == std::vector<int>{1, 101, 201});
      CHECK(found.clip.info.pixel_um.value() == Approx(0.108));
      CHECK(found.clip.info.fps == Approx(4));
      CHECK(found.told.empty());
      options.brightest_slice = true, options.slice.reset();
      CHECK(read(path, options).values() == std::vector<int>{11, 111, 211});
    }
}

TEST_CASE("the interval of an OME stack is from the first slice of a frame to that of the next") {
  const TempFolder temp;
  const auto path = temp / "stack.ome.tif";
  std::string planes;
  for (int t = 0; t < 4; ++t)
    for (int z = 0; z < 2; ++z)
      for (int c = 0; c < 2; ++c)
        planes += "<Plane TheC=\"" + std::to_string(c) + "\" TheZ=\"" + std::to_string(z) + "\" TheT=\"" +
                  std::to_string(t) + "\" DeltaT=\"" + std::to_string(2000 * t + 500 * z + 300 * c) +
                  "\" DeltaTUnit=\"ms\"/>";
  write_tiff(path, hyperstack(4, 2, 2),
             {ome(R"(DimensionOrder="XYCZT" SizeC="2" SizeZ="2" SizeT="4")", planes)});
  io::ReadOptions options;
  options.channel = 0, options.slice = 0;
  const auto found = read(path, options);
  CHECK(found.clip.info.fps == Approx(0.5));
  CHECK(found.mentions("not evenly spaced") == 0);
}

TEST_CASE("an OME stack that ended early, in uneven time or in several files is told") {
  const TempFolder temp;
  const auto path = temp / "stack.ome.tif";
  std::string planes;
  for (int t = 0; t < 5; ++t)
    planes += "<Plane TheC=\"0\" TheZ=\"0\" TheT=\"" + std::to_string(t) + "\" DeltaT=\"" +
              (t == 3 ? "9.5" : std::to_string(2 * t)) + "\"/>";
  write_tiff(path, hyperstack(5, 1, 1),
             {ome(R"(DimensionOrder="XYCZT" SizeC="1" SizeZ="1" SizeT="8")", planes)});
  const auto early = read(path);
  CHECK(early.values() == std::vector<int>{0, 100, 200, 300, 400});
  CHECK(early.mentions("only 5 of the 8 frames") == 1);
  CHECK(early.mentions("not evenly spaced") == 1);
  CHECK(early.clip.info.fps == Approx(0.5));
  write_tiff(
      path, hyperstack(2, 1, 1),
      {ome(
          R"(SizeC="1" SizeZ="1" SizeT="2")",
          R"(<TiffData IFD="0"><UUID FileName="a.tif">x</UUID></TiffData><TiffData><UUID FileName="b.tif"/></TiffData>)")});
  const auto refused = message_of<core::IoError>([&] { read(path); });
  CHECK(contains(refused, "2 files (a.tif"));
  write_tiff(path, hyperstack(2, 1, 1),
             {ome(R"(SizeC="1" SizeZ="1" SizeT="3")",
                  R"(<TiffData IFD="0" FirstT="0"/><TiffData IFD="1" FirstT="2"/>)")});
  CHECK(contains(message_of<core::IoError>([&] { read(path); }), "frame 1 is missing"));
}

TEST_CASE("stacks of 8 bits and floats have axes too, and what they lack is refused by name") {
  const TempFolder temp;
  const auto path = temp / "stack.tif";
  write_tiff(path, hyperstack(3, 1, 2, "CZT", CV_8U), {imagej(6, "channels=2\nframes=3\n")});
  io::ReadOptions options;
  options.channel = 1;
  const auto bytes = read(path, options);
  CHECK(bytes.clip.info.depth == CV_8U);
  CHECK(same_pixels(bytes.clip.frames.at(2), page(2, 0, 1, CV_8U)));
  options.channel = 2;
  CHECK(contains(message_of<core::InputError>([&] { read(path, options); }),
                 "channel 2 is out of range: 0 to 1"));
  options.channel.reset(), options.slice = 0;
  CHECK(contains(message_of<core::InputError>([&] { read(path, options); }), "no slices"));
  write_tiff(path, hyperstack(3, 2, 1, "CZT", CV_32F),
             {imagej(6, "slices=2\nframes=3\n"), 0, 0, 1, true, true});
  options.slice = 2;
  CHECK(contains(message_of<core::InputError>([&] { read(path, options); }),
                 "slice 2 is out of range: 0 to 1"));
  options.slice = 1;
  CHECK(read(path, options).values() == std::vector<int>{10, 110, 210});
}

TEST_CASE("levels are those in use, of the whole format, or given") {
  const TempFolder temp;
  const auto path = temp / "stack.tif";
  std::vector<cv::Mat> pages{cv::Mat(8, 8, CV_16UC1, cv::Scalar(400)),
                             cv::Mat(8, 8, CV_16UC1, cv::Scalar(520))};
  pages[0].col(3) = cv::Scalar(620);
  write_tiff(path, pages);
  const auto usual = read(path);
  CHECK(usual.clip.info.white == 1023);
  CHECK(usual.mentions("frame rate") == 1);
  io::ReadOptions options;
  options.levels = io::parse_levels("400:640");
  const auto given = read(path, options);
  CHECK(given.clip.info.white == 240);
  CHECK(given.clip.frames.at(0).at<std::uint16_t>(0, 3) == 220);
  CHECK(given.clip.frames.at(0).at<std::uint16_t>(0, 0) == 0);
  options.levels = io::parse_levels("full");
  CHECK(read(path, options).clip.info.white == 65535);
  for (auto& frame : pages) frame.convertTo(frame, CV_32F);
  write_tiff(path, pages);
  const auto full = read(path, options);
  CHECK(full.clip.info.white == 220);
  CHECK(full.clip.frames.at(0).at<float>(0, 3) == 220.0F);
  CHECK(read(path).mentions("floats from 400 to 620") == 1);
  // 8 bits are spread
  cv::Mat bytes(8, 8, CV_8UC1, cv::Scalar(110));
  bytes.col(1) = cv::Scalar(70);
  write_tiff(path, {bytes, bytes});
  options.levels = io::parse_levels("50:150");
  const auto spread = read(path, options);
  CHECK(spread.clip.frames.at(0).at<std::uint8_t>(0, 0) == 153);
  CHECK(spread.clip.frames.at(0).at<std::uint8_t>(0, 1) == 51);
  CHECK(spread.clip.info.white == 255);
}

TEST_CASE("a doubtful depth is told once") {
  const TempFolder temp;
  const auto path = temp / "stack.tif";
  const auto told = [&](int low, int high) {
    std::vector<cv::Mat> pages{cv::Mat(8, 8, CV_16UC1, cv::Scalar(low)),
                               cv::Mat(8, 8, CV_16UC1, cv::Scalar(high))};
    write_tiff(path, pages);
    io::ReadOptions options;
    options.fps = 10;
    return read(path, options).told;
  };
  CHECK(told(100, 4000).empty());
  REQUIRE(told(100, 20000).size() == 1);
  CHECK(contains(told(100, 20000)[0], "15 of 16 bits"));
  REQUIRE(told(3900, 4000).size() == 1);
  CHECK(contains(told(3900, 4000)[0], "--levels 3900:4000"));
}
