// SPDX-License-Identifier: Apache-2.0
#include "apps/comparison/comparison.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>
#include <optional>

#include <opencv2/core.hpp>

#include "apps/cli/interrupt.hpp"
#include "apps/cli/summary.hpp"
#include "apps/comparison/comparison_json.hpp"
#include "apps/comparison/comparison_words.hpp"
#include "apps/pictures/side_by_side.hpp"
#include "core/error.hpp"
#include "core/io/clip_writer.hpp"
#include "pipeline/clip_strokes.hpp"
#include "pipeline/compared_models.hpp"
#include "pipeline/comparison_curve.hpp"
#include "pipeline/prediction.hpp"

namespace emberfold::apps {

using Json = nlohmann::ordered_json;

namespace {

constexpr int kBatch = 16;

// A model's clip while it is drawn.
struct Column {
  const pipeline::ComparedModel* model;
  pipeline::ComparedModel::Frames draw;
  std::unique_ptr<io::VideoWriter> writer;
  pipeline::ClipMeasures measures;
  pipeline::ClipStrokes strokes;
};

struct Drawing {
  int drawn_frames = 0;  // of the models' clips
  pipeline::SourceMeasures source;
  std::vector<Column> columns;
  std::vector<ComparedFrame> pictures;
};

// The next frames of a model's clip, measured and written.
std::vector<cv::Mat> draw_column(Column& column, int count, bool with_strokes, const Session& session) {
  auto frames = column.draw(count);
  for (const auto& frame : frames) column.writer->write(frame);
  const auto levels = pipeline::levels_of(frames);
  column.measures.add(pipeline::luma_of(levels), session.context);
  if (with_strokes) column.strokes.add(levels, session.context);
  return frames;
}

// Runs through the clip and the models' clips together, a batch at a time.
void draw_all(core::FrameSource& source, Drawing& drawing, bool with_strokes, io::OutputFolder& output,
              const Session& session) {
  const auto& info = source.info();
  std::vector<std::string> labels{"source"};
  for (const auto& column : drawing.columns) labels.push_back(column.model->label);
  const std::vector<cv::Size> sizes(labels.size(), {info.width, info.height});
  SideBySide beside(output.staged("side_by_side.mp4"), labels, sizes, info.fps);
  const int frames = drawing.source.frames, both = std::min(frames, drawing.drawn_frames),
            all = std::max(frames, drawing.drawn_frames);
  source.rewind();
  session.context.report("synthesize", 0);
  for (int t = 0; t < all; t += kBatch) {
    const auto levels = next_levels(source, std::clamp(frames - t, 0, kBatch), session);
    if (std::ssize(levels) < std::min(frames - t, kBatch))
      throw core::IoError("the clip has become shorter while it was read");
    drawing.source.add(pipeline::luma_of(levels), session.context);
    std::vector<std::vector<cv::Mat>> rows(1);
    for (const auto& one : levels) rows[0].push_back(core::to_bytes(one));
    const int drawn = std::clamp(drawing.drawn_frames - t, 0, kBatch);
    for (auto& column : drawing.columns) rows.push_back(draw_column(column, drawn, with_strokes, session));
    for (int i = t; i < std::min(both, t + kBatch); ++i) {
      std::vector<cv::Mat> row;
      for (const auto& clip : rows) row.push_back(clip[static_cast<std::size_t>(i - t)]);
      beside.write(row);
      if (i == both / 4 || i == both * 3 / 4) drawing.pictures.push_back({i, compose_rows(row, labels, 3)});
    }
    session.context.report("synthesize", std::min(1.0, static_cast<double>(t + kBatch) / all));
  }
  beside.finish();
  for (auto& column : drawing.columns) column.writer->finish();
}

std::vector<Column> make_columns(std::span<const pipeline::ComparedModel> models, const core::ClipInfo& info,
                                 const pipeline::ClipMeasures& blank, const pipeline::CompareOptions& options,
                                 const io::OutputFolder& output) {
  const cv::Size size(info.width, info.height);
  std::vector<Column> columns;
  for (const auto& model : models)
    columns.push_back({&model, model.draw(),
                       io::create_video(output.staged(model.file), size, info.fps, info.channels == 3), blank,
                       pipeline::ClipStrokes(size, info.fps, options.sketch, options.match)});
  return columns;
}

Json synthesis_json(const Drawing& drawing, const mcmc::StrokeSeries* strokes, const Session& session) {
  Json synthesis = {{"frames", drawing.drawn_frames}};
  std::optional<mcmc::StrokeStatistics> of_source;
  if (strokes != nullptr) of_source = mcmc::stroke_statistics(*strokes);
  for (const auto& column : drawing.columns) {
    std::optional<mcmc::StrokeStatistics> found;
    if (of_source) found = mcmc::stroke_statistics(column.strokes.series(session.context));
    synthesis[column.model->key] = held_json(column.measures, found, drawing.source.all, of_source);
  }
  synthesis["noise_floor"] = noise_floor_json(drawing.source, strokes);
  synthesis["source"] = own_json(drawing.source.all, of_source);
  return synthesis;
}

Json models_json(std::span<const pipeline::ComparedModel> models) {
  Json out = Json::array();
  for (const auto& model : models)
    out.push_back(
        {{"key", model.key}, {"label", model.label}, {"parameters", model.parameters}, {"file", model.file}});
  return out;
}

}  // namespace

Comparison compare_clip(core::FrameSource& source, const std::string& clip,
                        const pipeline::CompareOptions& options, const pipeline::KnownModels& known,
                        io::OutputFolder& output, Session& session) {
  options.validate();
  const auto& info = source.info();
  pipeline::SketchedClip own;
  if (known.sketched == nullptr) own = pipeline::sketch_clip(source, options.sketch, session.context);
  const auto& sketched = known.sketched != nullptr ? *known.sketched : own;
  const auto frames = static_cast<int>(sketched.sketch.frames.size());
  need_frames(clip, frames);
  const int first = std::clamp(static_cast<int>(std::lround(frames * options.learn_share)), 4, frames);
  const auto steps = pipeline::prediction_steps(std::min(options.steps, std::max(1, frames - first)));
  const pipeline::ModelInput input{
      source, frames, first, steps, sketched, options, session.common.seed, session.context};
  const auto models = pipeline::learn_models(input, known);

  const int drawn_frames = options.frames > 0 ? options.frames : frames;
  const cv::Size size(info.width, info.height);
  const auto scale = pipeline::measure_scale(std::min(frames / 2, drawn_frames), size);
  Json measures = begin_measures(scale);
  measures["clip"] = clip_json(clip, info, frames);
  measures["seed"] = session.common.seed;
  measures["learned_frames"] = first;
  measures["models"] = models_json(models);
  if (first < frames) {
    auto measured = pipeline::measure_prediction(source, first, frames, steps, models, session.context);
    measures["prediction"] = std::move(measured.prediction);
    measures["reconstruction"] = std::move(measured.reconstruction);
  } else {
    measures["prediction"] = nullptr;
  }

  Drawing drawing{drawn_frames, pipeline::SourceMeasures(size, scale, frames), {}, {}};
  try {
    drawing.columns =
        make_columns(models, info, pipeline::ClipMeasures(size, scale, drawn_frames), options, output);
    draw_all(source, drawing, options.strokes, output, session);
  } catch (const core::IoError& error) {
    throw core::IoError(output.with_final_name(error.what()));
  }
  mcmc::StrokeSeries strokes;
  if (options.strokes) strokes = pipeline::stroke_series(sketched.sketch, options.match, session.context);
  measures["synthesis"] = synthesis_json(drawing, options.strokes ? &strokes : nullptr, session);
  NamedMeasures curves{{"source", &drawing.source.all}};
  Comparison comparison;
  comparison.files = {"measures.json", "side_by_side.mp4"};
  for (const auto& column : drawing.columns) {
    curves.emplace_back(column.model->key, &column.measures);
    comparison.files.push_back(column.model->file);
  }
  measures["curves"] = curves_json(curves, scale);
  if (options.curve) measures["size_curve"] = pipeline::size_curve(input, drawing.source.all, scale);
  measures["words"] = comparison_words(measures);
  measures["warnings"] = session.warnings;
  write_measures(measures, output);
  comparison.measures = std::move(measures);
  comparison.pictures = std::move(drawing.pictures);
  return comparison;
}

}  // namespace emberfold::apps
