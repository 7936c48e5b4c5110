// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <fstream>
#include <iterator>
#include <sstream>

#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>

#include "apps/builtin/open_clip.hpp"
#include "core/io/clip_reader.hpp"
#include "core/io/clip_writer.hpp"
#include "graph/curves/curve_strokes.hpp"
#include "graph/events/events.hpp"
#include "graph/io/motion_io.hpp"
#include "tests/apps/commands/run_command.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/drawn_motion.hpp"
#include "tests/support/messages.hpp"

using namespace emberfold;
using namespace emberfold::apps;
using namespace emberfold::test;

namespace {

// A folder of pictures: strokes that move, come apart, begin and end.
std::string write_clip(const fs::path& path, int width, int height, int frames, int count = 8) {
  const auto strokes = made_strokes(count, width, height, frames);
  const auto writer = io::create_video(path, {width, height}, 25, true);
  for (int t = 0; t < frames; ++t) writer->write(made_picture(strokes, width, height, t));
  writer->finish();
  return path.string();
}

std::string write_flat(const fs::path& path, int width, int height, int frames) {
  const auto writer = io::create_video(path, {width, height}, 25, true);
  for (int t = 0; t < frames; ++t) writer->write(cv::Mat(height, width, CV_8UC3, cv::Scalar(90, 120, 60)));
  writer->finish();
  return path.string();
}

bool is_one_clear_line(const std::string& text) {
  return text.starts_with("emberfold: ") && std::ranges::count(text, '\n') == 1 && text.ends_with("\n");
}

// Output without the warnings about a model of little data, and of images that tell no frame rate.
std::string without_model_warnings(const std::string& text) {
  std::istringstream lines(text);
  std::string rest;
  for (std::string line; std::getline(lines, line);)
    if (!line.starts_with("emberfold: warning: model: ") && !contains(line, "its frame rate is not known"))
      rest += line + "\n";
  return rest;
}

// Fails in a way that names `what`, in one line, and leaves nothing behind.
void check_refused(const std::vector<std::string>& arguments, int exit, const std::vector<std::string>& what,
                   const fs::path& output = {}) {
  const auto result = run_command(arguments);
  INFO(result.err);
  CHECK(result.exit == exit);
  CHECK(is_one_clear_line(result.err));
  CHECK(result.out.empty());
  for (const auto& part : what) CHECK(contains(result.err, part));
  if (!output.empty()) CHECK_FALSE(fs::exists(output));
}

}  // namespace

TEST_CASE("analyze writes everything it names, each readable and in agreement") {
  const TempFolder temp;
  const auto clip = write_clip(temp / "clip", 120, 90, 14);
  const auto result =
      run_command({"analyze", clip, "-o", (temp / "out").string(), "--json", "--reconstruction"});
  INFO(result.err);
  REQUIRE(result.exit == 0);
  const Json summary = Json::parse(result.out);
  CHECK(result.out == bytes_of(temp / "out/summary.json"));
  for (const auto& [name, about] : summary["files"].items()) CHECK(fs::exists(temp / "out" / name));
  CHECK(fs::exists(temp / "out/report.html"));

  std::ifstream motion_file(temp / "out/motion.jsonl"), sketch_file(temp / "out/sketch.jsonl"),
      events_file(temp / "out/events.json");
  const auto motion = graph::read_motion(motion_file, "motion.jsonl");
  CHECK(graph::read_sketch(sketch_file, "sketch.jsonl").frames.size() == motion.sketch.frames.size());
  const auto events = graph::read_events(events_file, "events.json");
  REQUIRE_FALSE(events.empty());
  CHECK(summary["clip"]["frames"] == 14);
  CHECK(summary["events"]["total"] == events.size());
  for (const auto& [name, count] : summary["events"]["classes"].items())
    CHECK(count == std::ranges::count_if(
                       events, [&type = name](const auto& e) { return graph::name(e.type) == type; }));
  std::size_t patches = 0;
  for (const auto& graph : motion.sketch.frames) patches += graph.size();
  CHECK(patches > 100);
  CHECK(summary["sketch"]["patches"] == patches);
  CHECK(summary["sketch"]["psnr"]["frames"] == 14);
  CHECK(summary["sketch"]["psnr"]["mean"] > 22.5);

  const auto video = core::read_all(*apps::open_clip((temp / "out/overlay.mp4").string(), {}, {}));
  CHECK(video.frames.size() == 14);
  CHECK(video.info.width == 640);
  const auto drawn = core::read_all(*apps::open_clip((temp / "out/reconstruction.avi").string(), {}, {}));
  CHECK(drawn.frames.size() == 14);
  CHECK(drawn.info.width == 120);
  CHECK(entries(temp / "out/matches") >= 1);
  for (const auto& entry : fs::directory_iterator(temp / "out"))
    CHECK_FALSE(contains(entry.path().filename().string(), ".part"));
}

