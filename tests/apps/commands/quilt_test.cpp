// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <cstring>
#include <fstream>

#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "apps/builtin/open_clip.hpp"
#include "apps/builtin/rust.hpp"
#include "core/io/clip_reader.hpp"
#include "core/io/clip_writer.hpp"
#include "core/npy.hpp"
#include "tests/apps/commands/command_check.hpp"
#include "tests/support/messages.hpp"

using namespace emberfold;
using namespace emberfold::apps;
using namespace emberfold::test;

namespace {

// A small time-lapse of rust as a folder of PNG, of 8 or 16 bits.
std::string write_lapse(const fs::path& path, cv::Size size = {72, 64}, int frames = 10, bool deep = false,
                        std::uint64_t seed = 1) {
  BuiltinOptions options;
  options.width = std::max(64, size.width), options.height = std::max(64, size.height);
  options.frames = std::max(2, frames), options.seed = seed;
  const auto clip = make_rust(options);
  const auto writer = io::create_video(path, size, 25, true);
  for (int t = 0; t < frames; ++t) {
    cv::Mat frame = clip.frames[static_cast<std::size_t>(t)](cv::Rect({}, size));
    if (deep) frame.convertTo(frame, CV_16U, 257);
    writer->write(frame);
  }
  writer->finish();
  return path.string();
}

core::NpyArray read_array(const fs::path& path) {
  std::ifstream in(path, std::ios::binary);
  return core::read_npy(in);
}

void write_array(const fs::path& path, const core::NpyArray& array) {
  std::ofstream out(path, std::ios::binary);
  core::write_npy(out, array);
}

Json quilted(const std::string& clip, const fs::path& out, const std::vector<std::string>& more = {}) {
  const auto result = run_command(joined({"quilt", clip, "-o", out.string(), "--json", "-q"}, more, {}));
  INFO(result.err);
  REQUIRE(result.exit == 0);
  return Json::parse(result.out);
}

core::Clip frames_of(const fs::path& path) {
  return core::read_all(*apps::open_clip(path.string(), {}, {}));
}

// Number of values that differ between a rendered clip and the source seen through the map.
int wrong_pixels(const core::Clip& drawn, const core::Clip& source, const fs::path& map) {
  const auto array = read_array(map);
  const auto& values = std::get<std::vector<std::int32_t>>(array.data);
  int wrong = 0;
  for (std::size_t t = 0; t < drawn.frames.size(); ++t)
    for (std::size_t i = 0; i < values.size() / 3; ++i) {
      const int x = static_cast<int>(i % array.shape[1]), y = static_cast<int>(i / array.shape[1]);
      wrong +=
          std::memcmp(drawn.frames[t].ptr(y, x), source.frames[t].ptr(values[3 * i + 2], values[3 * i + 1]),
                      drawn.frames[t].elemSize()) == 0
              ? 0
              : 1;
    }
  return wrong;
}

const std::vector<std::string> kSmall{"--size", "100x90", "--block", "24", "--set", "quilt.format=png"};

}  // namespace

TEST_CASE("quilt writes a folder with clip and map and pictures and report") {
  const TempFolder temp;
  const auto clip = write_lapse(temp / "lapse");
  const auto summary = quilted(clip, temp / "out", kSmall);
  for (const char* name : {"map.npy", "map.png", "seams.png", "report.html", "summary.json", "frames"})
    CHECK(fs::exists(temp / "out" / name));
  CHECK(std::distance(fs::directory_iterator(temp / "out"), {}) == 6);
  CHECK(read_array(temp / "out/map.npy").shape == std::vector<std::size_t>{90, 100, 3});
  const auto drawn = frames_of(temp / "out/frames");
  CHECK(drawn.frames.size() == 10);
  CHECK(wrong_pixels(drawn, frames_of(clip), temp / "out/map.npy") == 0);
  CHECK(summary["output"]["frames"] == 10);
  CHECK(summary["quilt"]["blocks"] ==
        summary["quilt"]["columns"].get<int>() * summary["quilt"]["rows"].get<int>());
  CHECK(summary["options"]["quilt"]["overlap"] == 6);
  CHECK(summary["quilt"]["seam_ratio"] > 0);
  const auto page = bytes_of(temp / "out/report.html");
  for (const char* part : {"Seam gradient ratio", "Verbatim blocks", "data:image/jpeg"})
    CHECK(contains(page, part));
  CHECK(cv::imread((temp / "out/seams.png").string()).size() == cv::Size(100, 90));
}

