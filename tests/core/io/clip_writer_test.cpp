// SPDX-License-Identifier: Apache-2.0
#include "core/io/clip_writer.hpp"

#include <algorithm>
#include <atomic>
#include <csignal>
#include <fstream>
#include <limits>
#include <thread>

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/videoio.hpp>
#include <sched.h>
#include <sys/resource.h>

#include "core/error.hpp"
#include "core/io/clip_reader.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/clip_fixture.hpp"
#include "tests/support/messages.hpp"
#include "tests/support/read_clip.hpp"

using namespace emberfold;
using namespace emberfold::test;

namespace {

std::vector<std::string> names_in(const fs::path& folder) {
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(folder)) names.push_back(entry.path().filename().string());
  std::sort(names.begin(), names.end());
  return names;
}

void write(const fs::path& path, const std::vector<cv::Mat>& frames, double fps = 25) {
  const auto writer = io::create_video(path, frames.at(0).size(), fps, frames.at(0).channels() == 3);
  for (const auto& frame : frames) writer->write(frame);
  writer->finish();
}

std::vector<cv::Mat> noise(cv::Size size, int type, std::uint64_t frames, std::uint32_t limit = 256) {
  std::vector<cv::Mat> clip;
  for (std::uint64_t i = 0; i < frames; ++i) clip.push_back(noise_frame(size, type, i, limit));
  return clip;
}

}  // namespace

TEST_CASE("avi and PNG give back every byte, grey and colour") {
  const TempFolder folder;
  for (const int type : {CV_8UC1, CV_8UC3, CV_16UC1, CV_16UC3})
    for (const char* name : {"clip.avi", "clip.AVI", "images"}) {
      if (CV_MAT_DEPTH(type) == CV_16U && std::string(name) != "images") continue;
      INFO(name << " type " << type);
      const auto frames = noise({34, 26}, type, 7, CV_MAT_DEPTH(type) == CV_16U ? 65536 : 256);
      write(folder / name, frames, 12.5);
      const core::Clip back = read_clip(folder / name);
      REQUIRE(back.frames.size() == frames.size());
      CHECK(back.info.channels == CV_MAT_CN(type));
      CHECK(back.info.fps == (std::string(name) == "images" ? 25 : 12.5));
      for (std::size_t i = 0; i < frames.size(); ++i) CHECK(same_pixels(back.frames[i], frames[i]));
    }
}

TEST_CASE("a pattern names the frames of a folder, as PNG and as EXR in linear light") {
  const TempFolder folder;
  const auto frames = noise({9, 7}, CV_8UC3, 3);
  write(folder / "shots/fire_%03d.png", frames);
  CHECK(names_in(folder / "shots") ==
        std::vector<std::string>{"fire_000.png", "fire_001.png", "fire_002.png"});
  CHECK(same_pixels(read_clip(folder / "shots/fire_%03d.png").frames[2], frames[2]));
  write(folder / "light/%d.exr", frames);
  CHECK(names_in(folder / "light") == std::vector<std::string>{"0.exr", "1.exr", "2.exr"});
  const cv::Mat light = cv::imread((folder / "light/1.exr").string(), cv::IMREAD_UNCHANGED);
  REQUIRE(light.type() == CV_32FC3);
  double worst = 0;
  for (int y = 0; y < 7; ++y)
    for (int x = 0; x < 9; ++x)
      for (int c = 0; c < 3; ++c) {
        const double value = frames[1].at<cv::Vec3b>(y, x)[c] / 255.0;
        const double wanted =
            value <= 0.04045 ? value / 12.92 : std::pow((value + 0.055) / 1.055, 2.4);  // IEC 61966-2-1
        worst = std::max(worst, std::abs(double{light.at<cv::Vec3f>(y, x)[c]} - wanted));
      }
  CHECK(worst < 3e-4);  // a half has 11 binary digits
}