TEST_CASE("analyze tells the events of curves where asked, and figures of the network in each frame") {
  const TempFolder temp;
  const auto clip = write_clip(temp / "clip", 160, 120, 12);
  REQUIRE(run_command({"analyze", clip, "-o", (temp / "out").string(), "--bottom-up", "--curve-events", "-q"})
              .exit == 0);
  std::ifstream motion_file(temp / "out/motion.jsonl"), events_file(temp / "out/events.json");
  const auto motion = graph::read_motion(motion_file, "motion.jsonl");
  auto expected = graph::stroke_events(graph::curves_as_strokes(motion));
  std::erase_if(expected, [&](const auto& event) { return graph::changes_names_alone(motion, event); });
  CHECK(graph::read_events(events_file, "events.json") == expected);
  const auto lines = [&](const char* name) {
    std::ifstream file(temp / "out" / name);
    return std::count(std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>(), '\n');
  };
  CHECK(lines("network.csv") == 13);
  CHECK(lines("curves.csv") > 12);
  CHECK(lines("contacts.csv") >= 1);
  // the figures of the network change as the changes of topology say, also in a sketched clip
  const Json topology = json_of(temp / "out/summary.json")["topology"];
  CHECK((topology["gaps"] == 11 && topology["balanced"] == 11));
  CHECK(topology["said"] == topology["measured"]);
  CHECK(lines("topology.csv") >= 1);
  CHECK(lines("tips.csv") > 1);
}

TEST_CASE("any number of threads writes the same bytes") {
  const TempFolder temp;
  const auto clip = write_clip(temp / "clip", 160, 120, 24);
  for (const char* threads : {"1", "2", "8"})
    REQUIRE(
        run_command({"analyze", clip, "-o", (temp / threads).string(), "--threads", threads, "-q"}).exit ==
        0);
  for (const char* name : {"sketch.jsonl", "motion.jsonl", "events.json", "events.csv", "trajectories.csv",
                           "strokes.csv", "curves.csv", "joints.csv", "topology.csv", "tips.csv",
                           "review.html", "birth_map.png", "death_map.png", "trajectories.png"}) {
    INFO(name);
    const auto one = bytes_of(temp / "1" / name);
    CHECK(one.size() > 100);
    CHECK(one == bytes_of(temp / "2" / name));
    CHECK(one == bytes_of(temp / "8" / name));
  }
}

TEST_CASE("a clip that never changes has no strokes and no events, and a report all the same") {
  const TempFolder temp;
  const auto clip = write_flat(temp / "clip", 64, 48, 5);
  const auto result = run_command({"analyze", clip, "-o", (temp / "out").string(), "--json", "--quiet"});
  CHECK(result.exit == 0);
  CHECK(without_model_warnings(result.err).empty());
  const Json summary = Json::parse(result.out);
  CHECK(summary["events"]["total"] == 0);
  CHECK(summary["sketch"]["patches"] == 0);
  CHECK(summary["sketch"]["psnr"]["mean"] > 45);
  CHECK(bytes_of(temp / "out/report.html").ends_with("</html>\n"));
}

TEST_CASE("a clip of 2 x 2 pixels goes through") {
  const TempFolder temp;
  const auto clip = write_flat(temp / "clip", 2, 2, 3);
  for (const char* command : {"analyze", "sketch"}) {
    const auto result = run_command({command, clip, "-o", (temp / command).string()});
    INFO(result.err);
    CHECK(result.exit == 0);
    CHECK(fs::file_size(temp / command / "overlay.mp4") > 0);
  }
}

