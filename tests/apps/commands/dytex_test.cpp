// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <fstream>
#include <numbers>

#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

#include "apps/builtin/open_clip.hpp"
#include "apps/textures/texture_modes.hpp"
#include "core/io/clip_reader.hpp"
#include "core/io/model_folder.hpp"
#include "dytex/model/archive.hpp"
#include "tests/apps/commands/command_check.hpp"
#include "tests/support/messages.hpp"

using namespace emberfold;
using namespace emberfold::apps;
using namespace emberfold::test;

namespace {

// A texture whose modes are known: a pair of radius 0.9 and period 12, and a real one of radius 0.8.
dytex::LinearDynamicTexture known_texture() {
  dytex::LinearDynamicTexture texture;
  texture.info.width = 3, texture.info.height = 2, texture.info.channels = 1, texture.info.depth = CV_8U;
  texture.info.frames = 4;
  texture.mean = Eigen::VectorXf::Constant(6, 100);
  texture.C = Eigen::MatrixXf::Identity(6, 3);
  const double c = 0.9 * std::cos(std::numbers::pi / 6), s = 0.9 * std::sin(std::numbers::pi / 6);
  texture.A = Eigen::Matrix3d{{0.8, 0, 0}, {0, c, -s}, {0, s, c}};
  texture.B = Eigen::Matrix3d::Identity();
  texture.weights = Eigen::VectorXd::Ones(3);
  texture.states = Eigen::MatrixXd::Ones(3, 4);
  texture.singular = Eigen::Vector4d(6, 2, 1, 0.5);
  return texture;
}

}  // namespace

TEST_CASE("modes have the radius and period and decay of their eigenvalues") {
  const auto modes = texture_modes(known_texture());
  REQUIRE(modes.size() == 2);
  CHECK(modes[0].pair);
  CHECK_THAT(modes[0].radius, WithinAbs(0.9, 1e-12));
  CHECK_THAT(modes[0].period(), WithinRel(12.0, 1e-12));
  CHECK_THAT(modes[0].decay(), WithinRel(-1 / std::log(0.9), 1e-12));
  CHECK_FALSE(modes[1].pair);
  CHECK_THAT(modes[1].radius, WithinAbs(0.8, 1e-12));
  CHECK(std::isinf(modes[1].period()));
  CHECK_THAT(share_of_variance(known_texture(), 2), WithinRel(40 / 41.25, 1e-12));
  auto still = known_texture();
  still.singular.setZero();
  CHECK(share_of_variance(still, 2) == 1);
}

TEST_CASE("dytex learn writes a model and synth and info take it") {
  const TempFolder temp;
  const auto clip = write_strokes(temp / "clip", {61, 40}, 30);
  const auto model = (temp / "deep/model").string();
  const auto learned = run_command({"dytex", "learn", clip, "-o", model, "-n", "5", "--json"});
  INFO(learned.err);
  REQUIRE(learned.exit == 0);
  CHECK(learned.out == bytes_of(fs::path(model) / "summary.json"));
  const Json summary = Json::parse(learned.out);
  CHECK(summary["clip"]["frames"] == 30);
  CHECK(summary["texture"]["order"] == 5);
  const auto texture = dytex::linear_dynamic_texture(io::read_model(model, io::kTextureFormat));
  CHECK(texture.order() == 5);
  CHECK(texture.pixels() == 61 * 40 * 3);
  CHECK_THAT(summary["texture"]["share_of_variance"].get<double>(),
             WithinAbs(texture.singular.head(5).squaredNorm() / texture.singular.squaredNorm(), 1e-6));
  const cv::Mat picture = cv::imread((fs::path(model) / "components.png").string());
  CHECK(picture.cols == 12 + 4 * 252);
  CHECK(picture.rows > 300);

  const auto info = run_command({"dytex", "info", model});
  CHECK(info.exit == 0);
  for (const char* part : {"61 x 40", "colour", "30 frames", "components          5", "slowest modes"})
    CHECK(contains(info.out, part));
  CHECK(Json::parse(run_command({"dytex", "info", model, "--json"}).out) == summary["texture"]);

  for (const std::string out : {"new.avi", "new.mp4", "frames"}) {
    const auto drawn = run_command({"dytex", "synth", model, "-o", (temp / out).string(), "--frames", "9"});
    INFO(drawn.err);
    REQUIRE(drawn.exit == 0);
    CHECK(core::read_all(*apps::open_clip((temp / out).string(), {}, {})).frames.size() == 9);
  }
  // A second model takes the first one's place, whatever its order.
  CHECK(run_command({"dytex", "learn", clip, "-o", model, "--energy", "0.5", "-q"}).exit == 0);
  CHECK(dytex::linear_dynamic_texture(io::read_model(model, io::kTextureFormat)).order() < 5);
}

