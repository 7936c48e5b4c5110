// SPDX-License-Identifier: Apache-2.0
#include "mcmc/learning/stroke_statistics.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <set>
#include <string>

#include <boost/math/distributions/students_t.hpp>

#include "core/error.hpp"
#include "mcmc/learning/operator_rates.hpp"

namespace emberfold::mcmc {

namespace {

constexpr double probability = 0.95;

double total(std::span<const double> values) {
  return std::accumulate(values.begin(), values.end(), 0.0);
}

// Sums over blocks of neighbouring frames of equal length: eight of them, or as many as √T frames allow. The
// rest at the end, less than a block, is left out.
std::vector<double> block_sums(std::span<const double> values) {
  const auto root = static_cast<std::size_t>(std::lround(std::sqrt(static_cast<double>(values.size()))));
  const auto length = std::max({std::size_t{1}, root, values.size() / 8});
  std::vector<double> sums;
  for (std::size_t first = 0; first + length <= values.size(); first += length)
    sums.push_back(total(values.subspan(first, length)));
  return sums;
}

double student(std::size_t blocks) {
  const boost::math::students_t law(static_cast<double>(blocks - 1));
  return boost::math::quantile(law, 0.5 + probability / 2);
}

constexpr double kNormalQuantile = 1.959964;

}  // namespace

StrokeSeries stroke_series(const graph::MotionGraph& motion, std::span<const graph::Event> events) {
  const auto& frames = motion.sketch.frames;
  StrokeSeries series;
  for (auto& counts : series.events) counts.assign(frames.empty() ? 0 : frames.size() - 1, 0);
  series.strokes.assign(frames.size(), 0), series.ended = series.strokes, series.length = series.strokes;
  for (const auto& event : events)
    if (event.frame >= 1 && static_cast<std::size_t>(event.frame) < frames.size())
      series.events[static_cast<std::size_t>(event.type)][static_cast<std::size_t>(event.frame - 1)] += 1;
  std::map<graph::SubgraphId, std::size_t> last;
  for (std::size_t t = 0; t < frames.size(); ++t) {
    const auto& graph = frames[t];
    std::set<graph::SubgraphId> here;
    for (const auto& vertex : graph.vertices()) here.insert(vertex.subgraph), last[vertex.subgraph] = t;
    series.strokes[t] = static_cast<double>(here.size());
    series.length[t] = graph::seen_length(graph);
  }
  for (const auto& [stroke, t] : last)
    if (t + 1 < frames.size()) series.ended[t] += 1;
  return series;
}

RateInterval mean_count(std::span<const double> counts) {
  if (counts.empty()) throw core::InputError("a mean of counts needs at least one");
  const double events = total(counts), time = static_cast<double>(counts.size());
  constexpr double jeffreys = 0.5;
  double dispersion = 1;
  const auto sums = block_sums(counts);
  if (events > 0 && sums.size() >= 4) {
    const double mean = total(sums) / static_cast<double>(sums.size());
    double squares = 0;
    for (const double sum : sums) squares += (sum - mean) * (sum - mean);
    const double heavier = student(sums.size()) / kNormalQuantile;
    if (mean > 0)
      dispersion = std::max(1.0, squares / (static_cast<double>(sums.size() - 1) * mean) * heavier * heavier);
  }
  auto interval =
      rate_interval(events, time, (dispersion - 1) * (events + jeffreys), jeffreys, 0, probability);
  interval.mean = events / time;
  if (events <= 0) interval.low = 0;
  return interval;
}

RateInterval mean_ratio(std::span<const double> numerator, std::span<const double> denominator) {
  if (numerator.size() != denominator.size())
    throw core::InputError("a ratio's series have " + std::to_string(numerator.size()) + " and " +
                           std::to_string(denominator.size()) + " values; allowed is the same number");
  const double above = total(numerator), below = total(denominator);
  if (!(above > 0) || !(below > 0)) return {};
  const double ratio = above / below;
  const auto a = block_sums(numerator), b = block_sums(denominator);
  double squares = 0, sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const double residual = a[i] - ratio * b[i];
    squares += residual * residual;
    sum += a[i];
  }
  if (a.size() < 4 || !(sum > 0)) return {ratio, 0, std::numeric_limits<double>::infinity()};
  const auto blocks = static_cast<double>(a.size());
  const double error = std::sqrt(blocks / (blocks - 1) * squares) / sum;  // of the ratio's logarithm
  const double factor = std::exp(student(a.size()) * error);
  return {ratio, ratio / factor, ratio * factor};
}

StrokeStatistics stroke_statistics(const StrokeSeries& series) {
  if (series.strokes.size() < 2) throw core::InputError("stroke statistics need at least two frames");
  StrokeStatistics result;
  result.frames = static_cast<int>(series.strokes.size());
  for (std::size_t type = 0; type < 6; ++type) {
    result.happened[type] = total(series.events[type]);
    result.events_a_frame[type] = mean_count(series.events[type]);
  }
  result.strokes_a_frame = total(series.strokes) / static_cast<double>(series.strokes.size());
  // A stroke can end in any frame but the last.
  const std::span strokes(series.strokes), ended(series.ended);
  result.lifetime = mean_ratio(strokes.first(strokes.size() - 1), ended.first(ended.size() - 1));
  result.length = mean_ratio(series.length, series.strokes);
  return result;
}

}  // namespace emberfold::mcmc
