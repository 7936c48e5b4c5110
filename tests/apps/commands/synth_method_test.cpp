// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "core/io/model_folder.hpp"
#include "core/model_arrays.hpp"
#include "graph/io/motion_io.hpp"
#include "pipeline/clip_model.hpp"
#include "tests/apps/commands/learned_clip.hpp"

using namespace emberfold;
using namespace emberfold::apps;
using namespace emberfold::test;

TEST_CASE("a model of an older version, which kept textures too, is drawn as one without them") {
  const LearnedClip made(12);
  auto archive = io::read_model(made.model, io::kMotionFormat);
  archive.arrays["residual_within"] = core::float_array(cv::Mat(63, 63, CV_32F, cv::Scalar(1)));
  archive.arrays["residual_speed"] = {{1}, false, std::vector{2.0}};
  const auto older = made.temp / "older";
  io::write_model(older, archive);
  io::write_model(older / "texture", {R"({"format": "emberfold.linear_dynamic_texture"})",
                                      {{"A", core::float_array(cv::Mat(2, 2, CV_32F, cv::Scalar(1)))}}});
  const auto read = pipeline::to_archive(pipeline::clip_model(io::read_model(older, io::kMotionFormat)));
  CHECK(read.arrays.contains("footage"));
  CHECK_FALSE(read.arrays.contains("residual_within"));
  const auto drawn = [&](const std::string& model, const std::string& name, const std::string& method) {
    const auto clip = made.temp / (name + ".avi");
    const auto result =
        run_command({"synth", model, "-o", clip.string(), "--frames", "3", "-q", "--method", method});
    INFO(result.err);
    REQUIRE(result.exit == 0);
    return bytes_of(clip);
  };
  for (const char* method : {"footage", "diffusion"})
    CHECK(drawn(older.string(), std::string("older_") + method, method) == drawn(made.model, method, method));
}

TEST_CASE("synth says so where an edit shows in no frame") {
  const LearnedClip made;
  const auto warns = [&](const std::vector<std::string>& edit) {
    std::vector<std::string> arguments{"synth",    made.model, "-o",         (made.temp / "one.avi").string(),
                                       "--frames", "1",        "--overwrite"};
    arguments.insert(arguments.end(), edit.begin(), edit.end());
    const auto result = run_command(arguments);
    REQUIRE(result.exit == 0);
    return result.err.find("shows in none of the 1 frames") != std::string::npos;
  };
  CHECK(warns({"--set", "synth.splits=2"}));  // nothing parts in a first frame
  CHECK_FALSE(warns({"--method", "edit", "--speed", "0.5"}));
  CHECK_FALSE(warns({"--strokes", "coarse"}));
}

