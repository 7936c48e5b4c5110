// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "apps/builtin/open_clip.hpp"
#include "core/io/clip_reader.hpp"
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
#include "sketch/rendering/sharpening.hpp"
#include "tests/apps/commands/run_command.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/drawn_models.hpp"
#include "tests/support/drawn_motion.hpp"
#include "tests/support/messages.hpp"

using namespace emberfold;
using namespace emberfold::apps;
using namespace emberfold::test;

namespace {

/// A clip of strokes that move, and what analyze makes of it.
struct Learned {
  TempFolder temp;
  std::string clip, model;

  explicit Learned(int frames = 24, bool colour = true) {
    const auto strokes = made_strokes(8, 160, 120, frames);
    const auto writer = io::create_video(temp / "clip", {160, 120}, 25, colour);
    for (int t = 0; t < frames; ++t) {
      cv::Mat picture = made_picture(strokes, 160, 120, t);
      if (!colour) cv::extractChannel(picture, picture, 1);
      writer->write(picture);
    }
    writer->finish();
    clip = (temp / "clip").string();
    model = (temp / "a/model").string();
    const auto result =
        run_command({"analyze", clip, "-o", (temp / "a").string(), "-q", "--set", "calibrate.calibrate=0"});
    INFO(result.err);
    REQUIRE(result.exit == 0);
  }
};

core::Clip read_clip(const fs::path& path) {
  return core::read_all(*apps::open_clip(path.string(), {}, {}));
}

void check_refused(const std::vector<std::string>& arguments, int exit, const std::vector<std::string>& what,
                   const fs::path& output) {
  const auto result = run_command(arguments);
  INFO(result.err);
  CHECK(result.exit == exit);
  CHECK(result.err.starts_with("emberfold: "));
  CHECK(std::ranges::count(result.err, '\n') == 1);
  for (const auto& part : what) CHECK(contains(result.err, part));
  CHECK(result.out.empty());
  CHECK_FALSE(fs::exists(output));
  CHECK_FALSE(fs::exists(output.string() + ".part"));
}

/// Bytes of the largest file that is not whole yet; -1 where there is none.
std::intmax_t largest_unfinished(const fs::path& folder) {
  std::intmax_t largest = -1;
  std::error_code ignored;
  for (const auto& entry : fs::directory_iterator(folder, ignored))
    if (contains(entry.path().string(), ".part"))
      largest = std::max(largest, static_cast<std::intmax_t>(fs::file_size(entry.path(), ignored)));
  return largest;
}

void replace_in(const fs::path& file, const std::string& from, const std::string& to) {
  std::string text = bytes_of(file);
  const auto at = text.find(from);
  REQUIRE(at != std::string::npos);
  text.replace(at, from.size(), to);
  std::ofstream(file, std::ios::binary) << text;
}

}  // namespace

TEST_CASE("analyze writes the model that its clip's motion gives, and tells its figures") {
  const Learned made;
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
  const Learned made;
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
  SECTION("an edited model has no footage to show") {
    const auto edited = (made.temp / "edited").string();
    REQUIRE(run_command({"motion", "edit", made.model, "-o", edited, "--births", "2", "-q"}).exit == 0);
    draw(edited, sheet);
    CHECK(cv::imread(sheet.string()).rows < 3 * height);
  }
}

TEST_CASE("synth draws the frames of the model's graphs, in every form") {
  const Learned made;
  const auto avi = made.temp / "new.avi", folder = made.temp / "new", mp4 = made.temp / "new.mp4",
             motion_file = made.temp / "new.jsonl", overlay = made.temp / "over.mp4";
  const auto result =
      run_command({"synth", made.model, "-o", avi.string(), "--frames", "40", "--seed", "5", "--json",
                   "--fill", "diffusion", "--motion", motion_file.string(), "--overlay", overlay.string()});
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
  auto look =
      pipeline::render_options(model, sketch::read_background(archive, {model.width, model.height}), {});
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
                         "--fill", "diffusion"})
                .exit == 0);
  const auto pictures = read_clip(folder), video = read_clip(mp4);
  REQUIRE(pictures.frames.size() == 40);
  CHECK(video.frames.size() == 40);
  for (std::size_t t = 0; t < 40; ++t) CHECK(same_pixels(pictures.frames[t], drawn.frames[t]));
}

