// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "apps/builtin/open_clip.hpp"
#include "apps/pictures/draw.hpp"
#include "apps/pictures/overlay.hpp"
#include "apps/sketching/sketch_heat.hpp"
#include "apps/sketching/sketch_progress.hpp"
#include "core/io/clip_reader.hpp"
#include "graph/io/motion_io.hpp"
#include "pipeline/reconstruct.hpp"
#include "sketch/inpainting/fill.hpp"
#include "tests/apps/commands/command_check.hpp"
#include "tests/support/messages.hpp"

using namespace emberfold;
using namespace emberfold::apps;
using namespace emberfold::test;

namespace {

// Runs `emberfold sketch` and returns its summary.
Json sketched(const std::string& clip, const fs::path& out, const std::vector<std::string>& more) {
  const auto result = run_command(joined({"sketch", clip, "-o", out.string(), "--json", "-q"}, more, {}));
  INFO(result.err);
  REQUIRE(result.exit == 0);
  return Json::parse(result.out);
}

std::vector<cv::Mat> drawn_frames(const fs::path& path) {
  return core::read_all(*apps::open_clip(path.string(), {}, {})).frames;
}

// Two lines and grain of 12 grey levels, 64 × 48.
std::string write_grain(const fs::path& path, int frames) {
  const auto writer = io::create_video(path, {64, 48}, 25, false);
  for (int t = 0; t < frames; ++t) {
    cv::Mat frame =
        noise_frame({64, 48}, CV_8UC1, static_cast<std::uint64_t>(t) + 1, 24) + cv::Scalar::all(90);
    cv::line(frame, {14 + t, 0}, {16 + t, 47}, cv::Scalar::all(220), 3, cv::LINE_AA);
    cv::line(frame, {48 - t, 0}, {44, 47}, cv::Scalar::all(20), 3, cv::LINE_AA);
    writer->write(frame);
  }
  writer->finish();
  return path.string();
}

cv::Mat grey(const cv::Mat& frame) {
  cv::Mat out = frame;
  if (frame.channels() == 3) cv::cvtColor(frame, out, cv::COLOR_BGR2GRAY);
  return out;
}

// A disc and a border line on 60 × 40, nothing else.
sketch::Sketchable made_part() {
  sketch::Sketchable part{cv::Mat::zeros(40, 60, CV_32F), cv::Mat::zeros(40, 60, CV_8U)};
  cv::circle(part.mask, {40, 20}, 6, cv::Scalar(255), cv::FILLED);
  part.levels.setTo(230.5F, part.mask);
  part.mask.col(0).setTo(255);
  part.levels.col(0).setTo(10.25F);
  return part;
}

}  // namespace

TEST_CASE("strokes and anchors take the share asked for and bring the frame more than 3 dB nearer",
          "[slow]") {
  const TempFolder temp;
  for (const std::string patches : {"fitted", "pixels"}) {
    const auto alone = sketched("builtin:fire", temp / "alone",
                                {"--range", "30:32", "--anchors", "0", "--patches", patches});
    const auto held = sketched("builtin:fire", temp / "held", {"--range", "30:32", "--patches", patches});
    CHECK(held["options"]["drawing"]["anchors"] == 0.2);
    CHECK(alone["sketch"]["anchor_share"]["max"] == 0);
    for (std::size_t t = 0; t < 2; ++t) {
      const double patch_share = held["per_frame"]["sketchable_share"][t],
                   anchor_share = held["per_frame"]["anchor_share"][t];
      CHECK(patch_share < 0.6 * alone["per_frame"]["sketchable_share"][t].get<double>());
      CHECK(patch_share + anchor_share <= 0.2 + 1e-12);
      CHECK(patch_share + anchor_share > 0.19);
      CHECK(held["per_frame"]["psnr"][t] > alone["per_frame"]["psnr"][t].get<double>() + 3);
    }
  }
}

TEST_CASE("where the patches show as much as the anchors may there are none and a warning") {
  const TempFolder temp;
  const auto clip = write_strokes(temp / "clip", {80, 60}, 2);
  const auto with = sketched(clip, temp / "with", {"--anchors", "0.001"});
  const auto without = sketched(clip, temp / "without", {"--anchors", "0"});
  REQUIRE(without["sketch"]["sketchable_share"]["min"] > 0.01);
  CHECK(with["sketch"]["anchor_share"]["max"] == 0);
  REQUIRE(with["warnings"].size() == 2);  // and of the frame rate
  CHECK(contains(with["warnings"][1].get<std::string>(), "--anchors"));
  CHECK(bytes_of(temp / "with/reconstruction.avi") == bytes_of(temp / "without/reconstruction.avi"));
}

