// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <memory>
#include <optional>

#include <nlohmann/json.hpp>

#include "apps/builtin/open_clip.hpp"
#include "apps/cli/command_line.hpp"
#include "apps/cli/summary.hpp"
#include "apps/sketching/given_evidence.hpp"
#include "apps/sketching/sketch_film.hpp"
#include "apps/sketching/sketch_frames.hpp"
#include "apps/sketching/sketch_heat.hpp"
#include "core/io/staged_output.hpp"
#include "pipeline/reconstruct.hpp"

namespace emberfold::apps {

namespace {

using Json = nlohmann::ordered_json;

struct Sketch {
  Reading reading;
  std::string output, evidence, patches = "fitted", fill = "diffusion";
  SketchRequest request;
  bool own_regions = false;
};

// Only names that the parser accepts arrive here.
pipeline::PatchDrawing patches_named(const std::string& name) {
  return name == "pixels" ? pipeline::PatchDrawing::pixels : pipeline::PatchDrawing::fitted;
}

sketch::FillMethod fill_named(const std::string& name) {
  if (name == "julesz") return sketch::FillMethod::julesz;
  return name == "efros-leung" ? sketch::FillMethod::efros_leung : sketch::FillMethod::diffusion;
}

void refuse(const std::string& option, const std::string& value, const std::string& allowed) {
  throw Misuse(option + " is " + value + "; allowed is " + allowed);
}

// Completes the request with dependent options, and checks it.
SketchRequest check_request(const Sketch& asked, const io::ReadOptions& read, const Session& session) {
  SketchRequest request = asked.request;
  request.first_frame = read.first;
  request.patches = patches_named(asked.patches);
  request.ground.kind = fill_named(asked.fill);
  request.ground.seed = session.common.seed;
  check_options(request.extract, "sketch");
  if (!asked.evidence.empty() && request.extract.boundaries)
    throw Misuse("--evidence cannot go with sketch.boundaries: either tells where the curves are");
  const int regions = request.ground.texture.regions;
  const auto& texture = request.ground.texture;
  if (regions != 0 && (regions < texture.fewest || regions > texture.most))
    refuse("--regions", std::to_string(regions),
           "0 (as many as fit best) or " + std::to_string(texture.fewest) + " to " +
               std::to_string(texture.most));
  if (asked.own_regions && request.ground.kind == sketch::FillMethod::diffusion)
    throw Misuse("--regions is for --fill julesz or efros-leung; the diffusion knows no textures");
  if (!(request.anchors >= 0 && request.anchors <= 1))
    refuse("--anchors", number_text(request.anchors), "0 (none) to 1, a share of the frame");
  // A texture is drawn where nothing is held.
  if (request.ground.kind != sketch::FillMethod::diffusion && !request.keep_anchors) request.anchors = 0;
  if (request.heat_frame && *request.heat_frame < 0)
    refuse("--heat-film", std::to_string(*request.heat_frame), "a frame's number, from 0");
  return request;
}

void check_heat_frame(const SketchRequest& request, std::optional<std::int64_t> frames) {
  if (request.heat_frame && frames && *frames > 0 && *request.heat_frame >= *frames)
    refuse(
        "--heat-film", std::to_string(*request.heat_frame),
        "0 to " + std::to_string(*frames - 1) + ", for " + std::to_string(*frames) + " frames are sketched");
}

void warn_about_run(const SketchRun& run, Session& session) {
  const auto& figures = run.figures;
  if (figures.not_converged > 0)
    session.warn("the fill stopped before its tolerance in " + std::to_string(figures.not_converged) +
                 " frames");
  if (figures.without_room > 0)
    session.warn("in " + std::to_string(figures.without_room) +
                 " frames the patches alone show as much as --anchors allows; they have no anchors");
}

Json asked_json(const Sketch& asked, const SketchRequest& request, const io::ReadOptions& read) {
  Json fill = {{"kind", asked.fill}};
  if (request.ground.kind != sketch::FillMethod::diffusion) fill["regions"] = request.ground.texture.regions;
  Json drawing = {{"patches", asked.patches}, {"anchors", request.anchors}};
  return {{"reading", reading_json(read)},
          {"sketch", options_json(request.extract)},
          {"fill", fill},
          {"drawing", drawing}};
}

Json summarise(const Sketch& asked, const SketchRequest& request, const io::ReadOptions& read,
               const core::ClipInfo& info, const SketchRun& run, const Session& session) {
  Json summary = begin_summary("sketch", session);
  const auto& figures = run.figures;
  summary["clip"] = clip_json(asked.reading.clip, info, static_cast<int>(run.sketch.frames.size()));
  summary["options"] = asked_json(asked, request, read);
  summary["sketch"] = {{"patches_per_frame", spread_json(figures.patches)},
                       {"sketchable_share", spread_json(figures.patch_share)},
                       {"anchor_share", spread_json(figures.anchor_share)},
                       {"fill", asked.fill},
                       {"psnr", spread_json(figures.psnr)}};
  summary["per_frame"] = {{"patches", figures.patches},
                          {"sketchable_share", figures.patch_share},
                          {"anchor_share", figures.anchor_share},
                          {"psnr", figures.psnr}};
  if (request.ground.kind != sketch::FillMethod::diffusion) {
    summary["sketch"]["regions"] = spread_json(figures.regions);
    summary["per_frame"]["regions"] = figures.regions;
  }
  if (request.ground.kind == sketch::FillMethod::julesz) {
    summary["sketch"]["histogram_distance"] = spread_json(figures.histogram_distance);
    summary["per_frame"]["histogram_distance"] = figures.histogram_distance;
  }
  summary["warnings"] = session.warnings;
  return summary;
}

// Writes all files but the summary.
SketchRun write_sketched(const std::string& clip, const SketchRequest& request, core::FrameSource& source,
                         io::OutputFolder& output, Stages& stages, Session& session) {
  try {
    SketchRun run;
    output.write("sketch.jsonl",
                 [&](std::ostream& lines) { run = sketch_frames(source, request, lines, output, session); });
    if (run.sketch.frames.empty()) throw core::IoError(clip + " holds no frame");
    check_heat_frame(request, static_cast<std::int64_t>(run.sketch.frames.size()));
    warn_about_run(run, session);
    if (request.film) {
      stages.begin("picture");
      write_film_picture(source, request, run, output, session);
    }
    if (request.heat_frame) {
      stages.begin("heat");
      write_heat_film(source, request, run, output, session);
    }
    return run;
  } catch (const core::IoError& error) {
    throw core::IoError(output.with_final_name(error.what()));
  }
}

void run_sketch(const Sketch& asked, Session& session) {
  const io::ReadOptions read = check_reading(asked.reading, session);
  SketchRequest request = check_request(asked, read, session);
  const std::vector<std::string> inputs{asked.reading.clip, asked.evidence, asked.reading.options.mask};
  require_apart(inputs, asked.output,
                {"overlay.mp4", "reconstruction.avi", "film.mp4", "film.png", "heat.mp4", "sketch.jsonl",
                 "drift.csv", "summary.json"},
                session.common);
  io::OutputFolder output(asked.output, session.common.existing());
  output.protect(inputs);
  Stages stages;
  stages.begin("sketch");
  const auto source = open_clip(asked.reading.clip, read, session);
  check_heat_frame(request, source->info().frames);
  std::optional<GivenEvidence> evidence;
  if (!asked.evidence.empty()) request.evidence = &evidence.emplace(asked.evidence, read, source->info());
  const SketchRun run = write_sketched(asked.reading.clip, request, *source, output, stages, session);
  stages.end();
  Json summary = summarise(asked, request, read, source->info(), run, session);
  write_drift(output, *source);
  summary["seconds"] = stages.seconds();
  summary["peak_memory_mb"] = peak_memory_mb();
  write_summary(output, summary);
  session.check_stop();
  output.commit();
  session.console.say(std::to_string(run.sketch.frames.size()) + " frames sketched into " +
                      output.path().string());
  if (session.common.json) session.print(json_text(summary));
}

void add_drawing(CLI::App& command, Sketch& asked) {
  auto& request = asked.request;
  command
      .add_option("--patches", asked.patches,
                  "Draw patches from attributes (fitted) or the frame's pixels (pixels)")
      ->type_name("KIND")
      ->check(CLI::IsMember({"fitted", "pixels"}).description(""))
      ->default_str(asked.patches);
  command
      .add_option("--fill", asked.fill, "Draw the rest by diffusion, or as a texture: julesz or efros-leung")
      ->type_name("KIND")
      ->check(CLI::IsMember({"diffusion", "julesz", "efros-leung"}).description(""))
      ->default_str(asked.fill);
  add_number(command, "--regions", request.ground.texture.regions, "N",
             "Use 3 to 7 textures with julesz and efros-leung; 0: as many as fit best");
  add_number(command, "--anchors", request.anchors, "SHARE",
             "Hold pixels, too, with strokes on SHARE; if given, sketch.jsonl has them");
  command.add_flag("--film", request.film,
                   "Write film.mp4, film.png: input, graph, sketchable part, reconstruction");
  command
      .add_option_function<std::string>(
          "--heat-film",
          [&request](const std::string& text) {
            int frame = 0;
            parse_number("--heat-film", text, frame);
            request.heat_frame = frame;
          },
          "Write heat.mp4: the diffusion of this frame, step by step")
      ->type_name("FRAME");
}

}  // namespace

void add_sketch(CLI::App& app, CommandLine& line) {
  auto* command =
      add_command(app, "sketch", "Extract the primal sketch of every frame, and draw the frame from it", R"(
  emberfold sketch photo.png -o out/photo --patches pixels
  emberfold sketch fire.mp4 -o out/film --film --heat-film 40
  emberfold sketch river.mp4 -o out/texture --fill julesz --range 0:10)");
  const auto asked = std::make_shared<Sketch>();
  add_reading(*command, asked->reading);
  add_output(*command, asked->output);
  add_drawing(*command, *asked);
  const auto settings = add_settings(*command, line);
  add_sketch_options(*command, *settings, asked->request.extract);
  command
      ->add_option("--evidence", asked->evidence,
                   "Draw along these curves: image or clip of their probability, white = 1")
      ->type_name("FILE");
  finish_command(*command, line, asked, run_sketch, [asked, command, settings] {
    asked->own_regions = command->count("--regions") > 0;
    asked->request.keep_anchors = command->count("--anchors") > 0;
  });
}

}  // namespace emberfold::apps
