// SPDX-License-Identifier: Apache-2.0
#include "apps/commands/demo_story.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdio>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "apps/builtin/open_clip.hpp"
#include "apps/cli/interrupt.hpp"
#include "apps/comparison/comparison.hpp"
#include "apps/report/report_strip.hpp"
#include "apps/textures/texture_modes.hpp"
#include "core/io/clip_writer.hpp"
#include "core/io/model_folder.hpp"
#include "dytex/learn.hpp"
#include "dytex/model/archive.hpp"
#include "pipeline/clip_model.hpp"
#include "pipeline/clip_synthesis.hpp"

namespace emberfold::apps {

namespace {

using Json = nlohmann::ordered_json;

dytex::LearnOptions learn_options(const Analysis& analysis) {
  dytex::LearnOptions options;
  const auto frames = static_cast<int>(analysis.found.motion.sketch.frames.size());
  options.components = std::clamp(frames - 1, 1, options.components);
  return options;
}

dytex::LinearDynamicTexture learn_demo_texture(core::FrameSource& source, const dytex::LearnOptions& options,
                                               Analysis& analysis, io::OutputFolder& output,
                                               Session& session) {
  source.rewind();
  auto learned = dytex::learn(source, options, session.context);
  io::write_model(output, "dytex", dytex::archive_view(learned.texture));
  analysis.report.eigenvalues = texture_eigenvalues(learned.texture);
  analysis.summary["texture"] = texture_json(learned.texture);
  analysis.summary["texture"].erase("modes");
  return std::move(learned.texture);
}

/// An edit of the demo: of the clip's strokes, or of the way its frames are played.
struct DemoEdit {
  const char *file, *name;
  pipeline::ClipSynthesisOptions options;
};

std::vector<DemoEdit> demo_edits(std::uint64_t seed) {
  const auto rates = [&](std::initializer_list<graph::EventType> types, double factor) {
    pipeline::ClipSynthesisOptions options{.seed = seed, .method = pipeline::SynthesisMethod::edit};
    for (const auto type : types) options.edit.rates[static_cast<std::size_t>(type)] = factor;
    return options;
  };
  const auto played = [&](double speed) {
    return pipeline::ClipSynthesisOptions{
        .seed = seed, .method = pipeline::SynthesisMethod::footage, .speed = speed};
  };
  auto wind = rates({}, 1);
  wind.edit.wind = {1.5, 0};
  using enum graph::EventType;
  return {{"edited_splits.avi", "Twice the splits", rates({split, disconnect}, 2)},
          {"edited_births.avi", "Half the births", rates({birth}, 0.5)},
          {"edited_wind.avi", "In the wind", wind},
          {"edited_slower.avi", "Half as fast", played(0.5)},
          {"edited_backwards.avi", "Backwards", played(-1)}};
}

/// Writes new, edited clips of the model, with the clip's length.
void write_edits(int frames, io::OutputFolder& output, Session& session) {
  const auto model =
      pipeline::read_clip_model(output.staged("model").string(), pipeline::SynthesisMethod::edit);
  for (const auto& [file, name, options] : demo_edits(session.common.seed)) {
    pipeline::ClipSynthesis synthesis(model, options, session.context);
    io::write_video(output.staged(file), synthesis, frames, session.context);
  }
}

/// Joins the clip, those drawn from its models and the edited ones, side by side.
ReportClips make_clips(core::FrameSource& source, const Comparison& comparison,
                       const io::OutputFolder& output, const Session& session) {
  std::vector<std::unique_ptr<core::FrameSource>> drawn;
  std::vector<NamedSource> clips{{"Source", &source}};
  for (const auto& [file, name] : {std::pair{"synthesized_footage.avi", "Clip's footage"},
                                   std::pair{"synthesized_strokes.avi", "Clip's strokes"},
                                   std::pair{"synthesized_motion.avi", "Motion model"},
                                   std::pair{"synthesized_dytex.avi", "Linear dynamic texture"}}) {
    if (std::ranges::find(comparison.files, file) == comparison.files.end()) continue;
    drawn.push_back(open_clip(output.staged(file).string(), {}, {}));
    clips.push_back({name, drawn.back().get()});
  }
  for (const auto& edit : demo_edits(session.common.seed)) {
    drawn.push_back(open_clip(output.staged(edit.file).string(), {}, {}));
    clips.push_back({edit.name, drawn.back().get()});
  }
  return make_strip(clips, output, session);
}

void list_files(const Comparison& comparison, Json& files) {
  const std::map<std::string, const char*> about = {
      {"measures.json", "how close the models come to the clip"},
      {"side_by_side.mp4", "the clip and those drawn from its models"},
      {"synthesized_footage.avi", "a new clip made of the clip's own frames"},
      {"synthesized_strokes.avi", "a new clip of the clip's strokes at other times"},
      {"synthesized_motion.avi", "a new clip of strokes, from the motion model"},
      {"synthesized_dytex.avi", "a new clip from the linear dynamic texture"}};
  files["dytex/"] = "a linear dynamic texture: 'emberfold dytex synth' draws from it";
  for (const auto& edit : demo_edits(0))
    files[edit.file] = std::string("a new clip of the clip's own frames: ") + edit.name;
  for (const auto& file : comparison.files)
    files[file] = about.contains(file) ? about.at(file) : "written by the comparison";
}

std::optional<double> value_at(const Json& measures, std::initializer_list<const char*> path) {
  const Json* here = &measures;
  for (const char* key : path) {
    if (!here->is_object() || !here->contains(key)) return std::nullopt;
    here = &(*here)[key];
  }
  return here->is_number() ? std::optional(here->get<double>()) : std::nullopt;
}

}  // namespace

ReportMeasures measures_table(const Json& measures) {
  ReportMeasures table{{"Clip's footage", "Motion model", "Linear dynamic texture", "Held against"}, {}, {}};
  const auto psnr = [&](const char* way) {
    return value_at(measures, {"prediction", "methods", way, "psnr"});
  };
  const auto apart = [&](const char* of, const char* key) {
    return value_at(measures, {"synthesis", of, key});
  };
  table.rows.push_back(
      {"Prediction, dB PSNR",
       "Every frame of the second half, predicted from those before it by models of the first. "
       "More is closer. Held against: the frame before shown again.",
       {psnr("footage"), psnr("motion_model"), psnr("linear_dynamic_texture"), psnr("frame_before")}});
  for (const auto& [key, name, about] :
       {std::tuple{"temporal_db", "Spectrum in time, dB apart",
                   "How far the power at each frequency in time lies from the source's. Less is closer. Held "
                   "against: the source's own halves."},
        std::tuple{"radial_db", "Spectrum in space, dB apart", "The same of frequencies in space."}})
    table.rows.push_back({name,
                          about,
                          {apart("footage", key), apart("motion_model", key),
                           apart("linear_dynamic_texture", key), apart("noise_floor", key)}});
  const auto mean = psnr("mean_image"),
             sketch = value_at(measures, {"reconstruction", "motion_model", "psnr"});
  const auto decibels = [](double value) {
    std::array<char, 32> text{};
    std::snprintf(text.data(), text.size(), "%.1f dB", value);
    return std::string(text.data());
  };
  if (mean) table.note += "The mean image alone predicts at " + decibels(*mean) + ". ";
  if (sketch)
    table.note += "Frames drawn from their own sketch, the bound of what a graph can show, reach " +
                  decibels(*sketch) + ".";
  return table;
}

void add_model_clips(core::FrameSource& source, const AnalyzeOptions& options, Analysis& analysis,
                     io::OutputFolder& output, Session& session) {
  pipeline::CompareOptions compare;
  compare.sketch = options.sketch;
  compare.match = options.match;
  compare.learn = learn_options(analysis);
  // Two models only; 'emberfold compare' shows the others, which would double the time.
  compare.in_full = false;
  compare.steps = 1;
  analysis.stages.begin("texture");
  const auto texture = learn_demo_texture(source, compare.learn, analysis, output, session);
  analysis.stages.begin("compare");
  const pipeline::KnownModels known{&analysis.found.sketched, &analysis.found.model.motion,
                                    &analysis.found.model.sharpening, &texture};
  const auto comparison = compare_clip(source, analysis.clip, compare, known, output, session);
  analysis.stages.begin("clips");
  analysis.report.measures = measures_table(comparison.measures);
  write_edits(static_cast<int>(analysis.found.motion.sketch.frames.size()), output, session);
  analysis.report.clips = make_clips(source, comparison, output, session);
  analysis.stages.end();
  for (const char* part : {"prediction", "synthesis"})
    if (comparison.measures.contains(part)) analysis.summary["comparison"][part] = comparison.measures[part];
  if (auto& summary = analysis.summary; summary.contains("comparison"))
    summary["comparison"]["prediction"].erase("per_frame");
  list_files(comparison, analysis.summary["files"]);
}

}  // namespace emberfold::apps
