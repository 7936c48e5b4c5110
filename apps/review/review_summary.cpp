// SPDX-License-Identifier: Apache-2.0
#include "apps/review/review_summary.hpp"

#include <string>

#include <nlohmann/json.hpp>

#include "core/text/format_number.hpp"

namespace emberfold::apps {

namespace {

using Json = nlohmann::ordered_json;

Json interval_json(const core::Interval& interval, double exposure) {
  constexpr int kDigits = 6;
  const auto rounded = [&](double value) { return core::round_significant(value / exposure, kDigits); };
  return {{"mean", rounded(interval.mean)}, {"low", rounded(interval.low)}, {"high", rounded(interval.high)}};
}

}  // namespace

Json review_json(const pipeline::ReviewedClip& reviewed, const graph::Units& units) {
  Json classes = Json::object();
  for (std::size_t c = 0; c < reviewed.counts.size(); ++c) {
    const auto types = graph::all_event_types();
    const std::string name = c < types.size() ? std::string(graph::name(types[c])) : "all";
    classes[name] = {{"count", interval_json(reviewed.counts[c], 1)},
                     {"a_frame", interval_json(reviewed.rates[c], 1)},
                     {"a_second", units.seconds ? interval_json(reviewed.rates[c], *units.seconds) : Json()}};
  }
  const auto pair = [](const std::array<double, 2>& values) {
    return Json{{"strokes", core::round_to(values[0], 4)}, {"joints", core::round_to(values[1], 4)}};
  };
  return {{"yes", reviewed.yes},
          {"no", reviewed.no},
          {"other", reviewed.other},
          {"added", reviewed.added},
          {"unmatched", reviewed.unmatched},
          {"shift", pair(reviewed.shift)},
          {"slope", pair(reviewed.slope)},
          {"level", 0.9},
          {"classes", std::move(classes)}};
}

}  // namespace emberfold::apps
