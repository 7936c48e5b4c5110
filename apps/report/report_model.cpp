// SPDX-License-Identifier: Apache-2.0
#include "apps/report/report_model.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <nlohmann/json.hpp>

#include "apps/pictures/still.hpp"
#include "core/text/format_number.hpp"
#include "graph/attribute_graph.hpp"

namespace emberfold::apps {

namespace {

using Json = nlohmann::ordered_json;
constexpr std::size_t kCells = 4000, kExemplars = 24, kExemplarPoints = 3000, kEigenvalues = 500;

// Rounds to four digits, which is more than a page shows.
double round_for_page(double value) {
  return core::round_significant(value, 4);
}

Json numbers_json(std::span<const double> values) {
  Json out = Json::array();
  for (const double value : values) out.push_back(round_for_page(value));
  return out;
}

// Replaces blocks of cells by their mean until at most kCells remain.
mcmc::CellMap pool_cells(const mcmc::CellMap& map) {
  const std::size_t cells = map.values.size();
  int block = 1;
  while (cells > kCells * static_cast<std::size_t>(block) * static_cast<std::size_t>(block)) ++block;
  if (block == 1) return map;
  mcmc::CellMap out{map.cell * block, (map.columns + block - 1) / block, (map.rows + block - 1) / block, {}};
  for (int y = 0; y < map.rows; y += block)
    for (int x = 0; x < map.columns; x += block) {
      double sum = 0;
      int count = 0;
      for (int v = y; v < std::min(map.rows, y + block); ++v)
        for (int u = x; u < std::min(map.columns, x + block); ++u, ++count)
          sum += map.values[static_cast<std::size_t>(v) * static_cast<std::size_t>(map.columns) +
                            static_cast<std::size_t>(u)];
      out.values.push_back(sum / count);
    }
  return out;
}

Json map_json(const mcmc::CellMap& whole) {
  const auto map = pool_cells(whole);
  return {
      {"cell", map.cell}, {"columns", map.columns}, {"rows", map.rows}, {"values", numbers_json(map.values)}};
}

Json drift_json(const mcmc::MotionModel& model) {
  const auto x = pool_cells(model.drift_x), y = pool_cells(model.drift_y);
  double most = 0;
  for (std::size_t i = 0; i < std::min(x.values.size(), y.values.size()); ++i)
    most = std::max(most, std::hypot(x.values[i], y.values[i]));
  return {{"cell", x.cell},
          {"columns", x.columns},
          {"rows", x.rows},
          {"x", numbers_json(x.values)},
          {"y", numbers_json(y.values)},
          {"most", round_for_page(most)}};
}

Json motion_json(const mcmc::Autoregression& motion) {
  const double radius = mcmc::spectral_radius(motion);
  Json out = {{"a1", round_for_page(motion.a1)},
              {"a2", round_for_page(motion.a2)},
              {"coupling", round_for_page(motion.coupling)},
              {"noise", round_for_page(motion.noise)},
              {"range", round_for_page(motion.range)},
              {"measurement", round_for_page(motion.measurement)},
              {"radius", round_for_page(radius)},
              {"deviation", nullptr}};
  if (radius < 1) out["deviation"] = round_for_page(mcmc::stationary_deviation(motion));
  return out;
}

// Lists the roots of z² = a1 z + a2: the poles of a stroke's rigid motion.
Json poles_json(const char* of, const mcmc::Autoregression& motion) {
  const std::complex<double> root = std::sqrt(std::complex<double>(motion.a1 * motion.a1 / 4 + motion.a2));
  Json out = Json::array();
  for (const auto z : {motion.a1 / 2 + root, motion.a1 / 2 - root})
    out.push_back({{"of", of}, {"re", round_for_page(z.real())}, {"im", round_for_page(z.imag())}});
  return out;
}

// Returns the expected births per frame; border cells count by the part inside.
double births_a_frame(const mcmc::MotionModel& model) {
  const auto& map = model.rates.birth;
  double sum = 0;
  for (std::size_t i = 0; i < map.values.size(); ++i) {
    const auto columns = static_cast<std::size_t>(map.columns);
    const double x = static_cast<double>(i % columns) * map.cell,
                 y = static_cast<double>(i / columns) * map.cell;
    sum += map.values[i] * std::clamp(model.width - x, 0.0, map.cell) *
           std::clamp(model.height - y, 0.0, map.cell);
  }
  return sum;
}

// "a stroke of 5 to 8 patches"
std::string stroke_sizes(std::size_t size) {
  constexpr std::size_t kLongest = 100'000;
  std::size_t least = 1;
  while (least < kLongest && mcmc::size_class(least) < size) ++least;
  std::size_t most = least;
  while (most < kLongest && mcmc::size_class(most + 1) == size) ++most;
  if (most == kLongest) return "a stroke of " + std::to_string(least) + " patches or more";
  const std::string from = size == 0 ? "up to " : std::to_string(least) + " to ";
  return "a stroke of " + from + std::to_string(most) + " patches";
}

Json rates_json(const mcmc::MotionModel& model, std::span<const graph::Event> events) {
  const auto seen = [&](graph::EventType type) {
    return static_cast<std::size_t>(std::ranges::count(events, type, &graph::Event::type));
  };
  Json out = Json::array();
  const auto row = [&](const char* name, const std::string& per, const Json& count, double rate) {
    out.push_back({{"name", name}, {"per", per}, {"seen", count}, {"rate", round_for_page(rate)}});
  };
  using enum graph::EventType;
  const auto& rates = model.rates;
  row("birth", "in the frame", seen(birth), births_a_frame(model));
  row("death", "in the frame", seen(death), static_cast<double>(seen(death)) / std::max(1, model.frames - 1));
  for (std::size_t i = 0; i < mcmc::kSizeClasses; ++i)
    row("", stroke_sizes(i), nullptr, rates.death_by_size[i]);
  row("split", "a patch inside a curve", seen(split), rates.split);
  row("merge", "a pair of ends in line", seen(merge), rates.merge);
  row("connect", "a pair of strokes beside each other", seen(connect), rates.connect);
  row("disconnect", "an arm of a junction", seen(disconnect), rates.disconnect);
  return out;
}

const char* kind_name(const graph::Patch& patch) {
  return graph::on_step(patch) ? "step" : patch.contrast > 0 ? "ridge" : "valley";
}

Json exemplar_json(const mcmc::Exemplar& exemplar, std::size_t& points) {
  Json curves = Json::array();
  for (const auto& curve : graph::curves(exemplar.graph)) {
    Json line = Json::array({kind_name(exemplar.graph.patch(curve.front()))});
    for (const auto index : curve) {
      const auto at = exemplar.graph.patch(index).position;
      line.push_back(std::round(at.x * 10) / 10);
      line.push_back(std::round(at.y * 10) / 10);
    }
    points += curve.size();
    curves.push_back(std::move(line));
  }
  return {{"patches", exemplar.graph.size()},
          {"x", std::round(exemplar.place.x)},
          {"y", std::round(exemplar.place.y)},
          {"curves", std::move(curves)}};
}

// Picks exemplars evenly, except those too large for the page.
Json exemplars_json(const std::vector<mcmc::Exemplar>& exemplars) {
  std::vector<int> numbers(exemplars.size());
  std::iota(numbers.begin(), numbers.end(), 0);
  Json out = Json::array();
  std::size_t points = 0;
  for (const int i : spread_evenly(numbers, kExemplars)) {
    std::size_t more = points;
    Json shown = exemplar_json(exemplars[static_cast<std::size_t>(i)], more);
    if (more > kExemplarPoints || shown["curves"].empty()) continue;
    points = more;
    out.push_back(std::move(shown));
  }
  return out;
}

}  // namespace

Json report_clips(const ReportClips& clips) {
  return {{"names", clips.names},   {"width", clips.width}, {"height", clips.height},
          {"frames", clips.frames}, {"fps", clips.fps},     {"mp4", base64(clips.mp4)}};
}

Json report_measures(const ReportMeasures& measures) {
  Json rows = Json::array();
  for (const auto& row : measures.rows) {
    Json values = Json::array();
    for (const auto& value : row.values)
      values.push_back(value && std::isfinite(*value) ? Json(round_for_page(*value)) : Json(nullptr));
    rows.push_back({{"name", row.name}, {"about", row.about}, {"values", std::move(values)}});
  }
  return {{"columns", measures.columns}, {"rows", std::move(rows)}, {"note", measures.note}};
}

Json report_motion_model(const mcmc::MotionModel& model, std::span<const graph::Event> events) {
  Json poles = poles_json("sway", model.displacement);
  for (const auto& pole : poles_json("contrast", model.contrast)) poles.push_back(pole);
  return {{"sway", motion_json(model.displacement)},
          {"contrast", motion_json(model.contrast)},
          {"poles", std::move(poles)},
          {"rates", rates_json(model, events)},
          {"birth", map_json(model.rates.birth)},
          {"death", map_json(model.rates.death)},
          {"drift", drift_json(model)},
          {"exemplars", exemplars_json(model.exemplars)},
          {"exemplars_total", model.exemplars.size()}};
}

Json motion_model_figures(const mcmc::MotionModel& model) {
  const auto& rates = model.rates;
  return {{"sway", motion_json(model.displacement)},
          {"contrast", motion_json(model.contrast)},
          {"rates",
           {{"birth_per_frame", round_for_page(births_a_frame(model))},
            {"death_by_size", numbers_json(rates.death_by_size)},
            {"split", round_for_page(rates.split)},
            {"merge", round_for_page(rates.merge)},
            {"connect", round_for_page(rates.connect)},
            {"disconnect", round_for_page(rates.disconnect)}}},
          {"largest_drift", drift_json(model)["most"]},
          {"exemplars", model.exemplars.size()},
          {"first_strokes", graph::components(model.first).count}};
}

Json report_eigenvalues(std::span<const std::complex<double>> eigenvalues) {
  Json out = Json::array();
  for (const auto z : eigenvalues.first(std::min(eigenvalues.size(), kEigenvalues)))
    out.push_back({round_for_page(z.real()), round_for_page(z.imag())});
  return out;
}

}  // namespace emberfold::apps