TEST_CASE("a map is applied to other clips of other depth and single frames") {
  const TempFolder temp;
  const auto clip = write_lapse(temp / "lapse");
  const auto deep = write_lapse(temp / "deep", {72, 64}, 10, true, 5);
  quilted(clip, temp / "out", kSmall);
  const auto map = (temp / "out/map.npy").string();
  quilted(deep, temp / "other", {"--apply", map});
  const auto drawn = frames_of(temp / "other/frames");
  CHECK(drawn.info.depth == CV_16U);
  CHECK(wrong_pixels(drawn, frames_of(deep), map) == 0);
  CHECK(bytes_of(temp / "other/map.npy") == bytes_of(map));
  // Streamed: only the clip and its map, which stays where it is the one applied.
  quilted(clip, temp / "again.avi", {"--apply", map});
  CHECK(wrong_pixels(frames_of(temp / "again.avi"), frames_of(clip), map) == 0);
  CHECK(bytes_of(temp / "map.npy") == bytes_of(map));
  quilted(clip, temp / "out/beside.avi", {"--apply", map});
  CHECK(bytes_of(temp / "out/beside.avi") == bytes_of(temp / "again.avi"));
  CHECK(bytes_of(temp / "map.npy") == bytes_of(map));
  quilted(deep, temp / "seven.png", {"--apply", map, "--frame", "7"});
  CHECK(same_pixels(cv::imread((temp / "seven.png").string(), cv::IMREAD_UNCHANGED), drawn.frames[7]));
  // A map beyond the source is refused.
  const auto small = write_lapse(temp / "small", {40, 40}, 3);
  check_one_line({"quilt", small, "--apply", map, "-o", (temp / "no").string(), "-q"}, 1,
                 {"map.npy", "40x40"}, temp / "no");
  check_one_line({"quilt", clip, "--apply", map, "--size", "50", "-o", (temp / "no").string()}, 2,
                 {"--apply", "--size"}, temp / "no");
  check_one_line({"quilt", clip, "--apply", map, "--frame", "10", "-o", (temp / "no.png").string(), "-q"}, 1,
                 {"frame 10"}, temp / "no.png");
}

TEST_CASE("quilt warns where a source is no texture and not where it is") {
  const TempFolder temp;
  cv::Mat grain(64, 72, CV_8U), hill(64, 72, CV_8U);
  cv::RNG random(1);
  random.fill(grain, cv::RNG::UNIFORM, 0, 256);
  cv::imwrite((temp / "grain.png").string(), grain);
  CHECK(quilted((temp / "grain.png").string(), temp / "texture", kSmall)["warnings"].empty());
  // One smooth hill: blocks of it fit nowhere else.
  for (int i = 0; i < 64 * 72; ++i) hill.data[i] = static_cast<unsigned char>(3 * (i % 72) + i / 144);
  cv::imwrite((temp / "hill.png").string(), hill);
  const auto summary = quilted((temp / "hill.png").string(), temp / "hill", kSmall);
  REQUIRE(summary["warnings"].size() == 1);
  CHECK(contains(summary["warnings"][0], "rather than a texture"));
  CHECK(contains(summary["warnings"][0], "quilt.seams=moving"));
}