TEST_CASE("the start and the noise and the seed of a synthesis do what they say") {
  const TempFolder temp;
  const auto clip = write_strokes(temp / "clip", {40, 32}, 24);
  const auto model = (temp / "model").string();
  REQUIRE(run_command({"dytex", "learn", clip, "-o", model, "-n", "20", "-q"}).exit == 0);
  const auto first = [&](const std::vector<std::string>& more) {
    const auto out = (temp / "out").string();
    std::vector<std::string> arguments{"dytex",    "synth", model, "-o",         out,
                                       "--frames", "2",     "-q",  "--overwrite"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    REQUIRE(run_command(arguments).exit == 0);
    return cv::imread(out + "/frame_00000.png");
  };
  const auto away = [&](const cv::Mat& frame, int t) {
    const auto name = "frame_000" + std::string(t < 10 ? "0" : "") + std::to_string(t) + ".png";
    return cv::norm(frame, cv::imread((temp / "clip" / name).string()), cv::NORM_L2) /
           std::sqrt(3.0 * frame.rows * frame.cols);
  };
  const auto seventh = first({"--start", "7"});
  CHECK(away(seventh, 7) < 3);
  CHECK(away(seventh, 20) > 3 * away(seventh, 7));
  CHECK_FALSE(same_pixels(first({"--start", "7", "--noise"}), seventh));
  CHECK(same_pixels(first({}), first({"--start", "stationary", "--seed", "1"})));
  CHECK_FALSE(same_pixels(first({}), first({"--seed", "2"})));
}

TEST_CASE("dytex writes the same bytes at any number of threads") {
  const TempFolder temp;
  const auto clip = write_strokes(temp / "clip", {80, 60}, 24);
  for (const std::string threads : {"1", "2", "8"}) {
    const auto model = (temp / threads).string();
    REQUIRE(run_command({"dytex", "learn", clip, "-o", model, "--threads", threads, "-q"}).exit == 0);
    REQUIRE(run_command({"dytex", "synth", model, "-o", (temp / ("s" + threads)).string(), "--frames", "20",
                         "--threads", threads, "-q"})
                .exit == 0);
  }
  for (const std::string threads : {"2", "8"}) {
    for (const char* name : {"model.json", "A.npy", "B.npy", "C.npy", "mean.npy", "states.npy",
                             "singular.npy", "weights.npy", "components.png"}) {
      INFO(name);
      CHECK(bytes_of(temp / threads / name) == bytes_of(temp / "1" / name));
    }
    for (const char* name : {"frame_00000.png", "frame_00019.png"})
      CHECK(bytes_of(temp / ("s" + threads) / name) == bytes_of(temp / "s1" / name));
  }
}

TEST_CASE("what a model is learned by is asked for by words and told in the summary", "[slow]") {
  const TempFolder temp;
  const auto clip = write_strokes(temp / "clip", {40, 32}, 60);
  const auto learn = [&](const std::vector<std::string>& more) {
    const auto model = (temp / "model").string();
    const auto learned = run_command(joined({"dytex", "learn", clip, "-o", model, "--json", "-q"}, more));
    INFO(learned.err);
    REQUIRE(learned.exit == 0);
    REQUIRE(run_command({"dytex", "synth", model, "-o", (temp / "out.avi").string(), "--frames", "9", "-q",
                         "--overwrite"})
                .exit == 0);
    CHECK(run_command({"dytex", "info", model}).exit == 0);
    return Json::parse(learned.out);
  };
  const Json held_out = learn({"--order", "held-out"});
  CHECK(held_out["learning"]["held_out_errors"].size() > 10);
  CHECK(held_out["options"]["learn"]["order"] == "held-out");
  CHECK(learn({"--order", "auto"})["texture"] == held_out["texture"]);
  CHECK(learn({"--order", "gavish-donoho"})["learning"]["held_out_errors"].empty());
  CHECK(learn({"--method", "n4sid", "-n", "3"})["learning"]["transition"] == "n4sid");
  const Json ranked = learn({"--set", "learn.noise_rank=2", "-n", "6"});
  CHECK(ranked["texture"]["noise_inputs"] == 2);
  CHECK(ranked["texture"]["noise_share"] < 1);
  CHECK(ranked["texture"]["noise_share"] > 0.2);
  CHECK(ranked["options"]["learn"]["noise_rank"] == 2);
  CHECK(contains(run_command({"dytex", "info", (temp / "model").string()}).out, "driven by 2 noises, with "));
  CHECK(learn({"-n", "6"})["texture"]["noise_share"] == 1);
}

TEST_CASE("short clips get fewer components unless more were asked for") {
  const TempFolder temp;
  const auto clip = write_strokes(temp / "clip", {24, 20}, 6);
  const auto model = temp / "model";
  const auto learned = run_command({"dytex", "learn", clip, "-o", model.string()});
  CHECK(learned.exit == 0);
  CHECK(contains(learned.err, "6 frames: 5 components"));
  check_one_line({"dytex", "learn", clip, "-o", (temp / "no").string(), "-n", "6", "-q"}, 2,
                 {"--components is 6", "1 to 5"}, temp / "no");
}

TEST_CASE("what dytex cannot take is refused in one line") {
  const TempFolder temp;
  const auto clip = write_strokes(temp / "clip", {24, 20}, 6);
  const auto one = write_strokes(temp / "one", {24, 20}, 1);
  const auto model = (temp / "model").string(), out = (temp / "out").string();
  REQUIRE(run_command({"dytex", "learn", clip, "-o", model, "-q"}).exit == 0);
  const auto learn = [&](const std::vector<std::string>& more, int exit,
                         const std::vector<std::string>& what) {
    check_one_line(joined({"dytex", "learn"}, more, {"-o", out, "-q"}), exit, what, out);
  };
  learn({clip, "-n", "0"}, 2, {"--components", "0"});
  learn({clip, "-n", "3", "--set", "learn.noise_rank=4"}, 2, {"learn.noise_rank is 4", "0 to 3"});
  learn({clip, "-n", "3", "--set", "learn.noise_rank=-1"}, 2, {"learn.noise_rank is -1", "0 to 3"});
  learn({clip, "--set", "learn.noise_rank=6"}, 2, {"learn.noise_rank is 6", "0 to 5"});
  learn({clip, "-n", "3", "--em", "--set", "learn.noise_rank=1"}, 2, {"EM", "learn.noise_rank=0"});
  learn({clip, "-n", "2.5"}, 2, {"components", "2.5"});
  learn({clip, "-n", "3", "--energy", "0.9"}, 2, {"--energy", "--components"});
  learn({clip, "--energy", "0"}, 2, {"--energy", "0"});
  learn({clip, "--energy", "nan"}, 2, {"--energy"});
  learn({clip, "--energy", "1.5"}, 2, {"--energy", "1.5"});
  learn({clip, "--order", "best"}, 2, {"--order", "best", "held-out"});
  learn({clip, "--order", "auto", "-n", "3"}, 2, {"--order", "--components"});
  learn({clip, "--order", "held-out"}, 2, {"order", "at least 10", "6"});
  learn({clip, "--method", "magic"}, 2, {"--method", "magic", "n4sid"});
  learn({clip, "--set", "learn.block=-1"}, 2, {"learn.block", "-1", "0"});
  learn({one}, 1, {"one", "at least two"});
  learn({one, "--energy", "0.9"}, 1, {"one", "at least two"});
  learn({(temp / "no.mp4").string()}, 1, {"no.mp4"});
  learn({model}, 1, {"is no clip but a linear dynamic texture"});
  check_one_line({"dytex", "learn", clip, "-o", clip, "-q"}, 2, {"clip", "which is read"});
  check_one_line({"dytex", "learn", clip, "-o", one, "-q"}, 1, {"one", "other things"});

  const auto synth = [&](const std::vector<std::string>& more, int exit,
                         const std::vector<std::string>& what) {
    check_one_line(joined({"dytex", "synth"}, more, {"-o", out, "-q"}), exit, what, out);
  };
  synth({model, "--frames", "0"}, 2, {"--frames", "0", "1"});
  synth({model, "--start", "6"}, 2, {"--start", "6", "0 to 5"});
  synth({model, "--start", "-1"}, 2, {"--start"});
  synth({model, "--start", "soon"}, 2, {"--start", "soon", "stationary"});
  synth({clip}, 1, {"is a clip, not a model; learn one with 'emberfold dytex learn'"});
  synth({"builtin:fire"}, 1, {"is a clip, not a model"});
  synth({(temp / "no").string()}, 1, {"no such"});
  check_one_line({"dytex", "synth", model, "-o", (temp / "x.gif").string(), "-q"}, 2, {".gif"});
  check_one_line({"dytex", "info", clip}, 1, {"is a clip, not a model"});
  check_one_line({"dytex", "inof", model}, 2, {"inof", "info"});
  check_one_line({"analyze", model, "-o", out, "-q"}, 1, {"is no clip but a linear dynamic texture"}, out);
}

TEST_CASE("a damaged model is refused by the name of what is damaged") {
  const TempFolder temp;
  const auto clip = write_strokes(temp / "clip", {24, 20}, 6);
  const auto model = temp / "model";
  REQUIRE(run_command({"dytex", "learn", clip, "-o", model.string(), "-q"}).exit == 0);
  const auto refused = [&](const char* file, const std::function<void(std::string&)>& damage,
                           const std::vector<std::string>& what) {
    const auto whole = bytes_of(model / file);
    auto text = whole;
    damage(text);
    std::ofstream(model / file, std::ios::binary) << text;
    check_one_line({"dytex", "synth", model.string(), "-o", (temp / "out").string(), "-q"}, 1, what,
                   temp / "out");
    std::ofstream(model / file, std::ios::binary) << whole;
  };
  refused("model.json", [](auto& text) { text.resize(text.size() / 2); }, {"model.json"});
  refused("model.json",
          [](auto& text) {
            const auto at = text.find("\"version\"");
            text.replace(text.find_first_of("0123456789", at), 1, "99");
          },
          {model.string(), "version", "99"});
  refused("A.npy", [](auto& text) { text.resize(text.size() - 8); }, {"A.npy"});
  refused("A.npy", [](auto& text) { text.replace(text.size() - 8, 8, 8, '\xff'); }, {"A"});
  refused("C.npy", [&](auto& text) { text = bytes_of(model / "A.npy"); }, {"C"});
  fs::remove(model / "states.npy");
  check_one_line({"dytex", "info", model.string()}, 1, {model.string(), "states"});
}

TEST_CASE("help of dytex opens with examples") {
  for (const std::string command : {"learn", "synth", "info"}) check_help(command);
  const auto overview = run_command({"dytex"});
  CHECK(overview.exit == 0);
  for (const char* word : {"learn", "synth", "info"}) CHECK(contains(overview.out, word));
}
