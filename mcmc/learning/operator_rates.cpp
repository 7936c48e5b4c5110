// SPDX-License-Identifier: Apache-2.0
#include "mcmc/learning/operator_rates.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <numeric>

#include <boost/math/distributions/gamma.hpp>

#include "core/error.hpp"
#include "mcmc/learning/drift.hpp"
#include "mcmc/learning/operator_sites.hpp"
#include "mcmc/learning/stroke_places.hpp"

namespace emberfold::mcmc {

namespace {

using graph::EventType;
using graph::Point;

double total(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0);
}

constexpr double least_reach = 10, most_reach = 60;  // px
constexpr double doubt = 0.2;                        // events that the prior is worth

// Events over exposure, with `doubt` of a prior event and the mean exposure for it over `all`.
double rate(const OperatorCounts::Count& count, const OperatorCounts::Count& all) {
  if (all.exposure <= 0 || all.events <= 0) return 0;
  const double mean = all.events / all.exposure;
  return std::min(1.0, (count.events + doubt) / (count.exposure + doubt / mean));
}

constexpr double jeffreys = 0.5;  // events

void add_intervals(const OperatorCounts& counts, RateEstimate& result) {
  if (counts.gaps <= 0) return;
  for (std::size_t type = 0; type < counts.events.size(); ++type) {
    auto& interval = result.events_per_frame[type];
    interval = rate_interval(counts.events[type], counts.gaps, 0, jeffreys, 0);
    interval.mean = counts.events[type] / counts.gaps;
    if (counts.events[type] <= 0) interval.low = 0;
  }
  OperatorCounts::Count deaths;
  for (const auto& count : counts.death) deaths += count;
  if (deaths.events <= 0) return;
  for (std::size_t s = 0; s < kSizeClasses; ++s) {
    const auto& count = counts.death[s];
    result.death_by_size[s] =
        rate_interval(count.events, count.exposure, 0, doubt, doubt * deaths.exposure / deaths.events);
  }
}

// Places at which events could happen.
struct ExposureMaps {
  std::array<CellMap, kSizeClasses> die;
  CellMap split, disconnect;
};

void count_strokes(const graph::AttributeGraph& graph, OperatorCounts& counts, ExposureMaps& exposures) {
  const auto parts = graph::components(graph);
  for (const auto& stroke : vertices_by_stroke(parts)) {
    const auto size = size_class(stroke.size());
    ++counts.death[size].exposure;
    ++exposures.die[size].values[exposures.die[size].index(stroke_middle(graph, stroke))];
  }
  const OperatorSites found = find_sites(graph, parts, counts.reach);
  counts.split.exposure += static_cast<double>(found.split_sites.size());
  counts.disconnect.exposure += static_cast<double>(found.disconnect_sites.size());
  const auto at = [&](std::uint32_t v) { return exposures.split.index(graph.patch(v).position); };
  for (const auto v : found.split_sites) ++exposures.split.values[at(v)];
  for (const auto& arm : found.disconnect_sites) ++exposures.disconnect.values[at(arm.a)];
  counts.merge.exposure += static_cast<double>(found.merge_sites.size());
  counts.connect.exposure += static_cast<double>(found.connect_sites.size());
}

std::map<graph::SubgraphId, std::size_t> stroke_sizes(const graph::AttributeGraph& graph) {
  std::map<graph::SubgraphId, std::size_t> sizes;
  for (const auto& vertex : graph.vertices()) ++sizes[vertex.subgraph];
  return sizes;
}

void count_events(const graph::MotionGraph& motion, std::span<const graph::Event> events,
                  OperatorCounts& counts) {
  const CellMap grid = make_cell_grid(motion.sketch.width, motion.sketch.height);
  counts.births.assign(motion.sketch.frames.size() - 1, grid);
  counts.deaths = counts.separations = counts.births;
  for (std::size_t i = 0; i < events.size();) {
    const int frame = events[i].frame;
    const auto sizes = stroke_sizes(motion.sketch.frames[static_cast<std::size_t>(frame) - 1]);
    const auto gap = static_cast<std::size_t>(frame) - 1;
    for (; i < events.size() && events[i].frame == frame; ++i) {
      const auto& event = events[i];
      ++counts.events[static_cast<std::size_t>(event.type)];
      switch (event.type) {
        case EventType::birth:
          ++counts.births[gap].values[grid.index(event.position)];
          break;
        case EventType::death:
          ++counts.deaths[gap].values[grid.index(event.position)];
          if (const auto found = sizes.find(event.before.at(0)); found != sizes.end())
            ++counts.death[size_class(found->second)].events;
          break;
        case EventType::split:
          ++counts.split.events;
          ++counts.separations[gap].values[grid.index(event.position)];
          break;
        case EventType::merge:
          ++counts.merge.events;
          break;
        case EventType::connect:
          ++counts.connect.events;
          break;
        case EventType::disconnect:
          ++counts.disconnect.events;
          ++counts.separations[gap].values[grid.index(event.position)];
          break;
      }
    }
  }
}

double quantile(std::vector<double> values, double share, double otherwise) {
  if (values.empty()) return otherwise;
  const auto at = static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::ranges::nth_element(values, values.begin() + at);
  return values[static_cast<std::size_t>(at)];
}

// Measures the widths of the gaps that close and open.
void measure_gaps(const graph::MotionGraph& motion, std::span<const graph::Event> events,
                  OperatorCounts& counts) {
  std::vector<double> unions, splits, disconnects;
  for (const auto& event : events) {
    const auto& frames = motion.sketch.frames;
    const auto t = static_cast<std::size_t>(event.frame);
    if (event.before.size() == 2)
      unions.push_back(gap_between_strokes(frames[t - 1], event.before[0], event.before[1]));
    if (event.after.size() == 2)
      (event.type == EventType::split ? splits : disconnects)
          .push_back(gap_between_strokes(frames[t], event.after[0], event.after[1]));
  }
  counts.reach = std::clamp(quantile(unions, 0.9, counts.reach), least_reach, most_reach);
  counts.split_gap = std::min(quantile(splits, 0.5, counts.split_gap), most_reach);
  counts.disconnect_gap = std::min(quantile(disconnects, 0.5, counts.disconnect_gap), most_reach);
}

CellMap sum(const std::vector<CellMap>& maps) {
  CellMap result = maps.at(0);
  for (std::size_t i = 1; i < maps.size(); ++i)
    for (std::size_t c = 0; c < result.values.size(); ++c) result.values[c] += maps[i].values[c];
  return result;
}

// Σ K n under a Gaussian K of peak 1: weighted number of events around each cell.
std::vector<double> kernel_sums(const CellMap& map, double sigma) {
  auto sums = spread_over_cells(map, sigma);
  const double cells = std::max(1.0, 2 * std::numbers::pi * sigma * sigma);
  for (double& s : sums) s *= cells;
  return sums;
}

// (1 + Σ K n) / (1 + Σ K e): events over expected events, shrunk towards 1 with the weight of one event.
std::vector<double> relative_rates(const CellMap& events, const CellMap& expected, double sigma) {
  auto n = kernel_sums(events, sigma);
  const auto e = kernel_sums(expected, sigma);
  for (std::size_t c = 0; c < n.size(); ++c) n[c] = (1 + n[c]) / (1 + e[c]);
  return n;
}

// Log-likelihood of each gap's events under the map made from the other gaps.
double leave_one_out_likelihood(const std::vector<CellMap>& gaps, const CellMap& all, const CellMap& expected,
                                double sigma) {
  double sum = 0;
  CellMap expected_others = expected;
  const double share = 1 - 1 / static_cast<double>(gaps.size());
  for (double& e : expected_others.values) e *= share;
  const auto e = kernel_sums(expected_others, sigma);
  const auto n_all = kernel_sums(all, sigma);
  for (const auto& gap : gaps) {
    if (total(gap.values) <= 0) continue;
    const auto mine = kernel_sums(gap, sigma);
    for (std::size_t c = 0; c < gap.values.size(); ++c)
      if (gap.values[c] > 0 && expected.values[c] > 0)
        sum += gap.values[c] *
               std::log((1 + std::max(0.0, n_all[c] - mine[c])) / (1 + e[c]) * expected.values[c]);
  }
  // Expected number of events in a gap, equal for all gaps.
  const auto map = relative_rates(all, expected, sigma);
  for (std::size_t c = 0; c < map.size(); ++c) sum -= map[c] * expected.values[c];
  return sum;
}

CellMap relative_map(const std::vector<CellMap>& gaps, const CellMap& expected) {
  const CellMap all = sum(gaps);
  CellMap best = expected;
  double highest = -std::numeric_limits<double>::infinity();
  for (const double sigma : {0.7, 1.0, 1.4, 2.0, 2.8, 4.0, 5.7, 8.0, 16.0}) {
    const double likely = leave_one_out_likelihood(gaps, all, expected, sigma);
    if (!(likely > highest)) continue;
    highest = likely;
    best.values = relative_rates(all, expected, sigma);
  }
  if (highest == -std::numeric_limits<double>::infinity()) std::ranges::fill(best.values, 1.0);
  return best;
}

}  // namespace

