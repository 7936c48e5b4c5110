// SPDX-License-Identifier: Apache-2.0
#include <fstream>

#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>

#include "apps/builtin/open_clip.hpp"
#include "apps/textures/texture_edits.hpp"
#include "core/io/clip_reader.hpp"
#include "core/io/model_folder.hpp"
#include "dytex/model/archive.hpp"
#include "dytex/model/layers.hpp"
#include "tests/apps/commands/command_check.hpp"
#include "tests/support/messages.hpp"

using namespace emberfold;
using namespace emberfold::apps;
using namespace emberfold::test;

namespace {

dytex::LinearDynamicTexture model_at(const fs::path& folder) {
  return dytex::linear_dynamic_texture(io::read_model(folder, io::kTextureFormat));
}

/// A clip and its model, made once.
struct Learned {
  TempFolder temp;
  std::string clip = write_strokes(temp / "clip", {40, 32}, 24);
  std::string model = (temp / "model").string();
  Learned() { REQUIRE(run_command({"dytex", "learn", clip, "-o", model, "-n", "18", "-q"}).exit == 0); }
};

std::string one_box(const fs::path& path, cv::Size size, const cv::Rect& inside) {
  cv::Mat mask = cv::Mat::zeros(size, CV_8U);
  mask(inside).setTo(255);
  cv::imwrite(path.string(), mask);
  return path.string();
}

}  // namespace

TEST_CASE("edits are written as the words that make them") {
  using namespace emberfold::dytex;
  const std::vector<Edit> edits{
      {Speed{2}},       {Scales{1, 0.1, 2}},  {Flow{0.5}},       {Speed{-1}, false}, {Reverse{}},
      {Intensity{0.3}}, {Weights{{1, 0.25}}}, {Directions{{3}}}, {Flow{2}, true},    {Scales{}}};
  CHECK(edit_words(edits) ==
        "--speed 2 --medium 0.1 --fine 2 --flow 0.5 --no-contrast --speed -1 --reverse --intensity 0.3 "
        "--weights 1,0.25 --directions 3 --contrast --flow 2");
  CHECK(edit_words({}).empty());
  CHECK(parse_numbers("1,2.5 , 3") == std::vector<double>{1, 2.5, 3});
}

TEST_CASE("dytex edit applies its options in their order") {
  const Learned learned;
  const auto out = (learned.temp / "edited").string();
  const auto result = run_command({"dytex", "edit", learned.model, "-o", out, "--coarse", "2", "--speed",
                                   "1.2", "--intensity", "0.5", "--speed", "-1", "--fine", "0.5", "--json"});
  INFO(result.err);
  REQUIRE(result.exit == 0);
  const std::vector<dytex::Edit> edits{{dytex::Scales{2, 1, 1}},
                                       {dytex::Speed{1.2}},
                                       {dytex::Intensity{0.5}},
                                       {dytex::Speed{-1}},
                                       {dytex::Scales{1, 1, 0.5}}};
  const auto expected = dytex::edit(model_at(learned.model), edits).texture, found = model_at(out);
  CHECK(found.A == expected.A);
  CHECK(found.B == expected.B);
  CHECK(found.C == expected.C);
  CHECK(found.weights == expected.weights);
  const Json summary = Json::parse(result.out);
  CHECK(result.out == bytes_of(fs::path(out) / "summary.json"));
  const std::string words = "--coarse 2 --speed 1.2 --intensity 0.5 --speed -1 --fine 0.5";
  CHECK(summary["edits"] == Json{words});
  CHECK(summary["amplitude"]["after"] != summary["amplitude"]["before"]);
  // Earlier edits stay recorded.
  const auto twice = (learned.temp / "twice").string();
  REQUIRE(run_command({"dytex", "edit", out, "-o", twice, "--preset", "hazy", "-q"}).exit == 0);
  CHECK(Json::parse(bytes_of(fs::path(twice) / "model.json"))["edits"] == Json{words, "--coarse 2"});
  CHECK(model_at(twice).weights[0] == 4);
  // A model is never replaced by its own edit.
  const auto before = bytes_of(fs::path(out) / "model.json");
  check_one_line({"dytex", "edit", out, "-o", out, "--speed", "2", "-q"}, 2, {out, "which is read"});
  CHECK(bytes_of(fs::path(out) / "model.json") == before);
  REQUIRE(run_command({"dytex", "synth", twice, "-o", (learned.temp / "new").string(), "--frames", "3", "-q"})
              .exit == 0);
}

