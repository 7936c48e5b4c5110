// SPDX-License-Identifier: Apache-2.0
#include <fstream>

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "core/io/clip_reader.hpp"
#include "graph/io/motion_io.hpp"
#include "tests/apps/commands/command_check.hpp"

using namespace emberfold;
using namespace emberfold::test;

namespace {

std::string write_line(const fs::path& path, cv::Point a, cv::Point b, cv::Size size = {120, 90}) {
  cv::Mat picture(size, CV_8U, cv::Scalar(60));
  cv::line(picture, a, b, cv::Scalar(200), 3, cv::LINE_AA);
  cv::GaussianBlur(picture, picture, {}, 1);
  cv::imwrite(path.string(), picture);
  return path.string();
}

Json morphed(const std::vector<std::string>& words) {
  const auto result = run_command(joined({"motion", "morph"}, words, {"--json", "-q"}));
  INFO(result.err);
  REQUIRE(result.exit == 0);
  return Json::parse(result.out);
}

graph::MotionGraph graphs_in(const fs::path& folder) {
  std::ifstream file(folder / "motion.jsonl");
  return graph::read_motion(file, "motion.jsonl");
}

}  // namespace

TEST_CASE("a line is moved to where another picture has it, and drawn on the way") {
  const TempFolder temp;
  const auto a = write_line(temp / "a.png", {20, 30}, {60, 30}),
             b = write_line(temp / "b.png", {60, 60}, {100, 60});
  const auto told = morphed({a, b, "-o", (temp / "out").string(), "--frames", "7"});
  CHECK(told["morph"]["length_px"].get<double>() == Approx(50).margin(2));
  CHECK(told["morph"]["curves_moved"] == 1);
  CHECK(told["from"]["curves"] == 1);
  for (const auto& [name, about] : told["files"].items()) CHECK(fs::exists(temp / "out" / name));
  const auto motion = graphs_in(temp / "out");
  REQUIRE(motion.sketch.frames.size() == 7);
  const auto film = core::read_all(*io::open_video((temp / "out/morph.avi").string(), {}, {}));
  REQUIRE(film.frames.size() == 7);
  CHECK(film.frames[3].size() == cv::Size(120, 90));

  SECTION("its first frame is the sketch's reconstruction") {
    REQUIRE(run_command({"sketch", a, "-o", (temp / "sketched").string(), "-q", "--anchors", "0", "--set",
                         "sketch.outlines=false"})
                .exit == 0);
    const auto drawn =
        core::read_all(*io::open_video((temp / "sketched/reconstruction.avi").string(), {}, {}));
    CHECK(cv::norm(film.frames[0], drawn.frames[0], cv::NORM_INF) == 0);
  }
  SECTION("back from its graphs it is as long, and seen backwards") {
    const auto back = morphed({(temp / "out/motion.jsonl").string(), a, "--at", "6", "-o",
                               (temp / "back").string(), "--frames", "7"});
    CHECK(back["morph"]["length_px"].get<double>() ==
          Approx(told["morph"]["length_px"].get<double>()).epsilon(1e-6));
    CHECK(graphs_in(temp / "back").sketch.frames[2].size() == motion.sketch.frames[4].size());
  }
}

TEST_CASE("a morph of a picture to itself stands still") {
  const TempFolder temp;
  const auto a = write_line(temp / "a.png", {20, 30}, {60, 50});
  const auto told = morphed({a, a, "-o", (temp / "out").string(), "--frames", "4"});
  CHECK(told["morph"]["length_px"].get<double>() == Approx(0).margin(1e-9));
  const auto film = core::read_all(*io::open_video((temp / "out/morph.avi").string(), {}, {}));
  for (const auto& frame : film.frames) CHECK(cv::norm(frame, film.frames[0], cv::NORM_INF) == 0);
}

TEST_CASE("a morph refuses pictures of two sizes, missing frames, and options that make no sense") {
  const TempFolder temp;
  const auto a = write_line(temp / "a.png", {20, 30}, {60, 30}),
             large = write_line(temp / "large.png", {20, 30}, {60, 30}, {200, 90});
  const auto out = temp / "out";
  check_one_line({"motion", "morph", a, large, "-o", out.string(), "-q"}, 1, {"120x90", "200x90", "one size"},
                 out);
  check_one_line({"motion", "morph", a, a, "-o", out.string(), "--at", "3", "-q"}, 1, {"no frame 3"}, out);
  check_one_line({"motion", "morph", a, a, "-o", out.string(), "--to", "-1"}, 2, {"--to is -1"}, out);
  check_one_line({"motion", "morph", a, a, "-o", out.string(), "--frames", "2"}, 2,
                 {"--frames is 2", "3 to 10000"}, out);
  check_one_line({"motion", "morph", a, a, "-o", out.string(), "--range", "0:1"}, 2, {"--range"}, out);
  check_one_line({"motion", "morph", a, a, "-o", out.string(), "--set", "sketch.spacing=1"}, 2,
                 {"sketch.spacing is 1"}, out);
  check_one_line({"motion", "morph", a, (temp / "none.png").string(), "-o", out.string(), "-q"}, 1,
                 {"none.png"}, out);
}
