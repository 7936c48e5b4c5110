// SPDX-License-Identifier: Apache-2.0
#include "graph/io/units.hpp"

#include <utility>

#include <nlohmann/json.hpp>

#include "graph/io/units_json.hpp"

namespace emberfold::graph {

double Units::time(int frame) const {
  const double step = seconds.value_or(1);
  const int known = static_cast<int>(times.size());
  if (known == 0) return origin.seconds + frame * step;
  if (frame < known) return times[static_cast<std::size_t>(frame)];
  return times.back() + (frame + 1 - known) * step;
}

double Units::span(int first, int last) const {
  return times.empty() ? (last - first) * seconds.value_or(1) : time(last) - time(first);
}

double Units::step(int first, int last) const {
  const double mean = last > first && !times.empty() ? span(first, last) / (last - first) : 0;
  return mean > 0 ? mean : seconds.value_or(1);
}

Point Units::place(Point position) const {
  return position + Point{origin.x, origin.y};
}

Units units_of(const core::ClipInfo& info) {
  Units units{{}, info.pixel_um, info.times, info.origin};
  if (info.fps_is_known) units.seconds = 1 / info.fps;
  return units;
}

std::vector<Event> moved(std::vector<Event> events, Point by) {
  for (Event& event : events) event.position = event.position + by;
  return events;
}

void add_units(nlohmann::ordered_json& clip, const Units& units) {
  if (!units.times.empty()) clip["times_s"] = units.times;
  const auto& [x, y, seconds, counted_from] = units.origin;
  if (!counted_from.empty())
    clip["counted_from"] = {{"origin", counted_from}, {"x", x}, {"y", y}, {"time_s", seconds}};
}

Units read_units(const nlohmann::json& clip) {
  Units units;
  if (clip.at("fps_is_known").get<bool>()) units.seconds = 1 / clip.at("fps").get<double>();
  if (clip.at("pixel_um").is_number()) units.um = clip.at("pixel_um").get<double>();
  if (clip.contains("times_s")) units.times = clip["times_s"].get<std::vector<double>>();
  if (clip.contains("counted_from")) {
    const auto& from = clip["counted_from"];
    units.origin = {from.at("x"), from.at("y"), from.at("time_s"), from.at("origin")};
  }
  return units;
}

}  // namespace emberfold::graph
