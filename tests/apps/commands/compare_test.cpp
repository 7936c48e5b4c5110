// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <map>

#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>

#include "apps/builtin/open_clip.hpp"
#include "apps/pictures/side_by_side.hpp"
#include "core/io/clip_reader.hpp"
#include "tests/apps/commands/command_check.hpp"
#include "tests/support/messages.hpp"

using namespace emberfold;
using namespace emberfold::apps;
using namespace emberfold::test;

namespace {

const std::vector<std::string> kDrawn{
    "synthesized_motion.avi", "synthesized_footage.avi", "synthesized_strokes.avi", "synthesized_dytex.avi",
    "synthesized_star.avi",   "video_loop.avi",          "contact_sheet.png"};

std::string write_clip(const fs::path& path, const core::Clip& clip) {
  const auto writer = io::create_video(path, clip.frames[0].size(), 25, clip.frames[0].channels() == 3);
  for (const auto& frame : clip.frames) writer->write(frame);
  writer->finish();
  return path.string();
}

}  // namespace

TEST_CASE("clips beside each other are as high as they should be") {
  const TempFolder temp;
  const std::vector<cv::Size> sizes{{64, 48}, {30, 60}};
  SideBySide beside(temp / "a.mp4", {"one", "a name that is far too long for so narrow a panel"}, sizes, 25);
  beside.write(std::vector<cv::Mat>{cv::Mat(48, 64, CV_8UC3, cv::Scalar(0, 0, 250)),
                                    cv::Mat(60, 30, CV_8UC1, cv::Scalar(30))});
  beside.finish();
  const auto clip = core::read_all(*apps::open_clip((temp / "a.mp4").string(), {}, {}));
  CHECK(clip.info.width == 320 + 6 + 120);
  CHECK(clip.info.height == 240 + 28);
  const auto pixel = [&](int x) { return clip.frames[0].at<cv::Vec3b>(150, x); };
  CHECK(pixel(160)[2] > 200);
  CHECK(pixel(160)[0] < 60);
  CHECK(std::abs(pixel(380)[1] - 30) < 12);
}

TEST_CASE("compare holds a clip against its models and writes all that it names", "[slow]") {
  const TempFolder temp;
  const auto clip = write_strokes(temp / "clip", {81, 60}, 40);
  for (const std::string threads : {"1", "3"}) {
    const auto result =
        run_command({"compare", clip, "-o", (temp / threads).string(), "--threads", threads, "--json", "-q"});
    INFO(result.err);
    REQUIRE(result.exit == 0);
    const Json summary = Json::parse(result.out);
    for (const auto& file : summary["files"]) CHECK(fs::exists(temp / threads / file.get<std::string>()));
    CHECK(bytes_of(temp / threads / "measures.json") == bytes_of(temp / "1/measures.json"));
    for (const auto& name : kDrawn) CHECK(bytes_of(temp / threads / name) == bytes_of(temp / "1" / name));
    CHECK(summary["measures"] == Json::parse(bytes_of(temp / threads / "measures.json")));
  }
  const Json measures = Json::parse(bytes_of(temp / "1/measures.json"));
  CHECK(measures["format"] == "emberfold.measures");
  CHECK(measures["version"] == 2);
  CHECK(measures["segment"] == 16);
  CHECK(measures["prediction"]["first_frame"] == 20);
  CHECK(measures["prediction"]["steps"] == Json({1, 2, 4, 8}));
  for (const char* way :
       {"motion_model", "footage", "linear_dynamic_texture", "star", "frame_before", "mean_image"})
    CHECK(measures["prediction"]["methods"][way]["psnr"] > 10);
  for (const char* way : {"motion_model", "linear_dynamic_texture"})
    CHECK(measures["reconstruction"][way]["ssim"] > 0.1);
  for (const char* way :
       {"motion_model", "footage", "strokes", "linear_dynamic_texture", "star", "noise_floor"})
    for (const char* measure : {"temporal_db", "radial_db", "autocorrelation", "patterns", "flow_px",
                                "crease_sharpness", "si", "ti"})
      CHECK(measures["synthesis"][way][measure] >= 0);
  for (const char* way : {"motion_model", "footage", "strokes", "linear_dynamic_texture", "noise_floor"})
    CHECK(measures["synthesis"][way]["stroke_events"] >= 0);
  for (const char* baseline : {"star", "video_loop"})
    CHECK_FALSE(measures["synthesis"][baseline].contains("stroke_events"));
  for (const auto& model : measures["models"]) CHECK(model["parameters"] > 100);
  CHECK(measures["synthesis"]["source"]["strokes"]["frames"] == 40);
  CHECK(measures["words"].size() >= 8);
  const auto& curves = measures["curves"];
  CHECK(curves["temporal_db"]["source"].size() == 8);
  CHECK(curves["radial_db"]["footage"].size() == 30);
  CHECK(curves["autocorrelation"]["star"].size() == 5);
  for (const auto& name : kDrawn)
    if (name.ends_with(".avi"))
      CHECK(core::read_all(*apps::open_clip((temp / "1" / name).string(), {}, {})).frames.size() == 40);
  for (const auto& model : measures["models"]) {
    const Json& visible = measures["synthesis"][model["key"].get<std::string>()]["visible"];
    for (const char* figure : {"complete", "coherent", "flow", "variance", "difference", "copied"})
      CHECK(visible[figure].get<double>() >= 0);
  }
  // The loop is the clip itself; models of strokes are not.
  CHECK(measures["synthesis"]["video_loop"]["visible"]["copied"] == 1);
  CHECK(measures["synthesis"]["motion_model"]["visible"]["copied"] < 1);
  CHECK(measures["synthesis"]["strokes"]["visible"]["copied"] < 1);
  CHECK_FALSE(measures["prediction"]["methods"].contains("video_loop"));
  CHECK(measures["words"][0].get<std::string>().starts_with("To the eye the new clip of the "));
  const auto video = apps::open_clip((temp / "1/side_by_side.mp4").string(), {}, {});
  CHECK(video->info().height >= 240);
  CHECK(video->info().width > 5 * 81 * 240 / 60);
  const auto page = bytes_of(temp / "1/report.html");
  for (const char* part :
       {"To the eye", "What the measures say", "Spectrum in time", "Prediction", "data:image/jpeg"})
    CHECK(contains(page, part));
}