TEST_CASE("anchors fill the share that the cores of patches leave, with the frame's own pixels") {
  const TempFolder temp;
  const cv::Mat noise = noise_frame({60, 40}, CV_8UC1, 7);
  cv::Mat levels;
  noise.convertTo(levels, CV_32F);
  graph::Patch patch;
  patch.position = {30, 20};
  patch.width = 8;
  const graph::AttributeGraph graph{{{{1}, {}, patch}}, {}};
  const auto cores = sketch::draw_cores(graph, levels.size(), 1);
  const int strokes = cv::countNonZero(cores.mask);
  CHECK(strokes < cv::countNonZero(sketch::draw_fitted(graph, levels.size(), 1).mask));
  for (const auto drawing : {pipeline::PatchDrawing::fitted, pipeline::PatchDrawing::pixels}) {
    for (const int total : {strokes + 1, strokes + 137, 1800}) {
      const auto both = pipeline::add_anchors(graph, levels, drawing, total / 2400.0);
      CHECK(both.size() == static_cast<std::size_t>(total - strokes + 1));
      const auto held = pipeline::draw_patches(levels, both, drawing);
      CHECK(cv::countNonZero(held.mask) == total);
      const cv::Mat own = (held.mask != 0) & (cores.mask == 0);
      CHECK(cv::norm(held.levels, levels, cv::NORM_INF, own) == 0);
      const cv::Mat& of_strokes = drawing == pipeline::PatchDrawing::fitted ? cores.levels : levels;
      CHECK(cv::norm(held.levels, of_strokes, cv::NORM_INF, cores.mask) == 0);
    }
    CHECK(pipeline::add_anchors(graph, levels, drawing, strokes / 2400.0).size() == 1);
  }
}

TEST_CASE("anchors are in sketch.jsonl, which draws what the command drew, and are no strokes") {
  const TempFolder temp;
  const auto clip = write_strokes(temp / "clip", {80, 60}, 3);
  const auto sketch_of = [&](const char* name) {
    std::ifstream file(temp / name / "sketch.jsonl");
    return graph::read_sketch(file, name);
  };
  for (const std::string patches : {"fitted", "pixels"}) {
    const auto with = sketched(clip, temp / "with", {"--anchors", "0.3", "--patches", patches});
    const auto without = sketched(clip, temp / "without", {"--anchors", "0"});
    const auto both = sketch_of("with"), strokes = sketch_of("without");
    const auto drawn = drawn_frames(temp / "with/reconstruction.avi");
    const auto inputs = drawn_frames(clip);
    REQUIRE(both.frames.size() == 3);
    for (std::size_t t = 0; t < 3; ++t) {
      const auto& frame = both.frames[t];
      const auto alone = graph::without_anchors(frame);
      CHECK(alone.size() == strokes.frames[t].size());
      CHECK(graph::curves(frame).size() == graph::curves(strokes.frames[t]).size());
      const auto anchors = static_cast<double>(frame.size() - alone.size());
      CHECK_THAT(with["per_frame"]["anchor_share"][t].get<double>() * 80 * 60, WithinAbs(anchors, 1e-6));
      cv::Mat levels;
      inputs[t].convertTo(levels, CV_32F);
      const auto drawing =
          patches == "fitted" ? pipeline::PatchDrawing::fitted : pipeline::PatchDrawing::pixels;
      const auto again = pipeline::reconstruct(levels, frame, drawing);
      cv::Mat bytes = again.bytes;
      if (bytes.channels() != drawn[t].channels()) cv::cvtColor(bytes, bytes, cv::COLOR_GRAY2BGR);
      CHECK(cv::norm(bytes, drawn[t], cv::NORM_INF) <= 1);
      CHECK(again.psnr > pipeline::reconstruct(levels, alone, drawing).psnr + 6);
      // Pictures of the graph show strokes alone.
      cv::Mat colour = inputs[t];
      if (colour.channels() == 1) cv::cvtColor(colour, colour, cv::COLOR_GRAY2BGR);
      CHECK(same_pixels(draw_types(colour, frame, 0), draw_types(colour, alone, 0)));
    }
    CHECK(with["per_frame"]["patches"] == without["per_frame"]["patches"]);
    CHECK(bytes_of(temp / "with/overlay.mp4") == bytes_of(temp / "without/overlay.mp4"));
  }
}

