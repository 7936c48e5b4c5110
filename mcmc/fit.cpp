// SPDX-License-Identifier: Apache-2.0
#include "mcmc/fit.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/error.hpp"
#include "mcmc/balance.hpp"
#include "mcmc/drift.hpp"
#include "mcmc/exemplars.hpp"
#include "mcmc/lineages.hpp"
#include "mcmc/moments.hpp"
#include "mcmc/rates.hpp"

namespace emberfold::mcmc {

namespace {

constexpr std::size_t shortest = 12;  // frames: shorter lineages tell no rest
constexpr double few = 5;             // samples in a cell
constexpr std::size_t most_exemplars = 300;

// Each lineage's travel, less what the drift made of it.
Series without_drift(const std::vector<detail::Lineage>& all, const Drift& drift) {
  Series series;
  for (const auto& lineage : all) {
    std::vector<double> travel;
    double drifted = 0;
    for (const auto& sample : lineage.samples) {
      travel.push_back(sample.travel - drifted);
      drifted += graph::dot(drift.at(sample.position), sample.normal);
    }
    series.push_back(std::move(travel));
  }
  return series;
}

Series contrasts(const std::vector<detail::Lineage>& all) {
  Series series;
  for (const auto& lineage : all) {
    series.emplace_back();
    for (const auto& sample : lineage.samples) series.back().push_back(sample.contrast);
  }
  return series;
}

// How bright a stroke is on its way in, in shares of what it has later; `backwards`: on its way out.
std::array<double, 8> way_in(const std::vector<detail::Lineage>& all, int frames, bool backwards) {
  std::array<double, 8> sum{}, shares{};
  double count = 0;
  for (const auto& lineage : all) {
    const auto n = lineage.samples.size();
    if (n < 2 * sum.size() || (backwards ? lineage.last() >= frames - 1 : lineage.first == 0)) continue;
    const auto at = [&](std::size_t k) { return lineage.samples[backwards ? n - 1 - k : k].contrast; };
    double later = 0;
    for (std::size_t k = sum.size(); k < n; ++k) later += at(k);
    later /= static_cast<double>(n - sum.size());
    for (std::size_t k = 0; k < sum.size(); ++k) sum[k] += at(k) - later;
    ++count;
  }
  for (std::size_t k = 0; k < sum.size(); ++k) shares[k] = count > 0 ? std::exp(sum[k] / count) : 1;
  // Brighter with every frame, and all of it in the end.
  double limit = 1;
  for (auto share = shares.rbegin(); share != shares.rend(); ++share)
    limit = *share = std::clamp(*share, 0.0, limit);
  return shares;
}

// The frame whose number of patches is nearest the mean.
std::size_t usual_frame(const graph::MotionGraph& motion) {
  const auto& frames = motion.sketch.frames;
  double mean = 0;
  for (const auto& graph : frames) mean += static_cast<double>(graph.size());
  mean /= static_cast<double>(frames.size());
  const auto found = std::ranges::min_element(
      frames, {}, [&](const auto& graph) { return std::abs(static_cast<double>(graph.size()) - mean); });
  return static_cast<std::size_t>(found - frames.begin());
}

CellMap usual_density(const graph::MotionGraph& motion) {
  CellMap map = grid_over(motion.sketch.width, motion.sketch.height);
  for (const auto& graph : motion.sketch.frames)
    for (const auto& vertex : graph.vertices())
      map.values[map.index(vertex.patch.position)] += 1 / static_cast<double>(motion.sketch.frames.size());
  map.values = spread(map, 2);
  return map;
}

// The SD of the travel about its mean in each cell, less what the sketch adds, over what is usual; where
// little was seen nearer to 1.
CellMap sway_by_place(const std::vector<detail::Lineage>& all, const Series& travel,
                      const Autoregression& sway, const CellMap& grid) {
  CellMap squares = grid, counts = grid;
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (travel[i].size() < shortest) continue;
    const double mean = std::accumulate(travel[i].begin(), travel[i].end(), 0.0) / double(travel[i].size());
    for (std::size_t k = 0; k < travel[i].size(); ++k) {
      const auto cell = grid.index(all[i].samples[k].position);
      squares.values[cell] += (travel[i][k] - mean) * (travel[i][k] - mean);
      ++counts.values[cell];
    }
  }
  CellMap shares = grid;
  const double error = sway.measurement * sway.measurement;
  const double usual = sway.noise > 0 ? std::pow(stationary_deviation(sway), 2) : 0;
  const auto s = spread(squares, 1), n = spread(counts, 1);
  for (std::size_t c = 0; c < shares.values.size(); ++c) {
    const double variance = (s[c] + few * (usual + error)) / (n[c] + few);
    shares.values[c] = usual > 0 ? std::sqrt(std::clamp((variance - error) / usual, 0.01, 9.0)) : 1;
  }
  return shares;
}

void append(std::vector<std::string>& all, const std::vector<std::string>& more) {
  all.insert(all.end(), more.begin(), more.end());
}

}  // namespace

FitResult fit(const graph::MotionGraph& motion, const FitOptions& options, const core::Context& context) {
  const auto frames = static_cast<int>(motion.sketch.frames.size());
  if (frames < 2)
    throw core::InputError("a motion model is learned from two frames or more; here are " +
                           std::to_string(frames));
  FitResult result;
  MotionModel& model = result.model;
  model.width = motion.sketch.width, model.height = motion.sketch.height;
  model.fps = motion.sketch.fps, model.frames = frames;

  context.report("fit", 0);
  const auto lineages = detail::lineages(motion);
  const Drift drift = measure_drift(lineages, grid_over(model.width, model.height));
  model.drift_x = drift.x, model.drift_y = drift.y;
  const Series travel = without_drift(lineages, drift);
  const auto sway = estimate(moments(motion, lineages, travel, true, shortest), "sway");
  const auto contrast = estimate(moments(motion, lineages, contrasts(lineages), false, shortest), "contrast");
  model.sway = sway.motion, model.contrast = contrast.motion;
  model.sway_share = sway_by_place(lineages, travel, model.sway, grid_over(model.width, model.height));
  append(result.notes, sway.notes);
  append(result.notes, contrast.notes);
  model.appearing = way_in(lineages, frames, false);
  model.vanishing = way_in(lineages, frames, true);

  context.report("fit", 0.3);
  const auto events = graph::stroke_events(motion);
  result.counts = count_operators(motion, events);
  auto rates = estimate_rates(result.counts);
  model.rates = std::move(rates.rates);
  append(result.notes, rates.notes);
  const auto displacement = displacements(motion, lineages, travel);
  model.exemplars = sample_exemplars(motion, displacement, most_exemplars);
  model.density = usual_density(motion);
  const auto usual = usual_frame(motion);
  model.first = at_rest(motion.sketch.frames[usual], displacement[usual]);

  context.report("fit", 0.5);
  append(result.notes, balance(model, born_sizes(motion, events), result.counts, options.seed, context));
  if (context.cancelled()) result.status = core::Status::cancelled;
  return result;
}

}  // namespace emberfold::mcmc