TEST_CASE("compare draws clips of any length and predicts with what it may learn from", "[slow]") {
  const TempFolder temp;
  const auto clip = write_strokes(temp / "clip", {60, 48}, 24, 4);
  const auto run = [&](const std::vector<std::string>& more) {
    const auto result =
        run_command(joined({"compare", clip, "-o", (temp / "out").string(), "--json", "-q"}, more));
    INFO(result.err);
    REQUIRE(result.exit == 0);
    return Json::parse(result.out)["measures"];
  };
  const auto longer = run({"--frames", "40"});
  CHECK(longer["synthesis"]["frames"] == 40);
  CHECK(longer["models"].size() == 6);
  CHECK(
      core::read_all(*apps::open_clip((temp / "out/synthesized_dytex.avi").string(), {}, {})).frames.size() ==
      40);
  CHECK(core::read_all(*apps::open_clip((temp / "out/side_by_side.mp4").string(), {}, {})).frames.size() ==
        24);
  const auto whole = run({"--set", "compare.learn_share=1"});
  CHECK(whole["prediction"].is_null());
  CHECK(whole["learned_frames"] == 24);
}

TEST_CASE("two clips are compared and their distances hold what they should") {
  const TempFolder temp;
  const auto a = write_clip(temp / "a", noise_clip({40, 32}, 40, 1)),
             b = write_clip(temp / "b", noise_clip({40, 32}, 40, 2));
  const auto faint = write_clip(temp / "faint", noise_clip({40, 32}, 40, 3, 26));
  const auto small = write_clip(temp / "small", noise_clip({30, 20}, 20, 4));
  const auto measure = [&](const std::string& one, const std::string& other) {
    const auto result = run_command({"compare", one, other, "-o", (temp / "out").string(), "--json", "-q"});
    INFO(result.err);
    REQUIRE(result.exit == 0);
    return Json::parse(result.out)["measures"];
  };
  const auto same = measure(a, a);
  CHECK(same["distances"]["other"]["temporal_db"] == 0);
  CHECK(same["distances"]["other"]["radial_db"] == 0);
  for (const char* key : {"autocorrelation", "patterns", "flow_px", "crease_sharpness", "si", "ti"})
    CHECK(same["distances"]["other"][key] == 0);
  CHECK(same["psnr"] == 100);
  CHECK(same["ssim"] == 1);
  const auto sample = measure(a, b);
  CHECK(sample["distances"]["other"]["temporal_db"] < 0.5);
  CHECK(sample["distances"]["other"]["radial_db"] < 1);
  // Two independent uniform levels of 0 … 255 lie (256² − 1) / 6 apart in the mean square.
  CHECK_THAT(sample["psnr"].get<double>(), WithinAbs(10 * std::log10(255.0 * 255 * 6 / 65535), 0.1));
  // A tenth of the range is a hundredth of the power: 20 dB.
  const auto weak = measure(a, faint);
  CHECK_THAT(weak["distances"]["other"]["temporal_db"].get<double>(), WithinAbs(19.9, 0.4));
  CHECK_THAT(weak["distances"]["other"]["radial_db"].get<double>(), WithinAbs(19.9, 0.8));
  const auto other_size = measure(a, small);
  CHECK(other_size["psnr"].is_null());
  CHECK(other_size["psnr_missing"] == "the sizes differ");
  CHECK(other_size["distances"]["other"]["temporal_db"] < 1);
  CHECK(core::read_all(*apps::open_clip((temp / "out/side_by_side.mp4").string(), {}, {})).frames.size() ==
        20);
  const auto table = run_command({"compare", a, small, "-o", (temp / "out").string(), "-q"});
  for (const char* part : {"Spectrum in time", "noise floor", "the sizes differ"})
    CHECK(contains(table.out, part));
}

