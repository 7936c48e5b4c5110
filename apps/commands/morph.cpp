// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>

#include "apps/builtin/open_clip.hpp"
#include "apps/cli/command_line.hpp"
#include "apps/cli/summary.hpp"
#include "apps/pictures/draw.hpp"
#include "apps/pictures/overlay.hpp"
#include "apps/pictures/png.hpp"
#include "apps/pictures/side_by_side.hpp"
#include "core/io/clip_writer.hpp"
#include "core/io/files.hpp"
#include "core/text/format_number.hpp"
#include "graph/io/motion_io.hpp"
#include "sketch/rendering/morph_frames.hpp"

namespace emberfold::apps {

namespace {

using Json = nlohmann::ordered_json;

struct Morphing {
  std::string from, to, output;
  int at = 0, until = 0;
  ReadingWords words;
  io::ReadOptions read;
  graph::MorphOptions morph;
  sketch::ExtractOptions extract;
};

/// One end of a morph.
struct MorphEnd {
  graph::AttributeGraph graph;
  cv::Size size;
  double fps = 25;
  int channels = 1;
  float level = 0;  ///< mean luma
};

bool is_sketch_file(const std::string& name) {
  return std::filesystem::path(name).extension() == ".jsonl";
}

std::string no_such_frame(const std::string& name, int frame, std::int64_t frames) {
  return name + " has no frame " + std::to_string(frame) + "; it has " + std::to_string(frames) +
         ", counted from 0";
}

MorphEnd read_sketched_end(const std::string& name, int frame) {
  auto file = io::open_file(name);
  auto sketch = graph::read_sketch(file, name);
  if (static_cast<std::size_t>(frame) >= sketch.frames.size())
    throw core::IoError(no_such_frame(name, frame, static_cast<std::int64_t>(sketch.frames.size())));
  MorphEnd end{sketch.frames[static_cast<std::size_t>(frame)], {sketch.width, sketch.height}, sketch.fps};
  double sum = 0, count = 0;
  for (const auto& vertex : end.graph.vertices())
    for (const auto& level : {vertex.patch.left, vertex.patch.right}) {
      if (level[0] != level[1] || level[1] != level[2]) end.channels = 3;
      sum += double{level[0]} + double{level[1]} + double{level[2]}, count += 3;
    }
  if (count > 0) end.level = static_cast<float>(sum / count);
  return end;
}

MorphEnd read_drawn_end(const std::string& name, int frame, io::ReadOptions read,
                        const sketch::ExtractOptions& extract, Session& session) {
  const auto whole = open_clip(name, read, session);
  if (const auto frames = whole->info().frames; frames && frame >= *frames)
    throw core::IoError(no_such_frame(name, frame, *frames));
  read.first = frame;
  read.last = frame + 1;
  const auto source = frame == 0 ? nullptr : open_clip(name, read, session);
  core::FrameSource& clip = source ? *source : *whole;
  const cv::Mat picture = clip.next();
  if (picture.empty()) throw core::IoError(name + " has no frame " + std::to_string(frame));
  const auto& info = clip.info();
  const cv::Mat levels = core::to_levels(picture, info);
  return {sketch::extract(levels, extract), levels.size(), info.fps, info.channels,
          static_cast<float>(cv::mean(core::luma(levels))[0])};
}

MorphEnd read_end(const std::string& name, int frame, const Morphing& asked, const io::ReadOptions& read,
                  Session& session) {
  return is_sketch_file(name) ? read_sketched_end(name, frame)
                              : read_drawn_end(name, frame, read, asked.extract, session);
}

std::string size_text(cv::Size size) {
  return std::to_string(size.width) + "x" + std::to_string(size.height);
}

void check_ends(const Morphing& asked, const MorphEnd& from, const MorphEnd& to) {
  if (from.size == to.size) return;
  throw core::IoError(asked.from + " is " + size_text(from.size) + " and " + asked.to + " is " +
                      size_text(to.size) + " px; both must be of one size");
}

io::ReadOptions check_morphing(const Morphing& asked, const Session& session) {
  check_options(asked.morph, "morph");
  check_options(asked.extract, "sketch");
  for (const auto& [name, frame] : {std::pair{"--at", asked.at}, {"--to", asked.until}})
    if (frame < 0)
      throw Misuse(std::string(name) + " is " + std::to_string(frame) + "; allowed is 0 or more");
  if (!asked.words.range.empty())
    throw Misuse("--range: a morph is between two frames; --at and --to name them");
  io::ReadOptions read = check_reading(asked.words, asked.read, session);
  if (read.every != 1 || read.stabilize != io::Stabilize::none)
    throw Misuse("--every and --stabilize are for whole clips; a morph is between two frames");
  return read;
}

/// The films and the picture of a morph.
class MorphFilms {
 public:
  MorphFilms(const graph::Morph& morph, const io::OutputFolder& output, int channels) : morph_(morph) {
    const auto& sketch = morph.motion.sketch;
    const cv::Size size(sketch.width, sketch.height);
    film_ = io::create_video(output.staged("morph.avi"), size, sketch.fps, channels == 3);
    const cv::Mat blank(size, CV_8UC3);
    overlay_ = io::create_video(output.staged("overlay.mp4"),
                                draw_sketch(blank, sketch.frames.front()).size(), sketch.fps, true);
  }