TEST_CASE("a map whose seams move is written and applied") {
  const TempFolder temp;
  const auto clip = write_lapse(temp / "lapse", {72, 64}, 16);
  const auto still = quilted(clip, temp / "still", kSmall);
  const auto moving = quilted(clip, temp / "moving", joined(kSmall, {"--set", "quilt.seams=moving"}, {}));
  const auto map = (temp / "moving/map.npy").string();
  const auto array = read_array(map);
  REQUIRE(array.shape.size() == 2);
  CHECK(array.shape[1] == 6);
  CHECK(array.shape[0] > 1 + 100 * 90);
  CHECK(moving["quilt"]["seam_ratio"] < still["quilt"]["seam_ratio"]);
  CHECK(moving["quilt"]["change_ratio"] > 0);
  CHECK_FALSE(still["quilt"].contains("change_ratio"));
  CHECK(contains(bytes_of(temp / "moving/report.html"), "Flicker ratio"));
  quilted(clip, temp / "again", {"--apply", map, "--set", "quilt.format=png"});
  quilted(clip, temp / "streamed.avi", {"--apply", map});
  CHECK(bytes_of(temp / "again/map.npy") == bytes_of(map));
  CHECK(bytes_of(temp / "map.npy") == bytes_of(map));
  const auto drawn = frames_of(temp / "moving/frames"), again = frames_of(temp / "again/frames"),
             streamed = frames_of(temp / "streamed.avi");
  REQUIRE(again.frames.size() == 16);
  REQUIRE(streamed.frames.size() == 16);
  for (std::size_t t = 0; t < 16; ++t) {
    CHECK(same_pixels(again.frames[t], drawn.frames[t]));
    CHECK(same_pixels(streamed.frames[t], drawn.frames[t]));
  }
  auto broken = array;
  std::get<std::vector<std::int32_t>>(broken.data)[6] = 1;
  write_array(temp / "broken.npy", broken);
  check_one_line(
      {"quilt", clip, "--apply", (temp / "broken.npy").string(), "-o", (temp / "no").string(), "-q"}, 1,
      {"broken.npy", "pixel 0,0", "frame 1"}, temp / "no");
}

TEST_CASE("quilt writes the same bytes at any number of threads and from a file") {
  const TempFolder temp;
  const auto clip = write_lapse(temp / "lapse");
  quilted(clip, temp / "1", joined(kSmall, {"--threads", "1"}, {"--set", "control.jitter=2"}));
  quilted(clip, temp / "3", joined(kSmall, {"--threads", "3"}, {"--set", "control.jitter=2"}));
  const auto mapped = quilted(clip, temp / "file",
                              joined(kSmall, {"--set", "quilt.memory=0"}, {"--set", "control.jitter=2"}));
  CHECK(mapped["mapped_mb"] > 0);
  for (const char* other : {"3", "file"})
    for (const char* name : {"map.npy", "time.npy", "map.png", "seams.png", "frames/frame_00009.png"})
      CHECK(bytes_of(temp / other / name) == bytes_of(temp / "1" / name));
  for (const auto& entry : fs::directory_iterator(temp / "file"))
    CHECK_FALSE(entry.path().filename().string().starts_with("."));
}

TEST_CASE("control maps of every kind steer time") {
  const TempFolder temp;
  const auto clip = write_lapse(temp / "lapse");
  quilted(clip, temp / "plain", kSmall);
  const auto map = (temp / "plain/map.npy").string();
  const auto plain = frames_of(temp / "plain/frames");
  const auto last_of = [&](const std::vector<std::string>& more) {
    quilted(clip, temp / "out", joined({"--apply", map, "--set", "quilt.format=png"}, more, {}));
    return frames_of(temp / "out/frames").frames.back();
  };
  CHECK(same_pixels(last_of({"--control", "1"}), plain.frames[9]));
  CHECK(same_pixels(last_of({"--control", "0"}), plain.frames[0]));
  CHECK(same_pixels(last_of({"--frames", "9", "--control", "0.5"}), plain.frames[4]));
  CHECK(same_pixels(last_of({"--set", "control.offset=4"}), plain.frames[5]));
  CHECK(same_pixels(last_of({"--frames", "13", "--set", "control.ends=loop"}), plain.frames[2]));
  CHECK(same_pixels(last_of({"--frames", "13", "--set", "control.ends=ping-pong"}), plain.frames[6]));
  CHECK(same_pixels(last_of({"--frames", "13"}), plain.frames[9]));
  const auto right = last_of({"--control", "gradient:right"});
  CHECK(same_pixels(right.col(99), plain.frames[9].col(99)));
  CHECK(same_pixels(right.col(0), plain.frames[0].col(0)));
  // A picture: white at the top. Depth: near where it is black. Distance: from where it is white.
  cv::Mat picture = cv::Mat::zeros(90, 100, CV_8U);
  picture.rowRange(0, 30).setTo(255);
  cv::imwrite((temp / "picture.png").string(), picture);
  const auto name = (temp / "picture.png").string();
  const cv::Rect top(0, 0, 100, 30), low(0, 89, 100, 1);
  for (const std::string kind : {"", "depth:", "distance:"}) {
    const auto shown = last_of({"--control", kind + name});
    INFO(kind);
    CHECK(same_pixels(shown(top), plain.frames[kind == "depth:" ? 0 : 9](top)));
    CHECK(same_pixels(shown(low), plain.frames[kind == "depth:" ? 9 : 0](low)));
  }
  // An array with rates and offsets, and what is written beside the clip, are the same.
  std::vector<float> values;
  for (int i = 0; i < 9000; ++i) values.insert(values.end(), {0.5F, -2.5F});
  write_array(temp / "time.npy", {{90, 100, 2}, false, values});
  const auto both = last_of({"--control", (temp / "time.npy").string()});
  CHECK(same_pixels(both, plain.frames[7]));  // 9/2 + 2.5
  CHECK(read_array(temp / "out/time.npy") == read_array(temp / "time.npy"));
}

