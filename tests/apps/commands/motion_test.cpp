// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <regex>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>

#include "core/io/model_folder.hpp"
#include "mcmc/model/motion_model.hpp"
#include "pipeline/clip_model.hpp"
#include "pipeline/parameter_count.hpp"
#include "tests/apps/commands/command_check.hpp"

using namespace emberfold;
using namespace emberfold::test;

namespace {

struct Learned {
  TempFolder temp;
  std::string model;

  Learned() {
    const auto clip = write_strokes(temp / "clip.avi", {160, 120}, 24, 9);
    REQUIRE(run_command({"analyze", clip, "-o", (temp / "run").string(), "-q", "--quality", "draft"}).exit ==
            0);
    model = (temp / "run/model").string();
  }

  std::string draw(const std::string& from, const std::string& name, std::vector<std::string> options) const {
    const auto clip = (temp / (name + ".avi")).string();
    std::vector<std::string> words{"synth", from, "-o", clip, "--frames", "10", "-q", "--seed", "5"};
    words.insert(words.end(), options.begin(), options.end());
    const auto result = run_command(words);
    INFO(result.err);
    REQUIRE(result.exit == 0);
    return bytes_of(clip);
  }
};

const Learned& learned() {
  static const Learned made;
  return made;
}

std::vector<std::string> join(std::vector<std::string> a, const std::vector<std::string>& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

}  // namespace

TEST_CASE("a clip drawn of an edited model is that of synth with the same edits", "[slow]") {
  const auto& made = learned();
  const auto mask = (made.temp / "mask.png").string();
  cv::Mat picture(120, 160, CV_8U, cv::Scalar(0));
  picture.colRange(0, 60) = 255;
  cv::imwrite(mask, picture);
  struct Case {
    std::vector<std::string> edits, of_synth, of_edit;  // the rates are settings of synth
  };
  const std::vector<Case> cases{{{"--speed", "1.5", "--contrast", "1.4"}, {}, {}},
                                {{"--wind", "-1,0.5", "--birth-map", mask}, {}, {}},
                                {{"--flicker", "2"},
                                 {"--set", "synth.splits=3", "--set", "synth.deaths=0.5"},
                                 {"--splits", "3", "--deaths", "0.5"}},
                                {{"--reverse", "--speed", "2"}, {}, {}}};
  const auto plain = made.draw(made.model, "plain", {"--method", "diffusion"});
  int number = 0;
  for (const auto& one : cases) {
    const auto name = "edited" + std::to_string(number++);
    const auto folder = (made.temp / name).string();
    const auto edited = run_command(join({"motion", "edit", made.model, "-o", folder, "-q", "--seed", "5"},
                                         join(one.edits, one.of_edit)));
    INFO(edited.err);
    REQUIRE(edited.exit == 0);
    const auto wanted = made.draw(made.model, name + "_synth",
                                  join({"--method", "diffusion"}, join(one.edits, one.of_synth)));
    CHECK(made.draw(folder, name + "_drawn", {"--method", "diffusion"}) == wanted);
    CHECK(wanted != plain);
    CHECK_FALSE(pipeline::clip_model(io::read_model(folder, io::kMotionFormat)).footage);
  }
  CHECK(made.draw((made.temp / "edited0").string(), "unasked", {}) ==
        made.draw((made.temp / "edited0").string(), "asked", {"--method", "diffusion"}));
}

TEST_CASE("motion info tells how many parameters a model has") {
  const auto& made = learned();
  const auto told = Json::parse(run_command({"motion", "info", made.model, "--json"}).out);
  const auto model = mcmc::motion_model(io::read_model(made.model, io::kMotionFormat));
  CHECK(told["parameters"] == pipeline::parameter_count(model));
  CHECK(told["width"] == 160);
  CHECK(told["methods"] == Json({"diffusion", "footage", "texture", "edit", "strokes"}));
  const auto table = run_command({"motion", "info", made.model}).out;
  CHECK(contains(
      table, "parameters            " + std::to_string(static_cast<long>(pipeline::parameter_count(model)))));
}

TEST_CASE("motion edit tells misuse in the option's name and leaves nothing behind") {
  const auto& made = learned();
  const auto nowhere = made.temp / "refused";
  const auto refused = [&](const std::vector<std::string>& edits, const std::string& text) {
    check_one_line(join({"motion", "edit", made.model, "-o", nowhere.string(), "-q"}, edits), 2, {text},
                   nowhere);
  };
  refused({}, "nothing to edit");
  refused({"--speed", "0"}, "--speed is 0, must be in 0.1…10");
  refused({"--births", "-1"}, "--births is -1");
  refused({"--wind", "3"}, "--wind is 3; give X,Y");
  refused({"--wind", "9,0"}, "--wind is 9, must be in -8…8");
  refused({"--contrast", "20"}, "--contrast is 20");
  check_one_line({"motion", "edit", made.temp.path().string(), "-o", nowhere.string(), "--speed", "2", "-q"},
                 1, {"model"}, nowhere);
  check_one_line({"motion", "edit", made.model, "-o", made.model, "--speed", "2", "-q"}, 2,
                 {"which is read"});
}

TEST_CASE("motion likelihood tells the terms of every gap, which sum to the total") {
  const auto& made = learned();
  const auto run = (made.temp / "run").string();
  const auto told = Json::parse(run_command({"motion", "likelihood", made.model, run, "--json"}).out);
  REQUIRE(told["gaps"].size() == 23);
  for (const auto& gap : told["gaps"]) {
    double sum = 0;
    for (const char* term :
         {"displacement", "contrast", "births", "deaths", "splits", "merges", "connects", "disconnects"})
      sum += gap[term].get<double>();
    CHECK(gap["total"].get<double>() == Approx(sum));
  }
  const auto csv = run_command({"motion", "likelihood", made.model, run + "/motion.jsonl", "--csv"}).out;
  CHECK(csv.starts_with("frame,displacement,contrast,births,"));
  CHECK(std::ranges::count(csv, '\n') == 24);
  const auto table = run_command({"motion", "likelihood", made.model, run}).out;
  CHECK(contains(table, "\n  mean "));
  CHECK(contains(table, "motion of a place: "));

  check_one_line({"motion", "likelihood", made.model, run, "--csv", "--json"}, 2, {"--csv and --json"});
  check_one_line({"motion", "likelihood", made.model, (made.temp / "nothing").string()}, 1, {"nothing"});
  check_one_line({"motion", "likelihood", run, run}, 1, {"model"});
  const auto large = write_strokes(made.temp / "large.avi", {200, 120}, 8, 4);
  REQUIRE(run_command({"sketch", large, "-o", (made.temp / "large").string(), "-q"}).exit == 0);
  check_one_line({"motion", "likelihood", made.model, (made.temp / "large/sketch.jsonl").string()}, 1,
                 {"sketch.jsonl"});
}
