// SPDX-License-Identifier: Apache-2.0
#include <memory>

#include <nlohmann/json.hpp>

#include "apps/clip_writer.hpp"
#include "apps/command_line.hpp"
#include "apps/draw.hpp"
#include "apps/output_folder.hpp"
#include "apps/overlay.hpp"
#include "apps/reconstruct.hpp"
#include "apps/sketch_dictionary.hpp"
#include "apps/stream_frames.hpp"
#include "apps/summary.hpp"
#include "graph/motion_io.hpp"

namespace emberfold::apps {

namespace {

using Json = nlohmann::ordered_json;

struct Sketch {
  Reading reading;
  std::string output, patches = "fitted";
  sketch::ExtractOptions extract;
  sketch::FillOptions fill;
  DictionaryRequest dictionary;
};

struct Sketched {
  graph::AttributeGraph graph;
  Reconstruction reconstruction;
  cv::Mat overlay;
  std::vector<sketch::Code> codes;
};

// All of the clip: what is found, and the figures of each frame.
struct SketchRun {
  graph::SketchSequence sketch;
  std::vector<double> share, psnr, patches;
  int not_converged = 0;
  CodeFigures codes;
};

SketchRun sketch_clip(const Sketch& asked, core::FrameSource& source, const SketchDictionary* dictionary,
                      OutputFolder& output, const Session& session) {
  const auto& info = source.info();
  const auto drawing = asked.patches == "pixels" ? PatchDrawing::pixels : PatchDrawing::fitted;
  SketchRun run;
  run.sketch.width = info.width, run.sketch.height = info.height, run.sketch.fps = info.fps;
  std::unique_ptr<ClipWriter> overlay;
  const auto reconstruction = create_clip(output.staged("reconstruction.avi"), {info.width, info.height},
                                          info.fps, info.channels == 3);
  stream_frames(
      source, "sketch", info.frames, session.context,
      [&](int t, const cv::Mat& frame) {
        const cv::Mat levels = core::to_levels(frame, info);
        Sketched made{
            dictionary ? dictionary->graph(t, levels, asked.extract) : sketch::extract(levels, asked.extract),
            {},
            {},
            {}};
        if (dictionary) made.codes = encode_frame(levels, made.graph, *dictionary);
        made.reconstruction =
            asked.patches == "learned"
                ? reconstruct(levels,
                              sketch::draw_learned(made.graph, made.codes, dictionary->dictionary,
                                                   levels.size(), levels.channels()),
                              asked.fill)
                : reconstruct(levels, made.graph, drawing, asked.fill);
        made.overlay = draw_types(to_colour_bytes(frame, info), made.graph, t);
        return made;
      },
      [&](int, Sketched made) {
        if (!overlay)
          overlay = create_clip(output.staged("overlay.mp4"), made.overlay.size(), info.fps, true);
        overlay->write(made.overlay);
        reconstruction->write(made.reconstruction.bytes);
        run.sketch.append(made.graph);
        run.share.push_back(made.reconstruction.share);
        run.psnr.push_back(made.reconstruction.psnr);
        run.patches.push_back(static_cast<double>(made.graph.size()));
        run.codes.add(made.codes);
        run.not_converged += made.reconstruction.converged ? 0 : 1;
      });
  if (run.sketch.frames.empty()) throw core::IoError(asked.reading.clip + " holds no frame");
  overlay->finish();
  reconstruction->finish();
  return run;
}

Json summarise(const Sketch& asked, const ReadOptions& read, const core::ClipInfo& info, const SketchRun& run,
               const Session& session) {
  Json summary = begin_summary("sketch", session);
  summary["clip"] = clip_json(asked.reading.clip, info, static_cast<int>(run.sketch.frames.size()));
  summary["options"] = {{"reading", reading_json(read)},
                        {"sketch", options_json(asked.extract)},
                        {"fill", options_json(asked.fill)},
                        {"drawing", {{"patches", asked.patches}}}};
  summary["sketch"] = {{"patches_per_frame", spread_json(run.patches)},
                       {"sketchable_share", spread_json(run.share)},
                       {"psnr", spread_json(run.psnr)}};
  summary["per_frame"] = {{"patches", run.patches}, {"sketchable_share", run.share}, {"psnr", run.psnr}};
  summary["warnings"] = session.warnings;
  return summary;
}

void run_sketch(const Sketch& asked, Session& session) {
  const ReadOptions read = check_reading(asked.reading, session);
  check_options(asked.extract);
  check_options(asked.fill);
  if (asked.patches == "learned" && !asked.dictionary.any())
    throw Misuse("--patches learned needs a dictionary: give --learn-dictionary or --dictionary FOLDER");
  OutputFolder output(asked.output);
  Stages stages;
  stages.begin("sketch");
  const auto source =
      open_clip(asked.reading.clip, read, [&](const std::string& text) { session.warn(text); });
  const auto dictionary = prepare_dictionary(asked.dictionary, *source, asked.extract, session);
  SketchRun run;
  try {
    run = sketch_clip(asked, *source, dictionary ? &*dictionary : nullptr, output, session);
  } catch (const core::IoError& error) {
    throw core::IoError(output.of_final(error.what()));
  }
  if (run.not_converged > 0)
    session.warn("the fill stopped before its tolerance in " + std::to_string(run.not_converged) + " frames");
  stages.begin("write");
  output.write("sketch.jsonl", [&](std::ostream& out) { graph::write_sketch(out, run.sketch); });
  stages.end();
  Json summary = summarise(asked, read, source->info(), run, session);
  if (dictionary) summary["dictionary"] = run.codes.json(dictionary->dictionary);
  if (asked.dictionary.learn) write_dictionary(output, dictionary->dictionary);
  summary["seconds"] = stages.seconds();
  summary["peak_memory_mb"] = peak_memory_mb();
  output.write("summary.json", [&](std::ostream& out) { out << json_text(summary); });
  session.check_stop();
  output.commit();
  session.console.say(std::to_string(run.sketch.frames.size()) + " frames sketched into " +
                      output.path().string());
  if (session.common.json) session.print(json_text(summary));
}

}  // namespace

void add_sketch(CLI::App& app, Chosen& chosen) {
  auto* command =
      app.add_subcommand("sketch", "Draw the primal sketch of every frame, and the frame from its sketch");
  command->footer(
      "  emberfold sketch fire.mp4 -o out/sketch\n"
      "  emberfold sketch photo.png -o out/photo --patches pixels");
  const auto asked = std::make_shared<Sketch>();
  add_reading(*command, asked->reading);
  add_output(*command, asked->output);
  command
      ->add_option("--patches", asked->patches,
                   "Draw patches from their attributes (fitted), with the frame's own pixels, or as a "
                   "dictionary tells them (learned)")
      ->type_name("fitted|pixels|learned")
      ->check(CLI::IsMember({"fitted", "pixels", "learned"}).description(""))
      ->default_str(asked->patches);
  auto* learn = command->add_flag("--learn-dictionary", asked->dictionary.learn,
                                  "Learn what the clip's patches look like: dictionary/, dictionary.png");
  command->add_option("--dictionary", asked->dictionary.folder, "Use a dictionary that was learned before")
      ->type_name("FOLDER")
      ->excludes(learn);
  add_fields(*command, asked->extract, "Sketching");
  add_fields(*command, asked->fill, "Filling");
  add_common(*command, chosen.common, "Print the content of summary.json");
  command->callback(
      [asked, &chosen] { chosen.run = [asked](Session& session) { run_sketch(*asked, session); }; });
}

}  // namespace emberfold::apps
