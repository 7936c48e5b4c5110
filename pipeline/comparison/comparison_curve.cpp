// SPDX-License-Identifier: Apache-2.0
#include "pipeline/comparison/comparison_curve.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <vector>

#include "dytex/baselines/star.hpp"
#include "pipeline/comparison/compared_models.hpp"
#include "pipeline/comparison/prediction.hpp"

namespace emberfold::pipeline {

namespace {

constexpr int kMostFrames = 128;      // of a drawn clip that are measured
constexpr int kBatch = 16;            // frames that are in memory at once
constexpr double kMostSpacing = 100;  // px, the maximum for a sketch
constexpr double kEqual = 1000;       // qualities equal after rounding to 1/1000 dB are ties

std::string reduced_text(double scale) {
  return scale < 1 ? ", frames reduced to 1/" + std::to_string(static_cast<int>(1 / scale)) : "";
}

std::string pixels_text(double length) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%g", length);
  return text.data();
}

ClipMeasures measure_drawn(const ComparedModel& model, const TrainingInput& input,
                           const MeasureScale& scale) {
  const auto& info = input.source.info();
  const int frames = std::max(std::min(input.frames, kMostFrames), 2 * std::max(scale.segment, scale.lags));
  ClipMeasures measures({info.width, info.height}, scale, frames);
  const auto draw_next = model.begin_clip();
  for (int t = 0; t < frames; t += kBatch) {
    measures.add(levels_to_luma(bytes_to_levels(draw_next(std::min(kBatch, frames - t)))), input.context);
    input.context.check();
  }
  return measures;
}

SizeCurvePoint measure_point(const ComparedModel& model, const std::string& size_text,
                             const TrainingInput& input, const ClipMeasures& source,
                             const MeasureScale& scale) {
  SizeCurvePoint point{model.key, model.label, size_text, model.parameters, {}, {}};
  if (input.learned_frames < input.frames) {
    const int next = 1;
    const auto predicted = measure_prediction(input.source, input.learned_frames, input.frames,
                                              std::span(&next, 1), std::span(&model, 1), input.context);
    point.next_frame = predicted.methods.back().by_step.front();
  }
  point.distances = pixel_distances(measure_drawn(model, input, scale), source);
  return point;
}

// Returns whether `a` predicts better than `b` or, without held-out frames, draws the closer spectrum in
// time.
bool is_better(const SizeCurvePoint& a, const SizeCurvePoint& b) {
  const auto steps = [](double value) { return std::round(value * kEqual); };
  return a.next_frame && b.next_frame ? steps(a.next_frame->psnr) > steps(b.next_frame->psnr)
                                      : steps(a.distances.temporal_db) < steps(b.distances.temporal_db);
}

void find_equals(SizeCurve& curve) {
  const auto& points = curve.points;
  const auto strokes = std::ranges::find(points, "motion_model", &SizeCurvePoint::model);
  if (strokes == points.end()) return;
  curve.motion_model = static_cast<std::size_t>(strokes - points.begin());
  auto& best = curve.equal_texture;
  for (std::size_t i = 0; i < points.size(); ++i)
    if (points[i].model == "linear_dynamic_texture" && points[i].parameters <= strokes->parameters &&
        (!best || is_better(points[i], points[*best])))
      best = i;
}

}  // namespace

SizeCurve measure_size_curve(const TrainingInput& input, const ClipMeasures& source,
                             const MeasureScale& scale) {
  SizeCurve curve;
  const int one = 1;
  const auto next_only = [&](const SketchedClip& sketched, const CompareOptions& options) {
    return TrainingInput{input.source, input.frames, input.learned_frames, std::span(&one, 1),
                         sketched,     options,      input.seed,           input.context};
  };
  const auto add = [&](const std::optional<ComparedModel>& model, const std::string& size_text,
                       const TrainingInput& from) {
    if (model) curve.points.push_back(measure_point(*model, size_text, from, source, scale));
    input.context.check();
  };
  for (const int factor : {1, 2, 4}) {
    CompareOptions options = input.options;
    options.sketch.spacing = std::min(factor * options.sketch.spacing, kMostSpacing);
    const auto sketched =
        factor == 1 ? input.sketched : sketch_clip(input.source, options.sketch, input.context);
    const auto from = next_only(sketched, options);
    const auto strokes = learn_strokes(from, {});
    if (!strokes) continue;
    add(sketch_model(strokes, input.seed, input.context),
        "a patch every " + pixels_text(options.sketch.spacing) + " px", from);
  }
  const auto from = next_only(input.sketched, input.options);
  for (const double reduced : {0.125, 0.25, 0.5, 1.0})
    for (int n = 1; n <= std::min(input.options.learn.components, std::max(1, input.learned_frames / 3));
         n *= 2) {
      const auto& info = input.source.info();
      if (std::min(info.width, info.height) * reduced < 2) continue;
      add(texture_model(from, {}, n, reduced),
          std::to_string(n) + (n == 1 ? " component" : " components") + reduced_text(reduced), from);
    }
  for (const int reach : {1, 2, 3})
    add(star_model(from, reach), "neighbours up to " + std::to_string(reach) + " px away", from);
  find_equals(curve);
  return curve;
}

}  // namespace emberfold::pipeline