TEST_CASE("dytex edit takes weights from a list or a file and tells what was dropped") {
  const Learned learned;
  const auto out = (learned.temp / "edited").string(), list = (learned.temp / "weights.txt").string();
  std::ofstream(list) << "0.5, 1\n2 0\n";
  for (const std::string& weights : {std::string("0.5,1,2,0"), list}) {
    REQUIRE(run_command({"dytex", "edit", learned.model, "-o", out, "--weights", weights, "-q"}).exit == 0);
    CHECK(model_at(out).weights.head(5) == Eigen::VectorXd{{0.5, 1, 2, 0, 1}});
  }
  const auto fast = run_command({"dytex", "edit", learned.model, "-o", out, "--speed", "3", "--json"});
  REQUIRE(fast.exit == 0);
  const Json summary = Json::parse(fast.out);
  CHECK(summary["dropped_poles"] > 0);
  CHECK(contains(fast.err, "of the poles became 0"));
  REQUIRE(run_command({"dytex", "edit", learned.model, "-o", out, "--no-contrast", "--speed", "0.5", "-q"})
              .exit == 0);
  CHECK(model_at(out).B == model_at(learned.model).B);
}

TEST_CASE("edits that cannot be are refused in one line") {
  const Learned learned;
  const auto out = learned.temp / "edited";
  const auto refused = [&](const std::vector<std::string>& words, int exit,
                           const std::vector<std::string>& what) {
    check_one_line(joined({"dytex", "edit", learned.model, "-o", out.string(), "-q"}, words, {}), exit, what,
                   out);
  };
  refused({}, 2, {"nothing to edit", "--speed"});
  refused({"--speed", "4"}, 2, {"--speed is 4", "-3 to 3"});
  refused({"--speed", "fast"}, 2, {"--speed", "fast"});
  refused({"--flow", "0.001"}, 2, {"--flow is 0.001", "0.01 to 100"});
  refused({"--intensity", "-1"}, 2, {"--intensity is -1"});
  refused({"--weights", "1,99"}, 2, {"--weights[1] is 99"});
  refused({"--weights", "nothing.txt"}, 1, {"nothing.txt"});
  refused({"--weights", "1,1,1,1,1,1,1,1,1,1,1,1,1,1,1,1,1,1,1,1"}, 2, {"--weights has 20", "18 components"});
  refused({"--preset", "stormy"}, 2, {"--preset is stormy", "rough-sea"});
  check_one_line({"dytex", "edit", learned.clip, "-o", out.string(), "--speed", "2"}, 1,
                 {"is a clip, not a model"}, out);
}

TEST_CASE("a loop of frames begins again") {
  const Learned learned;
  const auto out = learned.temp / "loop";
  REQUIRE(run_command(
              {"dytex", "synth", learned.model, "-o", out.string(), "--loop", "10", "--frames", "23", "-q"})
              .exit == 0);
  CHECK(bytes_of(out / "frame_00000.png") == bytes_of(out / "frame_00010.png"));
  CHECK(bytes_of(out / "frame_00002.png") == bytes_of(out / "frame_00022.png"));
  CHECK(bytes_of(out / "frame_00000.png") != bytes_of(out / "frame_00001.png"));
  REQUIRE(
      run_command({"dytex", "synth", learned.model, "-o", out.string(), "--loop", "10", "-q", "--overwrite"})
          .exit == 0);
  CHECK_FALSE(fs::exists(out / "frame_00010.png"));
  check_one_line({"dytex", "synth", learned.model, "-o", (learned.temp / "x").string(), "--loop", "0", "-q"},
                 2, {"--loop is 0", "1 to 1000000"});
  check_one_line({"dytex", "synth", learned.model, "-o", (learned.temp / "x").string(), "--loop", "5",
                  "--start", "0", "-q"},
                 2, {"--start", "--loop"});
  REQUIRE(run_command({"dytex", "synth", learned.model, "-o", out.string(), "--start", "mean", "--frames",
                       "1", "-q", "--overwrite"})
              .exit == 0);
  const auto texture = model_at(learned.model);
  const cv::Mat mean(32, 40, CV_32FC3, const_cast<float*>(texture.mean.data()));
  CHECK(same_pixels(cv::imread((out / "frame_00000.png").string()), core::to_bytes(mean)));
}