TEST_CASE("control maps that cannot be are refused") {
  const TempFolder temp;
  const auto clip = write_lapse(temp / "lapse", {72, 64}, 3);
  const auto out = (temp / "out").string();
  const auto refused = [&](const std::vector<std::string>& more, int exit,
                           const std::vector<std::string>& what) {
    check_one_line(joined({"quilt", clip, "-o", out, "-q", "--size", "80", "--block", "24"}, more, {}), exit,
                   what, out);
  };
  const auto array = [&](const char* name, std::vector<std::size_t> shape, float value) {
    std::size_t count = 1;
    for (const auto side : shape) count *= side;
    write_array(temp / name, {std::move(shape), false, std::vector<float>(count, value)});
    return (temp / name).string();
  };
  const auto small = array("small.npy", {40, 50}, 1);
  refused({"--control", small}, 1, {"small.npy", "50x40", "80x80"});
  refused({"--control", array("nan.npy", {80, 80}, std::nanf(""))}, 1, {"nan.npy", "not a number"});
  refused({"--control", array("line.npy", {80}, 1)}, 1, {"line.npy", "height x width"});
  refused({"--set", "control.offset=" + array("two.npy", {80, 80, 2}, 1)}, 1, {"two.npy"});
  refused({"--control", "nan"}, 1, {"--control", "not a number"});
  refused({"--control", "gradient:in"}, 2, {"gradient:in", "right"});
  refused({"--control", (temp / "no.png").string()}, 1, {"no.png"});
  refused({"--set", "control.jitter=a"}, 2, {"control.jitter", "'a'"});
  refused({"--set", "control.jitter=-1"}, 2, {"control.jitter"});
  refused({"--set", "control.ends=tight"}, 2, {"tight"});
}

TEST_CASE("stills and masks and guides and several sources are quilted") {
  const TempFolder temp;
  const auto clip = write_lapse(temp / "lapse", {72, 64}, 4);
  const auto more = write_lapse(temp / "more", {64, 80}, 4, false, 9);
  const auto still = (temp / "lapse/frame_00003.png").string();
  quilted(still, temp / "still.png", {"--size", "90", "--block", "24", "--tileable"});
  CHECK(cv::imread((temp / "still.png").string()).size() == cv::Size(90, 90));
  CHECK(fs::exists(temp / "map.npy"));
  cv::Mat mask = cv::Mat::zeros(64, 72, CV_8U), guide(30, 30, CV_8U);
  mask.colRange(36, 72).setTo(255);
  for (int x = 0; x < 30; ++x) guide.col(x).setTo(8 * x);
  cv::imwrite((temp / "mask.png").string(), mask);
  cv::imwrite((temp / "guide.png").string(), guide);
  quilted(clip, temp / "masked",
          joined(kSmall, {"--mask", (temp / "mask.png").string()},
                 {"--also", more, "--guide", (temp / "guide.png").string()}));
  const auto array = read_array(temp / "masked/map.npy");
  const auto& values = std::get<std::vector<std::int32_t>>(array.data);
  int from_second = 0, forbidden = 0;
  for (std::size_t i = 0; i < values.size(); i += 3) {
    from_second += values[i];
    if (values[i] == 0 && values[i + 1] >= 36) ++forbidden;
  }
  CHECK(forbidden == 0);
  CHECK(from_second > 0);
  const auto all = (temp / "all.png").string();
  mask.setTo(255);
  cv::imwrite(all, mask);
  const auto out = (temp / "no").string();
  check_one_line(joined({"quilt", clip, "-o", out, "-q", "--mask", all}, kSmall, {}), 1, {"leaves no place"},
                 out);
  check_one_line(joined({"quilt", more, "-o", out, "-q", "--mask", all}, kSmall, {}), 1,
                 {"all.png", "72x64", "64x80"}, out);
}

