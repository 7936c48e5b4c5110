// SPDX-License-Identifier: Apache-2.0
#include "apps/comparison/comparison_json.hpp"

#include <algorithm>
#include <array>
#include <cstdio>

#include "apps/cli/summary.hpp"
#include "apps/comparison/comparison.hpp"
#include "core/error.hpp"
#include "pipeline/clip_strokes.hpp"

namespace emberfold::apps {

using Json = nlohmann::ordered_json;

Json begin_measures(const pipeline::MeasureScale& scale) {
  return {{"format", "emberfold.measures"}, {"version", 2},
          {"emberfold", kVersion},          {"measured_on", "luma"},
          {"segment", scale.segment},       {"lags", scale.lags},
          {"rings", scale.rings},           {"floor", dytex::kRounding}};
}

Json curves_json(const NamedMeasures& clips, const pipeline::MeasureScale& scale) {
  Json temporal = {{"frequency", Json::array()}}, radial = {{"frequency", Json::array()}},
       memory = {{"lag", Json::array()}};
  for (int k = 1; k <= scale.segment / 2; ++k) temporal["frequency"].push_back(double(k) / scale.segment);
  for (int i = 1; i <= scale.rings; ++i) radial["frequency"].push_back(i / (2.0 * scale.rings));
  for (int lag = 1; lag <= scale.lags; ++lag) memory["lag"].push_back(lag);
  for (const auto& [name, clip] : clips) {
    temporal[name] = pipeline::decibels_json(clip->temporal());
    radial[name] = pipeline::decibels_json(clip->radial());
    Json values = Json::array();
    for (const double value : clip->autocorrelation()) values.push_back(pipeline::rounded(value));
    memory[name] = std::move(values);
  }
  return {{"temporal_db", std::move(temporal)},
          {"radial_db", std::move(radial)},
          {"autocorrelation", std::move(memory)}};
}

void need_frames(const std::string& clip, std::int64_t frames) {
  if (frames <= 0) throw core::IoError(clip + " holds no frame");
  if (frames < pipeline::kFewestFrames)
    throw core::IoError(clip + " holds " + std::to_string(frames) + (frames == 1 ? " frame" : " frames") +
                        "; a comparison needs at least " + std::to_string(pipeline::kFewestFrames));
}

void write_measures(const Json& measures, io::OutputFolder& output) {
  output.write("measures.json", [&](std::ostream& out) { out << json_text(measures); });
}

Json own_json(const pipeline::ClipMeasures& clip, const std::optional<mcmc::StrokeStatistics>& strokes) {
  Json own = {{"figures", pipeline::pixel_figures(clip)}};
  if (strokes) own["strokes"] = pipeline::strokes_json(*strokes);
  return own;
}

Json held_json(const pipeline::ClipMeasures& clip, const std::optional<mcmc::StrokeStatistics>& strokes,
               const pipeline::ClipMeasures& source, const std::optional<mcmc::StrokeStatistics>& of_source) {
  Json held = pipeline::pixel_distances(clip, source);
  if (strokes && of_source) held.update(pipeline::stroke_distances(*strokes, *of_source));
  held.update(own_json(clip, strokes));
  return held;
}

Json noise_floor_json(const pipeline::SourceMeasures& source, const mcmc::StrokeSeries* strokes) {
  Json floor = pipeline::pixel_distances(source.first, source.second);
  if (strokes == nullptr) return floor;
  const int half = source.frames / 2;
  floor.update(pipeline::stroke_distances(
      mcmc::stroke_statistics(pipeline::select_frames(*strokes, 0, half)),
      mcmc::stroke_statistics(pipeline::select_frames(*strokes, half, source.frames))));
  return floor;
}

std::vector<cv::Mat> next_levels(core::FrameSource& source, int most, const Session& session) {
  std::vector<cv::Mat> levels;
  while (std::ssize(levels) < most) {
    const cv::Mat frame = source.next();
    session.check_stop();
    if (frame.empty()) break;
    levels.push_back(core::to_levels(frame, source.info()));
  }
  return levels;
}

std::vector<pipeline::Measure> all_measures() {
  std::vector<pipeline::Measure> all(pipeline::pixel_measures().begin(), pipeline::pixel_measures().end());
  all.insert(all.end(), pipeline::stroke_measures().begin(), pipeline::stroke_measures().end());
  return all;
}

std::vector<Held> held_clips(const Json& measures) {
  std::vector<Held> held;
  for (const auto& model : measures.value("models", Json::array()))
    held.push_back({model["key"].get<std::string>(), model["label"].get<std::string>()});
  if (measures.contains("other")) held.push_back({"other", "the other clip"});
  held.push_back({"noise_floor", "noise floor"});
  std::erase_if(held, [&](const Held& one) { return distances_of(measures, one.key).is_null(); });
  return held;
}

const Json& distances_of(const Json& measures, const std::string& key) {
  static const Json none = nullptr;
  for (const char* holder : {"synthesis", "distances"})
    if (measures.contains(holder) && measures[holder].contains(key)) return measures[holder][key];
  return none;
}

namespace {

std::string cell(const Json& holder, const std::string& key, int digits) {
  const int width = 13;
  std::array<char, 32> text{};
  if (holder.is_object() && holder.contains(key) && holder[key].is_number())
    std::snprintf(text.data(), text.size(), "%*.*f", width, digits, holder[key].get<double>());
  else
    std::snprintf(text.data(), text.size(), "%*s", width, "-");
  return text.data();
}

std::string row(const std::string& name, const std::string& cells) {
  std::string out = "  " + name;
  out.resize(std::max<std::size_t>(out.size(), 30), ' ');
  return out + cells + "\n";
}

// Names above columns of numbers: the label's last words that fit.
std::string heading(const std::string& label) {
  constexpr std::size_t kWidth = 13;
  std::string text = label == "linear dynamic texture" ? "dyn. texture"
                     : label == "the other clip"       ? "other clip"
                                                       : label;
  if (text.size() > kWidth - 1) text = text.substr(0, kWidth - 1);
  return std::string(kWidth - text.size(), ' ') + text;
}

std::string prediction_table(const Json& measures) {
  const auto& prediction = measures["prediction"];
  std::string head = "frames foretold from " + std::to_string(prediction["moments"].get<int>()) + " moments";
  head.resize(std::max<std::size_t>(head.size() + 2, 32), ' ');
  for (const auto& step : prediction["steps"])
    head += heading((step == 1 ? "next, dB" : "+" + step.dump() + ", dB"));
  std::string out = head + heading("next, SSIM") + heading("itself, dB") + "\n";
  std::vector<Held> ways = held_clips(measures);
  std::erase_if(ways, [](const Held& one) { return one.key == "noise_floor"; });
  ways.push_back({"frame_before", "the frame before"});
  ways.push_back({"mean_image", "the first part's mean image"});
  for (const auto& [key, label] : ways) {
    if (!prediction["methods"].contains(key)) continue;
    const auto& method = prediction["methods"][key];
    std::string cells = "  ";
    for (const auto& value : method["by_step"]["psnr"]) cells += cell({{"x", value}}, "x", 2);
    const auto& shown = measures["reconstruction"];
    out += row(label, cells + cell(method, "ssim", 3) +
                          cell(shown.contains(key) ? shown[key] : Json(nullptr), "psnr", 2));
  }
  return out + "\n";
}

}  // namespace

std::string comparison_table(const Json& measures) {
  std::string out;
  if (measures.contains("prediction") && !measures["prediction"].is_null()) out += prediction_table(measures);
  const auto held = held_clips(measures);
  std::string head = "how far from the source";
  head.resize(32, ' ');
  for (const auto& one : held) head += heading(one.label);
  out += head + "\n";
  for (const auto& measure : all_measures()) {
    std::string cells = "  ";
    for (const auto& one : held) cells += cell(distances_of(measures, one.key), measure.key, 3);
    const std::string unit = measure.unit;
    if (cells.find_first_of("0123456789") != std::string::npos)
      out += row(measure.name + (unit.empty() ? "" : ", " + unit), cells);
  }
  if (!measures.contains("psnr")) return out;
  if (measures["psnr"].is_null())
    return out + "PSNR: none, " + measures["psnr_missing"].get<std::string>() + "\n";
  return out + row("PSNR, dB", "  " + cell(measures, "psnr", 2)) +
         row("SSIM", "  " + cell(measures, "ssim", 3));
}

}  // namespace emberfold::apps
