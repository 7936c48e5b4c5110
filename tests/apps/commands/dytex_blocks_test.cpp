// SPDX-License-Identifier: Apache-2.0
// `dytex learn` by blocks of frames.
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

#include "core/io/model_folder.hpp"
#include "dytex/model/archive.hpp"
#include "dytex/model/layers.hpp"
#include "tests/apps/commands/command_check.hpp"
#include "tests/apps/commands/waves_clip.hpp"

using namespace emberfold;
using namespace emberfold::test;

namespace {

std::vector<std::string> learn(const std::string& clip, const fs::path& model,
                               const std::vector<std::string>& more = {}) {
  return joined({"dytex", "learn", clip, "-o", model.string(), "-n", "5", "--set", "learn.block=8"}, more);
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
  CHECK(summary["options"]["learn"]["block"] == 8);
  CHECK(summary["learning"]["passes"] == 1);
  const auto texture = dytex::linear_dynamic_texture(io::read_model(temp / "model", io::kTextureFormat));
  CHECK(texture.components() == 5);
  CHECK(texture.states.cols() == 30);
  CHECK((texture.C.transpose() * texture.C - Eigen::MatrixXf::Identity(5, 5)).norm() < 1e-5F);
  CHECK(summary["texture"]["parameters"] == 61 * 40 * 3 * 6 + 2 * 25);
  CHECK(fs::file_size(temp / "model/components.png") > 1000);
}

TEST_CASE("dytex learn by blocks learns inside a mask") {
  const TempFolder temp;
  const auto clip = write_strokes(temp / "clip", {61, 40}, 30);
  cv::Mat mask = cv::Mat::zeros(40, 61, CV_8U);
  mask.colRange(0, 30).setTo(255);
  const auto inside = (temp / "mask.png").string();
  cv::imwrite(inside, mask);
  REQUIRE(run_command(learn(clip, temp / "model", {"-q", "--mask", inside})).exit == 0);
  const auto texture = dytex::linear_dynamic_texture(io::read_model(temp / "model", io::kTextureFormat));
  const cv::Mat region = dytex::moving_region(texture);
  CHECK(cv::countNonZero(region.colRange(0, 30)) > 0);
  CHECK(cv::countNonZero(region.colRange(30, 61)) == 0);
}

TEST_CASE("dytex learn takes a clip of more than 5000 frames by blocks", "[slow]") {
  const TempFolder temp;
  const auto clip = write_waves(temp / "clip.avi", {}, 1, {16, 12}, 5001);
  const auto model = temp / "model";
  check_one_line({"dytex", "learn", clip, "-o", model.string(), "-q", "--em"}, 2, {"--em", "5000"}, model);
  const auto learned = run_command({"dytex", "learn", clip, "-o", model.string(), "-n", "5"});
  INFO(learned.err);
  REQUIRE(learned.exit == 0);
  CHECK(contains(learned.err, "blocks of 1024 frames"));
  CHECK(contains(learned.err, "of 5001 frames"));
}

TEST_CASE("dytex learn by blocks refuses what it cannot do") {
  const TempFolder temp;
  const auto clip = write_strokes(temp / "clip", {61, 40}, 30);
  const fs::path model = temp / "model";
  check_one_line(learn(clip, model, {"--em"}), 2, {"--em", "learn.block"}, model);
  check_one_line(learn(clip, model, {"--set", "learn.block=-1"}), 2, {"learn.block is -1"}, model);
  check_one_line(learn("nothing.avi", model), 1, {"cannot read nothing.avi"}, model);
  check_one_line(
      {"dytex", "learn", clip, "-o", model.string(), "-q", "--order", "auto", "--set", "learn.block=8"}, 2,
      {"order", "all frames at once"}, model);
}

TEST_CASE("dytex learn by blocks leaves no model on a full disk") {
  const TempFolder temp;
  const auto clip = write_strokes(temp / "clip", {160, 120}, 30);
  CommandOptions full;
  full.most_file_bytes = 50'000;
  const auto learned = run_command(learn(clip, temp / "model", {"-q"}), full);
  INFO(learned.err);
  CHECK(learned.exit == 1);
  CHECK(contains(learned.err, "cannot write"));
  CHECK_FALSE(fs::exists(temp / "model"));
}
