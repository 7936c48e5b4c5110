// SPDX-License-Identifier: Apache-2.0
#include "core/io/clip_reader.hpp"

#include <algorithm>
#include <fstream>
#include <limits>
#include <utility>

#include <fcntl.h>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/videoio.hpp>
#include <unistd.h>

#include "core/error.hpp"
#include "core/io/clip_writer.hpp"
#include "core/io/frame_decoders.hpp"
#include "core/io/image_files.hpp"
#include "core/parallel.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/clip_fixture.hpp"
#include "tests/support/messages.hpp"
#include "tests/support/read_clip.hpp"

using namespace emberfold;
using namespace emberfold::test;

namespace {

std::vector<std::string> warnings_of(const std::function<void(const core::Warn&)>& call) {
  std::vector<std::string> lines;
  call([&](const std::string& line) { lines.push_back(line); });
  return lines;
}

template <class Error>
std::string open_error(const std::filesystem::path& path, const io::ReadOptions& options = {}) {
  return message_of<Error>([&] { read_clip(path, options); });
}

/// A lossless video of noise; the same frames again from noise_frame(size, type, index + 1).
void write_video(const std::filesystem::path& path, cv::Size size, int frames, bool colour = false) {
  const auto writer = io::create_video(path, size, 25, colour);
  for (int i = 0; i < frames; ++i)
    writer->write(noise_frame(size, colour ? CV_8UC3 : CV_8UC1, static_cast<std::uint64_t>(i) + 1));
  writer->finish();
}

void keep_bytes(const std::filesystem::path& from, const std::filesystem::path& to, double share) {
  std::filesystem::copy_file(from, to);
  std::filesystem::resize_file(
      to, static_cast<std::uintmax_t>(share * static_cast<double>(std::filesystem::file_size(from))));
}

/// Text that the call writes to file descriptor 2.
std::string stderr_of(const std::filesystem::path& scratch, const std::function<void()>& call) {
  const int kept = ::dup(2);
  const int file = ::open(scratch.c_str(), O_CREAT | O_TRUNC | O_WRONLY, 0600);
  ::dup2(file, 2);
  call();
  ::dup2(kept, 2);
  ::close(file);
  ::close(kept);
  return bytes_of(scratch);
}

}  // namespace

TEST_CASE("natural order sorts runs of digits as numbers") {
  std::vector<std::string> names{
      "img10", "img2", "img1", "img02", "img", "a9b2", "a9b10", "b1", "img99999999999999999999"};
  std::sort(names.begin(), names.end(), io::natural_less);
  CHECK(names == std::vector<std::string>{"a9b2", "a9b10", "b1", "img", "img1", "img02", "img2", "img10",
                                          "img99999999999999999999"});
  for (const auto& a : names) {
    CHECK_FALSE(io::natural_less(a, a));
    for (const auto& b : names) CHECK((a == b || io::natural_less(a, b) != io::natural_less(b, a)));
  }
}

TEST_CASE("patterns know stars, question marks and printf numbers") {
  CHECK(io::fits_pattern("img_*.png", "img_7.png"));
  CHECK(io::fits_pattern("*", ""));
  CHECK(io::fits_pattern("a*b*c", "aXbbYc"));
  CHECK_FALSE(io::fits_pattern("a*b*c", "aXYc"));
  CHECK(io::fits_pattern("img_??.png", "img_07.png"));
  CHECK_FALSE(io::fits_pattern("img_??.png", "img_007.png"));
  CHECK(io::fits_pattern("img_%04d.png", "img_0007.png"));
  CHECK(io::fits_pattern("img_%04d.png", "img_12345.png"));
  CHECK_FALSE(io::fits_pattern("img_%04d.png", "img_007.png"));
  CHECK_FALSE(io::fits_pattern("img_%04d.png", "img_00007.png"));
  CHECK(io::fits_pattern("%d", "10"));
  CHECK_FALSE(io::fits_pattern("%d", "010"));
  CHECK(io::fits_pattern("100%%", "100%"));
  CHECK(io::fits_pattern("v%d_%d*", "v1_22.png"));
  CHECK(io::is_pattern("d/img_%04d.png"));
  CHECK(io::is_pattern("d/*.png"));
  CHECK_FALSE(io::is_pattern("d*/img.png"));
  CHECK_FALSE(io::is_pattern("100%.png"));
}

