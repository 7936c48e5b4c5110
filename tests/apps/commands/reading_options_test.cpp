// SPDX-License-Identifier: Apache-2.0
#include <cstdlib>
#include <fstream>
#include <sstream>

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "graph/io/motion_io.hpp"
#include "tests/apps/commands/command_check.hpp"
#include "tests/support/sanitizer.hpp"

using namespace emberfold;
using namespace emberfold::test;

namespace {

graph::SketchSequence read_sketch_of(const fs::path& folder) {
  std::ifstream in(folder / "sketch.jsonl");
  return graph::read_sketch(in, "sketch.jsonl");
}

}  // namespace

TEST_CASE("structure counts where the mask is bright, and the summary tells what was asked for") {
  const TempFolder temp;
  const auto clip = write_strokes(temp / "clip", {120, 90}, 6, 8);
  cv::Mat mask = cv::Mat::zeros(90, 120, CV_8UC1);
  mask.colRange(60, 120) = cv::Scalar(255);
  cv::imwrite((temp / "mask.png").string(), mask);
  REQUIRE(run_command({"sketch", clip, "-o", (temp / "all").string(), "-q"}).exit == 0);
  REQUIRE(
      run_command({"sketch", clip, "-o", (temp / "part").string(), "-q", "--mask",
                   (temp / "mask.png").string(), "--fps", "0.5", "--pixel-size", "130nm", "--scale", "0.5"})
          .exit == 0);
  const auto all = read_sketch_of(temp / "all"), part = read_sketch_of(temp / "part");
  std::size_t left_of_it = 0, in_it = 0;
  for (const auto& frame : all.frames)
    for (const auto& vertex : frame.vertices()) ++(vertex.patch.position.x < 59 ? left_of_it : in_it);
  CHECK(left_of_it > 0);
  CHECK(in_it > 0);
  std::size_t left = 0;
  for (const auto& frame : part.frames)
    for (const auto& vertex : frame.vertices()) {
      CHECK(vertex.patch.position.x >= 29);
      ++left;
    }
  CHECK(left > 0);
  CHECK(part.fps == Approx(0.5));
  const Json summary = summary_of(temp / "part");
  CHECK(summary["clip"]["fps"] == 0.5);
  CHECK(summary["clip"]["fps_is_known"] == true);
  CHECK(summary["clip"]["pixel_um"].get<double>() == Approx(0.26));
  const Json& reading = summary["options"]["reading"];
  CHECK(reading["mask"] == (temp / "mask.png").string());
  CHECK(reading["fps"] == 0.5);
  CHECK(reading["pixel_um"].get<double>() == Approx(0.13));
  CHECK_FALSE(reading.contains("roi"));
}

TEST_CASE("drift.csv tells the motion that was taken out, a line a frame") {
  const TempFolder temp;
  const auto writer = io::create_video(temp / "clip.avi", {120, 90}, 25, false);
  cv::Mat world;
  cv::GaussianBlur(noise_frame({200, 160}, CV_8UC1, 3), world, {}, 2);
  cv::normalize(world, world, 20, 230, cv::NORM_MINMAX);
  for (int t = 0; t < 6; ++t) writer->write(world(cv::Rect(20 + 2 * t, 30 - t, 120, 90)));
  writer->finish();
  const auto out = temp / "out";
  REQUIRE(run_command({"sketch", (temp / "clip.avi").string(), "-o", out.string(), "-q", "--stabilize",
                       "translation"})
              .exit == 0);
  std::istringstream lines(bytes_of(out / "drift.csv"));
  std::string line;
  REQUIRE(std::getline(lines, line));
  CHECK(line == "frame,x,y,scale,degrees");
  for (int t = 0; t < 6; ++t) {
    REQUIRE(std::getline(lines, line));
    int frame = 0;
    double x = 0, y = 0;
    REQUIRE(std::sscanf(line.c_str(), "%d,%lf,%lf", &frame, &x, &y) == 3);
    CHECK(frame == t);
    CHECK(x == Approx(-2 * t).margin(0.1));
    CHECK(y == Approx(t).margin(0.1));
  }
  CHECK_FALSE(std::getline(lines, line));
  CHECK(summary_of(out)["options"]["reading"]["stabilize"] == "translation");
}

