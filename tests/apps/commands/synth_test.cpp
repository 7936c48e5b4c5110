// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "core/io/clip_writer.hpp"
#include "core/io/model_folder.hpp"
#include "core/io/staged_output.hpp"
#include "core/model_arrays.hpp"
#include "graph/io/motion_io.hpp"
#include "mcmc/model/motion_model.hpp"
#include "mcmc/simulation/synthesize.hpp"
#include "pipeline/clip_model.hpp"
#include "pipeline/clip_synthesis.hpp"
#include "pipeline/frame_synthesis.hpp"
#include "sketch/background/still_background.hpp"
#include "sketch/rendering/sharpening.hpp"
#include "tests/apps/commands/learned_clip.hpp"
#include "tests/support/drawn_models.hpp"

using namespace emberfold;
using namespace emberfold::apps;
using namespace emberfold::test;

namespace {

/// Bytes of the largest file that is not whole yet; -1 where there is none.
std::intmax_t largest_unfinished(const fs::path& folder) {
  std::intmax_t largest = -1;
  std::error_code ignored;
  for (const auto& entry : fs::directory_iterator(folder, ignored))
    if (contains(entry.path().string(), ".part"))
      largest = std::max(largest, static_cast<std::intmax_t>(fs::file_size(entry.path(), ignored)));
  return largest;
}

}  // namespace

TEST_CASE("analyze writes the model that its clip's motion gives, and tells its figures") {
  const LearnedClip made;
  const auto model = mcmc::motion_model(io::read_model(made.model, io::kMotionFormat));
  CHECK(model.width == 160);
  CHECK(model.height == 120);
  CHECK(model.frames == 24);
  CHECK_FALSE(model.exemplars.empty());
  const Json summary = json_of(made.temp / "a/summary.json");
  CHECK_THAT(summary["model"]["sway"]["a1"].get<double>(),
             Catch::Matchers::WithinRel(model.displacement.a1, 1e-3));
  CHECK(summary["model"]["sway"]["radius"] < 1);
  CHECK(summary["model"]["exemplars"] == model.exemplars.size());
  CHECK(summary["files"].contains("model/"));
  CHECK(summary["sketch"]["coding_gain"]["positive_share"] > 0.5);
  CHECK(summary["sketch"]["coding_gain"]["mean"] > 0);
  CHECK(contains(bytes_of(made.temp / "a/report.html"), "\"learned\":{\"motion\":"));
}

TEST_CASE("synth shows the clip, the drawn sketch and the drawn frame beside each other") {
  const LearnedClip made;
  const auto avi = made.temp / "new.avi", film = made.temp / "film.avi", sheet = made.temp / "film.png";
  const auto draw = [&](const std::string& model, const fs::path& to) {
    const auto result = run_command(
        {"synth", model, "-o", avi.string(), "--frames", "12", "--film", to.string(), "-q", "--overwrite"});
    INFO(result.err);
    REQUIRE(result.exit == 0);
  };
  draw(made.model, film);
  const auto drawn = read_clip(avi), shown = read_clip(film);
  REQUIRE(shown.frames.size() == 12);
  // Three panels of one height beside each other: the last is the drawn frame, enlarged.
  const cv::Mat whole = shown.frames[7];
  const int height = 240, width = 320, label = whole.rows / height > 0 ? whole.rows % height : 0;
  REQUIRE(whole.cols >= 3 * width);
  cv::Mat panel = whole(cv::Rect(whole.cols - width - (whole.cols - 3 * width) % 2, label, width, height)),
          small;
  cv::resize(drawn.frames[7], small, {width, height}, 0, 0, cv::INTER_CUBIC);
  CHECK(cv::norm(panel, small, cv::NORM_L1) / double(small.total() * 3) < 8);
  draw(made.model, sheet);
  const cv::Mat rows = cv::imread(sheet.string());
  CHECK(rows.rows > 3 * height);
  CHECK(rows.cols > 6 * width);
  SECTION("a model without footage has none to show") {
    auto bare = pipeline::clip_model(io::read_model(made.model, io::kMotionFormat));
    bare.footage.reset();
    io::write_model(made.temp / "bare", pipeline::to_archive(bare));
    draw((made.temp / "bare").string(), sheet);
    CHECK(cv::imread(sheet.string()).rows < 3 * height);
  }
}

