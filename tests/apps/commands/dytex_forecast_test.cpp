// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

#include "apps/builtin/open_clip.hpp"
#include "core/io/clip_reader.hpp"
#include "core/io/model_folder.hpp"
#include "dytex/model/archive.hpp"
#include "tests/apps/commands/command_check.hpp"
#include "tests/support/messages.hpp"

using namespace emberfold;
using namespace emberfold::apps;
using namespace emberfold::test;

namespace {

/// Waves that travel, and grain; what a texture of few components is good at.
std::string write_wave_video(const fs::path& path, int frames, int width = 48, int height = 36) {
  const auto writer = io::create_video(path, {width, height}, 25, false);
  core::Rng rng(3);
  double phase = 0;
  for (int t = 0; t < frames; ++t) {
    phase += 0.35 + 0.05 * rng.normal();
    cv::Mat frame(height, width, CV_8U);
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x)
        frame.at<unsigned char>(y, x) =
            cv::saturate_cast<unsigned char>(128 + 50 * std::sin(0.3 * x + 0.1 * y - phase) +
                                             25 * std::sin(0.2 * y + 2 * phase) + 2 * rng.normal());
    writer->write(frame);
  }
  writer->finish();
  return path.string();
}

/// A block that moves over the frames, and one frame that is all white.
std::string write_mask(const fs::path& path, int frames, int width = 48, int height = 36) {
  const auto writer = io::create_video(path, {width, height}, 25, false);
  for (int t = 0; t < frames; ++t) {
    cv::Mat frame(height, width, CV_8U, cv::Scalar(t == 20 ? 255 : 0));
    frame(cv::Rect(t % (width - 12), 8, 12, 16)) = 255;
    writer->write(frame);
  }
  writer->finish();
  return path.string();
}

}  // namespace

TEST_CASE("dytex forecast tells its error and how it was met") {
  const TempFolder temp;
  const auto clip = write_wave_video(temp / "clip.avi", 120);
  const auto model = (temp / "model").string(), out = (temp / "next").string();
  REQUIRE(run_command({"dytex", "learn", clip, "-o", model, "-n", "4", "--range", "0:100", "-q"}).exit == 0);
  const auto run =
      run_command({"dytex", "forecast", model, clip, "-o", out, "--after", "100", "--steps", "30", "--json"});
  INFO(run.err);
  REQUIRE(run.exit == 0);
  CHECK(run.out == bytes_of(fs::path(out) / "summary.json"));
  const Json summary = Json::parse(run.out);
  CHECK(summary["clip"]["frames"] == 100);
  const auto& steps = summary["steps"];
  REQUIRE(steps.size() == 30);
  CHECK(steps[19].contains("error"));
  CHECK_FALSE(steps[20].contains("error"));  // the clip ends there
  CHECK(steps[0]["error"].get<double>() < 0.5 * steps[0]["mean_error"].get<double>());
  CHECK(steps[0]["error"].get<double>() < 2 * steps[0]["expected_error"].get<double>());
  CHECK(steps[29]["expected_error"].get<double>() > steps[0]["expected_error"].get<double>());
  CHECK(core::read_all(*apps::open_clip(out + "/forecast.avi", {}, {})).frames.size() == 30);
  CHECK(cv::imread(out + "/deviation.png").size() == cv::Size(48, 36));
  CHECK(cv::imread(out + "/forecast.png").cols == 900);

  // Without a clip it goes on from where learning ended, which is where the filter ends too.
  const auto alone = run_command({"dytex", "forecast", model, "-o", out, "--steps", "3", "--json"});
  INFO(alone.err);
  REQUIRE(alone.exit == 0);
  const Json of_model = Json::parse(alone.out);
  CHECK(of_model["clip"].is_null());
  CHECK_THAT(of_model["steps"][0]["expected_error"].get<double>(),
             WithinAbs(steps[0]["expected_error"].get<double>(), 1e-3));
}

TEST_CASE("dytex curve finds the length from which on more frames do not help") {
  const TempFolder temp;
  const auto clip = write_wave_video(temp / "clip.avi", 160, 32, 24);
  const auto out = (temp / "curve").string();
  const auto run = run_command({"dytex", "curve", clip, "-o", out, "-n", "4", "--lengths", "15", "--json"});
  INFO(run.err);
  REQUIRE(run.exit == 0);
  const Json summary = Json::parse(run.out);
  const auto& points = summary["curve"]["points"];
  REQUIRE(points.size() == 15);
  CHECK(points[0]["length"] == 6);
  CHECK(points[14]["length"] == summary["curve"]["targets"][0]);
  CHECK(summary["curve"]["plateau"].get<double>() < summary["curve"]["frame_before_error"].get<double>());
  CHECK(summary["curve"]["critical_length"].is_number());
  CHECK(cv::imread(out + "/curve.png").cols == 900);
}

