// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <optional>

#include <opencv2/core.hpp>

#include "core/context.hpp"
#include "core/error.hpp"
#include "mcmc/learning/stroke_statistics.hpp"
#include "pipeline/compare.hpp"
#include "pipeline/comparison/clip_measures.hpp"
#include "pipeline/comparison/clip_profile.hpp"
#include "pipeline/comparison/clip_strokes.hpp"
#include "pipeline/comparison/compared_models.hpp"
#include "pipeline/comparison/prediction.hpp"
#include "pipeline/comparison/visible_measures.hpp"

namespace emberfold::pipeline {

namespace {

constexpr int kFramesAtOnce = 16;  // frames of each clip in memory at once
constexpr int kFewestLearned = 4;  // frames that models learn from

// A model's clip while it is drawn.
struct DrawnClip {
  const ComparedModel* model;
  ComparedModel::NextFrames next;
  ClipMeasures measures;
  std::optional<ClipStrokes> strokes;
  std::vector<cv::Mat> pictures = {};  // visible_pictures
};

struct Drawing {
  int drawn_frames = 0;  // of the models' clips
  SourceMeasures source;
  std::vector<cv::Mat> pictures;  // of the source
  std::vector<DrawnClip> clips;
};

void add_pictures(std::vector<cv::Mat>& pictures, std::span<const cv::Mat> luma) {
  for (const auto& one : luma)
    if (pictures.size() < VisibleMeasures::kMostFrames) pictures.push_back(visible_picture(one));
}

std::vector<DrawnClip> begin_clips(std::span<const ComparedModel> models, const core::ClipInfo& info,
                                   const ClipMeasures& blank, const CompareOptions& options) {
  const cv::Size size(info.width, info.height);
  std::vector<DrawnClip> clips;
  for (const auto& model : models) {
    clips.push_back({&model, model.begin_clip(), blank, {}});
    if (options.in_full && model.has_strokes)
      clips.back().strokes.emplace(size, info.fps, options.sketch, options.match);
  }
  return clips;
}

void announce(const CompareObserver& observer, const core::ClipInfo& info, const Drawing& drawing) {
  if (!observer.begin) return;
  std::vector<ObservedClip> clips{{"source", "source", info, drawing.source.frames}};
  for (const auto& clip : drawing.clips)
    clips.push_back({clip.model->key, clip.model->label, info, drawing.drawn_frames});
  observer.begin(clips);
}

std::vector<cv::Mat> draw_frames(DrawnClip& clip, int count, const core::Context& context) {
  auto frames = clip.next(count);
  const auto levels = bytes_to_levels(frames);
  const auto luma = levels_to_luma(levels);
  clip.measures.add(luma, context);
  add_pictures(clip.pictures, luma);
  if (clip.strokes) clip.strokes->add(levels, context);
  return frames;
}

// Draws all clips together with the source, a batch at a time.
void draw_all(core::FrameSource& source, Drawing& drawing, const core::Context& context,
              const CompareObserver& observer) {
  const int frames = drawing.source.frames, all = std::max(frames, drawing.drawn_frames);
  source.rewind();
  context.report("synthesize", 0);
  for (int t = 0; t < all; t += kFramesAtOnce) {
    const auto levels = next_levels(source, std::clamp(frames - t, 0, kFramesAtOnce), context);
    if (std::ssize(levels) < std::min(frames - t, kFramesAtOnce))
      throw core::IoError("the clip has become shorter while it was read");
    const auto luma = levels_to_luma(levels);
    drawing.source.add(luma, context);
    add_pictures(drawing.pictures, luma);
    std::vector<std::vector<cv::Mat>> batch(1);
    if (observer.take)
      for (const auto& one : levels) batch[0].push_back(core::to_bytes(one));
    const int drawn = std::clamp(drawing.drawn_frames - t, 0, kFramesAtOnce);
    for (auto& clip : drawing.clips) batch.push_back(draw_frames(clip, drawn, context));
    if (observer.take) observer.take(t, batch);
    context.report("synthesize", std::min(1.0, static_cast<double>(t + kFramesAtOnce) / all));
  }
}

void add_results(const Drawing& drawing, const mcmc::StrokeSeries* series, const core::Context& context,
                 ModelComparison& out) {
  OptionalStrokes source_strokes;
  if (series != nullptr) source_strokes = mcmc::stroke_statistics(*series);
  const VisibleMeasures visible(drawing.pictures, context);
  for (const auto& clip : drawing.clips) {
    OptionalStrokes strokes;
    if (clip.strokes) strokes = mcmc::stroke_statistics(clip.strokes->series(context));
    out.models.push_back({clip.model->key, clip.model->label, clip.model->parameters,
                          clip_profile(clip.measures, strokes),
                          clip_distances(clip.measures, strokes, drawing.source.all, source_strokes)});
    out.models.back().distances.visible = visible.measure(clip.pictures, context);
  }
  out.noise_floor = noise_floor(drawing.source, series);
  out.source = clip_profile(drawing.source.all, source_strokes);
}

}  // namespace

ModelComparison compare_models(core::FrameSource& source, const CompareOptions& options,
                               const KnownModels& known, std::uint64_t seed, const core::Context& context,
                               const CompareObserver& observer) {
  options.validate();
  const auto& info = source.info();
  SketchedClip own;
  if (known.sketched == nullptr) own = sketch_clip(source, options.sketch, context);
  const auto& sketched = known.sketched != nullptr ? *known.sketched : own;
  ModelComparison out;
  out.frames = static_cast<int>(sketched.sketch.frames.size());
  if (out.frames < kFewestFrames) throw ShortClipError(0, out.frames);
  out.learned_frames =
      std::clamp(static_cast<int>(std::lround(out.frames * options.learn_share)), kFewestLearned, out.frames);
  out.drawn_frames = options.frames > 0 ? options.frames : out.frames;
  const auto steps = prediction_steps(std::min(options.steps, std::max(1, out.frames - out.learned_frames)));
  const TrainingInput input{source, out.frames, out.learned_frames, steps, sketched, options, seed, context};
  const auto models = learn_models(input, known);
  if (out.learned_frames < out.frames)
    out.prediction = measure_prediction(source, out.learned_frames, out.frames, steps, models, context);

  const cv::Size size(info.width, info.height);
  out.scale = measure_scale(std::min(out.frames / 2, out.drawn_frames), size);
  Drawing drawing{out.drawn_frames, SourceMeasures(size, out.scale, out.frames), {}, {}};
  drawing.clips = begin_clips(models, info, ClipMeasures(size, out.scale, out.drawn_frames), options);
  announce(observer, info, drawing);
  draw_all(source, drawing, context, observer);
  mcmc::StrokeSeries series;
  if (options.in_full) series = stroke_series(sketched.sketch, options.match, context);
  add_results(drawing, options.in_full ? &series : nullptr, context, out);
  return out;
}

}  // namespace emberfold::pipeline