TEST_CASE("synth makes a clip of the model's footage unless strokes are asked for") {
  const LearnedClip made;
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
  CHECK(summary["options"]["synth"]["method"] == "footage");
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
  for (const auto& [method, more] : std::vector<std::pair<std::string, std::vector<std::string>>>{
           {"edit", {"--motion", (made.temp / "new.jsonl").string()}},
           {"diffusion", {"--intensity", "2"}},
           {"diffusion", {"--start", "stationary"}},
           {"edit", {"--strokes", "coarse"}},
           {"edit", {"--set", "synth.splits=2", "--speed", "0.5", "--reverse"}},
           {"diffusion", {"--set", "synth.splits=0.5"}},
           {"edit", {"--set", "synth.births=2"}}}) {
    auto arguments = more;
    arguments.insert(arguments.end(), {"--frames", "3", "--overwrite"});
    CHECK(draw("strokes.avi", arguments)["options"]["synth"]["method"] == method);
    arguments = {"synth", made.model, "-o", (made.temp / "no.avi").string(), "--method", "footage"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    check_one_line(arguments, 2, {more[0], "footage"}, made.temp / "no.avi");
  }
  const auto refuse = [&](const std::vector<std::string>& more, int exit,
                          const std::vector<std::string>& what) {
    std::vector<std::string> arguments{"synth", made.model, "-o", (made.temp / "no.avi").string()};
    arguments.insert(arguments.end(), more.begin(), more.end());
    check_one_line(arguments, exit, what, made.temp / "no.avi");
  };
  refuse({"--method", "edit", "--flicker", "2"}, 2, {"--method edit", "flicker"});
  refuse({"--method", "edit", "--start", "stationary"}, 2, {"--method edit", "--start"});
  const auto looped = run_command({"synth", made.model, "-o", (made.temp / "looped").string(), "--loop", "9",
                                   "--frames", "19", "--set", "synth.births=2", "-q"});
  INFO(looped.err);
  CHECK(looped.exit == 0);
  CHECK(bytes_of(made.temp / "looped/frame_00003.png") == bytes_of(made.temp / "looped/frame_00012.png"));
  refuse({"--loop", "1"}, 2, {"--loop is 1", "2 or more"});
  refuse({"--loop", "9", "--method", "diffusion"}, 2, {"--loop", "not diffusion"});
  refuse({"--loop", "9", "--flicker", "2"}, 2, {"--loop", "not diffusion: flicker needs drawn strokes"});
  const auto bytes = made.temp / "a/model/footage.npy";
  fs::resize_file(bytes, fs::file_size(bytes) - 1);
  refuse({"--frames", "2"}, 1, {"footage.npy"});
  fs::remove(bytes);
  refuse({"--method", "footage"}, 1, {"holds no frames of its clip"});
  refuse({"--method", "edit"}, 1, {"holds no frames of its clip"});
  CHECK(draw("older.avi", {"--frames", "3"})["options"]["synth"]["method"] == "diffusion");
}

TEST_CASE("synth edits the clip's own strokes, and says where it draws others") {
  const LearnedClip made;
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
  check_one_line({"synth", made.model, "-o", (made.temp / "no.avi").string(), "-q", "--method", "edit"}, 1,
                 {"holds no strokes of its clip's frames"}, made.temp / "no.avi");
}

TEST_CASE("synth lets the clip's strokes live again at other times, and says what that cannot show") {
  const LearnedClip made;
  const auto out = [&](const char* name) { return (made.temp / name).string(); };
  const auto draw = [&](const char* clip, const std::vector<std::string>& more) {
    std::vector<std::string> arguments{"synth",   made.model, "-o",       out(clip), "--method",
                                       "strokes", "--json",   "--frames", "20",      "--overwrite"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const auto result = run_command(arguments);
    INFO(result.err);
    REQUIRE(result.exit == 0);
    CHECK(contains(result.err, "of what moves is as in one frame of the clip"));
    return nlohmann::json::parse(result.out);
  };
  const auto summary =
      draw("a.avi", {"--motion", out("a.jsonl"), "--film", out("film.png"), "--threads", "2"});
  CHECK(summary["options"]["synth"]["method"] == "strokes");
  CHECK(summary["synthesis"]["copied_share"].get<double>() <= 1);
  std::ifstream stream(out("a.jsonl"));
  const auto motion = graph::read_motion(stream, "a.jsonl");
  REQUIRE(motion.sketch.frames.size() == 20);
  double patches = 0;
  for (const auto& graph : motion.sketch.frames) patches += static_cast<double>(graph.size()) / 20;
  CHECK(std::abs(patches - summary["synthesis"]["patches_per_frame"].get<double>()) < 0.01);
  draw("b.avi", {"--threads", "1"});
  CHECK(bytes_of(out("a.avi")) == bytes_of(out("b.avi")));
  draw("c.avi", {"--reverse", "--speed", "0.5", "--wind", "1,0", "--set", "synth.births=2"});
  CHECK(bytes_of(out("a.avi")) != bytes_of(out("c.avi")));
  const auto refuse = [&](const std::vector<std::string>& more, const std::vector<std::string>& what) {
    std::vector<std::string> arguments{"synth", made.model, "-o", out("no.avi"), "--method", "strokes"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    check_one_line(arguments, 2, what, out("no.avi"));
  };
  refuse({"--flicker", "2"}, {"--method strokes", "flicker"});
  refuse({"--start", "stationary"}, {"--method strokes", "--start"});
  refuse({"--set", "synth.splits=2"}, {"--method strokes", "rate of splits"});
  refuse({"--loop", "9"}, {"--loop", "not strokes"});
}

TEST_CASE("synth draws a texture of the clip's frames, and says what that has not") {
  const LearnedClip made;
  const auto out = [&](const char* name) { return (made.temp / name).string(); };
  const auto draw = [&](const char* clip, const std::string& threads) {
    const auto result = run_command({"synth", made.model, "-o", out(clip), "--method", "texture", "--json",
                                     "--frames", "20", "--threads", threads});
    INFO(result.err);
    REQUIRE(result.exit == 0);
    CHECK_FALSE(contains(result.err, "as in one frame"));
    return nlohmann::json::parse(result.out);
  };
  const auto summary = draw("a.avi", "2");
  CHECK(summary["options"]["synth"]["method"] == "texture");
  CHECK(summary["synthesis"].empty());
  draw("b.avi", "1");
  CHECK(bytes_of(out("a.avi")) == bytes_of(out("b.avi")));
  const auto source = read_clip(made.clip), drawn = read_clip(out("a.avi"));
  REQUIRE(drawn.frames.size() == 20);
  CHECK(std::abs(cv::mean(drawn.frames[5])[0] - cv::mean(source.frames[5])[0]) < 5);
  const auto refuse = [&](const std::vector<std::string>& more, const std::vector<std::string>& what) {
    std::vector<std::string> arguments{"synth", made.model, "-o", out("no.avi"), "--method", "texture"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    check_one_line(arguments, 2, what, out("no.avi"));
  };
  refuse({"--motion", out("a.jsonl")}, {"--motion", "not texture"});
  refuse({"--set", "synth.births=2"}, {"--set synth", "not texture"});
  refuse({"--reverse"}, {"--reverse", "--method texture"});
  refuse({"--loop", "9"}, {"--loop", "not texture"});
}

TEST_CASE("synth scales its frames and makes the ground transparent") {
  const LearnedClip made;
  const auto out = [&](const char* name) { return (made.temp / name).string(); };
  const auto run = [&](std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), {"synth", made.model, "--frames", "8", "-o"});
    const auto result = run_command(arguments);
    INFO(result.err);
    REQUIRE(result.exit == 0);
  };
  run({out("plain"), "-q"});
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

TEST_CASE("synth refuses sizes and grounds that cannot be") {
  const LearnedClip made(12);
  const auto out = made.temp / "new";
  const auto refused = [&](std::vector<std::string> arguments, int exit,
                           const std::vector<std::string>& what) {
    arguments.insert(arguments.begin(), {"synth", made.model, "-q"});
    check_one_line(arguments, exit, what, out);
  };
  const std::string to = out.string();
  refused({"-o", to, "--width", "0"}, 2, {"--width is 0", "16384"});
  refused({"-o", to, "--width", "99", "--height", "99"}, 2, {"distort", "160x120"});
  refused({"-o", to + ".mp4", "--alpha", "black"}, 2, {"--alpha", "PNG", "EXR"});
  refused({"-o", to, "--alpha", (made.temp / "none.png").string()}, 1, {"none.png"});
  refused({"-o", to, "--alpha", (made.temp / "clip/frame_00000.png").string(), "--width", "0"}, 2,
          {"--width"});
  cv::imwrite((made.temp / "tiny.png").string(), cv::Mat(5, 5, CV_8UC3, cv::Scalar(9, 9, 9)));
  refused({"-o", to, "--alpha", (made.temp / "tiny.png").string()}, 2, {"5x5", "160x120"});
}