TEST_CASE("synth draws the frames of the model's graphs, in every form") {
  const LearnedClip made;
  const auto avi = made.temp / "new.avi", folder = made.temp / "new", mp4 = made.temp / "new.mp4",
             motion_file = made.temp / "new.jsonl", overlay = made.temp / "over.mp4";
  const auto result =
      run_command({"synth", made.model, "-o", avi.string(), "--frames", "40", "--seed", "5", "--json",
                   "--method", "diffusion", "--motion", motion_file.string(), "--overlay", overlay.string()});
  INFO(result.err);
  REQUIRE(result.exit == 0);
  std::ifstream stream(motion_file);
  const auto motion = graph::read_motion(stream, "new.jsonl");
  const auto archive = io::read_model(made.model, io::kMotionFormat);
  const auto model = mcmc::motion_model(archive);
  CHECK(motion == mcmc::synthesize(model, 40, 5));

  const auto drawn = read_clip(avi);
  REQUIRE(drawn.frames.size() == 40);
  CHECK(drawn.info.fps == 25);
  auto look = pipeline::render_options(model, sketch::read_background(archive, {model.width, model.height}));
  const auto sharpening = sketch::read_sharpening(archive);
  look.blur_share = sharpening.blur_share, look.contrast_gain = sharpening.contrast_gain;
  std::size_t patches = 0;
  double apart = 0;
  const auto expected = pipeline::FrameSynthesis(mcmc::Synthesis(model, 5), look).next(40);
  for (std::size_t t = 0; t < 40; ++t) {
    patches += motion.sketch.frames[t].size();
    CHECK(same_pixels(drawn.frames[t], expected[t]));
    // The graphs' own picture, but for what comes and goes.
    apart += cv::norm(drawn.frames[t], sketch::render_frame(motion.sketch.frames[t], look), cv::NORM_L1);
  }
  CHECK(apart / (40 * 3 * 160 * 120) < 6);
  CHECK(patches > 40 * 20);

  const Json summary = Json::parse(result.out);
  CHECK(summary["command"] == "synth");
  CHECK(summary["clip"]["frames"] == 40);
  CHECK_THAT(summary["synthesis"]["patches_per_frame"].get<double>(),
             Catch::Matchers::WithinAbs(double(patches) / 40, 0.01));
  CHECK(read_clip(overlay).frames.size() == 40);

  for (const auto& path : {folder, mp4})
    REQUIRE(run_command({"synth", made.model, "-o", path.string(), "--frames", "40", "--seed", "5", "-q",
                         "--method", "diffusion"})
                .exit == 0);
  const auto pictures = read_clip(folder), video = read_clip(mp4);
  REQUIRE(pictures.frames.size() == 40);
  CHECK(video.frames.size() == 40);
  for (std::size_t t = 0; t < 40; ++t) CHECK(same_pixels(pictures.frames[t], drawn.frames[t]));
}

TEST_CASE("a grey clip's model draws grey frames") {
  const LearnedClip made(12, false);
  const auto out = made.temp / "new.avi";
  for (const char* method : {"footage", "diffusion"}) {
    REQUIRE(run_command({"synth", made.model, "-o", out.string(), "--frames", "3", "-q", "--overwrite",
                         "--method", method})
                .exit == 0);
    CHECK(read_clip(out).info.channels == 1);
  }
}