TEST_CASE("the film has four panels of all frames and its picture is the middle one") {
  const TempFolder temp;
  const auto clip = write_strokes(temp / "clip", {80, 60}, 7);
  const auto summary = sketched(clip, temp / "out", {"--film", "--anchors", "0.3"});
  const auto film = drawn_frames(temp / "out/film.mp4");
  REQUIRE(film.size() == 7);
  const int height = 480, width = 640;  // of a panel: the graph is drawn with 480 px on the shorter side
  CHECK(film[0].cols == 4 * width + 3 * 6);
  CHECK(film[0].rows > height + 28);
  const cv::Mat picture = cv::imread((temp / "out/film.png").string());
  REQUIRE(picture.size() == film[0].size());
  const auto distance = [&](const cv::Mat& frame) {
    return cv::norm(frame, picture, cv::NORM_L1) / double(picture.total() * 3);
  };
  for (std::size_t t = 0; t < film.size(); ++t)
    CHECK((t == 3 ? distance(film[t]) < 3 : distance(film[t]) > distance(film[3])));
  // The panels show what they are said to: the input, and the reconstruction.
  const auto panel = [&](int index) {
    cv::Mat small;
    cv::resize(picture(cv::Rect(index * (width + 6), 28, width, height)), small, {80, 60}, 0, 0,
               cv::INTER_AREA);
    return small;
  };
  const auto mean_error = [](const cv::Mat& a, const cv::Mat& b) {
    return cv::norm(a, b, cv::NORM_L1) / double(a.total() * 3);
  };
  CHECK(mean_error(panel(0), drawn_frames(clip)[3]) < 2);
  CHECK(mean_error(panel(3), drawn_frames(temp / "out/reconstruction.avi")[3]) < 2);
  cv::Mat open;
  cv::inRange(panel(2), cv::Scalar::all(127), cv::Scalar::all(129), open);
  CHECK(cv::countNonZero(open) > 0.3 * 80 * 60);
  CHECK(summary["options"]["drawing"]["anchors"] == 0.3);
}

TEST_CASE("steps of a film of heat are geometric as far as whole numbers allow") {
  for (const auto& [last, count] : std::vector<std::pair<std::int64_t, int>>{
           {1, 2}, {5, 96}, {95, 96}, {96, 96}, {1000, 96}, {1000000, 96}, {20000000000LL, 96}}) {
    const auto steps = heat_steps(last, count);
    CHECK(steps.front() == 0);
    CHECK(steps.back() == last);
    CHECK(std::ranges::adjacent_find(steps, std::greater_equal<>()) == steps.end());
    CHECK(steps.size() == static_cast<std::size_t>(std::min<std::int64_t>(count, last + 1)));
  }
  const auto steps = heat_steps(1000000, 96);
  const double ratio = double(steps[95]) / double(steps[94]);
  CHECK(ratio > 1.1);
  for (std::size_t i = 60; i < steps.size(); ++i)
    CHECK_THAT(double(steps[i]) / double(steps[i - 1]), WithinAbs(ratio, 0.01));
}

