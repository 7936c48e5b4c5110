// SPDX-License-Identifier: Apache-2.0
#include "mcmc/simulation/predict.hpp"

#include <string>

#include "core/error.hpp"
#include "mcmc/learning/ar_kalman.hpp"
#include "mcmc/learning/curve_tracks.hpp"

namespace emberfold::mcmc {

namespace {

constexpr double least_error = 0.02;  // px: SD of a measured place

}  // namespace

std::vector<graph::AttributeGraph> predict(const MotionModel& model, const graph::MotionGraph& motion,
                                           int steps) {
  validate(model);
  if (steps < 1)
    throw core::InputError("prediction: steps is " + std::to_string(steps) + "; allowed is 1 or more");
  const auto& frames = motion.sketch.frames;
  std::vector<std::vector<detail::TrackValue>> track_values(frames.size());
  const auto& displacement = model.displacement;
  const auto lane = [](double value) { return detail::Lanes<1>::Constant(value); };
  const detail::PathLaw<1> law{
      lane(displacement.a1), lane(displacement.a2), lane(displacement.noise * displacement.noise),
      lane(displacement.measurement * displacement.measurement + least_error * least_error)};
  const auto gains = detail::kalman_gains(law, frames.size());
  for (const auto& track : detail::track_curves(motion)) {
    detail::RestFilter<1> filter(law);
    double drifted = 0;
    for (std::size_t k = 0; k < track.samples.size(); ++k) {
      const auto& sample = track.samples[k];
      filter.measure(sample.normal_displacement - drifted, gains[k]);
      filter.advance(lane(0));
      const graph::Point v{model.drift_x.at(sample.position), model.drift_y.at(sample.position)};
      const double drift = graph::dot(v, sample.normal);
      auto ahead = filter;
      for (int step = 1; step < steps; ++step) ahead.advance(lane(0));
      const double expected = ahead.place()[0] + drifted + steps * drift;
      track_values[static_cast<std::size_t>(track.first) + k].push_back(
          {sample.vertex, sample.normal * (expected - sample.normal_displacement)});
      drifted += drift;
    }
  }
  std::vector<graph::AttributeGraph> result(frames.size());
  const auto ahead = static_cast<std::size_t>(steps);
  for (std::size_t t = ahead; t < frames.size(); ++t) {
    const auto& from = frames[t - ahead];
    const auto moves = detail::smooth_over_patches(from, track_values[t - ahead]);
    std::vector<graph::Vertex> vertices(from.vertices().begin(), from.vertices().end());
    for (std::size_t v = 0; v < vertices.size(); ++v)
      vertices[v].patch.position = vertices[v].patch.position + moves[v];
    result[t] = {std::move(vertices), {from.edges().begin(), from.edges().end()}};
  }
  return result;
}

}  // namespace emberfold::mcmc
