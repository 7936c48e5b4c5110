// SPDX-License-Identifier: Apache-2.0
// `dytex learn` by blocks of frames, on one process; ranks_test.py runs it on several.
#include "core/io/model_folder.hpp"
#include "dytex/model/archive.hpp"
#include "tests/apps/commands/command_check.hpp"

using namespace emberfold;
using namespace emberfold::test;

namespace {

std::vector<std::string> learn(const std::string& clip, const fs::path& model,
                               const std::vector<std::string>& more = {}) {
  return joined({"dytex", "learn", clip, "-o", model.string(), "-n", "5", "--set", "learn.block=8"}, more);
}

std::map<std::string, std::string> arrays_of(const fs::path& model) {
  std::map<std::string, std::string> files;
  for (const char* name : {"C", "mean", "A", "B", "states", "singular"})
    files[name] = bytes_of(model / (std::string(name) + ".npy"));
  return files;
}

}  // namespace

TEST_CASE("dytex learn by blocks writes a model like any other") {
  const TempFolder temp;
  const auto clip = write_strokes(temp / "clip", {61, 40}, 30);
  const auto learned = run_command(learn(clip, temp / "model", {"--json"}));
  INFO(learned.err);
  REQUIRE(learned.exit == 0);
  const Json summary = Json::parse(learned.out);
  CHECK(learned.out == bytes_of(temp / "model/summary.json"));
  CHECK(summary["learning"]["distributed"]["block"] == 8);
  CHECK(summary["learning"]["distributed"]["ranks"] == 1);
  CHECK(summary["learning"]["distributed"]["frames_decoded"] == Json::array({30}));
  CHECK(summary["learning"]["distributed"]["bytes_sent"] == Json::array({0}));
  const auto texture = dytex::linear_dynamic_texture(io::read_model(temp / "model", io::kTextureFormat));
  CHECK(texture.components() == 5);
  CHECK((texture.C.transpose() * texture.C - Eigen::MatrixXf::Identity(5, 5)).norm() < 1e-5F);
  CHECK(summary["texture"]["parameters"] == 61 * 40 * 3 * 6 + 2 * 25);
  CHECK(fs::file_size(temp / "model/components.png") > 1000);
  CHECK_FALSE(fs::exists(temp / "model.learning"));
}

TEST_CASE("dytex learn by blocks goes on after Ctrl-C with the same bytes") {
  const TempFolder temp;
  const auto clip = write_strokes(temp / "clip", {160, 120}, 60);
  REQUIRE(run_command(learn(clip, temp / "whole")).exit == 0);
  const fs::path kept = temp / "model.learning";
  CommandOptions stop;
  stop.interrupt_if = [&] { return fs::exists(kept / "block-2"); };
  const auto stopped = run_command(learn(clip, temp / "model"), stop);
  INFO(stopped.err);
  CHECK(stopped.exit == 130);
  CHECK(contains(stopped.err, "the same command goes on"));
  CHECK_FALSE(fs::exists(temp / "model"));
  const auto rest = run_command(learn(clip, temp / "model"));
  INFO(rest.err);
  REQUIRE(rest.exit == 0);
  CHECK(contains(rest.err, "going on with what is kept in"));
  CHECK(summary_of(temp / "model")["learning"]["distributed"]["resumed_frames"] >= 16);
  CHECK(arrays_of(temp / "model") == arrays_of(temp / "whole"));
}

TEST_CASE("dytex learn by blocks begins anew where the clip is another") {
  const TempFolder temp;
  const auto clip = write_strokes(temp / "clip", {61, 40}, 30);
  const fs::path kept = temp / "model.learning";
  fs::create_directory(kept);
  std::ofstream(kept / "key") << "emberfold.learning 1 another\n";
  std::ofstream(kept / "progress") << std::string(24, '\1');
  const auto learned = run_command(learn(clip, temp / "model"));
  INFO(learned.err);
  CHECK(learned.exit == 0);
  CHECK(summary_of(temp / "model")["learning"]["distributed"]["resumed_frames"] == 0);
}

TEST_CASE("dytex learn by blocks refuses what it cannot do") {
  const TempFolder temp;
  const auto clip = write_strokes(temp / "clip", {61, 40}, 30);
  const fs::path model = temp / "model";
  check_one_line(learn(clip, model, {"--em"}), 2, {"--em is not there", "learn.block"}, model);
  check_one_line(learn(clip, model, {"--set", "learn.block=-1"}), 2, {"learn.block is -1"}, model);
  check_one_line(learn("nothing.avi", model), 1, {"cannot read nothing.avi"}, model);
  check_one_line(
      {"dytex", "learn", clip, "-o", model.string(), "-q", "--order", "auto", "--set", "learn.block=8"}, 2,
      {"order", "all frames at once"}, model);
  CHECK_FALSE(fs::exists(temp / "model.learning"));
  fs::create_directory(temp / "model.learning");
  std::ofstream(temp / "model.learning/thesis.txt") << "mine";
  check_one_line(learn(clip, model), 1, {"model.learning", "holds other things"}, model);
  CHECK(bytes_of(temp / "model.learning/thesis.txt") == "mine");
}

TEST_CASE("dytex learn by blocks leaves no model on a full disk") {
  const TempFolder temp;
  const auto clip = write_strokes(temp / "clip", {160, 120}, 30);
  CommandOptions full;
  full.most_file_bytes = 50'000;  // the stripes of scores fit, C does not
  const auto learned = run_command(learn(clip, temp / "model", {"-q"}), full);
  INFO(learned.err);
  CHECK(learned.exit == 1);
  CHECK(contains(learned.err, "cannot write"));
  CHECK_FALSE(fs::exists(temp / "model"));
}