TEST_CASE("dytex learn goes on to the most likely model") {
  const TempFolder temp;
  const auto clip = write_wave_video(temp / "clip.avi", 60);
  const auto model = (temp / "model").string();
  const auto run = run_command({"dytex", "learn", clip, "-o", model, "-n", "4", "--em", "--json"});
  INFO(run.err);
  REQUIRE(run.exit == 0);
  const Json em = Json::parse(run.out)["learning"]["em"];
  const auto log = em["log_likelihood"].get<std::vector<double>>();
  CHECK(log.size() == em["iterations"].get<std::size_t>() + 1);
  CHECK(std::is_sorted(log.begin(), log.end()));
  CHECK(contains(run.err, "log-likelihood"));
}

TEST_CASE("dytex learn fills what a mask hides") {
  const TempFolder temp;
  const auto clip = write_wave_video(temp / "clip.avi", 60), mask = write_mask(temp / "mask.avi", 60);
  const auto whole = core::read_all(*apps::open_clip(clip, {}, {})),
             hidden = core::read_all(*apps::open_clip(mask, {}, {}));
  // Hidden pixels are black in the clip that is learned from.
  const auto writer = io::create_video(temp / "holes.avi", {48, 36}, 25, false);
  for (std::size_t t = 0; t < 60; ++t) {
    cv::Mat frame = whole.frames[t].clone();
    frame.setTo(0, hidden.frames[t] > 127);
    writer->write(frame);
  }
  writer->finish();
  std::vector<std::string> models;
  for (const std::string threads : {"1", "2", "8"}) {
    const auto model = (temp / ("model" + threads)).string(),
               filled = (temp / ("filled" + threads + ".avi")).string();
    const auto run = run_command({"dytex", "learn", (temp / "holes.avi").string(), "-o", model, "-n", "4",
                                  "--missing", mask, "--filled", filled, "--threads", threads, "-q"});
    INFO(run.err);
    REQUIRE(run.exit == 0);
    models.push_back(model);
    const auto shown = core::read_all(*apps::open_clip(filled, {}, {}));
    REQUIRE(shown.frames.size() == 60);
    double squares = 0, count = 0;
    for (std::size_t t = 0; t < 60; ++t) {
      cv::Mat a, b;
      shown.frames[t].convertTo(a, CV_32F);
      whole.frames[t].convertTo(b, CV_32F);
      const double distance = cv::norm(a, b, cv::NORM_L2, hidden.frames[t] > 127);
      squares += distance * distance;
      count += cv::countNonZero(hidden.frames[t] > 127);
      CHECK(cv::norm(a, b, cv::NORM_INF, hidden.frames[t] <= 127) == 0);
    }
    CHECK(std::sqrt(squares / count) < 6);  // of waves with an SD of 40, in noise of 2
  }
  for (const char* name : {"A.npy", "C.npy", "states.npy", "mean.npy"})
    for (const auto& model : models)
      CHECK(bytes_of(fs::path(model) / name) == bytes_of(fs::path(models[0]) / name));
}

TEST_CASE("what forecast and curve and EM cannot take is refused in one line") {
  const TempFolder temp;
  const auto clip = write_wave_video(temp / "clip.avi", 30),
             other = write_wave_video(temp / "other.avi", 30, 40, 30);
  const auto mask = write_mask(temp / "mask.avi", 29), out = (temp / "out").string();
  const auto model = (temp / "model").string();
  REQUIRE(run_command({"dytex", "learn", clip, "-o", model, "-n", "4", "-q"}).exit == 0);
  const auto refused = [&](const std::vector<std::string>& words, int exit,
                           const std::vector<std::string>& what) {
    check_one_line(joined({"dytex"}, words, {"-o", out, "-q"}), exit, what, out);
  };
  refused({"forecast", model, "--steps", "0"}, 2, {"--steps is 0", "1 to 10000"});
  refused({"forecast", model, "--after", "5"}, 2, {"--after", "no CLIP"});
  refused({"forecast", model, clip, "--after", "31"}, 2, {"--after is 31", "1 to 30"});
  refused({"forecast", model, clip, "--after", "0"}, 2, {"--after is 0"});
  refused({"forecast", model, other}, 1, {"other.avi", "40x30", "48x36"});
  refused({"forecast", clip}, 1, {"is a clip, not a model"});
  refused({"curve", clip, "-n", "21"}, 2, {"--components is 21", "30 frames", "allowed is 1 to 20"});
  refused({"curve", clip, "--lengths", "1"}, 2, {"--lengths is 1"});
  refused({"curve", model}, 1, {"is no clip"});
  refused({"learn", clip, "--filled", "x.avi"}, 2, {"--filled", "--missing"});
  refused({"learn", clip, "--missing", mask}, 2, {"--missing", "29 frames", "30"});
  refused({"learn", clip, "--missing", other}, 2, {"--missing", "40x30", "48x36"});
  const auto writer = io::create_video(temp / "white.avi", {48, 36}, 25, false);
  for (int t = 0; t < 30; ++t) writer->write(cv::Mat(36, 48, CV_8U, cv::Scalar(255)));
  writer->finish();
  refused({"learn", clip, "--missing", (temp / "white.avi").string()}, 2,
          {"--missing", "every pixel of every frame"});
  for (const std::string command : {"forecast", "curve"}) {
    const auto help = run_command({"dytex", command, "--help"});
    CHECK(help.exit == 0);
    CHECK(contains(help.out, "Examples:\n  emberfold dytex " + command));
  }
}