TEST_CASE("folders of pictures take opacity, straight in PNG and multiplied in EXR") {
  const TempFolder folder;
  const auto frames = noise({9, 7}, CV_8UC4, 2);
  for (const char* name : {"png", "exr/f_%05d.exr"}) {
    const auto writer = io::create_video(folder / name, {9, 7}, 25, true);
    for (const auto& frame : frames) writer->write(frame);
    CHECK_THROWS_AS(writer->write(noise({9, 7}, CV_8UC3, 1)[0]), core::InputError);
    writer->finish();
  }
  const cv::Mat png = cv::imread((folder / "png/frame_00001.png").string(), cv::IMREAD_UNCHANGED);
  CHECK(same_pixels(png, frames[1]));
  const cv::Mat exr = cv::imread((folder / "exr/f_00001.exr").string(), cv::IMREAD_UNCHANGED);
  REQUIRE(exr.type() == CV_32FC4);
  const auto& pixel = exr.at<cv::Vec4f>(3, 4);
  const auto& level = frames[1].at<cv::Vec4b>(3, 4);
  CHECK_THAT(double{pixel[3]}, Catch::Matchers::WithinAbs(level[3] / 255.0, 3e-4));
  CHECK_THAT(double{pixel[0]}, Catch::Matchers::WithinAbs(
                                   std::pow((level[0] / 255.0 + 0.055) / 1.055, 2.4) * level[3] / 255, 5e-4));
  const auto video = io::create_video(folder / "clip.avi", {9, 7}, 25, true);
  CHECK(contains(message_of<core::InputError>([&] { video->write(frames[0]); }), "opacity"));
}

TEST_CASE("names of frames that cannot be are refused, and foreign folders are left alone") {
  const TempFolder folder;
  const auto refused = [&](const fs::path& path) {
    return message_of<core::InputError>([&] { io::create_video(path, {8, 8}, 25, true); });
  };
  CHECK(contains(refused("new_%05d.png"), "needs a folder"));
  CHECK(contains(refused(folder / "a/%05d.tif"), ".exr"));
  CHECK(contains(refused(folder / "a/%05d_%d.png"), "one number"));
  CHECK(contains(refused(folder / "a/f*.png"), "one number"));
  CHECK(contains(refused(folder / "f_%5d.png"), "cannot write a clip as .png"));
  CHECK_FALSE(fs::exists(folder / "a"));
  write(folder / "a/x_%02d.png", noise({8, 8}, CV_8UC1, 3));
  write(folder / "a/x_%02d.png", noise({8, 8}, CV_8UC1, 2));
  CHECK(names_in(folder / "a").size() == 2);
  CHECK_THROWS_AS(io::create_video(folder / "a/y_%02d.png", {8, 8}, 25, true), core::IoError);
  CHECK(names_in(folder / "a").size() == 2);
  CHECK(io::is_frame_folder(folder / "a"));
  CHECK(io::is_frame_folder(folder / "a/x_%02d.exr"));
  CHECK_FALSE(io::is_frame_folder(folder / "a.mp4"));
}

TEST_CASE("an odd size gets its last row and column once more") {
  const TempFolder folder;
  const auto frames = noise({33, 21}, CV_8UC3, 2);
  write(folder / "clip.avi", frames);
  const core::Clip back = read_clip(folder / "clip.avi");
  REQUIRE(back.info.width == 34);
  REQUIRE(back.info.height == 22);
  for (std::size_t i = 0; i < 2; ++i) {
    CHECK(same_pixels(back.frames[i](cv::Rect(0, 0, 33, 21)).clone(), frames[i]));
    CHECK(same_pixels(back.frames[i].col(33).rowRange(0, 21).clone(), frames[i].col(32).clone()));
    CHECK(same_pixels(back.frames[i].row(21).colRange(0, 33).clone(), frames[i].row(20).clone()));
  }
  write(folder / "clip.mp4", frames);
  CHECK(read_clip(folder / "clip.mp4").info.width == 34);
  write(folder / "tiny.mp4", noise({1, 1}, CV_8UC1, 3));
  CHECK(read_clip(folder / "tiny.mp4").frames.size() == 3);
}

