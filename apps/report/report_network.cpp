// SPDX-License-Identifier: Apache-2.0
#include "apps/report/report_network.hpp"

#include <array>
#include <cmath>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "apps/report/report_data.hpp"
#include "graph/network/network_figures.hpp"

namespace emberfold::apps {

namespace {

using Json = nlohmann::ordered_json;

struct Totals {
  int tips = 0, branches = 0, components = 0, loops = 0;
  bool operator==(const Totals&) const = default;
  void add(const Totals& other, int sign) {
    tips += sign * other.tips, branches += sign * other.branches;
    components += sign * other.components, loops += sign * other.loops;
  }
};

Totals totals_of(const graph::NetworkFigures& f) {
  return {static_cast<int>(f.tips + 2 * f.points), static_cast<int>(f.branches),
          static_cast<int>(f.components), static_cast<int>(f.loops)};
}
Totals totals_of(const graph::TopologyChange& c) {
  return {c.tips, c.branches, c.components, c.loops};
}
Json totals_json(const Totals& totals) {
  return {{"tips", totals.tips},
          {"branches", totals.branches},
          {"components", totals.components},
          {"loops", totals.loops}};
}

}  // namespace

Json balance_json(const graph::MotionGraph& motion, std::span<const graph::TopologyChange> changes) {
  const auto& frames = motion.sketch.frames;
  std::vector<Totals> said(frames.size());
  Json kinds = Json::object();
  for (std::size_t c = 0; c <= static_cast<std::size_t>(graph::Change::t1); ++c) {
    const auto kind = static_cast<graph::Change>(c);
    Totals sums;
    int count = 0;
    for (const graph::TopologyChange& change : changes)
      if (change.change == kind) ++count, sums.add(totals_of(change), 1);
    Json row = {{"count", count}};
    row.update(totals_json(sums));
    kinds[std::string(graph::name(kind))] = std::move(row);
  }
  for (const graph::TopologyChange& change : changes)
    said[static_cast<std::size_t>(change.frame)].add(totals_of(change), 1);
  Totals all_said, all_measured, before;
  int balanced = 0;
  for (std::size_t t = 0; t < frames.size(); ++t) {
    const Totals now = totals_of(graph::network_figures(frames[t]));
    if (t > 0) {
      Totals measured = now;
      measured.add(before, -1);
      balanced += measured == said[t] ? 1 : 0;
      all_said.add(said[t], 1), all_measured.add(measured, 1);
    }
    before = now;
  }
  return {{"gaps", frames.empty() ? 0 : frames.size() - 1},
          {"balanced", balanced},
          {"changes", std::move(kinds)},
          {"said", totals_json(all_said)},
          {"measured", totals_json(all_measured)}};
}

Json report_network(const graph::MotionGraph& motion) {
  constexpr std::array<const char*, 5> kNames{"length", "tips", "junctions", "loops", "components"};
  const auto& frames = motion.sketch.frames;
  const std::size_t step = frames.size() / kSeries + 1;
  Json out = {{"step", step}};
  for (const char* name : kNames) out[name] = Json::array();
  std::array<double, kNames.size()> sums{};
  std::size_t count = 0;
  for (std::size_t t = 0; t < frames.size(); ++t) {
    const auto f = graph::network_figures(frames[t]);
    const std::array<double, kNames.size()> values{
        f.length, static_cast<double>(f.tips),
        static_cast<double>(f.junctions_3 + f.junctions_4 + f.junctions_more), static_cast<double>(f.loops),
        static_cast<double>(f.components)};
    for (std::size_t k = 0; k < values.size(); ++k) sums[k] += values[k];
    if (++count < step && t + 1 < frames.size()) continue;
    for (std::size_t k = 0; k < values.size(); ++k)
      out[kNames[k]].push_back(std::round(sums[k] / static_cast<double>(count) * 100) / 100);
    sums = {}, count = 0;
  }
  return out;
}

}  // namespace emberfold::apps
