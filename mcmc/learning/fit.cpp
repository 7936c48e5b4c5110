// SPDX-License-Identifier: Apache-2.0
#include "mcmc/learning/fit.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <span>

#include "core/error.hpp"
#include "mcmc/learning/curve_tracks.hpp"
#include "mcmc/learning/drift.hpp"
#include "mcmc/learning/exemplars.hpp"
#include "mcmc/learning/hard_core.hpp"
#include "mcmc/learning/moments.hpp"
#include "mcmc/learning/operator_rates.hpp"
#include "mcmc/learning/rate_modifiers.hpp"
#include "mcmc/learning/velocity_modes.hpp"
#include "mcmc/simulation/rate_calibration.hpp"

namespace emberfold::mcmc {

namespace {

constexpr std::size_t kShortestAtRest = 12;  // frames: shorter tracks give no rest
constexpr double kFewSamples = 5;            // samples in a cell
constexpr double most_share = 10;            // largest factor of the usual displacement
constexpr std::size_t most_exemplars = 300;
constexpr double renewal = 1e-3;  // of a stroke in a frame, to begin with

using CurveTracks = std::vector<detail::CurveTrack>;

// The tracks of a clip.
struct FollowedClip {
  CurveTracks tracks;
  Series normal_displacement;  // less the drift
};

Series contrasts(const CurveTracks& all) {
  Series series;
  for (const auto& track : all) {
    series.emplace_back();
    for (const auto& sample : track.samples) series.back().push_back(sample.contrast);
  }
  return series;
}

// Contrast of a stroke in its first frames, over its later contrast; `backwards`: in its last frames.
std::array<double, 8> fade_shares(const CurveTracks& tracks, int frames, bool backwards) {
  std::array<double, 8> sum{}, shares{};
  double count = 0;
  const auto add = [&](const detail::CurveTrack& track) {
    const auto n = track.samples.size();
    if (n < 2 * sum.size() || (backwards ? track.last() >= frames - 1 : track.first == 0)) return;
    const auto at = [&](std::size_t k) { return track.samples[backwards ? n - 1 - k : k].contrast; };
    double later = 0;
    for (std::size_t k = sum.size(); k < n; ++k) later += at(k);
    later /= static_cast<double>(n - sum.size());
    for (std::size_t k = 0; k < sum.size(); ++k) sum[k] += at(k) - later;
    ++count;
  };
  std::ranges::for_each(tracks, add);
  for (std::size_t k = 0; k < sum.size(); ++k) shares[k] = count > 0 ? std::exp(sum[k] / count) : 1;
  // The share rises with every frame, up to 1.
  double limit = 1;
  for (auto share = shares.rbegin(); share != shares.rend(); ++share)
    limit = *share = std::clamp(*share, 0.0, limit);
  return shares;
}

// The frame with the number of patches nearest the mean, as it was seen.
graph::AttributeGraph typical_frame(const graph::MotionGraph& motion) {
  const auto& frames = motion.sketch.frames;
  double mean = 0;
  for (const auto& graph : frames) mean += static_cast<double>(graph.size());
  mean /= static_cast<double>(frames.size());
  const auto found = std::ranges::min_element(
      frames, {}, [&](const auto& graph) { return std::abs(static_cast<double>(graph.size()) - mean); });
  return with_usual_contrast(*found, std::vector<double>(found->size()));
}

CellMap mean_density(const graph::MotionGraph& motion) {
  const auto& sketch = motion.sketch;
  CellMap map = make_cell_grid(sketch.width, sketch.height);
  const double share = 1 / static_cast<double>(sketch.frames.size());
  for (const auto& graph : sketch.frames)
    for (const auto& vertex : graph.vertices()) map.values[map.index(vertex.patch.position)] += share;
  map.values = spread_over_cells(map, 2);
  return map;
}

// SD of the travel about its mean in each cell, without the sketch's errors, over the usual SD; nearer to 1
// with few observations.
CellMap displacement_scale_map(const FollowedClip& followed, const Autoregression& displacement,
                               const CellMap& grid) {
  CellMap roots = grid, counts = grid;
  const auto& [all, normal_displacement] = followed;
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (normal_displacement[i].size() < kShortestAtRest) continue;
    const double mean = std::accumulate(normal_displacement[i].begin(), normal_displacement[i].end(), 0.0) /
                        double(normal_displacement[i].size());
    for (std::size_t k = 0; k < normal_displacement[i].size(); ++k) {
      const auto cell = grid.index(all[i].samples[k].position);
      roots.values[cell] += std::sqrt(std::abs(normal_displacement[i][k] - mean));
      counts.values[cell] += 1;
    }
  }
  CellMap shares = grid;
  const double error = displacement.measurement * displacement.measurement;
  const double usual = displacement.noise > 0 ? std::pow(stationary_deviation(displacement), 2) : 0;
  const auto s = spread_over_cells(roots, 1), n = spread_over_cells(counts, 1);
  for (std::size_t c = 0; c < shares.values.size(); ++c) {
    const double variance = RobustVariance::variance(
        (s[c] + kFewSamples * RobustVariance::root(usual + error)) / (n[c] + kFewSamples));
    shares.values[c] =
        usual > 0 ? std::clamp(std::sqrt(std::max(variance - error, 0.0) / usual), 0.1, most_share) : 1;
  }
  return shares;
}

void append(std::vector<std::string>& all, const std::vector<std::string>& more) {
  all.insert(all.end(), more.begin(), more.end());
}

// Learns drift, displacement, velocity modes and contrast; returns the tracks.
FollowedClip learn_motion(const graph::MotionGraph& motion, FitResult& result) {
  MotionModel& model = result.model;
  const CellMap grid = make_cell_grid(model.width, model.height);
  FollowedClip followed{detail::track_curves(motion), {}};
  const Drift drift = estimate_drift(followed.tracks, grid);
  for (const auto& track : followed.tracks)
    followed.normal_displacement.push_back(without_drift(track, drift.x, drift.y));
  const auto displacement = estimate_motion(
      collect_observations(motion, followed.tracks, followed.normal_displacement, true), "sway");
  const auto contrast = estimate_motion(
      collect_observations(motion, followed.tracks, contrasts(followed.tracks), false), "contrast");
  model.drift_x = drift.x, model.drift_y = drift.y;
  model.displacement = displacement.motion, model.contrast = contrast.motion;
  model.displacement_scale = displacement_scale_map(followed, model.displacement, grid);
  model.velocity = besides_sway(
      learn_velocity_modes(estimate_velocities(followed.tracks, grid, model.frames)), followed.tracks, model);
  append(result.notes, displacement.notes);
  append(result.notes, contrast.notes);
  model.appearing = fade_shares(followed.tracks, model.frames, false);
  model.vanishing = fade_shares(followed.tracks, model.frames, true);
  return followed;
}

double sum(const CellMap& map) {
  return std::accumulate(map.values.begin(), map.values.end(), 0.0);
}

// `born`: number of births of each size in the clip.
std::vector<std::string> calibrate_births(FitResult& result, std::array<double, kSizeClasses> born,
                                          std::uint64_t seed, const core::Context& context) {
  MotionModel& model = result.model;
  const EventStatistics& wanted = result.observed;
  const double seen = std::accumulate(born.begin(), born.end(), 0.0) / result.counts.gaps;
  const auto moves = [](double speed) { return speed != 0; };
  const bool leaves =
      std::ranges::any_of(model.drift_x.values, moves) || std::ranges::any_of(model.drift_y.values, moves);
  std::array<bool, kSizeClasses> known{};
  for (const auto& exemplar : model.exemplars) known[size_class(exemplar.graph.size())] = true;
  for (std::size_t s = 0; s < kSizeClasses; ++s) {
    // Sizes without an observed birth: as many births as deaths; more where strokes leave the frame.
    const double needed = wanted.strokes[s] * std::max(model.rates.death_by_size[s], leaves ? renewal : 0);
    born[s] = known[s] ? std::max(born[s] / result.counts.gaps, needed) : 0;
  }
  set_births(model, born, wanted.strokes);
  calibrate_rates(model, wanted, seed, context);
  const auto births = births_by_size(model);
  const double ratio = seen > 0 ? std::accumulate(births.begin(), births.end(), 0.0) / seen : 1;
  if (ratio >= 0.5 && ratio <= 1.5) return {};
  return {"births are drawn " + std::to_string(ratio) +
          " times as often as they were seen, so that the number of strokes stays"};
}

}  // namespace

