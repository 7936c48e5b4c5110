// SPDX-License-Identifier: Apache-2.0
#include "apps/comparison/comparison_table.hpp"

#include <algorithm>
#include <array>
#include <cstdio>
#include <vector>

#include "apps/comparison/comparison_json.hpp"
#include "pipeline/comparison/visible_measures.hpp"

namespace emberfold::apps {

using Json = nlohmann::ordered_json;

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

// Returns a label in words that fit above a column of numbers.
std::string heading(const std::string& label) {
  constexpr std::size_t kWidth = 13;
  std::string text = label == "linear dynamic texture" ? "dyn. texture"
                     : label == "clip's footage"       ? "footage"
                     : label == "clip's strokes"       ? "strokes"
                     : label == "the other clip"       ? "other clip"
                     : label == "video-texture loop"   ? "loop"
                                                       : label;
  if (text.size() > kWidth - 1) text = text.substr(0, kWidth - 1);
  return std::string(kWidth - text.size(), ' ') + text;
}

std::string prediction_table(const Json& measures) {
  const auto& prediction = measures["prediction"];
  std::string head = "from " + std::to_string(prediction["moments"].get<int>()) + " moments, more is better";
  head.resize(std::max<std::size_t>(head.size() + 2, 32), ' ');
  for (const auto& step : prediction["steps"])
    head += heading((step == 1 ? "next, dB" : "+" + step.dump() + ", dB"));
  std::string out = head + heading("next, SSIM") + heading("itself, dB") + "\n";
  std::vector<DistanceColumn> methods = distance_columns(measures);
  std::erase_if(methods, [](const DistanceColumn& one) { return one.key == "noise_floor"; });
  methods.push_back({"frame_before", "the frame before"});
  methods.push_back({"mean_image", "the first part's mean image"});
  for (const auto& [key, label] : methods) {
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

namespace {

/// Returns the table of tests whether events are equally frequent in both clips.
std::string rate_table(const Json& measures) {
  if (!measures.contains("rate_tests")) return {};
  const Json& tests = measures["rate_tests"];
  std::string head = "events a " + tests["per"].get<std::string>() + ", other to first";
  head.resize(32, ' ');
  std::string out = "\n" + head;
  for (const char* name : {"first", "other", "ratio", "90 % from", "to", "p"}) out += heading(name);
  out += "\n";
  for (const auto& [name, test] : tests["classes"].items()) {
    std::string cells = "  ";
    for (std::size_t i = 0; i < 2; ++i) cells += cell({{"x", test["counts"][i]}}, "x", 0);
    for (const char* key : {"ratio", "low", "high", "p"}) cells += cell(test, key, 3);
    out += row(name, cells);
  }
  return out;
}

/// Returns the table of the clips' visible differences.
std::string visible_table(const Json& measures, const std::vector<DistanceColumn>& columns) {
  std::string rows;
  for (const auto& measure : pipeline::visible_measures()) {
    std::string cells = "  ";
    for (const auto& one : columns) {
      const auto& distances = distances_of(measures, one.key);
      cells += cell(distances.contains("visible") ? distances["visible"] : Json(nullptr), measure.key, 2);
    }
    if (cells.find_first_of("0123456789") != std::string::npos)
      rows +=
          row(std::string(measure.name) + (measure.key == std::string("copied") ? ", 0 is best" : ""), cells);
  }
  if (rows.empty()) return {};
  std::string head = "to the eye, 1 is best";
  head.resize(32, ' ');
  for (const auto& one : columns) head += heading(one.label);
  return head + "\n" + rows + "\n";
}

}  // namespace

std::string comparison_table(const Json& measures) {
  std::string out;
  if (measures.contains("prediction") && !measures["prediction"].is_null()) out += prediction_table(measures);
  const auto columns = distance_columns(measures);
  out = visible_table(measures, columns) + out;
  std::string head = "from the source, less is nearer";
  head.resize(32, ' ');
  for (const auto& one : columns) head += heading(one.label);
  out += head + "\n";
  for (const auto& measure : all_measures()) {
    std::string cells = "  ";
    for (const auto& one : columns) cells += cell(distances_of(measures, one.key), measure.key, 3);
    const std::string unit = measure.unit;
    if (cells.find_first_of("0123456789") != std::string::npos)
      out += row(measure.name + (unit.empty() ? "" : ", " + unit), cells);
  }
  if (!measures.contains("psnr")) return out;
  if (measures["psnr"].is_null())
    return out + "PSNR: none, " + measures["psnr_missing"].get<std::string>() + "\n" + rate_table(measures);
  return out + row("PSNR, dB", "  " + cell(measures, "psnr", 2)) +
         row("SSIM", "  " + cell(measures, "ssim", 3)) + rate_table(measures);
}

}  // namespace emberfold::apps