OperatorCounts count_operators(const graph::MotionGraph& motion, std::span<const graph::Event> events) {
  OperatorCounts counts;
  const auto& frames = motion.sketch.frames;
  counts.gaps = static_cast<double>(frames.size()) - 1;
  measure_gaps(motion, events, counts);
  const CellMap grid = make_cell_grid(motion.sketch.width, motion.sketch.height);
  ExposureMaps exposures{{}, grid, grid};
  exposures.die.fill(grid);
  for (std::size_t t = 0; t + 1 < frames.size(); ++t) count_strokes(frames[t], counts, exposures);
  count_events(motion, events, counts);
  OperatorCounts::Count all;
  for (const auto& count : counts.death) all += count;
  counts.expected_deaths = counts.expected_separations = grid;
  for (std::size_t s = 0; s < kSizeClasses; ++s)
    for (std::size_t c = 0; c < counts.expected_deaths.values.size(); ++c)
      counts.expected_deaths.values[c] += exposures.die[s].values[c] * rate(counts.death[s], all);
  for (std::size_t c = 0; c < grid.values.size(); ++c)
    counts.expected_separations.values[c] =
        exposures.split.values[c] * rate(counts.split, counts.split) +
        exposures.disconnect.values[c] * rate(counts.disconnect, counts.disconnect);
  return counts;
}