TEST_CASE("mp4 is H.264 in 4:2:0 and close to what was written") {
  const TempFolder folder;
  std::vector<cv::Mat> frames;
  for (int i = 0; i < 12; ++i) {
    cv::Mat frame(48, 64, CV_8UC3);
    for (int y = 0; y < 48; ++y)
      for (int x = 0; x < 64; ++x)
        frame.at<cv::Vec3b>(y, x) =
            cv::Vec3b(static_cast<std::uint8_t>(40 + 2 * x), static_cast<std::uint8_t>(60 + 3 * y),
                      static_cast<std::uint8_t>(100 + 8 * i));
    frames.push_back(frame);
  }
  write(folder / "clip.mp4", frames, 29.97);
  const core::Clip back = read_clip(folder / "clip.mp4");
  REQUIRE(back.frames.size() == 12);
  CHECK_THAT(back.info.fps, Catch::Matchers::WithinAbs(29.97, 0.001));
  for (std::size_t i = 0; i < 12; ++i) {
    cv::Mat gap;
    cv::absdiff(back.frames[i], frames[i], gap);
    const cv::Scalar mean = cv::mean(gap);
    CHECK(std::max({mean[0], mean[1], mean[2]}) < 4);
  }
  cv::VideoCapture file((folder / "clip.mp4").string(), cv::CAP_FFMPEG);
  const auto code = static_cast<std::uint32_t>(file.get(cv::CAP_PROP_FOURCC));
  CHECK((code == 0x31637661U || code == 0x34363248U));  // avc1 or H264
  CHECK(static_cast<std::uint32_t>(file.get(cv::CAP_PROP_CODEC_PIXEL_FORMAT)) == 0x30323449U);  // I420
  CHECK(contains(bytes_of(folder / "clip.mp4").substr(0, 64), "ftypisom"));

  write(folder / "again.mp4", frames, 29.97);
  CHECK(bytes_of(folder / "clip.mp4") == bytes_of(folder / "again.mp4"));
  std::vector<cv::Mat> grey = noise({32, 32}, CV_8UC1, 2);
  write(folder / "grey.mp4", grey);
  CHECK(read_clip(folder / "grey.mp4").frames.size() == 2);
}

TEST_CASE("mp4 has the same bytes on one processor and on all, idle and under load") {
  const TempFolder folder;
  std::vector<cv::Mat> frames = noise({96, 64}, CV_8UC3, 50);
  for (auto& frame : frames) cv::GaussianBlur(frame, frame, {}, 2);
  write(folder / "idle.mp4", frames);
  const std::string idle = bytes_of(folder / "idle.mp4");
  CHECK(contains(idle, " threads=1 "));
  std::atomic<bool> stop = false;
  std::vector<std::thread> load;
  for (int i = 0; i < 6; ++i)
    load.emplace_back([&] {
      while (!stop) {
      }
    });
  for (int run = 0; run < 8; ++run) {
    // The encoder is handed memory that others used before.
    std::vector<std::vector<int>> used(
        40, std::vector<int>(static_cast<std::size_t>(20000 + 900 * run), run + 7));
    used.clear();
    write(folder / "busy.mp4", frames);
    CHECK(bytes_of(folder / "busy.mp4") == idle);
  }
  std::thread([&] {
    cpu_set_t one;
    CPU_ZERO(&one);
    CPU_SET(::sched_getcpu(), &one);
    ::sched_setaffinity(0, sizeof one, &one);
    write(folder / "one.mp4", frames);
  }).join();
  stop = true;
  for (auto& thread : load) thread.join();
  CHECK(bytes_of(folder / "one.mp4") == idle);
}

TEST_CASE("videos have the rate and the number of frames that were asked for") {
  const TempFolder folder;
  const auto frames = noise({32, 24}, CV_8UC3, 9);
  const std::pair<double, double> rates[] = {{25, 25},
                                             {12.5, 12.5},
                                             {29.97, 30000 / 1001.0},
                                             {30000 / 1001.0, 30000 / 1001.0},
                                             {14.985, 15000 / 1001.0},
                                             {7.1234567, 7.1234567},
                                             {1, 1},
                                             {999, 999},
                                             {1000, 1000}};
  for (const auto& [asked, wanted] : rates)
    for (const char* name : {"clip.mp4", "clip.avi"}) {
      INFO(name << " at " << asked);
      write(folder / name, frames, asked);
      cv::VideoCapture file((folder / name).string(), cv::CAP_FFMPEG);
      CHECK(file.get(cv::CAP_PROP_FRAME_COUNT) == 9);
      CHECK_THAT(file.get(cv::CAP_PROP_FPS), WithinRel(wanted, 1e-8));
      const core::Clip back = read_clip(folder / name);
      CHECK(back.frames.size() == 9);
      CHECK_THAT(back.info.fps, WithinRel(wanted, 1e-8));
      CHECK(back.info.times.empty());  // evenly spaced
    }
}

