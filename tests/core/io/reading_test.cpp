// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <fstream>
#include <thread>

#include <opencv2/imgcodecs.hpp>
#include <sys/stat.h>

#include "core/error.hpp"
#include "core/io/clip_reader.hpp"
#include "core/io/clip_writer.hpp"
#include "core/io/reading/missing_numbers.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/clip_fixture.hpp"
#include "tests/support/messages.hpp"
#include "tests/support/tiff_writer.hpp"

using namespace emberfold;
using namespace emberfold::test;

namespace {

void write_clip(const fs::path& path, int frames, bool colour = false, double fps = 25) {
  const auto writer = io::create_video(path, {32, 24}, fps, colour);
  for (int t = 0; t < frames; ++t)
    writer->write(noise_frame({32, 24}, colour ? CV_8UC3 : CV_8UC1, static_cast<std::uint64_t>(t) + 1));
  writer->finish();
}

struct Read {
  core::Clip clip;
  std::vector<std::string> told;
};

Read read(const fs::path& path, const io::ReadOptions& options = {}) {
  Read found;
  found.clip = core::read_all(
      *io::open_video(path.string(), options, [&](const std::string& line) { found.told.push_back(line); }));
  return found;
}

std::uint32_t number_at(const std::string& bytes, std::size_t at) {
  std::uint32_t value = 0;
  for (std::size_t i = 0; i < 4; ++i) value = value << 8 | static_cast<std::uint8_t>(bytes[at + i]);
  return value;
}

std::string digits(std::uint32_t value) {
  std::string text;
  for (int i = 3; i >= 0; --i) text += static_cast<char>(value >> (8 * i) & 0xFFU);
  return text;
}

/// Makes the frame `late` of an MP4 come three intervals after the one before: the table of times gets more
/// runs, and every box around it grows. The pixels lie before it and stay where they are.
void make_uneven(const fs::path& path, std::uint32_t late) {
  std::string bytes = bytes_of(path);
  const auto table = bytes.find("stts");
  REQUIRE(table != std::string::npos);
  REQUIRE(number_at(bytes, table + 8) == 1);
  const std::uint32_t count = number_at(bytes, table + 12), step = number_at(bytes, table + 16);
  const std::string runs = digits(3) + digits(late) + digits(step) + digits(1) + digits(3 * step) +
                           digits(count - late - 1) + digits(step);
  const auto grown = static_cast<std::uint32_t>(runs.size() - 12);
  bytes.replace(table + 8, 12, runs);
  for (const char* box : {"moov", "trak", "mdia", "minf", "stbl", "stts"}) {
    const auto at = bytes.find(box);
    REQUIRE(at != std::string::npos);
    bytes.replace(at - 4, 4, digits(number_at(bytes, at - 4) + grown));
  }
  if (const auto edits = bytes.find("edts"); edits != std::string::npos) bytes.replace(edits, 4, "free");
  std::ofstream(path, std::ios::binary) << bytes;
}

}  // namespace

TEST_CASE("numbers that are missing among images are told") {
  const auto words = [](const std::vector<std::string>& names) {
    std::vector<fs::path> files;
    for (const auto& name : names) files.emplace_back("frames/" + name);
    return io::missing_numbers(files);
  };
  CHECK(words({"a1.png", "a2.png", "a3.png"}).empty());
  CHECK(words({"a02.png", "a04.png", "a06.png"}).empty());  // every second one
  CHECK(words({"a.png", "b.png"}).empty());
  CHECK(words({"a1.png"}).empty());
  CHECK(words({"a1.png", "b3.png", "b4.png"}).empty());  // two sequences
  CHECK(contains(words({"a1.png", "a2.png", "a5.png", "a6.png"}), "2 numbers are missing"));
  CHECK(contains(words({"a1.png", "a2.png", "a5.png", "a6.png"}), "between a2.png and a5.png"));
  CHECK(contains(words({"a1_x.png", "a2_x.png", "a4_x.png"}), "1 number is missing"));
  CHECK(contains(words({"a01.png", "a03.png", "a05.png", "a11.png"}), "2 numbers are missing"));
  CHECK(
      contains(words({"a1.png", "a2.png", "a5.png"}), "2 numbers are missing"));  // of 1 and 3 the usual is 1
  CHECK(contains(words({"a1.png", "a4.png", "a7.png", "a9.png", "a16.png"}), "2 numbers are missing"));
  CHECK(words({"9999999999999999999999.png", "a2.png"}).empty());
}