TEST_CASE("what quilt cannot take is refused in one line") {
  const TempFolder temp;
  const auto clip = write_lapse(temp / "lapse", {72, 64}, 3);
  const auto deep = write_lapse(temp / "deep", {72, 64}, 3, true);
  const auto out = (temp / "out").string();
  const auto refused = [&](const std::vector<std::string>& more, int exit,
                           const std::vector<std::string>& what) {
    check_one_line(joined({"quilt"}, more, {"-q"}), exit, what, out);
  };
  refused({clip, "-o", out, "--block", "80"}, 2, {"--block is 80x80", "72x64"});
  refused({clip, "-o", out, "--block", "20", "--set", "quilt.overlap=11"}, 2,
          {"quilt.overlap is 11", "1 to 10"});
  refused({clip, "-o", out, "--block", "20x"}, 2, {"--block", "20x", "640x480"});
  refused({clip, "-o", out, "--size", "0x9"}, 2, {"--size is 0x9"});
  refused({clip, "-o", out, "--frames", "0"}, 2, {"--frames is 0"});
  refused({clip, "-o", out, "--set", "quilt.flatten=0.5"}, 2, {"quilt.flatten", "1 to 4096"});
  refused({clip, "-o", out, "--set", "quilt.overlap=0"}, 2, {"quilt.overlap is 0"});
  refused({clip, "-o", (temp / "x.gif").string()}, 2, {"x.gif", ".mp4"});
  refused({clip, "-o", (temp / "x.png").string()}, 2, {"x.png", "--frame"});
  refused({clip, "-o", (temp / "no/x.mp4").string()}, 1, {"no folder"});
  refused({deep, "-o", (temp / "x.mp4").string()}, 2, {"16"});
  refused({clip, "-o", out, "--also", deep}, 1, {"deep", "depth"});
  refused({clip, "-o", out, "--mask", "a", "--mask", "b"}, 2, {"2 masks for 1 clip"});
  refused({(temp / "nothing.mp4").string(), "-o", out}, 1, {"nothing.mp4"});
  const auto help = run_command({"quilt", "--help"});
  CHECK(help.exit == 0);
  CHECK(help.out.find("Examples:\n  emberfold quilt") < help.out.find("Usage: emberfold quilt"));
}

TEST_CASE("builtin rust is a time-lapse that grows and is read by every command") {
  BuiltinOptions options;
  options.frames = 12, options.width = 80, options.height = 64;
  const auto clip = make_rust(options);
  REQUIRE(clip.frames.size() == 12);
  const auto rusty = [&](const cv::Mat& frame) {  // redder than it is blue
    int count = 0;
    for (const auto& pixel : cv::Mat_<cv::Vec3b>(frame)) count += pixel[2] > pixel[0] ? 1 : 0;
    return static_cast<double>(count) / frame.size().area();
  };
  CHECK(rusty(clip.frames.front()) < 0.02);
  CHECK(rusty(clip.frames.back()) > 0.2);
  for (std::size_t t = 1; t < clip.frames.size(); ++t)
    CHECK(rusty(clip.frames[t]) > rusty(clip.frames[t - 1]) - 0.01);
  CHECK(same_pixels(make_rust(options).frames[5], clip.frames[5]));
  options.seed = 2;
  CHECK_FALSE(same_pixels(make_rust(options).frames[5], clip.frames[5]));
  const TempFolder temp;
  const auto learned =
      run_command({"dytex", "learn", "builtin:rust", "-o", (temp / "m").string(), "-q", "--scale", "0.3"});
  CHECK(learned.exit == 0);
  CHECK(contains(run_command({"quilt", "builtin:rost", "-o", (temp / "q").string()}).err, "builtin:rust"));
}