TEST_CASE("a frame that is cut from a larger one is written without its surroundings") {
  const TempFolder folder;
  const cv::Mat large = noise({40, 30}, CV_8UC3, 1)[0];
  const cv::Mat part = large(cv::Rect(3, 4, 15, 11));
  write(folder / "clip.avi", {part});
  const cv::Mat back = read_clip(folder / "clip.avi").frames.at(0);
  CHECK(same_pixels(back(cv::Rect(0, 0, 15, 11)).clone(), part.clone()));
  CHECK(same_pixels(back(cv::Rect(15, 0, 1, 11)).clone(), part.col(14).clone()));
}

TEST_CASE("two writers of one name do not mix: the last that finishes has its own clip there") {
  const TempFolder folder;
  for (const char* name : {"clip.avi", "clip.mp4", "clip"}) {
    const auto first = io::create_video(folder / name, {32, 24}, 25, true),
               second = io::create_video(folder / name, {32, 24}, 25, true);
    for (std::uint64_t t = 0; t < 9; ++t) {
      first->write(noise_frame({32, 24}, CV_8UC3, t));
      if (t < 5) second->write(noise_frame({32, 24}, CV_8UC3, 100 + t));
    }
    first->finish();
    CHECK(read_clip(folder / name).frames.size() == 9);
    second->finish();
    CHECK(read_clip(folder / name).frames.size() == 5);
  }
  CHECK(names_in(folder.path()) == std::vector<std::string>{"clip", "clip.avi", "clip.mp4"});
}

TEST_CASE("nothing appears under the final name before finish, and nothing stays without it") {
  const TempFolder folder;
  for (const char* name : {"clip.mp4", "clip.avi", "images"}) {
    INFO(name);
    {
      const auto writer = io::create_video(folder / name, {32, 32}, 25, false);
      writer->write(noise_frame({32, 32}, CV_8UC1, 1));
      CHECK_FALSE(fs::exists(folder / name));
      CHECK_FALSE(fs::is_empty(folder.path()));
    }
    CHECK(fs::is_empty(folder.path()));
    {
      const auto writer = io::create_video(folder / name, {32, 32}, 25, false);
      CHECK_FALSE(message_of<core::InputError>([&] { writer->finish(); }).empty());
    }
    CHECK(fs::is_empty(folder.path()));
    write(folder / name, {noise_frame({32, 32}, CV_8UC1, 1)});
    CHECK(names_in(folder.path()) == std::vector<std::string>{name});
    fs::remove_all(folder / name);
  }
}

TEST_CASE("a clip written over another replaces it only at finish") {
  const TempFolder folder;
  for (const char* name : {"clip.avi", "images"}) {
    write(folder / name, noise({16, 16}, CV_8UC1, 5));
    {
      const auto writer = io::create_video(folder / name, {16, 16}, 25, false);
      writer->write(noise_frame({16, 16}, CV_8UC1, 77));
      CHECK(read_clip(folder / name).frames.size() == 5);
      writer->finish();
      CHECK_FALSE(message_of<core::InputError>([&] { writer->finish(); }).empty());
      CHECK_FALSE(message_of<core::InputError>([&] {
                    writer->write(noise_frame({16, 16}, CV_8UC1, 7));
                  }).empty());
    }
    const core::Clip back = read_clip(folder / name);
    REQUIRE(back.frames.size() == 1);
    CHECK(same_pixels(back.frames[0], noise_frame({16, 16}, CV_8UC1, 77)));
  }
  CHECK(names_in(folder.path()) == std::vector<std::string>{"clip.avi", "images"});
}

TEST_CASE("a folder with anything else in it is refused and left alone") {
  const TempFolder folder;
  fs::create_directory(folder / "images");
  std::ofstream(folder / "images/letter.txt") << "keep me";
  cv::imwrite((folder / "images/frame_00000.png").string(), noise_frame({4, 4}, CV_8UC1, 1));
  const std::string message = message_of<core::IoError>([&] {
    io::create_video(folder / "images", {4, 4}, 25, false);
  });
  CHECK(contains(message, "letter.txt"));
  CHECK(names_in(folder / "images") == std::vector<std::string>{"frame_00000.png", "letter.txt"});

  {  // the letter comes while the clip is written
    fs::remove(folder / "images/letter.txt");
    const auto writer = io::create_video(folder / "images", {4, 4}, 25, false);
    writer->write(noise_frame({4, 4}, CV_8UC1, 2));
    std::ofstream(folder / "images/letter.txt") << "keep me";
    CHECK(contains(message_of<core::IoError>([&] { writer->finish(); }), "letter.txt"));
  }
  CHECK(bytes_of(folder / "images/letter.txt") == "keep me");
  CHECK(names_in(folder.path()) == std::vector<std::string>{"images"});
}