TEST_CASE("sketch takes a single picture and its reconstruction is what it says") {
  const TempFolder temp;
  const auto clip = write_clip(temp / "clip", 120, 90, 1);
  for (const std::string patches : {"fitted", "pixels"}) {
    const auto out = temp / patches;
    const auto result = run_command({"sketch", clip, "-o", out.string(), "--patches", patches, "--json"});
    INFO(result.err);
    REQUIRE(result.exit == 0);
    const Json summary = Json::parse(result.out);
    const auto drawn = core::read_all(*apps::open_clip((out / "reconstruction.avi").string(), {}, {}));
    REQUIRE(drawn.frames.size() == 1);
    const cv::Mat truth = cv::imread((temp / "clip/frame_00000.png").string());
    const double mse = std::pow(cv::norm(truth, drawn.frames[0], cv::NORM_L2), 2) / (120 * 90 * 3);
    CHECK_THAT(summary["sketch"]["psnr"]["mean"].get<double>(),
               Catch::Matchers::WithinAbs(10 * std::log10(255.0 * 255.0 / mse), 0.01));
    CHECK(summary["sketch"]["sketchable_share"]["mean"] > 0.01);
  }
  // the frame's own pixels can only be nearer to it
  const auto mean = [&](const char* name) {
    return summary_of(temp / name)["sketch"]["psnr"]["mean"].get<double>();
  };
  CHECK(mean("pixels") > mean("fitted"));
}

TEST_CASE("what cannot be read is refused by name, exit 1") {
  const TempFolder temp;
  const auto out = temp / "out";
  check_refused({"analyze", (temp / "no.mp4").string(), "-o", out.string()}, 1, {"no.mp4"}, out);
  fs::create_directory(temp / "empty");
  check_refused({"analyze", (temp / "empty").string(), "-o", out.string()}, 1, {"empty"}, out);
  std::ofstream(temp / "text.mp4") << "This is a text, and no video at all.\n";
  check_refused({"analyze", (temp / "text.mp4").string(), "-o", out.string(), "-q"}, 1, {"text.mp4"}, out);
  const auto one = write_flat(temp / "one", 32, 32, 1);
  check_refused({"analyze", one, "-o", out.string(), "-q"}, 1, {"one", "at least two"}, out);
  check_refused({"score", (temp / "no.json").string(), (temp / "no.json").string()}, 1, {"no.json"});
}

TEST_CASE("misuse is told in the option's own name, exit 2") {
  const TempFolder temp;
  const auto out = temp / "out";
  const auto clip = write_flat(temp / "clip", 16, 16, 2);
  const auto refused = [&](const std::vector<std::string>& more, const std::vector<std::string>& what) {
    for (const char* command : {"analyze", "sketch"}) {
      std::vector<std::string> arguments{command, clip, "-o", out.string()};
      arguments.insert(arguments.end(), more.begin(), more.end());
      check_refused(arguments, 2, what, out);
    }
  };
  refused({"--set", "sketch.min_contrast=nan"}, {"sketch.min_contrast", "not finite"});
  refused({"--set", "sketch.min_contrast=inf"}, {"sketch.min_contrast", "not finite"});
  refused({"--set", "sketch.min_contrast=-3"}, {"sketch.min_contrast", "-3", "0"});
  refused({"--set", "sketch.finest_scale=30"}, {"sketch.finest_scale", "30", "20"});
  refused({"--set", "sketch.scales=0"}, {"sketch.scales", "0", "1"});
  refused({"--set", "sketch.scales=2.5"}, {"sketch.scales", "2.5", "whole"});
  refused({"--set", "sketch.spacing=five"}, {"sketch.spacing", "five", "number"});
  refused({"--scale", "nan"}, {"--scale", "nan", "16"});
  refused({"--scale", "0"}, {"--scale", "0", "16"});
  refused({"--range", "5:3"}, {"--range", "5:3"});
  refused({"--range", "x"}, {"--range", "x"});
  refused({"--threads", "-1"}, {"--threads", "-1", "1024"});
  refused({"--threads", "999999"}, {"--threads", "1024"});
  refused({"--seed", "-1"}, {"--seed", "-1"});
  refused({"--min-contrats", "3"}, {"--min-contrats", "--set sketch.min_contrast=VALUE"});
  refused({"--min-contrast", "3"}, {"--min-contrast", "--set sketch.min_contrast=VALUE"});
  refused({"--set", "sketch.colour=maybe"}, {"sketch.colour", "maybe", "true"});
  refused({"--set", "sketsh.colour=true"}, {"'sketsh'", "sketch", "did you mean sketch?"});
  refused({"--set", "sketch.min_contrats=1"}, {"'min_contrats'", "did you mean min_contrast?"});
  for (const char* odd : {"", "=", "sketch", "sketch.colour", "colour=true", "."})
    refused({"--set", odd}, {"--set"});
  refused({"surplus"}, {"surplus"});
  check_refused({"analyze", clip, "-o", out.string(), "--set", "match.max_motion=0"}, 2,
                {"match.max_motion", "0"}, out);
  check_refused({"sketch", clip, "-o", out.string(), "--patches", "round"}, 2,
                {"--patches", "round", "fitted", "pixels"}, out);
  check_refused({"analyze", clip}, 2, {"--output"});
  check_refused({"analyse", clip}, 2, {"analyse", "analyze"});
  check_refused({"frobnicate"}, 2, {"frobnicate"});
  check_refused({"--verson"}, 2, {"--verson", "--version"});
  check_refused({"score", "a", "b", "--radius", "-1"}, 2, {"--radius", "-1"});
  check_refused({"score", "a", "b", "--frames", "nan"}, 2, {"--frames", "not finite"});
}