TEST_CASE("models and new clips are the same bytes at any number of threads, and others for another seed",
          "[slow]") {
  const LearnedClip made;
  for (const char* threads : {"1", "2", "8"}) {
    const std::string folder = (made.temp / threads).string();
    REQUIRE(run_command({"analyze", made.clip, "-o", folder, "--threads", threads, "-q"}).exit == 0);
    REQUIRE(run_command({"synth", folder + "/model", "-o", folder + "/new.avi", "--motion",
                         folder + "/new.jsonl", "--frames", "50", "--threads", threads, "-q"})
                .exit == 0);
    REQUIRE(run_command({"synth", folder + "/model", "-o", folder + "/footage.avi", "--frames", "50",
                         "--threads", threads, "-q"})
                .exit == 0);
  }
  std::vector<std::string> names{"new.avi", "new.jsonl", "footage.avi"};
  for (const auto& entry : fs::directory_iterator(made.temp / "1/model"))
    names.push_back("model/" + entry.path().filename().string());
  CHECK(names.size() > 5);
  for (const auto& name : names) {
    INFO(name);
    const auto one = bytes_of(made.temp / "1" / name);
    CHECK(one.size() > 60);
    CHECK(one == bytes_of(made.temp / "2" / name));
    CHECK(one == bytes_of(made.temp / "8" / name));
  }
  for (const auto& [method, same] : {std::pair("footage", "footage.avi"), std::pair("edit", "new.avi")}) {
    REQUIRE(run_command({"synth", made.model, "-o", (made.temp / "other.avi").string(), "--frames", "50",
                         "--seed", "2", "-q", "--overwrite", "--method", method})
                .exit == 0);
    CHECK(bytes_of(made.temp / "other.avi") != bytes_of(made.temp / "1" / same));
  }
}

TEST_CASE("what is no motion model is refused by name, and nothing is written") {
  const LearnedClip made(12);
  const auto out = made.temp / "out.avi";
  const auto refused = [&](const std::string& model, const std::vector<std::string>& what) {
    check_one_line({"synth", model, "-o", out.string(), "-q", "--frames", "2"}, 1, what, out);
  };
  refused((made.temp / "nothing").string(), {"nothing"});
  refused(made.clip, {"is a clip, not a model; learn one with 'emberfold analyze'"});
  std::ofstream(made.temp / "file.avi") << "not a model";
  refused((made.temp / "file.avi").string(), {"file.avi"});

  const auto copy = [&](const std::string& name) {
    fs::copy(made.model, made.temp / name);
    return (made.temp / name).string();
  };
  const auto texture = copy("texture");
  replace_in(fs::path(texture) / "model.json", "emberfold.motion_model", "emberfold.linear_dynamic_texture");
  refused(texture, {"linear dynamic texture", "emberfold dytex synth"});
  const auto newer = copy("newer");
  replace_in(fs::path(newer) / "model.json", "\"version\": 1", "\"version\": 99");
  refused(newer, {"newer", "99"});
  const auto cut = copy("cut");
  fs::resize_file(fs::path(cut) / "first_patches.npy",
                  fs::file_size(fs::path(cut) / "first_patches.npy") / 2);
  refused(cut, {"first_patches"});
  const auto missing = copy("missing");
  fs::remove(fs::path(missing) / "birth.npy");
  refused(missing, {"birth"});
  const auto text = copy("text");
  fs::resize_file(fs::path(text) / "model.json", 200);
  refused(text, {"model.json"});
  const auto unstable = copy("unstable");
  replace_in(fs::path(unstable) / "model.json", "\"a1\": ", "\"a1\": 7");
  refused(unstable, {"unstable", "sway"});
  const auto nan = copy("nan");
  {
    std::fstream file(fs::path(nan) / "birth.npy", std::ios::in | std::ios::out | std::ios::binary);
    const double value = std::numeric_limits<double>::quiet_NaN();
    file.seekp(-8, std::ios::end);
    file.write(reinterpret_cast<const char*>(&value), 8);
  }
  refused(nan, {"nan", "birth"});
}