TEST_CASE("gaps in a folder and a rate that nothing tells are told once each") {
  const TempFolder temp;
  write_clip(temp / "frames", 6);
  fs::remove(temp / "frames/frame_00003.png");
  const auto found = read(temp / "frames");
  REQUIRE(found.told.size() == 2);
  CHECK(contains(found.told[0], "missing"));
  CHECK(contains(found.told[1], "--fps"));
  CHECK_FALSE(found.clip.info.fps_is_known);
  io::ReadOptions options;
  options.fps = 0.2, options.pixel_size = 6.5, options.scale = 0.5;
  const auto told = read(temp / "frames", options);
  CHECK(told.told.size() == 1);
  CHECK(told.clip.info.fps == Approx(0.2));
  CHECK(told.clip.info.fps_is_known);
  CHECK(told.clip.info.pixel_um.value() == Approx(13));
}

TEST_CASE("a video whose frames come at uneven times is told once, one at even times not at all") {
  const TempFolder temp;
  for (const double fps : {25.0, 29.97, 12.5, 100.0}) {
    write_clip(temp / "even.mp4", 40, false, fps);
    const auto even = read(temp / "even.mp4");
    INFO(fps);
    CHECK(even.clip.frames.size() == 40);
    CHECK(even.told.empty());
    write_clip(temp / "even.avi", 40, false, fps);
    CHECK(read(temp / "even.avi").told.empty());
  }
  write_clip(temp / "uneven.mp4", 40);
  make_uneven(temp / "uneven.mp4", 17);
  const auto source = read(temp / "uneven.mp4");
  CHECK(source.clip.frames.size() == 40);
  REQUIRE(source.told.size() == 1);
  CHECK(contains(source.told[0], "not evenly spaced"));
  REQUIRE(source.clip.info.times.size() == 40);
  CHECK(source.clip.info.times[17] == Approx(0.68));
  CHECK(source.clip.info.times[18] == Approx(0.80));
  CHECK(source.clip.info.times[39] == Approx(1.64));
}

TEST_CASE("a part of a clip knows where and when it begins in the source") {
  const TempFolder temp;
  write_clip(temp / "clip.avi", 11);
  io::ReadOptions options;
  const auto origin = [&] { return io::open_video((temp / "clip.avi").string(), options)->info().origin; };
  CHECK(origin() == core::ClipOrigin{});
  options.first = 5, options.every = 2, options.scale = 0.5;
  CHECK(origin() == core::ClipOrigin{0, 0, 0.2, "source"});
  options.region = io::parse_region("8,6,20,10");
  CHECK(origin() == core::ClipOrigin{4, 3, 0.2, "source"});
  options.fps = 10;
  CHECK(origin() == core::ClipOrigin{4, 3, 0.5, "source"});
  options.counts_from_part = true;
  CHECK(origin() == core::ClipOrigin{0, 0, 0, "part"});
}

TEST_CASE("every n-th frame, a region and one colour are those of the whole clip") {
  const TempFolder temp;
  write_clip(temp / "clip.avi", 11, true);
  write_clip(temp / "frames", 11, true);
  const auto whole = read(temp / "clip.avi").clip;
  for (const char* name : {"clip.avi", "frames"}) {
    io::ReadOptions options;
    options.first = 2, options.last = 10, options.every = 3, options.region = io::parse_region("5,6,20,10");
    options.fps = 30;
    const auto source = io::open_video((temp / name).string(), options);
    CHECK(source->info().frames == 3);
    CHECK(source->info().fps == Approx(10));
    for (int pass = 0; pass < 2; ++pass) {
      const auto part = core::read_all(*source);
      REQUIRE(part.frames.size() == 3);
      for (std::size_t i = 0; i < 3; ++i)
        CHECK(same_pixels(part.frames[i], whole.frames[2 + 3 * i](cv::Rect(5, 6, 20, 10))));
      source->rewind();
    }
    options.channel = 0;  // red, which comes last
    cv::Mat red;
    cv::extractChannel(whole.frames[2](cv::Rect(5, 6, 20, 10)), red, 2);
    CHECK(same_pixels(read(temp / name, options).clip.frames.at(0), red));
    options.grey = true;
    CHECK(same_pixels(read(temp / name, options).clip.frames.at(0), red));
    options.channel = 3;
    CHECK(contains(message_of<core::InputError>([&] { read(temp / name, options); }), "channel 3"));
    options.channel.reset(), options.region = io::parse_region("20,0,13,24");
    CHECK(contains(message_of<core::InputError>([&] { read(temp / name, options); }), "32x24"));
    options.region.reset(), options.slice = 1;
    CHECK(contains(message_of<core::InputError>([&] { read(temp / name, options); }), "no slices"));
  }
}