TEST_CASE("the film of heat goes from the patches on grey to the fill") {
  const auto part = made_part();
  std::vector<HeatMoment> moments;
  const bool near = run_heat(part, cv::Scalar::all(0), {}, {}, [&](const HeatMoment& m) {
    moments.push_back({m.levels.clone(), m.steps, m.time, m.at_rest});
  });
  CHECK(near);
  CHECK(moments.size() > 60);
  CHECK(moments.size() < 140);
  CHECK(cv::norm(moments[0].levels, cv::Mat(40, 60, CV_32F, cv::Scalar(128)), cv::NORM_INF, part.mask == 0) ==
        0);
  const cv::Mat rest = sketch::fill(part.levels, part.mask).levels;
  double before = 1e9;
  for (const auto& moment : moments) {
    CHECK(cv::norm(moment.levels, part.levels, cv::NORM_INF, part.mask) == 0);
    const double distance = cv::norm(moment.levels, rest, cv::NORM_INF);
    CHECK(distance <= before + 0.05);  // the fill is exact to 0.03
    CHECK_THAT(moment.time, WithinAbs(0.25 * double(moment.steps), 1e-9));
    before = distance;
  }
  CHECK(cv::norm(moments[moments.size() - 2].levels, rest, cv::NORM_INF) < 0.5);
  CHECK(moments.back().at_rest);
  CHECK(cv::norm(moments.back().levels, rest, cv::NORM_INF) == 0);

  HeatOptions hurried;
  hurried.most_work = 60 * 40 * 20;
  moments.clear();
  CHECK_FALSE(
      run_heat(part, cv::Scalar::all(0), hurried, {}, [&](const HeatMoment& m) { moments.push_back(m); }));
  CHECK(moments.back().at_rest);
  CHECK(moments.back().steps <= 20);
  // Nothing held: nothing flows.
  const sketch::Sketchable none{cv::Mat::zeros(8, 8, CV_32F), cv::Mat::zeros(8, 8, CV_8U)};
  CHECK(run_heat(none, cv::Scalar::all(77), {}, {}, [&](const HeatMoment& m) {
    CHECK(cv::norm(m.levels, cv::Mat(8, 8, CV_32F, cv::Scalar(77)), cv::NORM_INF) == 0);
  }));
}

TEST_CASE("heat.mp4 ends with the reconstruction") {
  const TempFolder temp;
  const auto clip = write_grain(temp / "clip", 3);
  sketched(clip, temp / "out", {"--heat-film", "1"});
  const auto heat = drawn_frames(temp / "out/heat.mp4");
  CHECK(heat.size() > 60);
  const cv::Mat drawn = grey(drawn_frames(temp / "out/reconstruction.avi")[1]);
  const cv::Mat shown = enlarge(drawn, 480.0 / drawn.rows);
  const auto mean_error = [&](const cv::Mat& picture) {
    return cv::norm(grey(picture).rowRange(0, 480), shown, cv::NORM_L1) / double(shown.total());
  };
  CHECK(mean_error(heat.back()) < 3);  // H.264 in 4:2:0 takes 2 levels; run_heat itself is held to the fill
  CHECK(mean_error(heat.front()) > 8);
}

TEST_CASE("every fill draws texture of its own the same at any number of threads and in any part", "[slow]") {
  const TempFolder temp;
  const auto clip = write_grain(temp / "clip", 3);
  sketched(clip, temp / "diffusion", {});
  const auto smooth = drawn_frames(temp / "diffusion/reconstruction.avi");
  const auto spread = [&](const cv::Mat& frame) {  // from pixel to pixel, between the lines
    cv::Mat levels, beside;
    grey(frame).convertTo(levels, CV_32F);
    cv::subtract(levels(cv::Rect(24, 8, 16, 32)), levels(cv::Rect(25, 8, 16, 32)), beside);
    return cv::norm(beside, cv::NORM_L2) / std::sqrt(16.0 * 32);
  };
  const double true_spread = spread(drawn_frames(clip)[1]);
  for (const std::string fill : {"diffusion", "julesz", "efros-leung"}) {
    INFO(fill);
    std::vector<std::string> more{"--fill", fill, "--anchors", "0.1", "--film"};
    const auto one = sketched(clip, temp / "1", joined(more, {"--threads", "1"}, {}));
    sketched(clip, temp / "4", joined(more, {"--threads", "4"}, {}));
    for (const char* name : {"sketch.jsonl", "reconstruction.avi", "film.png", "overlay.mp4"}) {
      INFO(name);
      CHECK(bytes_of(temp / "1" / name).size() > 100);
      CHECK(bytes_of(temp / "1" / name) == bytes_of(temp / "4" / name));
    }
    CHECK(one["options"]["fill"]["kind"] == fill);
    CHECK(one["sketch"]["fill"] == fill);
    if (fill == "diffusion") continue;

    const auto summary = sketched(clip, temp / "own", {"--fill", fill, "--regions", "3"});
    const auto textured = drawn_frames(temp / "own/reconstruction.avi");
    CHECK(summary["per_frame"]["regions"] == Json({3, 3, 3}));
    CHECK(spread(smooth[1]) < 0.5 * true_spread);
    CHECK(spread(textured[1]) > 0.6 * true_spread);
    CHECK(spread(textured[1]) < 1.5 * true_spread);
    sketched(clip, temp / "part", {"--fill", fill, "--regions", "3", "--range", "1:3"});
    CHECK(same_pixels(drawn_frames(temp / "part/reconstruction.avi")[0], textured[1]));
    sketched(clip, temp / "seed", {"--fill", fill, "--regions", "3", "--seed", "2"});
    CHECK_FALSE(same_pixels(drawn_frames(temp / "seed/reconstruction.avi")[1], textured[1]));
    if (fill == "julesz") CHECK(summary["sketch"]["histogram_distance"]["max"] < 0.1);
  }
}