TEST_CASE("an overview, help that opens with examples and shows the defaults, the version") {
  const auto overview = run_command({});
  CHECK(overview.exit == 0);
  for (const char* word : {"Examples:", "analyze", "sketch", "synth", "dytex", "compare", "score", "demo"})
    CHECK(contains(overview.out, word));
  for (const char* command : {"analyze", "sketch", "synth", "compare", "score", "demo"}) {
    const auto help = run_command({command, "--help"});
    CHECK(help.exit == 0);
    CHECK(help.err.empty());
    const auto examples = help.out.find("Examples:\n  emberfold " + std::string(command));
    REQUIRE(examples != std::string::npos);
    CHECK(examples < help.out.find("Usage:"));
    for (const char* option : {"--seed N [1]", "--threads", "--json", "--quiet"})
      CHECK(contains(help.out, option));
    CHECK(run_command({"help", command}).out == help.out);
  }
  CHECK(run_command({"help"}).out == overview.out);
  CHECK(run_command({"batch", "--help"}).out == run_command({"runs", "batch", "--help"}).out);  // an old name
  CHECK(run_command({"--version"}).out.starts_with("emberfold "));
}

TEST_CASE("the help of every command fits on one screen") {
  std::vector<std::vector<std::string>> commands{{}};
  for (const char* one : {"analyze", "runs", "export", "sketch", "synth", "compare", "score", "demo", "quilt",
                          "dytex", "motion"})
    commands.push_back({one});
  for (const char* one : {"batch", "gather", "bench-events"}) commands.push_back({"runs", one});
  for (const char* one : {"learn", "edit", "synth", "compose", "page", "info", "forecast", "curve",
                          "distance", "classify", "compress"})
    commands.push_back({"dytex", one});
  for (const char* one : {"info", "likelihood", "morph"}) commands.push_back({"motion", one});
  for (auto words : commands) {
    words.emplace_back("--help");
    const auto help = run_command(words);
    INFO(help.out);
    CHECK(help.exit == 0);
    CHECK(std::ranges::count(help.out, '\n') <= 24);
    const auto options = help.out.substr(help.out.find("Usage:"));
    CHECK(std::ranges::count(options, '\n') <= 17);  // the usage and 16 more
    std::istringstream lines(help.out);
    for (std::string line; std::getline(lines, line);) CHECK(line.size() <= 100);
  }
}

TEST_CASE("help lists what --set takes, with defaults and ranges, and the options of reading") {
  const auto all = run_command({"help", "options"});
  CHECK(all.exit == 0);
  for (const char* name : {"sketch.spacing", "match.max_motion", "learn.components", "compare.steps",
                           "synth.births", "quilt.overlap", "control.jitter"})
    CHECK(contains(all.out, std::string("\n  ") + name + " "));
  for (const char* own : {"sketch.sensitivity", "sketch.edges", "compare.frames", "score.frames"})
    CHECK_FALSE(contains(all.out, own));
  const auto own = run_command({"help", "options", "dytex", "learn"});
  CHECK(contains(own.out, "learn.noise_rank"));
  CHECK_FALSE(contains(own.out, "sketch."));
  // each line's default is what the struct holds, and its range what validate() tells
  std::istringstream lines(run_command({"help", "options", "compare"}).out);
  bool found = false;
  for (std::string line; std::getline(lines, line);) {
    if (!contains(line, "compare.steps")) continue;
    found = true;
    CHECK(contains(line, " 8 "));
    CHECK(contains(line, " 1 to 64 "));
  }
  CHECK(found);
  for (const char* word : {"--range", "--scale", "--grey", "builtin:", "stack.tif"})
    CHECK(contains(run_command({"help", "reading"}).out, word));
  CHECK(contains(run_command({"help", "common"}).out, "--threads"));
  check_refused({"help", "analyse"}, 2, {"analyse", "did you mean analyze?"});
  check_refused({"help", "options", "demo"}, 2, {"demo"});
}