TEST_CASE("what comes through a pipe is read like the file, and its temporary copy leaves nothing") {
  const TempFolder temp;
  write_clip(temp / "clip.avi", 7, true);
  write_clip(temp / "clip.mp4", 7, true);
  write_tiff(temp / "stack.tif",
             {noise_frame({9, 8}, CV_16UC1, 1, 4096), noise_frame({9, 8}, CV_16UC1, 2, 4096)});
  cv::imwrite((temp / "one.png").string(), noise_frame({9, 8}, CV_8UC3, 3));
  const auto pipe = temp / "pipe";
  REQUIRE(::mkfifo(pipe.c_str(), 0600) == 0);
  for (const char* name : {"clip.avi", "clip.mp4", "stack.tif", "one.png"}) {
    INFO(name);
    const auto direct = read(temp / name);
    std::thread writer([&] { std::ofstream(pipe, std::ios::binary) << bytes_of(temp / name); });
    const auto piped = read(pipe);
    writer.join();
    CHECK(piped.clip.info == direct.clip.info);
    REQUIRE(piped.clip.frames.size() == direct.clip.frames.size());
    for (std::size_t i = 0; i < direct.clip.frames.size(); ++i)
      CHECK(same_pixels(piped.clip.frames[i], direct.clip.frames[i]));
    CHECK(piped.told.size() == direct.told.size());
    for (const auto& line : piped.told) CHECK(contains(line, "pipe"));
  }
  std::thread writer([&] { std::ofstream(pipe, std::ios::binary) << "no clip at all"; });
  const auto message = message_of<core::IoError>([&] { read(pipe); });
  writer.join();
  CHECK(contains(message, pipe.string()));
  CHECK_FALSE(contains(message, "/proc"));
}

TEST_CASE("options of reading are parsed, or refused by name") {
  CHECK(io::parse_length("0.065um") == Approx(0.065));
  CHECK(io::parse_length("0.065 µm") == Approx(0.065));
  CHECK(io::parse_length("65nm") == Approx(0.065));
  CHECK(io::parse_length("0.2mm") == Approx(200));
  CHECK(io::parse_length("1m") == Approx(1e6));
  for (const char* text : {"", "um", "1", "1 px", "-1um", "0um", "nanum", "1e30m"})
    CHECK_FALSE(message_of<core::InputError>([&] { io::parse_length(text); }).empty());
  const auto region = io::parse_region("1,2,30,40");
  CHECK((region.x == 1 && region.y == 2 && region.width == 30 && region.height == 40));
  for (const char* text : {"", "1,2,3", "1,2,3,4,5", "1,2,3,x", "-1,0,5,5", "0,0,0,5", "1.5,0,5,5"})
    CHECK_FALSE(message_of<core::InputError>([&] { io::parse_region(text); }).empty());
  CHECK(io::parse_levels("auto").kind == io::Levels::Kind::used);
  CHECK(io::parse_levels("-5:7.5").high == 7.5);
  for (const char* text : {"", ":", "5:5", "9:2", "1:2:3", "a:b", "max", "nan:5"})
    CHECK_FALSE(message_of<core::InputError>([&] { io::parse_levels(text); }).empty());
  CHECK(io::parse_stabilize("similarity") == io::Stabilize::similarity);
  CHECK_FALSE(message_of<core::InputError>([&] { io::parse_stabilize("yes"); }).empty());
}