TEST_CASE("a grey clip's model draws grey frames") {
  const Learned made(12, false);
  const auto out = made.temp / "new.avi";
  for (const char* fill : {"footage", "diffusion"}) {
    REQUIRE(run_command({"synth", made.model, "-o", out.string(), "--frames", "3", "-q", "--overwrite",
                         "--fill", fill})
                .exit == 0);
    CHECK(read_clip(out).info.channels == 1);
  }
}

TEST_CASE("models and new clips are the same bytes at any number of threads, and others for another seed") {
  const Learned made;
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
  for (const auto& [fill, same] : {std::pair("footage", "footage.avi"), std::pair("carried", "new.avi")}) {
    REQUIRE(run_command({"synth", made.model, "-o", (made.temp / "other.avi").string(), "--frames", "50",
                         "--seed", "2", "-q", "--overwrite", "--fill", fill})
                .exit == 0);
    CHECK(bytes_of(made.temp / "other.avi") != bytes_of(made.temp / "1" / same));
  }
}

TEST_CASE("what is no motion model is refused by name, and nothing is written") {
  const Learned made(12);
  const auto out = made.temp / "out.avi";
  const auto refused = [&](const std::string& model, const std::vector<std::string>& what) {
    check_refused({"synth", model, "-o", out.string(), "-q", "--frames", "2"}, 1, what, out);
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
  const Learned made(12);
  const auto out = made.temp / "out.avi";
  const auto refused = [&](int exit, const std::vector<std::string>& more,
                           const std::vector<std::string>& what) {
    std::vector<std::string> arguments{"synth", made.model, "-q"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    check_refused(arguments, exit, what, out);
  };
  refused(2, {}, {"--output"});
  refused(2, {"-o", out.string(), "--frames", "0"}, {"--frames", "0"});
  refused(2, {"-o", out.string(), "--frames", "-3"}, {"--frames", "-3"});
  refused(2, {"-o", out.string(), "--frames", "many"}, {"--frames", "many"});
  refused(2, {"-o", out.string(), "--fill", "paint"},
          {"--fill", "paint", "carried, diffusion, texture, dytex"});
  refused(2, {"-o", out.string(), "--set", "fill.tolerance=0"}, {"fill.tolerance", "0"});
  refused(2, {"-o", (made.temp / "new.gif").string()}, {".gif"});
  refused(1, {"-o", (made.temp / "no/where.avi").string()}, {"no folder"});
  refused(1, {"-o", out.string(), "--motion", (made.temp / "no/where.jsonl").string()}, {"where.jsonl"});
  refused(2, {"-o", out.string(), "--film", (made.temp / "film.gif").string(), "--frames", "2"}, {".gif"});
  refused(
      2,
      {"-o", out.string(), "--film", (made.temp / "film.avi").string(), "--loop", "9", "--fill", "texture"},
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
  const Learned made(12);
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
      run_command({"synth", made.model, "-o", shorter.string(), "--frames", "5", "-q", "--fill", "carried"})
          .exit == 0);
  const auto five = read_clip(shorter);
  for (std::size_t t = 0; t < std::min<std::size_t>(5, count); ++t)
    CHECK(same_pixels(five.frames[t], clip.frames[t]));
}

TEST_CASE("a synth that is interrupted before its first frame keeps nothing") {
  const Learned made(12);
  CommandOptions options;
  options.interrupt_if = [&] { return largest_unfinished(made.temp.path()) >= 0; };
  const auto result = run_command({"synth", made.model, "-o", (made.temp / "out.avi").string(), "--motion",
                                   (made.temp / "m.jsonl").string(), "--frames", "100000", "--threads", "1"},
                                  options);
  CHECK(result.exit == 130);
  CHECK(std::distance(fs::directory_iterator(made.temp.path()), fs::directory_iterator()) == 2);
}

TEST_CASE("synth changes the motion as it is asked to, and by nothing if by nothing") {
  const Learned made;
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
    check_refused(arguments, 2, {what}, none);
  };
  refused({"--speed", "0"}, "--speed is 0, must be in 0.1…10");
  refused({"--set", "synth.deaths=0"}, "at most 4 times the deaths");
  refused({"--set", "synth.splits=-1"}, "synth.splits is -1");
  const auto black = made.temp / "black.png";
  cv::imwrite(black.string(), cv::Mat(40, 40, CV_8U, cv::Scalar(0)));
  refused({"--birth-map", black.string()}, "is black: nothing would be born");
}

TEST_CASE("analyze learns what lies between strokes where asked, and synth draws it in step") {
  const Learned made(24);
  const auto folder = (made.temp / "b").string(), model = folder + "/model";
  for (const char* threads : {"1", "4"}) {
    const std::string name = folder + (threads[0] == '1' ? "" : threads);
    REQUIRE(run_command({"analyze", made.clip, "-o", name, "--bottom-up", "--texture", "4", "--threads",
                         threads, "-q"})
                .exit == 0);
    REQUIRE(run_command({"synth", name + "/model", "-o", name + "/new.avi", "--frames", "30", "--fill",
                         "dytex", "--threads", threads, "-q"})
                .exit == 0);
  }
  for (const char* file : {"model/texture/C.npy", "model/texture/states.npy", "new.avi"})
    CHECK(bytes_of(fs::path(folder) / file) == bytes_of(fs::path(folder + "4") / file));
  const Json summary = summary_of(fs::path(folder));
  CHECK(summary["model"]["texture"]["components"] == 4);
  CHECK(summary["model"]["texture"]["hidden_share"] > 0.02);
  CHECK(summary["seconds"].contains("texture"));
  // The texture is one of its own right.
  CHECK(run_command({"dytex", "info", model + "/texture"}).exit == 0);
  const auto opened = pipeline::read_clip_model(model, pipeline::ModelFill::dytex);
  pipeline::ClipSynthesis frames(opened, {.seed = 1, .fill_kind = pipeline::ModelFill::dytex});
  const auto drawn = read_clip(fs::path(folder) / "new.avi");
  REQUIRE(drawn.frames.size() == 30);
  for (std::size_t t = 0; t < 30; ++t) CHECK(same_pixels(drawn.frames[t], frames.next()));

  // The texture is edited with the strokes; by nothing if by nothing.
  for (const auto& [speed, same] : {std::pair{"1", true}, {"2", false}}) {
    const auto edited = made.temp / ("speed" + std::string(speed) + ".avi");
    REQUIRE(run_command({"synth", model, "-o", edited.string(), "--overwrite", "--frames", "30", "--fill",
                         "dytex", "-q", "--speed", speed})
                .exit == 0);
    CHECK((bytes_of(edited) == bytes_of(fs::path(folder) / "new.avi")) == same);
  }

  const auto out = made.temp / "out.avi";
  const auto refused = [&](const std::string& path, const std::vector<std::string>& what) {
    check_refused({"synth", path, "-o", out.string(), "-q", "--fill", "dytex"}, 1, what, out);
  };
  refused(made.model, {"holds no texture", "analyze --texture"});
  const auto copy = [&](const std::string& name) {
    fs::copy(model, made.temp / name, fs::copy_options::recursive);
    return (made.temp / name).string();
  };
  const auto newer = copy("newer");
  replace_in(fs::path(newer) / "texture/model.json", "\"version\": 2", "\"version\": 99");
  refused(newer, {"newer/texture", "99"});
  const auto other = copy("other");
  replace_in(fs::path(other) / "texture/model.json", "\"width\": 160", "\"width\": 120");
  replace_in(fs::path(other) / "texture/model.json", "\"height\": 120", "\"height\": 160");
  refused(other, {"other/texture", "120x160", "160x120"});
  const auto cut = copy("cut");
  fs::remove(fs::path(cut) / "texture/A.npy");
  refused(cut, {"cut/texture", "A"});
  // Without the texture option the damaged texture is not read.
  CHECK(run_command({"synth", cut, "-o", out.string(), "-q", "--frames", "2"}).exit == 0);
  check_refused({"analyze", made.clip, "-o", (made.temp / "c").string(), "--texture", "501", "-q"}, 2,
                {"--texture is 501"}, made.temp / "c");
}

TEST_CASE("synth lays the clip's residual on new frames where asked") {
  const Learned made;
  const auto plain = made.temp / "plain.avi";
  const auto draw = [&](const fs::path& out, const std::vector<std::string>& more) {
    std::vector<std::string> arguments{"synth",    made.model, "-o", out.string(),
                                       "--frames", "6",        "-q", "--overwrite"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const auto result = run_command(arguments);
    INFO(result.err);
    REQUIRE(result.exit == 0);
  };
  draw(plain, {});
  for (const char* threads : {"1", "4"})
    draw(made.temp / ("texture" + std::string(threads) + ".avi"),
         {"--fill", "texture", "--threads", threads});
  CHECK(bytes_of(made.temp / "texture1.avi") == bytes_of(made.temp / "texture4.avi"));
  CHECK(bytes_of(made.temp / "texture1.avi") != bytes_of(plain));
  // It goes at the strokes' speed.
  draw(made.temp / "back.avi", {"--fill", "texture", "--reverse"});
  draw(made.temp / "neutral.avi", {"--fill", "texture", "--speed", "1"});
  CHECK(bytes_of(made.temp / "back.avi") != bytes_of(made.temp / "texture1.avi"));
  CHECK(bytes_of(made.temp / "neutral.avi") == bytes_of(made.temp / "texture1.avi"));
  // A model of before there was such a thing.
  const auto old = made.temp / "old", out = made.temp / "out.avi";
  fs::copy(made.model, old, fs::copy_options::recursive);
  for (const char* name : {"within", "ahead", "colours", "strength"})
    fs::remove(old / ("residual_" + std::string(name) + ".npy"));
  const auto refused = [&](const fs::path& model, const std::vector<std::string>& what) {
    check_refused({"synth", model.string(), "-o", out.string(), "-q", "--fill", "texture"}, 1, what, out);
  };
  refused(old, {"old", "holds no residual", "emberfold analyze"});
  // One channel for frames of three.
  auto archive = io::read_model(made.model, io::kMotionFormat);
  for (const auto& [name, rows] : {std::pair{"within", 63}, {"ahead", 63}, {"colours", 1}})
    archive.arrays["residual_" + std::string(name)] =
        core::float_array(cv::Mat(rows, rows, CV_32F, cv::Scalar(1)));
  io::OutputFolder output(made.temp / "grey");
  io::write_model(output, "model", archive);
  output.commit();
  refused(made.temp / "grey/model", {"residual_within.npy is of 1 channels, its frames have 3"});
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
    check_refused({"synth", (folder / "model").string(), "-o", out.string(), "-q", "--frames", "2"}, 1, what,
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

TEST_CASE("synth makes a clip of the model's footage unless strokes are asked for") {
  const Learned made;
  const auto draw = [&](const std::string& name, const std::vector<std::string>& more) {
    std::vector<std::string> arguments{"synth",  made.model, "-o", (made.temp / name).string(),
                                       "--json", "-q"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const auto result = run_command(arguments);
    INFO(result.err);
    REQUIRE(result.exit == 0);
    return nlohmann::json::parse(result.out);
  };
  const auto summary = draw("new.avi", {"--frames", "40", "--loop", "20"});
  CHECK(summary["options"]["synth"]["fill"] == "footage");
  CHECK(summary["options"]["synth"]["loop"] == 20);
  CHECK(summary["synthesis"]["jump_cost"].get<double>() >= 0);
  CHECK(summary["synthesis"]["plays"].get<int>() >= 1);
  CHECK(summary["synthesis"]["plays_back"].is_boolean());
  const auto frames = read_clip(made.temp / "new.avi").frames;
  REQUIRE(frames.size() == 40);
  for (std::size_t t = 0; t < 20; ++t) CHECK(cv::norm(frames[t], frames[t + 20], cv::NORM_L1) == 0);
  // Strokes of the clip are bright lines on a ground; those of a footage have the clip's levels.
  const auto source = read_clip(made.clip).frames;
  CHECK(std::abs(cv::mean(frames[5])[0] - cv::mean(source[5])[0]) < 5);
  for (const auto& [fill, more] : std::vector<std::pair<std::string, std::vector<std::string>>>{
           {"carried", {"--motion", (made.temp / "new.jsonl").string()}},
           {"diffusion", {"--intensity", "2"}},
           {"diffusion", {"--start", "stationary"}},
           {"carried", {"--strokes", "coarse"}},
           {"carried", {"--set", "synth.splits=2", "--speed", "0.5", "--reverse"}},
           {"diffusion", {"--set", "synth.splits=0.5"}},
           {"carried", {"--set", "synth.births=2"}}}) {
    auto arguments = more;
    arguments.insert(arguments.end(), {"--frames", "3", "--overwrite"});
    CHECK(draw("strokes.avi", arguments)["options"]["synth"]["fill"] == fill);
    arguments = {"synth", made.model, "-o", (made.temp / "no.avi").string(), "--fill", "footage"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    check_refused(arguments, 2, {more[0], "footage"}, made.temp / "no.avi");
  }
  const auto refuse = [&](const std::vector<std::string>& more, int exit,
                          const std::vector<std::string>& what) {
    std::vector<std::string> arguments{"synth", made.model, "-o", (made.temp / "no.avi").string()};
    arguments.insert(arguments.end(), more.begin(), more.end());
    check_refused(arguments, exit, what, made.temp / "no.avi");
  };
  refuse({"--fill", "carried", "--flicker", "2"}, 2, {"--fill carried", "flicker"});
  refuse({"--fill", "carried", "--start", "stationary"}, 2, {"--fill carried", "--start"});
  const auto looped = run_command({"synth", made.model, "-o", (made.temp / "looped").string(), "--loop", "9",
                                   "--frames", "19", "--set", "synth.births=2", "-q"});
  INFO(looped.err);
  CHECK(looped.exit == 0);
  CHECK(bytes_of(made.temp / "looped/frame_00003.png") == bytes_of(made.temp / "looped/frame_00012.png"));
  refuse({"--fill", "texture", "--loop", "9"}, 2, {"--loop", "--fill draws strokes"});
  refuse({"--loop", "1"}, 2, {"--loop is 1", "2 or more"});
  refuse({"--loop", "9", "--fill", "diffusion"}, 2, {"--loop", "--fill draws strokes"});
  refuse({"--loop", "9", "--flicker", "2"}, 2, {"--loop", "--flicker draws strokes"});
  const auto bytes = made.temp / "a/model/footage.npy";
  fs::resize_file(bytes, fs::file_size(bytes) - 1);
  refuse({"--frames", "2"}, 1, {"footage.npy"});
  fs::remove(bytes);
  refuse({"--fill", "footage"}, 1, {"holds no frames of its clip"});
  refuse({"--fill", "carried"}, 1, {"holds no frames of its clip"});
  CHECK(draw("older.avi", {"--frames", "3"})["options"]["synth"]["fill"] == "diffusion");
}

TEST_CASE("synth carries the clip's own strokes where they are edited, and says where it draws others") {
  const Learned made;
  const auto out = made.temp / "new.avi", graphs = made.temp / "new.jsonl";
  const auto run = [&](const std::vector<std::string>& more) {
    std::vector<std::string> arguments{"synth",    made.model, "-o",         out.string(),
                                       "--frames", "30",       "--overwrite"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const auto result = run_command(arguments);
    INFO(result.err);
    REQUIRE(result.exit == 0);
    return result.err;
  };
  CHECK_FALSE(contains(run({"--motion", graphs.string()}), "drawn strokes"));
  std::ifstream stream(graphs);
  const auto motion = graph::read_motion(stream, "new.jsonl");
  REQUIRE(motion.sketch.frames.size() == 30);
  // Every frame and its graph are the clip's own.
  const auto source = read_clip(made.clip).frames;
  const auto drawn = read_clip(out).frames;
  for (std::size_t t = 0; t < drawn.size(); t += 7) {
    double least = 1e9;
    for (const auto& frame : source) least = std::min(least, cv::norm(frame, drawn[t], cv::NORM_L1));
    CHECK(least / double(drawn[t].total() * 3) < 6);
    CHECK(motion.sketch.frames[t].size() > 10);
  }
  CHECK(contains(run({"--set", "synth.merges=2"}), "merges above 1 needs drawn strokes"));
  fs::remove(made.temp / "a/model/footage_counts.npy");
  CHECK(contains(run({"--set", "synth.births=2"}), "holds none of its clip's frames"));
  check_refused({"synth", made.model, "-o", (made.temp / "no.avi").string(), "-q", "--fill", "carried"}, 1,
                {"holds no strokes of its clip's frames"}, made.temp / "no.avi");
}

TEST_CASE("synth scales its frames, makes the ground transparent, and tells where pixels come from") {
  const Learned made;
  const auto out = [&](const char* name) { return (made.temp / name).string(); };
  const auto run = [&](std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), {"synth", made.model, "--frames", "8", "-o"});
    const auto result = run_command(arguments);
    INFO(result.err);
    REQUIRE(result.exit == 0);
    return result.out;
  };
  const auto text = run({out("plain"), "--explain", out("map.png"), "--json", "-q"});
  const Json summary = Json::parse(text);
  double shares = 0;
  for (const auto& share : summary["synthesis"]["sources"]) shares += share.get<double>();
  CHECK_THAT(shares, Catch::Matchers::WithinAbs(1, 0.003));
  const cv::Mat map = cv::imread(out("map.png"));
  CHECK(map.cols > 6 * 160);
  CHECK(map.rows > 2 * 240 + 300);
  run({out("large"), "--width", "320", "-q"});
  run({out("clear/%04d.png"), "--alpha", "black", "-q"});
  run({out("small.avi"), "--height", "60", "-q"});
  const auto plain = read_clip(out("plain")), large = read_clip(out("large")),
             small = read_clip(out("small.avi"));
  REQUIRE(large.info.width == 320);
  REQUIRE(large.info.height == 240);
  REQUIRE(small.info.width == 80);
  cv::Mat back;
  cv::resize(large.frames[5], back, {160, 120}, 0, 0, cv::INTER_AREA);
  CHECK(cv::norm(back, plain.frames[5], cv::NORM_L1) / double(back.total() * 3) < 3);
  const cv::Mat clear = cv::imread(out("clear/0005.png"), cv::IMREAD_UNCHANGED);
  REQUIRE(clear.channels() == 4);
  for (int y = 0; y < clear.rows; y += 7)
    for (int x = 0; x < clear.cols; x += 7)
      for (int c = 0; c < 3; ++c) {
        const auto& pixel = clear.at<cv::Vec4b>(y, x);
        CHECK(std::abs(pixel[c] * pixel[3] / 255.0 - plain.frames[5].at<cv::Vec3b>(y, x)[c]) < 0.51);
      }
}

TEST_CASE("synth refuses sizes, grounds and maps that cannot be") {
  const Learned made(12);
  const auto out = made.temp / "new";
  const auto refused = [&](std::vector<std::string> arguments, int exit,
                           const std::vector<std::string>& what) {
    arguments.insert(arguments.begin(), {"synth", made.model, "-q"});
    check_refused(arguments, exit, what, out);
  };
  const std::string to = out.string();
  refused({"-o", to, "--width", "0"}, 2, {"--width is 0", "16384"});
  refused({"-o", to, "--width", "99", "--height", "99"}, 2, {"distort", "160x120"});
  refused({"-o", to + ".mp4", "--alpha", "black"}, 2, {"--alpha", "PNG", "EXR"});
  refused({"-o", to, "--alpha", (made.temp / "none.png").string()}, 1, {"none.png"});
  refused({"-o", to, "--alpha", (made.temp / "clip/frame_00000.png").string(), "--width", "0"}, 2,
          {"--width"});
  refused({"-o", to, "--explain", (made.temp / "map.jpg").string()}, 2, {"--explain", ".png"});
  refused({"-o", to, "--explain", (made.temp / "map.png").string(), "--fill", "diffusion"}, 2,
          {"--explain", "diffusion"});
  refused({"-o", to + "_%05d.exr", "--explain", to + "_%05d.exr"}, 2, {"--explain"});
  cv::imwrite((made.temp / "tiny.png").string(), cv::Mat(5, 5, CV_8UC3, cv::Scalar(9, 9, 9)));
  refused({"-o", to, "--alpha", (made.temp / "tiny.png").string()}, 2, {"5x5", "160x120"});
}
