// SPDX-License-Identifier: Apache-2.0
#include "apps/report/comparison_report.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <limits>
#include <map>
#include <optional>

#include <nlohmann/json.hpp>

#include "apps/comparison/comparison_json.hpp"
#include "apps/comparison/comparison_words.hpp"
#include "apps/pictures/curve_plot.hpp"
#include "apps/pictures/still.hpp"
#include "apps/report/report.hpp"
#include "apps/report/report_assets.hpp"
#include "pipeline/comparison/visible_measures.hpp"

namespace emberfold::apps {

using Json = nlohmann::ordered_json;

namespace {

constexpr const char* kComparisonStyle =
    "table.measures{border-collapse:collapse;width:100%}"
    ".measures th,.measures td{text-align:right;white-space:normal;padding:5px 10px;border-bottom:1px solid "
    "#8884}"
    ".measures th:first-child,.measures td:first-child{text-align:left}"
    ".measures .best{font-weight:700}.measures .floor{opacity:.65}"
    ".measures small{opacity:.65;display:block;font-weight:400}"
    ".plots{display:grid;grid-template-columns:repeat(auto-fit,minmax(min(420px,100%),1fr));gap:16px}"
    "figure{margin:0}figure img{width:100%}.plots img{border-radius:4px}"
    ".verdict{font-size:17px;font-weight:600;line-height:1.45}"
    "ul{padding-left:1.2em;overflow-wrap:anywhere}video{width:100%;background:#111;border-radius:4px}";

constexpr const char* kFilm =
    "<video src=\"side_by_side.mp4\" controls loop muted playsinline preload=\"metadata\" aria-label=\"All "
    "clips, in "
    "step\"></video>\n<p class=\"bar\"><a href=\"side_by_side.mp4\" download>the film</a> <a "
    "href=\"measures.json\" "
    "download>all measures</a> <a href=\"summary.json\" download>summary</a></p>\n";

std::string text_of(const Json& value, int digits) {
  if (!value.is_number()) return "–";
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.*f", digits, value.get<double>());
  return text.data();
}

std::string section(const std::string& title, const std::string& about, const std::string& body) {
  return "<section><div class=\"head\"><h2>" + title + "</h2><p>" + about + "</p></div>\n" + body +
         "</section>\n";
}

std::string figure(const cv::Mat& picture, const std::string& caption, std::size_t bytes, int longest) {
  const Still still = make_still(picture, longest, bytes);
  return "<figure><img alt=\"" + caption + "\" src=\"" + data_uri(still) + "\"><figcaption>" + caption +
         "</figcaption></figure>\n";
}

class Table {
 public:
  void head(const std::vector<std::string>& cells) {
    text_ += "<tr>";
    for (const auto& cell : cells) text_ += "<th>" + cell + "</th>";
    text_ += "</tr>\n";
  }
  /// `best`: index of the highlighted cell, `floor`: of one that does not compete; −1: none.
  void row(const std::string& name, const std::vector<std::string>& cells, int best = -1, int floor = -1) {
    text_ += "<tr><td>" + name + "</td>";
    for (int i = 0; i < static_cast<int>(cells.size()); ++i)
      text_ += std::string(i == best    ? "<td class=\"best\">"
                           : i == floor ? "<td class=\"floor\">"
                                        : "<td>") +
               cells[static_cast<std::size_t>(i)] + "</td>";
    text_ += "</tr>\n";
  }
  [[nodiscard]] std::string html() const {
    return "<div class=\"table-box\"><table class=\"measures\">" + text_ + "</table></div>\n";
  }

