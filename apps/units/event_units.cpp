// SPDX-License-Identifier: Apache-2.0
#include "apps/units/event_units.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>
#include <string>

#include "core/math/event_rates.hpp"
#include "core/text/format_number.hpp"

namespace emberfold::apps {

using Json = nlohmann::ordered_json;

namespace {

constexpr double kLevel = 0.9;

Json number_json(double value) {
  constexpr int kDigits = 6;
  return std::isfinite(value) ? Json(core::round_significant(value, kDigits)) : Json(nullptr);
}

Json interval_json(const core::Interval& interval) {
  return {{"mean", number_json(interval.mean)},
          {"low", number_json(interval.low)},
          {"high", number_json(interval.high)}};
}

/// Returns the total length of all strokes in all frames but the first, each times the time since the
/// previous frame, px s.
double stroke_length(const graph::MotionGraph& motion, const graph::Units& units) {
  double sum = 0;
  for (std::size_t t = 1; t < motion.sketch.frames.size(); ++t)
    sum += graph::seen_length(motion.sketch.frames[t]) *
           units.span(static_cast<int>(t) - 1, static_cast<int>(t));
  return sum;
}

/// Adds the median, and the values below and above which 5 % lie.
void add_spread(Json& out, std::vector<double> values, const std::string& suffix) {
  std::ranges::sort(values);
  const auto at = [&](double share) {
    const double place = share * static_cast<double>(values.size() - 1);
    const auto low = static_cast<std::size_t>(place), high = std::min(low + 1, values.size() - 1);
    return std::lerp(values[low], values[high], place - std::floor(place));
  };
  out["median" + suffix] = number_json(at(0.5));
  out["low" + suffix] = number_json(at((1 - kLevel) / 2));
  out["high" + suffix] = number_json(at((1 + kLevel) / 2));
}

/// Returns the spread of values, and of the same in physical units where these are known.
Json spread_json(const std::vector<double>& values, const char* unit, const std::vector<double>& in_world,
                 const std::string& suffix) {
  if (values.empty()) return nullptr;
  Json out = {{"unit", unit}, {"strokes", values.size()}};
  add_spread(out, values, "");
  if (!in_world.empty()) add_spread(out, in_world, suffix);
  return out;
}

}  // namespace

Json event_rates_json(const std::vector<graph::Event>& events, const graph::MotionGraph& motion,
                      const graph::Units& units, double share) {
  constexpr double kUmInMm = 1000;
  const auto& sketch = motion.sketch;
  const auto frames = static_cast<double>(std::max<std::size_t>(2, sketch.frames.size()) - 1);
  std::optional<double> seconds, area, length;
  if (units.seconds) seconds = units.span(0, static_cast<int>(frames));
  if (seconds && units.um) {
    const double mm = *units.um / kUmInMm;
    area = *seconds * sketch.width * sketch.height * share * mm * mm;
    length = stroke_length(motion, units) * mm;
  }
  const auto rates = [&](double count) {
    const auto rate = [&](const std::optional<double>& exposure) {
      return exposure && *exposure > 0 ? interval_json(core::event_rate(count, *exposure, kLevel))
                                       : Json(nullptr);
    };
    return Json{{"count", count},
                {"a_frame", rate(frames)},
                {"a_second", rate(seconds)},
                {"a_second_and_mm2", rate(area)},
                {"a_second_and_mm_of_stroke", rate(length)}};
  };
  Json classes = Json::object();
  for (const auto type : graph::all_event_types())
    classes[std::string(graph::name(type))] =
        rates(static_cast<double>(std::ranges::count(events, type, &graph::Event::type)));
  classes["all"] = rates(static_cast<double>(events.size()));
  const auto exposure = [](const std::optional<double>& value) {
    return value ? number_json(*value) : Json(nullptr);
  };
  return {
      {"level", kLevel},
      {"counted_in",
       {{"frames", frames}, {"s", exposure(seconds)}, {"s_mm2", exposure(area)}, {"s_mm", exposure(length)}}},
      {"classes", std::move(classes)}};
}

Json lives_json(const std::vector<graph::StrokeLife>& lives, const graph::Units& units) {
  std::vector<double> life, length, growth, speed, life_s, length_um, growth_um_s, speed_um_s;
  for (const auto& one : lives) {
    if (one.whole) life.push_back(one.frames());
    if (one.whole && units.seconds) life_s.push_back(units.span(one.first, one.last + 1));
    length.push_back(one.length);
    if (units.um) length_um.push_back(one.length * *units.um);
    if (one.frames() == 1) continue;
    growth.push_back(one.growth), speed.push_back(one.speed);
    if (!units.um || !units.seconds) continue;
    const double both = *units.um / units.step(one.first, one.last);
    growth_um_s.push_back(one.growth * both), speed_um_s.push_back(one.speed * both);
  }
  return {{"level", kLevel},
          {"life", spread_json(life, "frames", life_s, "_s")},
          {"length", spread_json(length, "px", length_um, "_um")},
          {"growth", spread_json(growth, "px a frame", growth_um_s, "_um_s")},
          {"speed", spread_json(speed, "px a frame", speed_um_s, "_um_s")}};
}

Json rate_tests_json(const std::vector<double>& counts_a, double exposure_a,
                     const std::vector<double>& counts_b, double exposure_b) {
  const auto test = [&](double a, double b) {
    const auto found = core::compare_rates(a, exposure_a, b, exposure_b, kLevel);
    return Json{{"ratio", number_json(found.ratio.mean)},
                {"low", number_json(found.ratio.low)},
                {"high", number_json(found.ratio.high)},
                {"p", number_json(found.p)},
                {"counts", {a, b}}};
  };
  Json classes = Json::object();
  for (const auto type : graph::all_event_types()) {
    const auto i = static_cast<std::size_t>(type);
    classes[std::string(graph::name(type))] = test(counts_a[i], counts_b[i]);
  }
  classes["all"] = test(std::accumulate(counts_a.begin(), counts_a.end(), 0.),
                        std::accumulate(counts_b.begin(), counts_b.end(), 0.));
  return {{"level", kLevel}, {"classes", std::move(classes)}};
}

}  // namespace emberfold::apps