RateInterval rate_interval(double events, double time, double variance, double prior_events,
                           double prior_time, double probability) {
  const double shape = events + prior_events, rate = time + prior_time, average = shape / rate;
  if (!(shape > 0) || !(rate > 0))
    throw core::InputError("a rate's interval needs more than no events and no time; here are " +
                           std::to_string(shape) + " in " + std::to_string(rate));
  const double spread = (shape + variance) / (rate * rate);
  const boost::math::gamma_distribution<double> gamma(average * average / spread, spread / average);
  return {average, boost::math::quantile(gamma, (1 - probability) / 2),
          boost::math::quantile(boost::math::complement(gamma, (1 - probability) / 2))};
}

RateEstimate estimate_rates(const OperatorCounts& counts) {
  RateEstimate result;
  add_intervals(counts, result);
  OperatorRates& rates = result.rates;
  OperatorCounts::Count deaths;
  for (const auto& count : counts.death) deaths += count;
  for (std::size_t s = 0; s < kSizeClasses; ++s) rates.death_by_size[s] = rate(counts.death[s], deaths);
  rates.death = relative_map(counts.deaths, counts.expected_deaths);
  rates.separation = relative_map(counts.separations, counts.expected_separations);

  const double births = total(sum(counts.births).values);
  const CellMap& grid = counts.expected_deaths;
  CellMap expected = grid;
  std::ranges::fill(expected.values, births / static_cast<double>(grid.values.size()));
  rates.birth = relative_map(counts.births, expected);
  const double mass = total(rates.birth.values) * grid.cell * grid.cell;
  for (double& value : rates.birth.values) value *= births / counts.gaps / mass;

  rates.split = rate(counts.split, counts.split);
  rates.merge = rate(counts.merge, counts.merge);
  rates.connect = rate(counts.connect, counts.connect);
  rates.disconnect = rate(counts.disconnect, counts.disconnect);
  rates.reach = counts.reach, rates.split_gap = counts.split_gap;
  rates.disconnect_gap = counts.disconnect_gap;
  if (births + deaths.events < 10)
    result.notes.push_back("only " + std::to_string(static_cast<int>(births)) + " births and " +
                           std::to_string(static_cast<int>(deaths.events)) +
                           " deaths: their rates are hardly known");
  return result;
}

}  // namespace emberfold::mcmc
