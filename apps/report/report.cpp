// SPDX-License-Identifier: Apache-2.0
#include "apps/report/report.hpp"

#include <algorithm>
#include <array>
#include <complex>
#include <string_view>

#include <nlohmann/json.hpp>

#include "apps/pictures/draw.hpp"
#include "apps/report/report_assets.hpp"
#include "apps/report/report_data.hpp"
#include "apps/report/report_network.hpp"

namespace emberfold::apps {

namespace {

using Json = nlohmann::ordered_json;

Json picture_json(int frame, const Still& still) {
  return {{"frame", frame}, {"width", still.width}, {"height", still.height}, {"uri", data_uri(still)}};
}

Json event_classes_json() {
  Json list = Json::array();
  for (const auto type : graph::all_event_types())
    list.push_back({{"name", graph::name(type)}, {"colour", hex(event_colour(type))}});
  return list;
}

// Returns the last part of a path, or the whole name if it is no path.
std::string title_of(std::string clip) {
  while (clip.size() > 1 && clip.back() == '/') clip.pop_back();
  const auto slash = clip.find_last_of('/');
  return slash == std::string::npos || slash + 1 == clip.size() ? clip : clip.substr(slash + 1);
}

}  // namespace

std::string fill_in(std::string_view page,
                    const std::vector<std::pair<std::string_view, std::string_view>>& values) {
  std::string out;
  while (true) {
    const auto open = page.find("{{");
    const auto close = open == std::string_view::npos ? open : page.find("}}", open);
    if (close == std::string_view::npos) return out.append(page);
    const auto name = page.substr(open + 2, close - open - 2);
    out.append(page.substr(0, open));
    for (const auto& [key, value] : values)
      if (key == name) out.append(value);
    page.remove_prefix(close + 2);
  }
}

std::string embed_json(const Json& value) {
  const std::string plain = value.dump(-1, ' ', false, Json::error_handler_t::replace);
  std::string out;
  out.reserve(plain.size());
  for (const char c : plain) {  // these occur only in strings, where the escape is equivalent
    if (c == '<')
      out += "\\u003c";
    else if (c == '>')
      out += "\\u003e";
    else if (c == '&')
      out += "\\u0026";
    else
      out += c;
  }
  return out;
}

std::string make_report(const ReportInput& input, const Json& summary) {
  const auto& motion = *input.motion;
  Json figures = summary;
  figures.erase("per_frame");  // report_series contains it, bounded
  Json data = {{"clip",
                {{"name", input.clip},
                 {"width", motion.sketch.width},
                 {"height", motion.sketch.height},
                 {"fps", motion.sketch.fps},
                 {"frames", motion.sketch.frames.size()}}},
               {"version", input.version},
               {"command", input.command_line},
               {"classes", event_classes_json()},
               {"summary", std::move(figures)},
               {"events", report_events(input.events)},
               {"series", report_series(motion, input.events)},
               {"network", report_network(motion)},
               {"strokes", report_stroke_paths(motion)},
               {"patches", report_patch_paths(motion)}};
  std::vector<int> numbers;
  for (const auto& shown : input.event_frames) numbers.push_back(shown.frame);
  const Json curves = report_curves(motion, numbers);
  data["frames"] = Json::array();
  for (std::size_t i = 0; i < input.event_frames.size(); ++i) {
    Json shown = picture_json(input.event_frames[i].frame, input.event_frames[i].still);
    shown["curves"] = curves[i];
    data["frames"].push_back(std::move(shown));
  }
  data["stills"] = Json::array();
  for (const auto& still : input.stills) {
    Json shown = picture_json(still.frame, still.input);
    shown["sketch"] = data_uri(still.sketch);
    shown["reconstruction"] = data_uri(still.reconstruction);
    shown["psnr"] = still.psnr;
    shown["share"] = still.share;
    data["stills"].push_back(std::move(shown));
  }
  if (input.trajectories)
    data["space_time"] = {{"uri", data_uri(*input.trajectories)},
                          {"width", input.trajectories->width},
                          {"height", input.trajectories->height}};
  data["matches"] = Json::array();
  for (const auto& match : input.matches) data["matches"].push_back(picture_json(match.frame, match.still));
  if (input.model != nullptr) data["learned"]["motion"] = report_motion_model(*input.model, input.events);
  if (!input.eigenvalues.empty()) {
    data["learned"]["eigenvalues"] = report_eigenvalues(input.eigenvalues);
    double radius = 0;
    for (const auto z : input.eigenvalues) radius = std::max(radius, std::abs(z));
    data["learned"]["texture_radius"] = radius;
  }
  if (input.clips) data["clips"] = report_clips(*input.clips);
  if (input.measures) data["measures"] = report_measures(*input.measures);
  if (input.sampled != nullptr) {
    data["sampler"] = report_sampler(*input.sampled, input.rates);
    data["sampler"]["probabilities"] = report_probabilities(input.all_events);
  }
  // The name may contain bytes that are not UTF-8; a pass through JSON replaces them.
  const auto title =
      Json::parse(Json(title_of(input.clip)).dump(-1, ' ', false, Json::error_handler_t::replace));
  return fill_in(kReportTemplate, {{"title", escape_html(title.get<std::string>())},
                                   {"style", kReportStyle},
                                   {"data", embed_json(data)},
                                   {"script", kReportScript}});
}

}  // namespace emberfold::apps
