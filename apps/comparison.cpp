// SPDX-License-Identifier: Apache-2.0
#include "apps/comparison.hpp"

#include <algorithm>
#include <functional>
#include <memory>
#include <optional>

#include <opencv2/core.hpp>

#include "apps/clip_spectra.hpp"
#include "apps/clip_writer.hpp"
#include "apps/comparison_json.hpp"
#include "apps/comparison_models.hpp"
#include "apps/draw_graph_frames.hpp"
#include "apps/interrupt.hpp"
#include "apps/prediction.hpp"
#include "apps/side_by_side.hpp"
#include "apps/summary.hpp"
#include "core/error.hpp"
#include "dytex/synthesize.hpp"
#include "mcmc/synthesize.hpp"

namespace emberfold::apps {

using Json = nlohmann::ordered_json;

namespace {

constexpr int kBatch = 16;

// A model's clip while it is drawn.
struct Column {
  std::string key, label, file;
  std::function<std::vector<cv::Mat>(int count)> draw;  // the next frames, CV_8U
  std::unique_ptr<ClipWriter> writer;
  ClipSpectra spectra;
};

struct Drawing {
  ClipSpectra source, first, second;
  std::vector<Column> columns;
};

std::vector<cv::Mat> luma_of(std::span<const cv::Mat> frames, const core::ClipInfo& info) {
  std::vector<cv::Mat> luma;
  for (const auto& frame : frames) luma.push_back(core::luma(frame, info));
  return luma;
}

core::ClipInfo bytes_info(const core::ClipInfo& info) {
  core::ClipInfo bytes = info;
  bytes.depth = CV_8U, bytes.white = 255;
  return bytes;
}

std::vector<Column> make_columns(const ComparedModels& models, const core::ClipInfo& info, float mean_level,
                                 const ClipSpectra& blank, const CompareOptions& options,
                                 OutputFolder& output, const Session& session) {
  const cv::Size size(info.width, info.height);
  std::vector<Column> columns;
  const auto add = [&](const char* key, const char* label, const std::string& file, auto draw) {
    columns.push_back({key, label, file, std::move(draw),
                       create_clip(output.staged(file), size, info.fps, info.channels == 3), blank});
  };
  if (models.motion) {
    const auto synthesis = std::make_shared<mcmc::Synthesis>(*models.motion, session.common.seed);
    const FrameLook look{size, info.channels, mean_level, options.fill, models.ground};
    add("motion_model", "motion model", "synthesized_motion.avi", [synthesis, look, &session](int count) {
      std::vector<graph::AttributeGraph> graphs;
      for (int i = 0; i < count; ++i) graphs.push_back(synthesis->next());
      return draw_batch(graphs, look, session.context);
    });
  }
  if (models.texture) {
    dytex::SynthesisOptions synthesis_options;
    synthesis_options.seed = session.common.seed;
    const auto synthesis = std::make_shared<dytex::Synthesis>(*models.texture, synthesis_options);
    add("linear_dynamic_texture", "linear dynamic texture", "synthesized_dytex.avi", [synthesis](int count) {
      std::vector<cv::Mat> frames;
      for (int i = 0; i < count; ++i) frames.push_back(synthesis->next());
      return frames;
    });
  }
  return columns;
}

float mean_level(core::FrameSource& source) {
  source.rewind();
  return static_cast<float>(cv::mean(core::luma(source.next(), source.info()))[0]);
}

// Runs through the clip and the models' clips together, a batch at a time.
void draw_all(core::FrameSource& source, const ComparedModels& models, Drawing& drawing, OutputFolder& output,
              const Session& session) {
  const auto& info = source.info();
  std::vector<std::string> labels{"source"};
  for (const auto& column : drawing.columns) labels.push_back(column.label);
  const std::vector<cv::Size> sizes(labels.size(), {info.width, info.height});
  SideBySide beside(output.staged("side_by_side.mp4"), labels, sizes, info.fps);
  source.rewind();
  session.context.report("synthesize", 0);
  for (int t = 0; t < models.frames;) {
    std::vector<cv::Mat> frames;
    for (int i = 0; i < std::min(kBatch, models.frames - t); ++i) {
      frames.push_back(source.next());
      session.check_stop();
      if (frames.back().empty()) throw core::IoError("the clip has become shorter while it was read");
    }
    const auto luma = luma_of(frames, info);
    drawing.source.add(luma, session.context);
    const auto count = static_cast<int>(frames.size());
    const auto in_first = static_cast<std::size_t>(std::clamp(models.half - t, 0, count));
    drawing.first.add(std::span(luma).first(in_first), session.context);
    drawing.second.add(std::span(luma).subspan(in_first), session.context);
    std::vector<std::vector<cv::Mat>> drawn{{}};
    for (const auto& frame : frames) drawn[0].push_back(core::to_bytes(core::to_levels(frame, info)));
    for (auto& column : drawing.columns) {
      drawn.push_back(column.draw(count));
      for (const auto& frame : drawn.back()) column.writer->write(frame);
      column.spectra.add(luma_of(drawn.back(), bytes_info(info)), session.context);
    }
    for (std::size_t i = 0; i < frames.size(); ++i) {
      std::vector<cv::Mat> row;
      for (const auto& clip : drawn) row.push_back(clip[i]);
      beside.write(row);
    }
    t += count;
    session.context.report("synthesize", double(t) / models.frames);
  }
  beside.finish();
  for (auto& column : drawing.columns) column.writer->finish();
}

}  // namespace

Comparison compare_clip(core::FrameSource& source, const std::string& clip, const CompareOptions& options,
                        const KnownModels& known, OutputFolder& output, Session& session) {
  const auto& info = source.info();
  const auto models = learn_models(source, clip, options, known, session);
  const int segment = segment_length(models.frames / 2), rings = dytex::ring_count({info.width, info.height});
  Json measures = begin_measures(segment, rings);
  measures["clip"] = clip_json(clip, info, models.frames);
  measures["seed"] = session.common.seed;
  measures["components"] = {
      {"clip", models.texture ? Json(models.texture->order()) : Json(nullptr)},
      {"first_half", models.half_texture ? Json(models.half_texture->order()) : Json(nullptr)}};

  const Predictors predictors{models.half,
                              models.frames,
                              models.half_texture ? &*models.half_texture : nullptr,
                              models.predicted.empty() ? nullptr : &models.predicted,
                              &models.sketches,
                              options.fill,
                              models.half_ground};
  measures["prediction"] = measure_prediction(source, predictors, session);

  const ClipSpectra blank({info.width, info.height}, segment, rings);
  Drawing drawing{blank, blank, blank, {}};
  Comparison comparison;
  comparison.files = {"measures.json", "side_by_side.mp4"};
  try {
    drawing.columns = make_columns(models, info, mean_level(source), blank, options, output, session);
    draw_all(source, models, drawing, output, session);
  } catch (const core::IoError& error) {
    throw core::IoError(output.of_final(error.what()));
  }
  Json synthesis = {{"noise_floor", distances_json(drawing.first, drawing.second)}};
  NamedSpectra curves{{"source", &drawing.source}};
  for (const auto& column : drawing.columns) {
    synthesis[column.key] = distances_json(column.spectra, drawing.source);
    curves.emplace_back(column.key, &column.spectra);
    comparison.files.push_back(column.file);
  }
  measures["synthesis"] = std::move(synthesis);
  measures["spectra"] = curves_json(curves, segment, rings);
  measures["warnings"] = session.warnings;
  write_measures(measures, output);
  comparison.measures = std::move(measures);
  return comparison;
}

}  // namespace emberfold::apps