FitResult fit(const graph::MotionGraph& motion, const FitOptions& options, const core::Context& context) {
  if (motion.sketch.frames.size() < 2)
    throw core::InputError("a motion model is learned from two frames or more; here are " +
                           std::to_string(motion.sketch.frames.size()));
  FitResult result;
  MotionModel& model = result.model;
  model.width = motion.sketch.width, model.height = motion.sketch.height;
  model.fps = motion.sketch.fps, model.frames = static_cast<int>(motion.sketch.frames.size());

  context.report("fit", 0);
  const auto followed = learn_motion(motion, result);

  context.report("fit", 0.3);
  const auto events = graph::stroke_events(motion);
  result.counts = count_operators(motion, events);
  auto rates = estimate_rates(result.counts);
  model.rates = std::move(rates.rates);
  model.rates.refractory_period = std::min(8.0, estimate_refractory_period(events));
  model.rates.modifiers = estimate_rate_modifiers(motion, events, model.rates);
  result.events_per_frame = rates.events_per_frame, result.death_by_size = rates.death_by_size;
  append(result.notes, rates.notes);
  model.exemplars = sample_exemplars(motion, contrast_deviations(motion, followed.tracks), most_exemplars);
  model.density = mean_density(motion);
  model.hard_core = estimate_hard_core(motion);
  model.first = typical_frame(motion);
  result.observed = event_statistics(result.counts, sum(model.density));

  context.report("fit", 0.5);
  if (options.calibrate)
    append(result.notes,
           calibrate_births(result, count_births_by_size(motion, events), options.seed, context));
  context.check();
  return result;
}

}  // namespace emberfold::mcmc