TEST_CASE("memory that does not suffice is reported with the clip, and leaves nothing", "[slow]") {
  if (kAddressSanitizer) {
    WARN("skipped: the address sanitizer reserves terabytes and cannot run under a limit on memory");
    return;
  }
  const TempFolder temp;
  const auto path = temp / "large.avi";
  const auto writer = io::create_video(path, {4000, 3000}, 25, true);
  const cv::Mat frame = noise_frame({4000, 3000}, CV_8UC3, 1);
  for (int t = 0; t < 2; ++t) writer->write(frame);
  writer->finish();
  const std::string command = "ulimit -v 900000; exec " + std::string(EMBERFOLD_PROGRAM) + " sketch " +
                              path.string() + " -o " + (temp / "out").string() + " -q 2> " +
                              (temp / "err").string();
  const int status = std::system(command.c_str());  // NOLINT(concurrency-mt-unsafe): no other thread here
  const std::string err = bytes_of(temp / "err");
  INFO(err);
  CHECK(WEXITSTATUS(status) == 1);
  CHECK(err.starts_with("emberfold: out of memory"));
  CHECK(std::ranges::count(err, '\n') == 1);
  CHECK(contains(err, "large.avi"));
  CHECK_FALSE(fs::exists(temp / "out"));
}

TEST_CASE("a full disk is told with file and cause, whatever was being written") {
  const TempFolder temp;
  const auto clip = write_strokes(temp / "clip", {120, 90}, 10, 8);
  for (const long long bytes : {3000LL, 30000LL})
    for (const std::string command : {"sketch", "analyze", "compare"}) {
      if (command == "compare" && bytes > 3000) continue;
      CommandOptions options;
      options.most_file_bytes = bytes;
      std::vector<std::string> words{command, clip, "-o", (temp / "out").string(), "-q"};
      if (command == "analyze") words.emplace_back("--bottom-up");
      if (command == "compare") words[1] = clip, words.insert(words.begin() + 2, clip);
      const auto result = run_command(words, options);
      INFO(command << " with " << bytes << ": " << result.err);
      if (result.exit == 0) continue;
      CHECK(result.exit == 1);
      const auto last = result.err.substr(result.err.rfind("emberfold: "));
      CHECK(contains(last, (temp / "out").string()));
      CHECK_FALSE(contains(last, "stream failed"));
      if (command == "analyze" && fs::exists(temp / "out")) {  // what its stages made goes on another time
        CHECK(entries(temp / "out") == 1);
        CHECK(fs::exists(temp / "out/stages"));
        fs::remove_all(temp / "out");
      }
      CHECK_FALSE(fs::exists(temp / "out"));
    }
}

TEST_CASE("a clip that is there is replaced only where --overwrite is given") {
  const TempFolder temp;
  const auto clip = write_strokes(temp / "clip", {48, 36}, 12);
  REQUIRE(run_command({"dytex", "learn", clip, "-o", (temp / "model").string(), "-q", "-n", "3"}).exit == 0);
  for (const char* name : {"new.mp4", "frames"}) {
    const std::string out = (temp / name).string();
    const std::vector<std::string> synth{"dytex",    "synth", (temp / "model").string(), "-o", out, "-q",
                                         "--frames", "3"};
    REQUIRE(run_command(synth).exit == 0);
    check_one_line(synth, 2, {out, "--overwrite"});
    CHECK(run_command(joined(synth, {"--overwrite"})).exit == 0);
  }
  const std::string page = (temp / "page.html").string();
  std::ofstream(page) << "mine";
  check_one_line({"dytex", "page", (temp / "model").string(), "-o", page}, 2, {page, "--overwrite"});
  CHECK(bytes_of(page) == "mine");
  // an earlier result of the same command may be made again
  for (int run = 0; run < 2; ++run)
    CHECK(run_command({"sketch", clip, "-o", (temp / "sketch").string(), "-q", "--range", "0:2"}).exit == 0);
}