TEST_CASE("a region is learned and edited alone and put back onto its clip") {
  const TempFolder temp;
  const auto clip = write_strokes(temp / "clip", {40, 32}, 24);
  const auto mask = one_box(temp / "mask.png", {40, 32}, {5, 6, 22, 18});
  const auto model = (temp / "part").string(), fast = (temp / "fast").string(), out = (temp / "out").string();
  REQUIRE(run_command({"dytex", "learn", clip, "-o", model, "-n", "8", "--mask", mask, "-q"}).exit == 0);
  const cv::Mat inside = cv::imread(mask, cv::IMREAD_GRAYSCALE);
  CHECK(cv::countNonZero(dytex::moving_region(model_at(model)) & ~inside) == 0);
  REQUIRE(run_command({"dytex", "edit", model, "-o", fast, "--speed", "-2", "--intensity", "3", "-q"}).exit ==
          0);
  for (const std::string& layer : {fast + ":" + mask, fast}) {
    const auto result = run_command(
        {"dytex", "compose", clip, "--layer", layer, "--feather", "3", "-o", out, "--json", "--overwrite"});
    INFO(result.err);
    REQUIRE(result.exit == 0);
    CHECK(Json::parse(result.out)["clip"]["frames"] == 24);
    const auto before = core::read_all(*apps::open_clip(clip, {}, {})),
               after = core::read_all(*apps::open_clip(out, {}, {}));
    REQUIRE(after.frames.size() == 24);
    double changed = 0;
    for (std::size_t t = 0; t < 24; ++t) {
      cv::Mat away;
      cv::absdiff(before.frames[t], after.frames[t], away);
      cv::transform(away, away, cv::Matx13f(1, 1, 1));
      CHECK(cv::countNonZero(away & ~inside) == 0);
      changed += cv::sum(away)[0];
    }
    CHECK(changed > 0);
  }
  // Two layers, each moving by itself.
  const auto other = one_box(temp / "other.png", {40, 32}, {28, 2, 12, 28});
  const auto both = run_command({"dytex", "compose", clip, "--layer", fast, "--layer", model + ":" + other,
                                 "-o", (temp / "both.avi").string()});
  INFO(both.err);
  CHECK(both.exit == 0);
  CHECK(contains(both.err, "2 layers"));
}

TEST_CASE("layers and masks that do not fit are refused in one line") {
  const Learned learned;
  const auto out = learned.temp / "out.avi";
  const auto small = one_box(learned.temp / "small.png", {20, 32}, {5, 6, 12, 18});
  const auto black = one_box(learned.temp / "black.png", {40, 32}, {0, 0, 0, 0});
  const auto refused = [&](const std::vector<std::string>& words, int exit,
                           const std::vector<std::string>& what) {
    check_one_line(joined({"dytex", "compose", learned.clip, "-o", out.string(), "-q"}, words, {}), exit,
                   what, out);
  };
  refused({"--layer", learned.model + ":" + small}, 1, {"small.png is 20 x 32", "40 x 32"});
  refused({"--layer", learned.model + ":"}, 2, {"--layer", "MODEL:MASK"});
  refused({"--layer", (learned.temp / "none").string()}, 1, {"none"});
  refused({"--layer", learned.model, "--feather", "-1"}, 2, {"--feather"});
  refused({"--layer", learned.model, "--grey"}, 1, {"colour", "grey"});
  refused({"--layer", learned.model, "--scale", "0.5"}, 1, {"40 x 32", "20 x 16"});
  refused({"--layer", learned.model, "--start", "soon"}, 2, {"--start is soon", "mean"});
  for (const auto& [mask, what] : {std::pair{small, "20"}, {black, "0 everywhere"}, {learned.model, "model"}})
    check_one_line(
        {"dytex", "learn", learned.clip, "-o", (learned.temp / "part").string(), "--mask", mask, "-q"},
        mask == learned.model ? 1 : 2, {what}, learned.temp / "part");
}
