// SPDX-License-Identifier: Apache-2.0
#include "mcmc/inference/path_likelihood.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "mcmc/learning/ar_kalman.hpp"
#include "mcmc/learning/drift.hpp"

namespace emberfold::mcmc::detail {

namespace {

/// One track on its way, with the steps of its filter.
struct FilteredTrack {
  std::vector<KalmanGain<1>> gains;
  RestFilter<1> filter;
};

Lanes<1> lane_of(double value) {
  return Lanes<1>::Constant(value);
}

FilteredTrack begin_track(const Autoregression& law, double scale, double least_error, std::size_t frames) {
  const double noise = scale * law.noise;
  const PathLaw<1> path{lane_of(law.a1), lane_of(law.a2), lane_of(noise * noise),
                        lane_of(law.measurement * law.measurement + least_error * least_error)};
  return {kalman_gains(path, frames), RestFilter<1>(path)};
}

double log_normal_density(double off, double variance) {
  return -0.5 * (std::log(2 * std::numbers::pi * variance) + off * off / variance);
}

// The mean expected deviation of each track's neighbours less its own; 0 without any.
std::vector<double> pulls(const std::vector<TrackNeighbours::Pair>& pairs,
                          const std::vector<double>& expected, bool turns_with_normal) {
  std::vector<double> sums(expected.size()), counts(expected.size());
  for (const auto& [a, b, sense] : pairs) {
    const double same = turns_with_normal ? sense : 1;
    sums[a] += same * expected[b], sums[b] += same * expected[a];
    ++counts[a], ++counts[b];
  }
  for (std::size_t i = 0; i < sums.size(); ++i)
    sums[i] = counts[i] > 0 ? sums[i] / counts[i] - expected[i] : 0;
  return sums;
}

}  // namespace

FollowedAttribute followed_displacement(const std::vector<CurveTrack>& tracks, const MotionModel& model) {
  FollowedAttribute result{{}, {}, true, 0.02};
  for (const auto& track : tracks) {
    result.values.push_back(without_drift(track, model.drift_x, model.drift_y));
    result.scales.push_back(model.displacement_scale.at(track.samples.front().position));
  }
  return result;
}

FollowedAttribute followed_contrast(const std::vector<CurveTrack>& tracks, const MotionModel& model) {
  constexpr double kLeastShare = 0.01;
  FollowedAttribute result{{}, std::vector<double>(tracks.size(), 1), false, 0.02};
  for (const auto& track : tracks) {
    auto& values = result.values.emplace_back();
    for (std::size_t k = 0; k < track.samples.size(); ++k) {
      const bool appears = track.first > 0 && k < model.appearing.size();
      const double share = appears ? std::max(model.appearing[k], kLeastShare) : 1;
      values.push_back(track.samples[k].contrast - std::log(share));
    }
  }
  return result;
}

std::vector<double> path_log_densities(const std::vector<CurveTrack>& tracks,
                                       const TrackNeighbours& neighbours, const FollowedAttribute& attribute,
                                       const Autoregression& law, std::size_t frames) {
  std::vector<FilteredTrack> filtered;
  std::vector<std::vector<std::uint32_t>> present(frames);
  for (std::uint32_t i = 0; i < tracks.size(); ++i) {
    filtered.push_back(
        begin_track(law, attribute.scales[i], attribute.least_error, tracks[i].samples.size()));
    for (std::size_t k = 0; k < tracks[i].samples.size(); ++k)
      present[static_cast<std::size_t>(tracks[i].first) + k].push_back(i);
  }
  std::vector<double> result(frames - 1), expected(tracks.size());
  for (std::size_t t = 0; t < frames; ++t) {
    for (const auto i : present[t]) {
      auto& [gains, filter] = filtered[i];
      const auto k = t - static_cast<std::size_t>(tracks[i].first);
      const double value = attribute.values[i][k];
      if (k > 0)
        result[t - 1] += log_normal_density(value - filter.place()[0], filter.place_variance(gains[k])[0]);
      filter.measure(value, gains[k]);
      expected[i] = filter.deviation()[0];
    }
    const auto pull = law.coupling > 0 ? pulls(neighbours.frames[t], expected, attribute.turns_with_normal)
                                       : std::vector<double>(tracks.size());
    for (const auto i : present[t]) filtered[i].filter.advance(lane_of(law.coupling * pull[i]));
  }
  return result;
}

}  // namespace emberfold::mcmc::detail