TEST_CASE("synth tells misuse in the option's name and leaves nothing behind when it fails") {
  const LearnedClip made(12);
  const auto out = made.temp / "out.avi";
  const auto refused = [&](int exit, const std::vector<std::string>& more,
                           const std::vector<std::string>& what) {
    std::vector<std::string> arguments{"synth", made.model, "-q"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    check_one_line(arguments, exit, what, out);
  };
  refused(2, {}, {"--output"});
  refused(2, {"-o", out.string(), "--frames", "0"}, {"--frames", "0"});
  refused(2, {"-o", out.string(), "--frames", "-3"}, {"--frames", "-3"});
  refused(2, {"-o", out.string(), "--frames", "many"}, {"--frames", "many"});
  refused(2, {"-o", out.string(), "--method", "paint"},
          {"--method", "paint", "edit, strokes, diffusion, texture"});
  refused(2, {"-o", out.string(), "--set", "synth.births=11"}, {"synth.births", "11"});
  refused(2, {"-o", (made.temp / "new.gif").string()}, {".gif"});
  refused(1, {"-o", (made.temp / "no/where.avi").string()}, {"no folder"});
  refused(1, {"-o", out.string(), "--motion", (made.temp / "no/where.jsonl").string()}, {"where.jsonl"});
  refused(2, {"-o", out.string(), "--film", (made.temp / "film.gif").string(), "--frames", "2"}, {".gif"});
  refused(2,
          {"-o", out.string(), "--film", (made.temp / "film.avi").string(), "--loop", "9", "--method",
           "diffusion"},
          {"--loop"});
  refused(2, {"-o", out.string(), "--overlay", (made.temp / "over.gif").string(), "--frames", "2"}, {".gif"});
  CommandOptions full;
  full.most_file_bytes = 3000;
  const auto result = run_command({"synth", made.model, "-o", out.string(), "-q", "--frames", "40"}, full);
  CHECK(result.exit == 1);
  CHECK_FALSE(fs::exists(out));
  std::size_t left = 0;
  for (const auto& entry : fs::directory_iterator(made.temp.path())) {
    INFO(entry.path());
    CHECK_FALSE(contains(entry.path().string(), ".part"));
    ++left;
  }
  CHECK(left == 2);  // the clip and its analysis
}

TEST_CASE("an interrupted synth leaves what was drawn, whole and of one length") {
  const LearnedClip made(12);
  const auto out = made.temp / "out.avi", motion = made.temp / "m.jsonl", overlay = made.temp / "over.avi";
  CommandOptions options;
  options.interrupt_if = [&] { return largest_unfinished(made.temp.path()) > 100'000; };
  const auto result = run_command({"synth", made.model, "-o", out.string(), "--motion", motion.string(),
                                   "--overlay", overlay.string(), "--frames", "2000", "--threads", "1"},
                                  options);
  INFO(result.err);
  CHECK(result.exit == 130);
  const auto clip = read_clip(out);
  const auto count = clip.frames.size();
  CHECK(count > 0);
  CHECK(count < 2000);
  CHECK(contains(result.err, "holds the " + std::to_string(count) + " of 2000 frames"));
  CHECK(read_clip(overlay).frames.size() == count);
  std::ifstream stream(motion);
  CHECK(graph::read_motion(stream, "m.jsonl").sketch.frames.size() == count);
  CHECK(std::distance(fs::directory_iterator(made.temp.path()), fs::directory_iterator()) == 5);
  // They are those that a shorter clip has.
  const auto shorter = made.temp / "shorter.avi";
  REQUIRE(
      run_command({"synth", made.model, "-o", shorter.string(), "--frames", "5", "-q", "--method", "edit"})
          .exit == 0);
  const auto five = read_clip(shorter);
  for (std::size_t t = 0; t < std::min<std::size_t>(5, count); ++t)
    CHECK(same_pixels(five.frames[t], clip.frames[t]));
}

TEST_CASE("a synth that is interrupted before its first frame keeps nothing") {
  const LearnedClip made(12);
  CommandOptions options;
  options.interrupt_if = [&] { return largest_unfinished(made.temp.path()) >= 0; };
  const auto result = run_command({"synth", made.model, "-o", (made.temp / "out.avi").string(), "--motion",
                                   (made.temp / "m.jsonl").string(), "--frames", "100000", "--threads", "1"},
                                  options);
  CHECK(result.exit == 130);
  CHECK(std::distance(fs::directory_iterator(made.temp.path()), fs::directory_iterator()) == 2);
}

TEST_CASE("synth changes the motion as it is asked to, and by nothing if by nothing") {
  const LearnedClip made;
  const auto plain = made.temp / "plain.avi", same = made.temp / "same.avi";
  REQUIRE(run_command({"synth", made.model, "-o", plain.string(), "--frames", "12", "-q"}).exit == 0);
  REQUIRE(run_command({"synth", made.model, "-o", same.string(), "--frames", "12", "-q", "--speed", "1",
                       "--set", "synth.births=1", "--intensity", "1"})
              .exit == 0);
  CHECK(bytes_of(plain) == bytes_of(same));
  const auto still = made.temp / "still.avi";
  const auto result = run_command({"synth", made.model, "-o", still.string(), "--frames", "12", "--intensity",
                                   "0", "--flicker", "0.5", "--start", "stationary", "--json"});
  INFO(result.err);
  REQUIRE(result.exit == 0);
  const Json edit = Json::parse(result.out)["options"]["edit"];
  CHECK(edit["intensity"] == 0);
  CHECK(edit["start"] == "stationary");
  CHECK(bytes_of(still) != bytes_of(plain));

  const auto none = made.temp / "none.avi";
  const auto refused = [&](const std::vector<std::string>& more, const std::string& what) {
    std::vector<std::string> arguments{"synth", made.model, "-o", none.string(), "--overwrite"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    check_one_line(arguments, 2, {what}, none);
  };
  refused({"--speed", "0"}, "--speed is 0, must be in 0.1…10");
  refused({"--set", "synth.deaths=0"}, "at most 4 times the deaths");
  refused({"--set", "synth.splits=-1"}, "synth.splits is -1");
  const auto black = made.temp / "black.png";
  cv::imwrite(black.string(), cv::Mat(40, 40, CV_8U, cv::Scalar(0)));
  refused({"--birth-map", black.string()}, "is black: nothing would be born");
}

TEST_CASE("models that nothing can be drawn from are refused with the reason") {
  const TempFolder temp;
  const auto out = temp / "out.avi";
  int count = 0;
  const auto refused = [&](const core::ModelArchive& archive, const std::vector<std::string>& what) {
    const auto folder = temp / std::to_string(count++);
    io::OutputFolder output(folder);
    io::write_model(output, "model", archive);
    output.commit();
    check_one_line({"synth", (folder / "model").string(), "-o", out.string(), "-q", "--frames", "2"}, 1, what,
                   out);
  };
  const auto good = made_model(96, 64, 16);
  auto model = good;
  model.exemplars.clear();
  refused(mcmc::to_archive(model), {"0/model", "no exemplars"});
  model = good;
  model.rates.birth.values.assign(model.rates.birth.values.size(), 0);
  model.rates.death_by_size = {};
  model.rates.split = model.rates.merge = model.rates.connect = model.rates.disconnect = 0;
  refused(mcmc::to_archive(model), {"1/model", "all rates of the model are 0"});
  auto archive = mcmc::to_archive(good);
  archive.text.replace(archive.text.find("1.31"), 4, "1.71");
  refused(archive, {"2/model", "sway is not stable", "spectral radius"});
  archive = mcmc::to_archive(good);
  archive.text.replace(archive.text.find("\"width\": 96"), 11, "\"width\": 48");
  refused(archive, {"3/model"});
  archive = mcmc::to_archive(good);
  sketch::add_sharpening(archive, {1.5, 1});
  refused(archive, {"4/model", "sharpening.npy is 1.5"});
  archive = mcmc::to_archive(good);
  archive.arrays["sharpening"] = {{1}, false, std::vector<double>{1}};
  refused(archive, {"5/model", "sharpening.npy is not two numbers"});
}