  void write(const cv::Mat& frame) {
    film_->write(frame);
    const auto& graph = morph_.motion.sketch.frames[t_];
    cv::Mat colour = frame;
    if (frame.channels() == 1) cv::merge(std::array{frame, frame, frame}, colour);
    overlay_->write(draw_sketch(colour, graph));
    const std::size_t last = morph_.motion.sketch.frames.size() - 1;
    if (t_ == stages_.size() * last / (kShown - 1)) {
      const OverlayOptions shown{.shorter_side = 240};
      stages_.push_back(enlarge(colour, enlargement(colour.size(), shown.shorter_side)));
      graphs_.push_back(draw_sketch(colour, graph, shown));
      labels_.push_back("frame " + std::to_string(t_) + " of " + std::to_string(last));
    }
    ++t_;
  }

  void finish(io::OutputFolder& output) {
    film_->finish();
    overlay_->finish();
    auto pictures = stages_;
    pictures.insert(pictures.end(), graphs_.begin(), graphs_.end());
    auto labels = labels_;
    labels.resize(pictures.size(), "graph");
    write_png(output, "morph.png", compose_rows(pictures, labels, stages_.size()));
  }

 private:
  static constexpr std::size_t kShown = 5;  // evenly spaced; fewer where there are fewer frames
  const graph::Morph& morph_;
  std::unique_ptr<io::VideoWriter> film_, overlay_;
  std::vector<cv::Mat> stages_, graphs_;
  std::vector<std::string> labels_;
  std::size_t t_ = 0;
};

Json end_json(const std::string& name, int frame, const graph::AttributeGraph& graph) {
  const auto strokes = graph::without_anchors(graph);
  return {{"name", name},
          {"frame", frame},
          {"patches", strokes.size()},
          {"strokes", graph::components(strokes).count},
          {"curves", graph::curves(strokes).size()}};
}

Json summarise(const Morphing& asked, const io::ReadOptions& read, const MorphEnd& from, const MorphEnd& to,
               const graph::Morph& morph, const Session& session) {
  Json summary = begin_summary("motion morph", session);
  summary["from"] = end_json(asked.from, asked.at, from.graph);
  summary["to"] = end_json(asked.to, asked.until, to.graph);
  summary["options"] = {{"reading", reading_json(read)},
                        {"morph", options_json(asked.morph)},
                        {"sketch", options_json(asked.extract)}};
  summary["morph"] = {{"width", from.size.width},  {"height", from.size.height},  {"fps", from.fps},
                      {"length_px", morph.length}, {"curves_moved", morph.moved}, {"curves_died", morph.died},
                      {"curves_born", morph.born}};
  summary["files"] = {{"morph.avi", "the frames, lossless"},
                      {"overlay.mp4", "the frames under their graphs"},
                      {"morph.png", "five frames and their graphs"},
                      {"motion.jsonl", "the graphs and their links"},
                      {"summary.json", "all figures"}};
  return summary;
}

void write_films(const MorphEnd& from, const MorphEnd& to, const graph::Morph& morph,
                 io::OutputFolder& output, const Session& session) {
  const int channels = std::max(from.channels, to.channels);
  try {
    MorphFilms films(morph, output, channels);
    sketch::draw_morph(
        morph, {channels, from.level, to.level}, [&](const cv::Mat& frame) { films.write(frame); },
        session.context);
    films.finish(output);
  } catch (const core::IoError& error) {
    throw core::IoError(output.with_final_name(error.what()));
  }
}

void run_morph(const Morphing& asked, Session& session) {
  const io::ReadOptions read = check_morphing(asked, session);
  const std::vector<std::string> inputs{asked.from, asked.to};
  require_apart(inputs, asked.output,
                {"morph.avi", "overlay.mp4", "morph.png", "motion.jsonl", "summary.json"}, session.common);
  io::OutputFolder output(asked.output, session.common.existing());
  output.protect(inputs);
  Stages stages;
  stages.begin("sketch");
  session.context.report("sketch", 0);
  const MorphEnd from = read_end(asked.from, asked.at, asked, read, session);
  const MorphEnd to = read_end(asked.to, asked.until, asked, read, session);
  check_ends(asked, from, to);
  stages.begin("morph");
  const auto morph = graph::morph(from.graph, to.graph, from.size.width, from.size.height, from.fps,
                                  asked.morph, session.context);
  stages.begin("draw");
  write_films(from, to, morph, output, session);
  output.write("motion.jsonl", [&](std::ostream& out) { graph::write_motion(out, morph.motion); });
  stages.end();
  Json summary = summarise(asked, read, from, to, morph, session);
  end_summary(summary, session, stages);
  write_summary(output, summary);
  session.check_stop();
  output.commit();
  session.console.say("the path is " + core::fixed_text(morph.length, 1) + " px long; " +
                      std::to_string(morph.moved) + " curves move, " + std::to_string(morph.died) + " die, " +
                      std::to_string(morph.born) + " are born; the film is " +
                      (output.path() / "morph.avi").string());
  if (session.common.json) session.print(json_text(summary));
}

}  // namespace

void add_morph(CLI::App& motion, CommandLine& line) {
  auto* command =
      add_command(motion, "morph", "Walk the shortest path between the graphs of two pictures", R"(
  emberfold motion morph a.png b.png -o out/morph
  emberfold motion morph fire.mp4 fire.mp4 --at 10 --to 60 -o out/morph --frames 60
  emberfold motion morph out/fire/sketch.jsonl b.png --at 10 -o out/morph)");
  const auto asked = std::make_shared<Morphing>();
  command->add_option("A", asked->from, "Begin at this picture, or at a frame of this clip or sketch.jsonl")
      ->required()
      ->type_name("");
  command->add_option("B", asked->to, "End at this one")->required()->type_name("");
  add_output(*command, asked->output);
  add_number(*command, "--at", asked->at, "FRAME", "Frame of A");
  add_number(*command, "--to", asked->until, "FRAME", "Frame of B");
  add_number(*command, "--frames", asked->morph.frames, "N", "Draw this many frames, both ends included");
  add_reading_options(*command, asked->words, asked->read, false);
  add_sketch_options(*command, *add_settings(*command, line), asked->extract);
  finish_command(*command, line, asked, run_morph);
}

}  // namespace emberfold::apps