TEST_CASE("a clip without a stroke is compared as far as it goes") {
  const TempFolder temp;
  core::Clip flat = noise_clip({20, 16}, 12, 1);
  for (auto& frame : flat.frames) frame = cv::Mat(16, 20, CV_8UC1, cv::Scalar(90));
  const auto clip = write_clip(temp / "flat", flat);
  const auto result = run_command({"compare", clip, "-o", (temp / "out").string(), "--json", "-q"});
  INFO(result.err);
  REQUIRE(result.exit == 0);
  const auto measures = Json::parse(result.out)["measures"];
  CHECK(measures["prediction"]["methods"]["frame_before"]["psnr"] == 100);
  CHECK(measures["synthesis"]["noise_floor"]["temporal_db"] == 0);
}

TEST_CASE("what compare cannot take is refused in one line") {
  const TempFolder temp;
  const auto clip = write_clip(temp / "clip", noise_clip({20, 16}, 12, 1)),
             few = write_clip(temp / "few", noise_clip({20, 16}, 7, 1));
  const auto out = temp / "out";
  const auto refused = [&](const std::vector<std::string>& more, int exit,
                           const std::vector<std::string>& what) {
    check_one_line(joined({"compare"}, more, {"-o", out.string(), "-q"}), exit, what, out);
  };
  refused({few}, 1, {"few", "7 frames", "at least 8"});
  refused({clip, few}, 1, {"few", "7 frames"});
  refused({clip, (temp / "no").string()}, 1, {"no such"});
  refused({clip, "--set", "learn.components=0"}, 2, {"learn.components", "0"});
  refused({clip, "--set", "compare.learn_share=0"}, 2, {"compare.learn_share", "0", "up to 1"});
  refused({clip, "--set", "compare.steps=65"}, 2, {"compare.steps", "65", "1 to 64"});
  refused({clip, "--frames", "3"}, 2, {"--frames", "3"});
  refused({clip, clip, clip}, 2, {"one argument too many"});
  REQUIRE(run_command({"dytex", "learn", clip, "-o", (temp / "model").string(), "-q"}).exit == 0);
  refused({(temp / "model").string()}, 1, {"is no clip but a linear dynamic texture"});
}

TEST_CASE("Ctrl-C ends compare and dytex learn with nothing left") {
  const TempFolder temp;
  const auto clip = write_strokes(temp / "clip", {480, 360}, 60, 20);
  const auto out = temp / "out";
  for (const std::vector<std::string>& command : {std::vector<std::string>{"compare"}, {"dytex", "learn"}}) {
    const auto arguments = joined(command, {clip}, {"-o", out.string(), "--threads", "1"});
    CommandOptions options;
    options.interrupt_if = [&] { return fs::exists(out); };
    const auto result = run_command(arguments, options);
    INFO(result.err);
    CHECK(result.exit == 130);
    CHECK_FALSE(fs::exists(out));
  }
}