TEST_CASE("ranges are read as users write them") {
  using Range = std::pair<std::int64_t, std::optional<std::int64_t>>;
  CHECK(io::parse_range("3:8") == Range{3, 8});
  CHECK(io::parse_range("3:") == Range{3, std::nullopt});
  CHECK(io::parse_range(":8") == Range{0, 8});
  for (const char* bad : {"", ":", "3", "3:3", "8:3", "-1:4", "a:b", "1:2:3", " 1:2", "1.5:2",
                          "99999999999999999999:", "0:0"}) {
    INFO(bad);
    CHECK_FALSE(message_of<core::InputError>([&] { io::parse_range(bad); }).empty());
  }
}

TEST_CASE("a folder of images is read in natural order, grey staying grey") {
  const TempFolder folder;
  for (const int i : {1, 2, 9, 10, 11, 100})
    cv::imwrite((folder / ("img" + std::to_string(i) + ".png")).string(),
                cv::Mat(6, 8, CV_8UC1, cv::Scalar(i)));
  std::ofstream(folder / "notes.txt") << "not an image";
  std::ofstream(folder / ".hidden.png") << "not an image either";
  const core::Clip clip = read_clip(folder.path());
  REQUIRE(clip.frames.size() == 6);
  CHECK(clip.info == core::ClipInfo{8, 6, 1, CV_8U, 25, 255, 6, false});
  std::vector<int> order;
  for (const auto& frame : clip.frames) order.push_back(frame.at<std::uint8_t>(0, 0));
  CHECK(order == std::vector<int>{1, 2, 9, 10, 11, 100});

  CHECK(read_clip(folder / "img1*.png").frames.size() == 4);
  CHECK(read_clip(folder / "img%d.png").frames.size() == 6);
  CHECK(read_clip(folder / "img%02d.png").frames.size() == 3);
  CHECK(read_clip(folder / "img9.png").frames.size() == 1);
}

TEST_CASE("ranges, rewinding and the number of frames agree for images and videos") {
  const TempFolder folder;
  write_video(folder / "clip.avi", {40, 30}, 12);
  write_video(folder / "images", {40, 30}, 12);
  for (const char* name : {"clip.avi", "images"}) {
    INFO(name);
    io::ReadOptions options;
    options.first = 3;
    options.last = 8;
    options.fps = 25;
    const auto source = io::open_video((folder / name).string(), options, {});
    core::ClipInfo info = source->info();
    CHECK(std::exchange(info.origin, {}) == core::ClipOrigin{0, 0, 0.12, "source"});
    CHECK(info == core::ClipInfo{40, 30, 1, CV_8U, 25, 255, 5});
    for (int pass = 0; pass < 3; ++pass) {
      for (std::uint64_t i = 3; i < 8; ++i)
        CHECK(same_pixels(source->next(), noise_frame({40, 30}, CV_8UC1, i + 1)));
      CHECK(source->next().empty());
      CHECK(source->next().empty());
      source->rewind();
    }
    static_cast<void>(source->next());
    source->rewind();
    source->rewind();
    CHECK(same_pixels(source->next(), noise_frame({40, 30}, CV_8UC1, 4)));

    options.first = 12;
    options.last.reset();
    CHECK(contains(open_error<core::InputError>(folder / name, options), "begins at frame 12"));
    CHECK(contains(open_error<core::InputError>(folder / name, options), "has 12 frames"));
    options.first = 10;
    options.last = 20;
    std::size_t frames = 0;
    const auto lines = warnings_of(
        [&](const core::Warn& warn) { frames = read_clip(folder / name, options, warn).frames.size(); });
    CHECK(frames == 2);
    REQUIRE(lines.size() == 1);
    CHECK(contains(lines[0], "has 12 frames"));
  }
}

TEST_CASE("16-bit images are white at their true range, over all frames") {
  const TempFolder folder;
  cv::imwrite((folder / "a1.png").string(), cv::Mat(4, 4, CV_16UC1, cv::Scalar(200)));
  cv::imwrite((folder / "a2.png").string(), cv::Mat(4, 4, CV_16UC1, cv::Scalar(2049)));
  const core::Clip twelve = read_clip(folder.path());
  CHECK(twelve.info.depth == CV_16U);
  CHECK(twelve.info.white == 4095);
  CHECK(twelve.frames[1].at<std::uint16_t>(0, 0) == 2049);
  io::ReadOptions first;
  first.last = 1;
  CHECK(read_clip(folder.path(), first).info.white == 4095);
  CHECK(read_clip(folder / "a1.png").info.white == 255);
  cv::imwrite((folder / "a3.png").string(), cv::Mat(4, 4, CV_16UC3, cv::Scalar(1, 2, 65535)));
  CHECK(contains(open_error<core::IoError>(folder.path()), "a3.png"));
  io::ReadOptions grey;
  grey.grey = true;
  CHECK(read_clip(folder.path(), grey).info.white == 32767);  // red alone: 0.299 of the full range
  CHECK(read_clip(folder / "a3.png").info.white == 65535);
}