TEST_CASE("sketches of a clip are the same bytes at any number of threads") {
  const TempFolder temp;
  sketched("builtin:river", temp / "several", {"--range", "20:28", "--threads", "3"});
  sketched("builtin:river", temp / "one", {"--range", "20:28", "--threads", "1"});
  CHECK(bytes_of(temp / "several/sketch.jsonl") == bytes_of(temp / "one/sketch.jsonl"));
}

TEST_CASE("curves may come from a file, one image for all frames or one for each") {
  const TempFolder temp;
  const auto clip = (temp / "clip.avi").string();
  const auto writer = io::create_video(clip, {96, 64}, 25, false);
  for (int t = 0; t < 4; ++t) {
    cv::Mat1b frame(64, 96, std::uint8_t{90});
    cv::line(frame, {10, 20}, {86, 20}, cv::Scalar(110), 3);
    cv::line(frame, {10, 44}, {86, 44}, cv::Scalar(110), 3);
    cv::GaussianBlur(frame, frame, {}, 1);
    writer->write(frame);
  }
  writer->finish();
  cv::Mat1b map(64, 96, std::uint8_t{0});
  cv::line(map, {10, 44}, {86, 44}, cv::Scalar(230), 2);
  cv::imwrite((temp / "one.png").string(), map);
  for (int t = 0; t < 3; ++t) cv::imwrite((temp / ("map" + std::to_string(t) + ".png")).string(), map);
  sketched(clip, temp / "out", {"--evidence", (temp / "one.png").string()});
  std::istringstream lines(bytes_of(temp / "out" / "sketch.jsonl"));
  const auto sketch = graph::read_sketch(lines, "sketch.jsonl");
  REQUIRE(sketch.frames.size() == 4);
  for (const auto& graph : sketch.frames) {
    CHECK(graph.size() >= 10);
    for (const auto& v : graph.vertices()) CHECK(std::abs(v.patch.position.y - 44) < 3);
  }
  const auto refused = [&](const std::vector<std::string>& options, int exit, const std::string& said) {
    std::vector<std::string> arguments{"sketch", clip, "-o", (temp / "refused").string(), "-q"};
    arguments.insert(arguments.end(), options.begin(), options.end());
    check_one_line(arguments, exit, {said}, temp / "refused");
  };
  refused({"--evidence", (temp / "map*.png").string()}, 1, "ends after 3 frames");
  cv::imwrite((temp / "small.png").string(), cv::Mat1b(map, cv::Rect(0, 0, 50, 40)));
  refused({"--evidence", (temp / "small.png").string()}, 1, "50x40");
  refused({"--evidence", (temp / "none.png").string()}, 1, "none.png");
  refused({"--evidence", (temp / "one.png").string(), "--set", "sketch.boundaries=true"}, 2, "--evidence");
}

