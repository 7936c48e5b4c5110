// SPDX-License-Identifier: Apache-2.0
#include "pipeline/comparison_curve.hpp"

#include <algorithm>
#include <array>
#include <cstdio>
#include <vector>

#include "dytex/baselines/star.hpp"
#include "pipeline/prediction.hpp"

namespace emberfold::pipeline {

using Json = nlohmann::ordered_json;

namespace {

constexpr int kMostFrames = 128, kBatch = 16;
constexpr double kMostSpacing = 100;  // px, that a sketch takes

struct Sized {
  ComparedModel model;
  std::string what;
};

std::string reduced_text(double scale) {
  return scale < 1 ? ", frames reduced to 1/" + std::to_string(static_cast<int>(1 / scale)) : "";
}

std::string pixels_text(double length) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%g", length);
  return text.data();
}

ClipMeasures measure_drawn(const ComparedModel& model, const ModelInput& input, const MeasureScale& scale) {
  const auto& info = input.source.info();
  const int frames = std::max(std::min(input.frames, kMostFrames), 2 * std::max(scale.segment, scale.lags));
  ClipMeasures measures({info.width, info.height}, scale, frames);
  const auto draw = model.draw();
  for (int t = 0; t < frames; t += kBatch) {
    measures.add(luma_of(levels_of(draw(std::min(kBatch, frames - t)))), input.context);
    input.context.check();
  }
  return measures;
}

Json point_json(const Sized& sized, const ModelInput& input, const ClipMeasures& source,
                const MeasureScale& scale) {
  Json point = {{"model", sized.model.key}, {"label", sized.model.label},
                {"what", sized.what},       {"parameters", sized.model.parameters},
                {"psnr", nullptr},          {"ssim", nullptr}};
  if (input.first < input.frames) {
    const int next = 1;
    const auto told = measure_prediction(input.source, input.first, input.frames, std::span(&next, 1),
                                         std::span(&sized.model, 1), input.context);
    const auto& method = told.prediction["methods"][sized.model.key];
    point["psnr"] = method["psnr"], point["ssim"] = method["ssim"];
  }
  point.update(pixel_distances(measure_drawn(sized.model, input, scale), source));
  return point;
}

// The texture no larger than the motion model that foretells best (or, with nothing held out, draws the
// nearest spectrum in time).
Json equal_json(const Json& points) {
  const Json* strokes = nullptr;
  const Json* best = nullptr;
  for (const auto& point : points)
    if (point["model"] == "motion_model" && strokes == nullptr) strokes = &point;
  if (strokes == nullptr) return nullptr;
  const auto better = [](const Json& a, const Json& b) {
    return a["psnr"].is_number() ? a["psnr"] > b["psnr"] : a["temporal_db"] < b["temporal_db"];
  };
  for (const auto& point : points)
    if (point["model"] == "linear_dynamic_texture" && point["parameters"] <= (*strokes)["parameters"] &&
        (best == nullptr || better(point, *best)))
      best = &point;
  return {{"parameters", (*strokes)["parameters"]},
          {"motion_model", *strokes},
          {"linear_dynamic_texture", best == nullptr ? Json(nullptr) : *best}};
}

}  // namespace

Json size_curve(const ModelInput& input, const ClipMeasures& source, const MeasureScale& scale) {
  Json points = Json::array();
  const int one = 1;
  const auto next_only = [&](const SketchedClip& sketched, const CompareOptions& options) {
    return ModelInput{input.source, input.frames, input.first, std::span(&one, 1),
                      sketched,     options,      input.seed,  input.context};
  };
  const auto add = [&](std::optional<ComparedModel> model, const std::string& what, const ModelInput& from) {
    if (model) points.push_back(point_json({std::move(*model), what}, from, source, scale));
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
    for (int n = 1; n <= std::min(input.options.learn.components, std::max(1, input.first / 3)); n *= 2) {
      const auto& info = input.source.info();
      if (std::min(info.width, info.height) * reduced < 2) continue;
      add(texture_model(from, {}, n, reduced),
          std::to_string(n) + (n == 1 ? " component" : " components") + reduced_text(reduced), from);
    }
  for (const int reach : {1, 2, 3})
    add(star_model(from, reach), "neighbours up to " + std::to_string(reach) + " px away", from);
  return {{"points", points}, {"equal", equal_json(points)}};
}

}  // namespace emberfold::pipeline
