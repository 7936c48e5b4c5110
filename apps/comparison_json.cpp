// SPDX-License-Identifier: Apache-2.0
#include "apps/comparison_json.hpp"

#include <array>
#include <cstdio>

#include "apps/comparison.hpp"
#include "apps/summary.hpp"

namespace emberfold::apps {

using Json = nlohmann::ordered_json;

Json begin_measures(int segment, int rings) {
  return {{"format", "emberfold.measures"}, {"version", 1},       {"emberfold", kVersion},
          {"spectra_of", "luma"},           {"segment", segment}, {"rings", rings},
          {"floor", dytex::kRounding}};
}

Json curves_json(const NamedSpectra& clips, int segment, int rings) {
  Json temporal = {{"frequency", Json::array()}}, radial = {{"frequency", Json::array()}};
  for (int k = 1; k <= segment / 2; ++k) temporal["frequency"].push_back(double(k) / segment);
  for (int i = 1; i <= rings; ++i) radial["frequency"].push_back(i / (2.0 * rings));
  for (const auto& [name, spectra] : clips) {
    temporal[name] = decibels_json(spectra->temporal());
    radial[name] = decibels_json(spectra->radial());
  }
  return {{"temporal_db", std::move(temporal)}, {"radial_db", std::move(radial)}};
}

void write_measures(const Json& measures, OutputFolder& output) {
  output.write("measures.json", [&](std::ostream& out) { out << json_text(measures); });
}

namespace {

std::string cell(const Json& holder, const char* key) {
  if (!holder.is_object() || !holder.contains(key) || !holder[key].is_number()) return "       -";
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%8.2f", holder[key].get<double>());
  return text.data();
}

std::string row(const std::string& name, const std::string& cells) {
  std::string out = "  " + name;
  out.resize(std::max<std::size_t>(out.size(), 30), ' ');
  return out + cells + "\n";
}

std::string prediction_table(const Json& prediction) {
  std::string out =
      "the next frame foretold, frames " + prediction["first_frame"].dump() + " to " +
      std::to_string(prediction["first_frame"].get<int>() + prediction["frames"].get<int>() - 1) +
      "   PSNR dB\n";
  for (const auto& [key, label] : {std::pair{"motion_model", "motion model"},
                                   {"linear_dynamic_texture", "linear dynamic texture"},
                                   {"frame_before", "the frame before"},
                                   {"mean_image", "the first half's mean image"},
                                   {"own_sketch", "(its own sketch, drawn)"}}) {
    const auto& methods = prediction["methods"];
    out += row(label, cell(methods.contains(key) ? methods[key] : Json(), "psnr"));
  }
  return out;
}

std::string distance_rows(const Json& distances) {
  std::string out;
  for (const auto& [key, label] : {std::pair{"motion_model", "motion model"},
                                   {"linear_dynamic_texture", "linear dynamic texture"},
                                   {"other", "the other clip"},
                                   {"noise_floor", "noise floor (its own halves)"}})
    if (distances.contains(key))
      out += row(label, cell(distances[key], "temporal_db") + "  " + cell(distances[key], "radial_db"));
  return out;
}

}  // namespace

std::string comparison_table(const Json& measures) {
  const std::string head = "distance of spectra, dB         in time  in space\n";
  if (measures.contains("prediction"))
    return prediction_table(measures["prediction"]) + "\n" + head + distance_rows(measures["synthesis"]);
  std::string out = head + distance_rows(measures["distances"]);
  const auto& psnr = measures["psnr"];
  return out + (psnr.is_null() ? "PSNR: none, " + measures["psnr_missing"].get<std::string>() + "\n"
                               : row("PSNR dB", cell(measures, "psnr")));
}

}  // namespace emberfold::apps