TEST_CASE("options of the sketch that cannot be are told in one line with exit 2") {
  const TempFolder temp;
  const auto out = temp / "out";
  const auto clip = write_strokes(temp / "clip", {32, 24}, 2, 1);
  const auto refused = [&](const std::vector<std::string>& more, const std::vector<std::string>& what) {
    check_one_line(joined({"sketch", clip, "-o", out.string(), "-q"}, more, {}), 2, what, out);
  };
  refused({"--set", "sketch.min_contrast=nan"}, {"sketch.min_contrast", "not finite"});
  refused({"--set", "sketch.boundaries=true", "--no-edges"}, {"sketch.boundaries", "no steps are drawn"});
  refused({"--anchors", "1.5"}, {"--anchors", "1.5", "0 (none) to 1"});
  refused({"--anchors", "-0.5"}, {"--anchors", "-0.5"});
  refused({"--anchors=nan"}, {"--anchors", "not finite"});
  refused({"--anchors", "many"}, {"--anchors", "many"});
  refused({"--fill", "water"}, {"--fill", "water", "diffusion", "julesz", "efros-leung"});
  refused({"--fill", "julesz", "--regions", "2"}, {"--regions", "2", "3 to 7"});
  refused({"--fill", "julesz", "--regions", "8"}, {"--regions", "8", "3 to 7"});
  refused({"--fill", "julesz", "--regions", "3.5"}, {"--regions", "3.5", "whole"});
  refused({"--regions", "3"}, {"--regions", "julesz", "efros-leung"});
  refused({"--heat-film", "2"}, {"--heat-film", "2", "0 to 1"});
  refused({"--heat-film", "-1"}, {"--heat-film", "-1"});
  refused({"--heat-film", "first"}, {"--heat-film", "first", "whole"});
  check_one_line({"analyze", clip, "-o", out.string(), "--film"}, 2, {"--film"}, out);
}

TEST_CASE("the smallest and the oddest pictures go through every way of drawing", "[slow]") {
  const TempFolder temp;
  for (const cv::Size size : {cv::Size(1, 1), cv::Size(2, 2), cv::Size(3, 90), cv::Size(120, 2)})
    for (const std::string fill : {"diffusion", "julesz", "efros-leung"}) {
      const auto name = std::to_string(size.width) + "x" + std::to_string(size.height);
      cv::imwrite((temp / "picture.png").string(), noise_frame(size, CV_8UC3, 5));
      INFO(name << " " << fill);
      const auto summary = sketched((temp / "picture.png").string(), temp / name,
                                    {"--fill", fill, "--film", "--heat-film", "0", "--anchors", "0.2"});
      CHECK(drawn_frames(temp / name / "film.mp4").size() == 1);
      CHECK(drawn_frames(temp / name / "heat.mp4").size() >= 2);
      CHECK(summary["sketch"]["psnr"]["mean"] > 5);
    }
}

TEST_CASE("films that are interrupted or do not fit on the disk leave nothing") {
  const TempFolder temp;
  const auto clip = write_strokes(temp / "clip", {320, 240}, 8, 10);
  const auto out = temp / "out";
  for (const std::string fill : {"julesz", "efros-leung"}) {
    CommandOptions options;
    options.interrupt_if = [&] { return fs::exists(out); };
    const auto result =
        run_command({"sketch", clip, "-o", out.string(), "--fill", fill, "--film", "-q"}, options);
    CHECK(result.exit == 130);
    CHECK_FALSE(fs::exists(out));
  }
  for (const long long most : {4000LL, 60000LL}) {
    CommandOptions options;
    options.most_file_bytes = most;
    const auto result = run_command(
        {"sketch", clip, "-o", out.string(), "--film", "--heat-film", "0", "--range", "0:2", "-q"}, options);
    INFO(result.err);
    CHECK(result.exit == 1);
    CHECK(std::ranges::count(without_rate_warnings(result.err), '\n') == 1);
    CHECK_FALSE(contains(result.err, ".part"));
    CHECK_FALSE(fs::exists(out));
  }
}

TEST_CASE("frames that are worked on at once tell one progress that never goes back and ends") {
  std::vector<double> told;
  const core::Context context({}, [&](std::string_view stage, double share) {
    CHECK(stage == "sketch");
    told.push_back(share);
  });
  FrameProgress progress(context, "sketch", 4);
  const auto first = progress.step(0, 0.5), second = progress.step(1, 0.5);
  first.report("julesz", 0);
  CHECK_THAT(told.back(), WithinAbs(0.125, 1e-12));
  second.report("julesz", 0.5);
  CHECK_THAT(told.back(), WithinAbs((0.5 + 0.75) / 4, 1e-12));
  first.report("julesz", 0);
  progress.report(1, 1);
  progress.report(0, 1);
  CHECK_THAT(told.back(), WithinAbs(0.5, 1e-12));
  progress.report(2, 1);
  progress.report(3, 1);
  CHECK(told.back() == 1);
  CHECK(std::ranges::is_sorted(told));
  std::vector<double> unknown;
  const core::Context open({}, [&](std::string_view, double share) { unknown.push_back(share); });
  FrameProgress blind(open, "sketch", {});
  blind.report(0, 1);
  CHECK(unknown == std::vector<double>{0});
}