TEST_CASE("targets and frames that cannot be are refused with a line that says why") {
  const TempFolder folder;
  const auto input_error = [](const std::function<void()>& call) {
    return message_of<core::InputError>(call);
  };
  for (const char* name : {"clip.mov", "clip.png", "clip.5"}) {
    const std::string message = input_error([&] { io::create_video(folder / name, {8, 8}, 25, true); });
    CHECK(contains(message, ".mp4"));
    CHECK(contains(message, ".avi"));
  }
  CHECK(contains(input_error([&] { io::create_video("", {8, 8}, 25, true); }), "empty"));
  for (const double fps : {0.0, -1.0, 2e6, std::numeric_limits<double>::quiet_NaN()})
    CHECK(contains(input_error([&] {
                     io::create_video(folder / "a.mp4", {8, 8}, fps, true);
                   }),
                   "frame rate"));
  CHECK(contains(input_error([&] { io::create_video(folder / "a.mp4", {0, 8}, 25, true); }), "width"));
  CHECK(contains(input_error([&] { io::create_video(folder / "a.mp4", {8, 16385}, 25, true); }), "height"));

  for (const char* name : {"none/clip.mp4", "none/clip.avi", "none/images"})
    CHECK(contains(message_of<core::IoError>([&] {
                     io::create_video(folder / name, {8, 8}, 25, true);
                   }),
                   "no folder"));
  fs::create_directory(folder / "taken.mp4");
  CHECK(contains(message_of<core::IoError>([&] {
                   io::create_video(folder / "taken.mp4", {8, 8}, 25, true);
                 }),
                 "folder"));
  std::ofstream(folder / "taken") << "a file";
  CHECK(contains(message_of<core::IoError>([&] {
                   io::create_video(folder / "taken", {8, 8}, 25, true);
                 }),
                 "file"));

  const auto video = io::create_video(folder / "b.avi", {8, 8}, 25, false);
  CHECK(contains(input_error([&] { video->write(cv::Mat(8, 9, CV_8UC1)); }), "9x8"));
  CHECK(contains(input_error([&] { video->write(cv::Mat(8, 8, CV_8UC3)); }), "colour"));
  CHECK(contains(input_error([&] { video->write(cv::Mat(8, 8, CV_16UC1)); }), "8 bits"));
  CHECK(contains(input_error([&] { video->write(cv::Mat(8, 8, CV_8UC4)); }), "opacity"));
  const auto images = io::create_video(folder / "c/", {8, 8}, 25, true);
  images->write(noise_frame({8, 8}, CV_8UC1, 1));
  CHECK(contains(input_error([&] { images->write(cv::Mat(8, 8, CV_16UC1)); }), "do not mix"));
  images->finish();
  CHECK(read_clip(folder / "c").info.channels == 3);
}

TEST_CASE("a full disk is told, and leaves nothing") {
  // A limit on the size of files stands in for the full disk: what passes it is refused half way through.
  const TempFolder folder;
  rlimit before{};
  REQUIRE(::getrlimit(RLIMIT_FSIZE, &before) == 0);
  const auto old_signal = std::signal(SIGXFSZ, SIG_IGN);
  for (const char* name : {"clip.mp4", "clip.avi", "images"}) {
    INFO(name);
    const auto frames = noise({128, 128}, CV_8UC3, 20);
    const rlimit small{30000, before.rlim_max};
    ::setrlimit(RLIMIT_FSIZE, &small);
    const std::string message = message_of<core::IoError>([&] { write(folder / name, frames); });
    ::setrlimit(RLIMIT_FSIZE, &before);
    CHECK(contains(message, (folder / name).string()));
    if (std::string(name) != "images") CHECK(contains(message, "the disk may be full"));
    CHECK(fs::is_empty(folder.path()));
  }
  std::signal(SIGXFSZ, old_signal);
}