TEST_CASE("a setting changes what its field changes, and the last of two counts") {
  const TempFolder temp;
  const auto clip = write_clip(temp / "clip", 96, 64, 2);
  const auto options = [&](const std::vector<std::string>& more) {
    std::vector<std::string> arguments{"sketch", clip, "-o", (temp / "out").string(), "--json", "-q"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const auto result = run_command(arguments);
    INFO(result.err);
    REQUIRE(result.exit == 0);
    return Json::parse(result.out)["options"]["sketch"];
  };
  const auto usual = options({});
  auto changed = usual;
  changed["spacing"] = 7.0;
  changed["boundaries"] = true;
  CHECK(options({"--set", "sketch.spacing=6", "--set", "sketch.boundaries=yes", "--set=sketch.spacing=7"}) ==
        changed);
  changed = usual;
  changed["edges"] = false;
  CHECK(options({"--no-edges"}) == changed);
}

TEST_CASE("progress is one line for each stage where there is no terminal, and none if quiet") {
  const TempFolder temp;
  const auto clip = write_clip(temp / "clip", 64, 48, 40, 3);
  const auto loud = run_command({"analyze", clip, "-o", (temp / "a").string()});
  CHECK(loud.exit == 0);
  CHECK(loud.out.empty());
  CHECK_FALSE(contains(loud.err, "\r"));
  std::istringstream lines(without_model_warnings(loud.err));
  std::vector<std::string> seen;
  for (std::string line; std::getline(lines, line);) seen.push_back(line);
  CHECK(seen.size() >= 3);
  CHECK(seen.size() <= 12);  // nine stages, what it will take, and the result
  std::ranges::sort(seen);
  CHECK(std::ranges::adjacent_find(seen) == seen.end());
  const auto quiet = run_command({"analyze", clip, "-o", (temp / "b").string(), "--quiet"});
  CHECK(quiet.exit == 0);
  CHECK(without_model_warnings(quiet.err).empty());
  CHECK(quiet.out.empty());
}

TEST_CASE("an output that cannot be written ends with exit 1 and nothing half done") {
  const TempFolder temp;
  const auto clip = write_clip(temp / "clip", 64, 48, 6, 3);
  std::ofstream(temp / "file") << "x";
  check_refused({"analyze", clip, "-o", (temp / "file").string(), "-q"}, 1, {(temp / "file").string()});
  check_refused({"sketch", clip, "-o", (temp / "file/sub").string(), "-q"}, 1, {"file"});
  if (::geteuid() != 0) {  // root may write anywhere
    fs::create_directory(temp / "locked");
    fs::permissions(temp / "locked", fs::perms::owner_read | fs::perms::owner_exec);
    check_refused({"analyze", clip, "-o", (temp / "locked").string(), "-q"}, 1, {"locked"});
  }
  for (const char* command : {"analyze", "sketch"})
    for (const long long most : {0LL, 2000LL, 9000LL}) {
      const auto out = temp / "out";
      CommandOptions options;
      options.most_file_bytes = most;
      const auto result = run_command({command, clip, "-o", out.string(), "-q"}, options);
      INFO(command << " with files up to " << most << ": " << result.err);
      CHECK(result.exit == 1);
      if (most > 0)
        CHECK(is_one_clear_line(without_model_warnings(result.err)));  // else not even this can be said
      CHECK_FALSE(contains(result.err, ".part"));
      // A run keeps what its stages made, and the events as soon as they are known; no other result.
      if (fs::exists(out)) {
        CHECK(command == std::string("analyze"));
        for (const auto& entry : fs::directory_iterator(out)) {
          const auto name = entry.path().filename().string();
          CHECK((name == "stages" || name == "events.json" || name == "events_all.json" ||
                 name == "events.csv"));
        }
      }
      fs::remove_all(out);
    }
  if (fs::exists("/dev/full")) {
    CommandOptions options;
    options.out_file = "/dev/full";
    std::ofstream(temp / "truth.json") << R"({"events": []})";
    const auto truth = (temp / "truth.json").string();
    const auto result = run_command({"score", truth, truth}, options);
    CHECK(result.exit == 1);
    CHECK(is_one_clear_line(result.err));
  }
}

TEST_CASE("Ctrl-C in the middle ends with exit 130, and nothing is left under a final name") {
  const TempFolder temp;
  const auto clip = write_clip(temp / "clip", 640, 480, 60, 40);
  const auto out = temp / "out";
  for (const char* command : {"analyze", "sketch"})
    for (const int signal : {SIGINT, SIGTERM}) {
      CommandOptions options;
      options.interrupt_if = [&] { return fs::exists(out); };
      options.signal = signal;
      const auto result = run_command({command, clip, "-o", out.string(), "--threads", "1"}, options);
      INFO(result.err);
      CHECK(result.exit == 130);
      CHECK(contains(result.err, "interrupted"));
      CHECK_FALSE(fs::exists(out));
    }
  fs::create_directory(out);
  std::ofstream(out / "events.json") << "an older run's";
  std::ofstream(out / "summary.json") << R"({"format": "emberfold.summary"})";
  CommandOptions options;
  options.interrupt_if = [&] { return fs::exists(out / "stages"); };  // while it is sketched
  CHECK(run_command({"analyze", clip, "-o", out.string(), "--threads", "1"}, options).exit == 130);
  CHECK(bytes_of(out / "events.json") == "an older run's");
  CHECK(entries(out) == 3);
}

TEST_CASE("score: the table, the JSON and what a reader refuses") {
  const TempFolder temp;
  const auto write = [&](const char* name, const std::string& text) {
    std::ofstream(temp / name) << text;
    return (temp / name).string();
  };
  const auto truth = write("truth.json", R"({"events": [
    {"frame": 3, "type": "birth", "x": 10, "y": 10}, {"frame": 9, "type": "split", "x": 50, "y": 50},
    {"frame": 12, "type": "merge", "x": 80, "y": 20}]})");
  const auto found = write("events.json", R"({"format": "emberfold.events", "version": 1, "events": [
    {"frame": 4, "type": "birth", "x": 12, "y": 10}, {"frame": 9, "type": "disconnect", "x": 52, "y": 50},
    {"frame": 30, "type": "merge", "x": 80, "y": 20}]})");
  const auto json = run_command({"score", truth, found, "--json"});
  REQUIRE(json.exit == 0);
  const Json score = Json::parse(json.out);
  CHECK(score["four"]["birth"] ==
        Json({{"true", 1}, {"found", 1}, {"hit", 1}, {"precision", 1.0}, {"recall", 1.0}, {"f1", 1.0}}));
  CHECK(score["four"]["separate"]["hit"] == 1);
  CHECK(score["four"]["unite"]["hit"] == 0);
  CHECK(score["four"]["all"]["hit"] == 2);
  CHECK(score["six"]["all"]["hit"] == 1);
  CHECK(score["six"]["disconnect"]["true"] == 0);
  const auto wide = run_command({"score", truth, found, "--json", "--frames", "18"});
  CHECK(Json::parse(wide.out)["four"]["all"]["hit"] == 3);
  const auto table = run_command({"score", truth, found});
  CHECK(contains(table.out, "four classes            true found   hit  precision  recall     F1\n"));
  CHECK(contains(table.out, "  birth                   1     1     1      1.000   1.000  1.000\n"));
  CHECK(contains(table.out, "  all                     3     3     2      0.667   0.667  0.667\n"));

  check_refused(
      {"score", truth, write("newer.json", R"({"format": "emberfold.events", "version": 99, "events": []})")},
      1, {"newer.json", "version"});
  check_refused({"score", truth, write("cut.json", R"({"events": [{"frame": 3, )")}, 1, {"cut.json"});
  check_refused(
      {"score", truth, write("odd.json", R"({"events": [{"frame": 1, "type": "bang", "x": 1, "y": 1}]})")}, 1,
      {"odd.json", "bang"});
}
