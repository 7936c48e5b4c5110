// SPDX-License-Identifier: Apache-2.0
#include "apps/comparison/comparison_json.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "apps/cli/summary.hpp"
#include "core/text/format_number.hpp"
#include "dytex/measures/spectra.hpp"
#include "pipeline/comparison/clip_strokes.hpp"

namespace emberfold::apps {

using Json = nlohmann::ordered_json;

namespace {

constexpr int kDigits = 3;      // decimals, of measures
constexpr int kRateDigits = 5;  // of rates and their intervals

Json rounded_json(double value) {
  return core::round_to(value, kDigits);
}

Json rate_json(double value) {
  return std::isfinite(value) ? Json(core::round_to(value, kRateDigits)) : Json(nullptr);
}

Json interval_json(const mcmc::RateInterval& interval) {
  if (!(interval.mean > 0)) return nullptr;
  return {{"mean", rate_json(interval.mean)},
          {"low", rate_json(interval.low)},
          {"high", rate_json(interval.high)}};
}

Json curve_json(const std::vector<double>& values) {
  Json out = Json::array();
  for (const double value : values) out.push_back(rounded_json(value));
  return out;
}

Json figures_json(const pipeline::PixelFigures& figures) {
  return {{"crease_sharpness", rounded_json(figures.crease_sharpness)},
          {"crease_gradient", rounded_json(figures.crease_gradient)},
          {"si", {{"most", rounded_json(figures.si)}, {"mean", rounded_json(figures.mean_si)}}},
          {"ti", {{"most", rounded_json(figures.ti)}, {"mean", rounded_json(figures.mean_ti)}}}};
}

Json strokes_json(const mcmc::StrokeStatistics& strokes) {
  Json events = Json::object();
  for (const auto type : graph::all_event_types()) {
    const auto i = static_cast<std::size_t>(type);
    const auto& rate = strokes.events_a_frame[i];
    events[std::string(graph::name(type))] = {{"count", strokes.happened[i]},
                                              {"a_frame", rate_json(rate.mean)},
                                              {"low", rate_json(rate.low)},
                                              {"high", rate_json(rate.high)}};
  }
  return {{"frames", strokes.frames},
          {"strokes_a_frame", rounded_json(strokes.strokes_a_frame)},
          {"events", std::move(events)},
          {"lifetime", interval_json(strokes.lifetime)},
          {"length", interval_json(strokes.length)}};
}

Json pixel_distances_json(const pipeline::PixelDistances& distances) {
  return {{"temporal_db", rounded_json(distances.temporal_db)},
          {"radial_db", rounded_json(distances.radial_db)},
          {"autocorrelation", rounded_json(distances.autocorrelation)},
          {"patterns", rounded_json(distances.patterns)},
          {"flow_px", rounded_json(distances.flow_px)},
          {"crease_sharpness", rounded_json(distances.crease_sharpness)},
          {"si", rounded_json(distances.si)},
          {"ti", rounded_json(distances.ti)}};
}

Json stroke_distances_json(const pipeline::StrokeDistances& distances) {
  Json inside = Json::object();
  for (const auto type : graph::all_event_types())
    inside[std::string(graph::name(type))] = distances.rate_inside[static_cast<std::size_t>(type)];
  inside["lifetime"] = distances.lifetime_inside;
  inside["length"] = distances.length_inside;
  return {{"stroke_events", rounded_json(distances.event_rates)},
          {"stroke_lifetime", rounded_or_null(distances.lifetime)},
          {"stroke_length", rounded_or_null(distances.length)},
          {"inside", std::move(inside)}};
}

Json visible_json(const pipeline::VisibleFigures& figures) {
  return {{"complete", rounded_json(figures.complete)},
          {"coherent", rounded_json(figures.coherent)},
          {"flow", rounded_json(figures.flow)},
          {"variance", rounded_json(figures.variance)},
          {"difference", rounded_json(figures.difference)},
          {"copied", rounded_json(figures.copied)},
          {"moves_alike", figures.moves_alike()},
          {"apart", rounded_json(figures.apart())}};
}

Json quality_json(const std::optional<pipeline::FrameQuality>& quality) {
  if (!quality) return nullptr;
  return {{"psnr", rounded_json(quality->psnr)}, {"ssim", rounded_json(quality->ssim)}};
}

}  // namespace

Json rounded_or_null(const std::optional<double>& value) {
  return value ? rounded_json(*value) : Json(nullptr);
}

Json begin_measures(const pipeline::MeasureScale& scale) {
  return {{"format", "emberfold.measures"}, {"version", 2},
          {"emberfold", kVersion},          {"measured_on", "luma"},
          {"segment", scale.segment},       {"lags", scale.lags},
          {"rings", scale.rings},           {"floor", dytex::kRounding}};
}

Json curves_json(const NamedCurves& clips, const pipeline::MeasureScale& scale) {
  Json temporal = {{"frequency", Json::array()}}, radial = {{"frequency", Json::array()}},
       memory = {{"lag", Json::array()}};
  for (int k = 1; k <= scale.segment / 2; ++k) temporal["frequency"].push_back(double(k) / scale.segment);
  for (int i = 1; i <= scale.rings; ++i) radial["frequency"].push_back(i / (2.0 * scale.rings));
  for (int lag = 1; lag <= scale.lags; ++lag) memory["lag"].push_back(lag);
  for (const auto& [name, curves] : clips) {
    temporal[name] = curve_json(curves->temporal_db);
    radial[name] = curve_json(curves->radial_db);
    memory[name] = curve_json(curves->autocorrelation);
  }
  return {{"temporal_db", std::move(temporal)},
          {"radial_db", std::move(radial)},
          {"autocorrelation", std::move(memory)}};
}

Json profile_json(const pipeline::ClipProfile& profile) {
  Json out = {{"figures", figures_json(profile.pixels)}};
  if (profile.strokes) out["strokes"] = strokes_json(*profile.strokes);
  return out;
}

Json distances_json(const pipeline::ClipDistances& distances) {
  Json out = pixel_distances_json(distances.pixels);
  if (distances.strokes) out.update(stroke_distances_json(*distances.strokes));
  if (distances.visible) out["visible"] = visible_json(*distances.visible);
  return out;
}

Json prediction_json(const pipeline::PredictionMeasures& prediction) {
  Json methods = Json::object(), per_frame = Json::object();
  for (const auto& method : prediction.methods) {
    Json psnr = Json::array(), ssim = Json::array();
    for (const auto& step : method.by_step) {
      const Json quality = quality_json(step);
      psnr.push_back(quality.is_null() ? quality : quality["psnr"]);
      ssim.push_back(quality.is_null() ? quality : quality["ssim"]);
    }
    Json out = quality_json(method.by_step.front());
    out["by_step"] = {{"psnr", std::move(psnr)}, {"ssim", std::move(ssim)}};
    methods[method.key] = std::move(out);
    per_frame[method.key] = curve_json(method.next_frame_psnr);
  }
  return {{"first_frame", prediction.first_frame},
          {"moments", prediction.starts},
          {"steps", prediction.steps},
          {"methods", std::move(methods)},
          {"per_frame", std::move(per_frame)}};
}

Json reconstruction_json(const pipeline::PredictionMeasures& prediction) {
  Json out = Json::object();
  for (const auto& method : prediction.methods)
    if (method.reconstruction) out[method.key] = quality_json(method.reconstruction);
  return out;
}

void write_measures(const Json& measures, io::OutputFolder& output) {
  output.write("measures.json", [&](std::ostream& out) { out << json_text(measures); });
}

std::vector<pipeline::MeasureDescription> all_measures() {
  std::vector<pipeline::MeasureDescription> all(pipeline::pixel_measures().begin(),
                                                pipeline::pixel_measures().end());
  all.insert(all.end(), pipeline::stroke_measures().begin(), pipeline::stroke_measures().end());
  return all;
}

std::vector<DistanceColumn> distance_columns(const Json& measures) {
  std::vector<DistanceColumn> columns;
  for (const auto& model : measures.value("models", Json::array()))
    columns.push_back({model["key"].get<std::string>(), model["label"].get<std::string>()});
  if (measures.contains("other")) columns.push_back({"other", "the other clip"});
  columns.push_back({"noise_floor", "noise floor"});
  std::erase_if(columns,
                [&](const DistanceColumn& one) { return distances_of(measures, one.key).is_null(); });
  return columns;
}

const Json& distances_of(const Json& measures, const std::string& key) {
  static const Json none = nullptr;
  for (const char* holder : {"synthesis", "distances"})
    if (measures.contains(holder) && measures[holder].contains(key)) return measures[holder][key];
  return none;
}

}  // namespace emberfold::apps