 private:
  std::string text_;
};

const Json& at(const Json& holder, std::initializer_list<std::string> path) {
  static const Json none = nullptr;
  const Json* here = &holder;
  for (const auto& key : path) {
    if (!here->is_object() || !here->contains(key)) return none;
    here = &(*here)[key];
  }
  return *here;
}

// Returns the index of the best competing value, −1 where there are fewer than two.
int best_of(const std::vector<std::optional<double>>& values, bool more_is_better) {
  int best = -1, count = 0;
  for (int i = 0; i < static_cast<int>(values.size()); ++i) {
    const auto& value = values[static_cast<std::size_t>(i)];
    if (!value) continue;
    ++count;
    const auto lead = best < 0 ? std::nullopt : values[static_cast<std::size_t>(best)];
    if (!lead || (more_is_better ? *value > *lead : *value < *lead)) best = i;
  }
  return count > 1 ? best : -1;
}

constexpr const char* sizes_name = "Size<small>how many numbers it takes to draw from the model</small>";

std::vector<std::string> size_cells(const Json& measures, const std::vector<DistanceColumn>& columns) {
  std::vector<std::string> cells;
  for (const auto& one : columns) {
    cells.emplace_back("–");
    for (const auto& model : measures["models"])
      if (model["key"] == one.key) cells.back() = text_of(model["parameters"], 0);
  }
  return cells;
}

std::string source_of(const Json& measures) {
  return measures.contains("other") ? "the first clip" : "the source";
}

std::string distances_table(const Json& measures) {
  Table table;
  const auto columns = distance_columns(measures);
  std::vector<std::string> head{"how far from " + source_of(measures)};
  for (const auto& one : columns) head.push_back(escape_html(one.label));
  table.head(head);
  for (const auto& measure : all_measures()) {
    std::vector<std::string> cells;
    std::vector<std::optional<double>> values;
    int floor = -1;
    for (const auto& one : columns) {
      const auto& value = at(distances_of(measures, one.key), {measure.key});
      const bool is_floor = one.key == "noise_floor";
      if (is_floor) floor = static_cast<int>(cells.size());
      cells.push_back(text_of(value, 3));
      values.push_back(value.is_number() && !is_floor ? std::optional(value.get<double>()) : std::nullopt);
    }
    if (std::ranges::none_of(values, [](const auto& value) { return value.has_value(); })) continue;
    const std::string unit = measure.unit;
    table.row(std::string(measure.name) + (unit.empty() ? "" : ", " + unit) + "<small>" + measure.about +
                  "</small>",
              cells, best_of(values, false), floor);
  }
  if (measures.contains("models")) table.row(sizes_name, size_cells(measures, columns));
  return table.html();
}

// Returns the table of the clips' visible differences.
std::string visible_table(const Json& measures) {
  std::vector<DistanceColumn> columns = distance_columns(measures);
  std::erase_if(columns,
                [&](const auto& one) { return !distances_of(measures, one.key).contains("visible"); });
  if (columns.empty()) return {};
  Table table;
  std::vector<std::string> head{"beside " + source_of(measures)};
  for (const auto& one : columns) head.push_back(escape_html(one.label));
  table.head(head);
  for (const auto& measure : pipeline::visible_measures()) {
    std::vector<std::string> cells;
    for (const auto& one : columns)
      cells.push_back(text_of(at(distances_of(measures, one.key), {"visible", measure.key}), 2));
    table.row(std::string(measure.name) + "<small>" + measure.about + "</small>", cells);
  }
  return table.html();
}

// Highlights a cell that is the best of its column.
std::string prediction_cell(const Json& method, const Json& methods, std::size_t step) {
  const auto& own = method["by_step"]["psnr"][step];
  const auto better = [&](const Json& other) {
    const auto& value = other["by_step"]["psnr"][step];
    return own.is_number() && value.is_number() && value > own;
  };
  const auto text = text_of(own, 2) + " (" + text_of(method["by_step"]["ssim"][step], 3) + ")";
  return !own.is_number() || std::ranges::any_of(methods, better) ? text : "<b>" + text + "</b>";
}

std::string prediction_tables(const Json& measures) {
  const auto& prediction = measures["prediction"];
  std::map<std::string, std::string> labels{{"frame_before", "the frame before, shown again"},
                                            {"mean_image", "the mean image of the first part"}};
  for (const auto& model : measures["models"])
    labels[model["key"].get<std::string>()] = model["label"].get<std::string>();
  std::vector<std::string> head{"PSNR, dB (SSIM)"};
  for (const auto& step : prediction["steps"])
    head.push_back(step == 1 ? "next frame" : step.dump() + " frames on");
  head.emplace_back("the frame itself");
  Table table;
  table.head(head);
  for (const auto& [key, method] : prediction["methods"].items()) {
    std::vector<std::string> cells;
    for (std::size_t s = 0; s < prediction["steps"].size(); ++s)
      cells.push_back(prediction_cell(method, prediction["methods"], s));
    const auto& own = at(measures, {"reconstruction", key});
    cells.push_back(own.is_null() ? "–" : text_of(own["psnr"], 2) + " (" + text_of(own["ssim"], 3) + ")");
    table.row(labels[key], cells);
  }
  return table.html();
}

std::string interval(const Json& value, const char* mean, int digits) {
  if (!value.is_object()) return "–";
  return text_of(value[mean], digits) + "<small>" + text_of(value["low"], digits) + " to " +
         text_of(value["high"], digits) + "</small>";
}

std::string strokes_table(const Json& measures) {
  const auto& source = at(distances_of(measures, "source"), {"strokes"});
  if (source.is_null()) return {};
  std::vector<std::string> head{"mean (95 % interval)", source_of(measures)};
  std::vector<const Json*> clips{&source}, inside{nullptr};
  for (const auto& one : distance_columns(measures)) {
    const auto& distances = distances_of(measures, one.key);
    if (!distances.contains("strokes")) continue;
    head.push_back(escape_html(one.label));
    clips.push_back(&distances["strokes"]), inside.push_back(&distances["inside"]);
  }
  Table table;
  table.head(head);
  const auto add = [&](const std::string& name, const std::string& key, const auto& cell) {
    std::vector<std::string> cells;
    for (std::size_t i = 0; i < clips.size(); ++i) {
      const bool within = inside[i] != nullptr && at(*inside[i], {key}) == true;
      cells.push_back((within ? "✓ " : "") + cell(*clips[i]));
    }
    table.row(name, cells);
  };
  for (const auto& [name, value] : source["events"].items())
    add(name + "s a frame", name,
        [&, key = name](const Json& clip) { return interval(clip["events"][key], "a_frame", 3); });
  for (const char* key : {"lifetime", "length"})
    add(std::string(key) == "lifetime" ? "lifetime, frames" : "length, px", key,
        [key](const Json& clip) { return interval(clip[key], "mean", 1); });
  table.row("strokes a frame", [&] {
    std::vector<std::string> cells;
    for (const auto* clip : clips) cells.push_back(text_of((*clip)["strokes_a_frame"], 1));
    return cells;
  }());
  return table.html();
}

// Returns the colour of a model, equal in every plot; parts of the source have the source's.
int colour_of(const Json& measures, const std::string& name) {
  if (name == "other") return 1;
  int colour = 1;
  for (const auto& model : measures.value("models", Json::array())) {
    if (model["key"] == name) return colour;
    ++colour;
  }
  return name == "mean_image" ? 5 : 0;
}

std::string plot(const Json& measures, const char* what, const char* x, CurvePlot look) {
  const auto& holder = at(measures, {"curves", what});
  if (holder.is_null()) return {};
  const auto axis = holder[x].get<std::vector<double>>();
  for (const auto& [name, values] : holder.items()) {
    if (name == x) continue;
    std::string label = name == "other" ? "the other clip" : name == "source" ? source_of(measures) : name;
    for (const auto& model : measures.value("models", Json::array()))
      if (model["key"] == name) label = model["label"].get<std::string>();
    look.curves.push_back({label, axis, values.get<std::vector<double>>(), false, colour_of(measures, name)});
  }
  return figure(draw_curves(look), look.title, 120'000, 900);
}

std::string prediction_plot(const Json& measures) {
  CurvePlot look{"Prediction", "frames ahead", "PSNR, dB", {}, false, false};
  const auto& prediction = measures["prediction"];
  const auto steps = prediction["steps"].get<std::vector<double>>();
  for (const auto& [key, method] : prediction["methods"].items()) {
    Curve curve{key, steps, {}, true, colour_of(measures, key)};
    for (const auto& model : measures["models"])
      if (model["key"] == key) curve.name = model["label"].get<std::string>();
    if (key == "frame_before") curve.name = "the frame before";
    if (key == "mean_image") curve.name = "the mean image";
    for (const auto& value : method["by_step"]["psnr"])
      curve.y.push_back(value.is_number() ? value.get<double>() : std::numeric_limits<double>::quiet_NaN());
    look.curves.push_back(std::move(curve));
  }
  return figure(draw_curves(look), look.title, 120'000, 900);
}

std::string file_name(const Json& clip) {
  const std::filesystem::path path(clip["name"].get<std::string>());
  return path.has_filename() ? path.filename().string() : path.parent_path().filename().string();
}

std::string list_of(const Json& sentences, std::size_t first = 0) {
  std::string list = "<ul>";
  for (std::size_t i = first; i < sentences.size(); ++i)
    list += "<li>" + escape_html(sentences[i].get<std::string>()) + "</li>\n";
  return list + "</ul>\n";
}

}  // namespace

std::string make_comparison_report(const Comparison& comparison, const Json& summary) {
  const auto& measures = comparison.measures;
  const auto name = escape_html(file_name(measures["clip"]) +
                                (measures.contains("other") ? " and " + file_name(measures["other"]) : ""));
  std::string page =
      "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<title>Comparison of " +
      name + "</title>\n<style>" + std::string(kReportStyle) + kComparisonStyle +
      "</style></head>\n<body><header><p class=\"brand\">emberfold <span>compare</span></p>\n<h1>" + name +
      "</h1>\n<p class=\"meta\"><code>" + escape_html(summary.value("command_line", "")) +
      "</code></p></header>\n<main>\n";
  const bool pair = measures.contains("other");
  const auto& words = measures["words"];
  const bool seen = !comparison.sheet.empty() && !words.empty();  // the first sentence is then the verdict
  if (seen)
    page += section("<span class=\"verdict\">" + escape_html(words[0].get<std::string>()) + "</span>",
                    "A row for each clip, from its beginning to its end: contact_sheet.png.",
                    figure(comparison.sheet, "contact sheet", 900'000, 2400) + visible_table(measures));
  page += section("What the measures say", "", list_of(words, seen ? 1 : 0));
  if (!measures["warnings"].empty()) page += section("Warnings", "", list_of(measures["warnings"]));
  std::string pictures;
  for (const auto& [frame, picture] : comparison.pictures)
    pictures += figure(picture, "frame " + std::to_string(frame) + " of each clip", 900'000, 2400);
  pictures = kFilm + pictures;
  page += section(
      "Side by side",
      std::string(
          pair ? ""
               : "Clips drawn from a model are new ones: they look like the source as far as the model "
                 "goes, and do not follow it. ") +
          "The film plays where the report lies in its folder, beside side_by_side.mp4.",
      pictures);
  page += section("Distances",
                  "0 is no difference. The noise floor is how far the first and the second half of " +
                      source_of(measures) + " lie apart" +
                      (pair ? "." : ": no model can be asked for less. The nearest is in bold."),
                  distances_table(measures));
  if (const auto strokes = strokes_table(measures); !strokes.empty())
    page += section("Strokes",
                    "Every clip is sketched and its strokes are followed in the same way. ✓: the mean lies "
                    "in the 95 % interval of " +
                        source_of(measures) + ".",
                    strokes);
  const bool predicted = at(measures, {"prediction"}).is_object();
  if (predicted)
    page += section(
        "Prediction",
        "Frames that no model has learned from, predicted from those before them; the best is in bold. The "
        "last column: how well a model shows a frame that it is given.",
        prediction_tables(measures));
  page += section(
      "Curves", "",
      "<div class=\"plots\">" +
          plot(measures, "temporal_db", "frequency",
               {"Spectrum in time", "cycles a frame", "power, dB", {}}) +
          plot(measures, "radial_db", "frequency", {"Spectrum in space", "cycles a pixel", "power, dB", {}}) +
          plot(measures, "autocorrelation", "lag", {"Autocorrelation", "frames apart", "correlation", {}}) +
          (predicted ? prediction_plot(measures) : "") + "</div>");
  page +=
      "<section><div class=\"head\"><h2>All figures</h2></div><details><summary>summary.json</summary><pre "
      "style=\"overflow:auto\">" +
      escape_html(summary.dump(1, ' ', false, Json::error_handler_t::replace)) +
      "</pre></details></section>\n";
  return page + "</main></body></html>\n";
}

}  // namespace emberfold::apps
