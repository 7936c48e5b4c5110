// SPDX-License-Identifier: Apache-2.0
#include "apps/report/quilt_report.hpp"

#include <nlohmann/json.hpp>

#include "apps/pictures/still.hpp"
#include "apps/report/report.hpp"
#include "apps/report/report_assets.hpp"
#include "core/text/format_number.hpp"

namespace emberfold::apps {

namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kQuiltStyle =
    ".pair{display:grid;grid-template-columns:1fr 2fr;gap:16px;margin-bottom:16px}"
    ".halves{display:grid;grid-template-columns:1fr 1fr;gap:16px}.verdict{font-size:18px;font-weight:620}"
    "@media (max-width:600px){.pair,.halves{grid-template-columns:1fr}}";

std::string tile_html(const std::string& name, const std::string& value, const std::string& more) {
  return "<div><dt>" + name + "</dt><dd>" + value + "</dd><dd class=\"sub\">" + more + "</dd></div>\n";
}

std::string figure_html(const cv::Mat& picture, const std::string& caption, std::size_t bytes) {
  const Still still = make_still(picture, 1024, bytes);
  return "<figure style=\"margin:0\"><img style=\"width:100%\" alt=\"" + caption + "\" src=\"" +
         data_uri(still) + "\"><figcaption>" + caption + "</figcaption></figure>\n";
}

std::string side_by_side_html(const std::string& left, const std::string& right) {
  return "<div class=\"pair\">" + left + right + "</div>\n";
}

/// Returns the opening sentence: whether the quilt visibly differs from its source.
std::string verdict(const Json& quilt) {
  const double seams = quilt.value("seam_ratio", 0.0), piece = quilt.value("largest_piece", 0.0),
               shown = quilt.value("source_share", 0.0);
  constexpr double kUnseen = 1.3, kSeen = 2.5, kLarge = 0.25, kLittle = 0.5;
  std::string text = seams < kUnseen ? "Seams hardly show"
                     : seams < kSeen ? "Seams show where one looks for them"
                                     : "Seams show";
  text += ": levels step " + core::fixed_text(seams, 1) + " times as much across them as elsewhere.";
  if (piece > kLarge)
    text += " A piece of " + core::fixed_text(100 * piece, 0) +
            " % of the output is the source as it is; smaller blocks vary more.";
  if (shown < kLittle)
    text += " Only " + core::fixed_text(100 * shown, 0) + " % of the source is shown, so things repeat.";
  return text;
}

std::string tiles_html(const Json& quilt) {
  std::string out = "<dl class=\"tiles\">\n";
  const auto percent = [&](const char* field) {
    return core::fixed_text(100 * quilt.value(field, 0.0), 1) + " %";
  };
  if (quilt.contains("columns"))
    out += tile_html("Blocks", std::to_string(quilt["blocks"].get<long>()),
                     std::to_string(quilt["columns"].get<int>()) + " across, " +
                         std::to_string(quilt["rows"].get<int>()) + " down") +
           tile_html("Verbatim blocks", percent("verbatim_blocks"), "only go on where a neighbour ends");
  else if (quilt.contains("blocks"))
    out += tile_html("Blocks", std::to_string(quilt["blocks"].get<long>()), "over the surface") +
           tile_html("Border gradient ratio", core::fixed_text(quilt.value("border_ratio", 0.0), 3),
                     "steps from chart to chart of the surface over steps elsewhere");
  if (quilt.contains("blocks"))
    out += tile_html("Compared exactly", core::fixed_text(quilt.value("compared_mean", 0.0), 0),
                     "places a block, on average; " + core::fixed_text(quilt.value("equals_mean", 0.0), 0) +
                         " of them equally good");
  out += tile_html("Seam gradient ratio", core::fixed_text(quilt.value("seam_ratio", 0.0), 3),
                   "steps across seams over steps elsewhere") +
         (quilt.contains("change_ratio")
              ? tile_html("Flicker ratio", core::fixed_text(quilt.value("change_ratio", 0.0), 3),
                          "steps in time where seams pass over steps elsewhere")
              : std::string()) +
         (quilt.contains("largest_piece")
              ? tile_html("Largest piece", percent("largest_piece"), "of the output, copied as it is")
              : std::string()) +
         tile_html("Source shown", percent("source_share"), "of its pixels");
  return out + "</dl>\n";
}

}  // namespace

std::string make_quilt_report(const std::string& clip, const QuiltPictures& pictures, const Json& summary) {
  constexpr std::size_t kPicture = 700'000;
  std::string page =
      "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<title>Quilt of " +
      escape_html(clip) + "</title>\n<style>";
  page += kReportStyle;
  page += kQuiltStyle;
  page += "</style></head>\n<body><header><p class=\"brand\">emberfold <span>quilt</span></p>\n<h1>" +
          escape_html(clip) + "</h1>\n<p class=\"meta\"><code>" +
          escape_html(summary.value("command_line", "")) + "</code></p></header>\n<main>\n";
  page += "<section><p class=\"verdict\">" + verdict(summary["quilt"]) +
          "</p>\n<p class=\"bar\"><a href=\"map.npy\" download>the map</a> <a href=\"map.png\" download>its "
          "picture</a> "
          "<a href=\"seams.png\" download>the seams</a> <a href=\"summary.json\" download>all "
          "figures</a></p></section>\n";
  page += tiles_html(summary["quilt"]);
  page +=
      "<section><div class=\"head\"><h2>Source and quilt</h2><p>The same moments; what seams join "
      "is copied as it is.</p></div>\n";
  for (const auto& pair : pictures.pairs)
    page += side_by_side_html(
        figure_html(pair.source, "source, frame " + std::to_string(pair.frame), kPicture / 3),
        figure_html(pair.quilt, "quilt, frame " + std::to_string(pair.frame), kPicture));
  page +=
      "</section>\n<section><div class=\"head\"><h2>Where pixels come from</h2><p>Hue: place across the "
      "source; "
      "lightness: place down, in the middle frame. Even slopes are copied as they are. " +
      std::string(summary["quilt"].contains("change_ratio") ? "Seams move with time."
                                                            : "Seams are the same in every frame.") +
      "</p></div>\n"
      "<div class=\"halves\">" +
      figure_html(pictures.map, "map", kPicture) + figure_html(pictures.seams, "seams", kPicture) +
      "</div></section>\n";
  page += "<section><div class=\"head\"><h2>All figures</h2></div><pre style=\"overflow:auto\">" +
          escape_html(summary.dump(1, ' ', false, Json::error_handler_t::replace)) + "</pre></section>\n";
  return page + "</main></body></html>\n";
}

}  // namespace emberfold::apps
