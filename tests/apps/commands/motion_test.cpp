// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <regex>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

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

TEST_CASE("edits of a model that cannot be are refused in the option's name and leave nothing behind") {
  const auto& made = learned();
  const auto nowhere = made.temp / "refused";
  const auto refused = [&](const std::vector<std::string>& edits, const std::string& text) {
    check_one_line(join({"synth", made.model, "-o", nowhere.string(), "-q"}, edits), 2, {text}, nowhere);
  };
  refused({"--speed", "0"}, "--speed is 0, must be in 0.1…10");
  refused({"--set", "synth.births=-1"}, "synth.births is -1");
  refused({"--wind", "3"}, "--wind is 3; give X,Y");
  refused({"--wind", "9,0"}, "--wind is 9, must be in -8…8");
  refused({"--contrast", "20"}, "--contrast is 20");
  check_one_line({"synth", made.temp.path().string(), "-o", nowhere.string(), "--speed", "2", "-q"}, 1,
                 {"model"}, nowhere);
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