TEST_CASE("alpha is dropped with one warning") {
  const TempFolder folder;
  const cv::Mat colour = noise_frame({9, 7}, CV_8UC3, 1);
  cv::Mat with_alpha;
  cv::cvtColor(colour, with_alpha, cv::COLOR_BGR2BGRA);
  with_alpha.forEach<cv::Vec4b>([](cv::Vec4b& p, const int*) { p[3] = 9; });
  for (const char* name : {"a1.png", "a2.png", "a3.tif"}) cv::imwrite((folder / name).string(), with_alpha);
  core::Clip clip;
  io::ReadOptions options;
  options.fps = 25;
  const auto lines =
      warnings_of([&](const core::Warn& warn) { clip = read_clip(folder.path(), options, warn); });
  REQUIRE(lines.size() == 1);
  CHECK(contains(lines[0], "alpha"));
  CHECK(clip.info.channels == 3);
  for (const auto& frame : clip.frames) CHECK(same_pixels(frame, colour));
}

TEST_CASE("grey images in a colour clip are spread, colour in a grey clip is refused") {
  const TempFolder folder;
  cv::imwrite((folder / "a1.png").string(), noise_frame({9, 7}, CV_8UC3, 1));
  cv::imwrite((folder / "a2.png").string(), noise_frame({9, 7}, CV_8UC1, 2));
  const core::Clip clip = read_clip(folder.path());
  REQUIRE(clip.frames.size() == 2);
  cv::Mat grey;
  cv::extractChannel(clip.frames[1], grey, 2);
  CHECK(clip.frames[1].channels() == 3);
  CHECK(same_pixels(grey, noise_frame({9, 7}, CV_8UC1, 2)));

  cv::imwrite((folder / "a0.png").string(), noise_frame({9, 7}, CV_8UC1, 3));
  const std::string error = open_error<core::IoError>(folder.path());
  CHECK(contains(error, "a1.png is in colour"));
  io::ReadOptions options;
  options.grey = true;
  CHECK(read_clip(folder.path(), options).frames.size() == 3);
}

TEST_CASE("scaling down averages areas, scaling up keeps flat regions, grey is luma") {
  const TempFolder folder;
  const cv::Mat frame = noise_frame({8, 6}, CV_8UC3, 4);
  cv::imwrite((folder / "a.png").string(), frame);
  io::ReadOptions options;
  options.scale = 0.5;
  const cv::Mat half = read_clip(folder / "a.png", options).frames.at(0);
  REQUIRE(half.size() == cv::Size(4, 3));
  for (int y = 0; y < 3; ++y)
    for (int x = 0; x < 4; ++x) {
      const cv::Scalar mean = cv::mean(frame(cv::Rect(2 * x, 2 * y, 2, 2)));
      for (int c = 0; c < 3; ++c) CHECK_THAT(half.at<cv::Vec3b>(y, x)[c], WithinAbs(mean[c], 0.51));
    }
  options.scale = 0.01;
  CHECK(read_clip(folder / "a.png", options).frames.at(0).size() == cv::Size(1, 1));

  options.scale = 1;
  options.grey = true;
  const cv::Mat grey = read_clip(folder / "a.png", options).frames.at(0);
  REQUIRE(grey.type() == CV_8UC1);
  for (int y = 0; y < 6; ++y)
    for (int x = 0; x < 8; ++x) {
      const auto& p = frame.at<cv::Vec3b>(y, x);
      CHECK_THAT(grey.at<std::uint8_t>(y, x), WithinAbs(0.114 * p[0] + 0.587 * p[1] + 0.299 * p[2], 0.51));
    }

  cv::Mat steps(8, 8, CV_16UC1, cv::Scalar(0));
  steps(cv::Rect(0, 0, 4, 8)).setTo(4095);
  cv::imwrite((folder / "deep.png").string(), steps);
  options.scale = 3;
  const cv::Mat large = read_clip(folder / "deep.png", options).frames.at(0);
  double most = 0;
  cv::minMaxLoc(large, nullptr, &most);
  CHECK(most == 4095);  // bicubic overshoot never passes white
  CHECK(large.size() == cv::Size(24, 24));

  for (const double bad :
       {0.0, -1.0, 16.1, std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    options.scale = bad;
    CHECK(contains(open_error<core::InputError>(folder / "a.png", options), "scale"));
  }
  cv::imwrite((folder / "wide.png").string(), cv::Mat(1100, 1100, CV_8UC1, cv::Scalar(1)));
  options.scale = 16;
  CHECK(contains(open_error<core::InputError>(folder / "wide.png", options), "17600x17600"));
}

TEST_CASE("what cannot be read is one clear line") {
  const TempFolder folder;
  const auto fails_with = [&](const std::filesystem::path& path, const std::string& part) {
    const std::string message = open_error<core::IoError>(path);
    INFO(path << " gave: " << message);
    CHECK(contains(message, part));
    CHECK_FALSE(contains(message, "\n"));
  };
  std::filesystem::create_directory(folder / "empty");
  std::ofstream(folder / "text.mp4") << "dear diary\n";
  std::ofstream(folder / "nothing.mp4") << "";
  std::ofstream(folder / "text.png") << "dear diary\n";
  fails_with(folder / "missing.mp4", "no such file");
  fails_with("", "empty");
  fails_with(folder / "empty", "holds no images");
  fails_with(folder / "empty/*.png", "no file fits");
  fails_with(folder / "absent/*.png", "no folder");
  fails_with(folder / "text.mp4", "no video");
  fails_with(folder / "nothing.mp4", "is empty");
  fails_with(folder / "text.png", "no image");

  cv::imwrite((folder / "whole.png").string(), noise_frame({60, 40}, CV_8UC3, 1));
  cv::imwrite((folder / "whole.jpg").string(), noise_frame({60, 40}, CV_8UC3, 1));
  keep_bytes(folder / "whole.png", folder / "cut.png", 0.6);
  keep_bytes(folder / "whole.jpg", folder / "cut.jpg", 0.6);
  fails_with(folder / "cut.png", "cut off");
  fails_with(folder / "cut.jpg", "cut off");
  std::filesystem::copy_file(folder / "whole.png", folder / "bad.png");
  std::fstream(folder / "bad.png", std::ios::in | std::ios::out | std::ios::binary).seekp(200) << "damage";
  fails_with(folder / "bad.png", "damaged");

  std::filesystem::create_directory(folder / "sizes");
  cv::imwrite((folder / "sizes/1.png").string(), cv::Mat(6, 8, CV_8UC1, cv::Scalar(1)));
  cv::imwrite((folder / "sizes/2.png").string(), cv::Mat(6, 9, CV_8UC1, cv::Scalar(1)));
  fails_with(folder / "sizes", "2.png is 9x6 pixels");
  fails_with(folder / "sizes", "1.png, is 8x6");
  std::filesystem::remove(folder / "sizes/2.png");
  cv::imwrite((folder / "sizes/3.png").string(), cv::Mat(6, 8, CV_16UC1, cv::Scalar(1)));
  fails_with(folder / "sizes", "3.png is of 16 bits");
}

TEST_CASE("a video that is cut off is read as far as it goes, with one warning and nothing on stderr") {
  const TempFolder folder;
  write_video(folder / "whole.avi", {64, 48}, 40);
  keep_bytes(folder / "whole.avi", folder / "cut.avi", 0.5);
  core::Clip clip;
  std::vector<std::string> lines;
  const std::string spilled = stderr_of(folder / "stderr.txt", [&] {
    lines = warnings_of([&](const core::Warn& warn) {
      const auto source = io::open_video((folder / "cut.avi").string(), {}, warn);
      CHECK(source->info().frames == 40);
      clip = core::read_all(*source);
      source->rewind();
      CHECK(core::read_all(*source).frames.size() == clip.frames.size());
    });
    CHECK_FALSE(open_error<core::IoError>(folder / "stderr.txt").empty());
  });
  CHECK(spilled.empty());
  REQUIRE(clip.frames.size() >= 15);
  REQUIRE(clip.frames.size() < 25);
  CHECK(clip.info.frames == static_cast<std::int64_t>(clip.frames.size()));
  REQUIRE(lines.size() == 1);
  CHECK(contains(lines[0], "only " + std::to_string(clip.frames.size()) + " of the 40 frames"));
  for (std::size_t i = 0; i + 1 < clip.frames.size(); ++i)
    CHECK(same_pixels(clip.frames[i], noise_frame({64, 48}, CV_8UC1, i + 1)));

  io::ReadOptions late;
  late.first = 30;
  CHECK(contains(open_error<core::InputError>(folder / "cut.avi", late),
                 std::to_string(clip.frames.size()) + " frames"));
}

TEST_CASE(
    "a rate of thousands of frames a second is read; one that cannot be is taken as 25, with a warning") {
  const auto [stored, fps, warnings] = GENERATE(table<std::string, double, std::size_t>(
      {{std::string("\xD0\7\0\0", 4), 2000, 0}, {std::string("\x80\x84\x1E\0", 4), 25, 1}}));
  const TempFolder folder;
  write_video(folder / "clip.avi", {32, 32}, 5);
  std::string bytes = bytes_of(folder / "clip.avi");
  const auto header = bytes.find("strh");
  REQUIRE(header != std::string::npos);
  bytes.replace(header + 8 + 20, 8, std::string("\1\0\0\0", 4) + stored);  // scale 1, rate 2000 or 2000000
  std::ofstream(folder / "fast.avi", std::ios::binary) << bytes;
  core::Clip clip;
  const auto lines =
      warnings_of([&](const core::Warn& warn) { clip = read_clip(folder / "fast.avi", {}, warn); });
  CHECK(clip.info.fps == fps);
  CHECK(clip.frames.size() == 5);
  REQUIRE(lines.size() == warnings);
  for (const auto& line : lines) CHECK(contains(line, "25 a second"));
}

TEST_CASE("videos decode to the same bytes at any thread count") {
  const TempFolder folder;
  {
    const auto writer = io::create_video(folder / "clip.mp4", {96, 64}, 30, true);
    for (std::uint64_t i = 0; i < 20; ++i) {
      cv::Mat frame;
      cv::GaussianBlur(noise_frame({96, 64}, CV_8UC3, i / 4), frame, {}, 3);
      writer->write(frame);
    }
    writer->finish();
  }
  std::vector<core::Clip> clips;
  for (const std::size_t threads : {1U, 2U, 4U}) {
    const core::ThreadLimit limit(threads);
    io::ReadOptions options;
    options.scale = 0.7;
    clips.push_back(read_clip(folder / "clip.mp4", options));
    REQUIRE(clips.back().frames.size() == 20);
    for (std::size_t i = 0; i < 20; ++i) CHECK(same_pixels(clips.back().frames[i], clips.front().frames[i]));
  }
  CHECK(clips[0].info == core::ClipInfo{67, 45, 3, CV_8U, 30, 255, 20});
}

TEST_CASE("a rotation flag turns the frames") {
  // The 3×3 matrix of the track header, unity as written, is set to a quarter turn: (0 1 0; −1 0 0) in 16.16.
  const TempFolder folder;
  cv::Mat frame(32, 64, CV_8UC3, cv::Scalar::all(20));
  frame(cv::Rect(0, 0, 32, 16)).setTo(cv::Scalar::all(220));  // bright top left
  {
    const auto writer = io::create_video(folder / "clip.mp4", frame.size(), 25, true);
    for (int i = 0; i < 3; ++i) writer->write(frame);
    writer->finish();
  }
  std::string bytes = bytes_of(folder / "clip.mp4");
  const auto header = bytes.find("tkhd");
  REQUIRE(header != std::string::npos);
  const auto matrix = header + 4 + 40;
  REQUIRE(bytes.substr(matrix, 4) == std::string("\0\1\0\0", 4));
  bytes.replace(matrix, 20,
                std::string("\0\0\0\0"
                            "\0\1\0\0"
                            "\0\0\0\0"
                            "\xFF\xFF\0\0"
                            "\0\0\0\0",
                            20));
  std::ofstream(folder / "turned.mp4", std::ios::binary) << bytes;

  const core::Clip clip = read_clip(folder / "turned.mp4");
  CHECK(clip.info.width == 32);
  CHECK(clip.info.height == 64);
  REQUIRE(clip.frames.size() == 3);
  CHECK(clip.frames[0].at<cv::Vec3b>(8, 24)[0] >
        180);  // a quarter turn clockwise: top left went to top right
  CHECK(clip.frames[0].at<cv::Vec3b>(8, 4)[0] < 60);
  CHECK(clip.frames[0].at<cv::Vec3b>(56, 24)[0] < 60);
}
