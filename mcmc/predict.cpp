// SPDX-License-Identifier: Apache-2.0
#include "mcmc/predict.hpp"

#include "mcmc/lineages.hpp"
#include "mcmc/rest_filter.hpp"

namespace emberfold::mcmc {

namespace {

constexpr double least_error = 0.02;  // px: SD of a measured place

}  // namespace

std::vector<graph::AttributeGraph> predict(const MotionModel& model, const graph::MotionGraph& motion) {
  validate(model);
  const auto& frames = motion.sketch.frames;
  std::vector<std::vector<detail::Told>> told(frames.size());
  const auto& sway = model.sway;
  const auto lane = [](double value) { return detail::Lanes<1>::Constant(value); };
  const detail::PathLaw<1> law{lane(sway.a1), lane(sway.a2), lane(sway.noise * sway.noise),
                               lane(sway.measurement * sway.measurement + least_error * least_error)};
  const auto gains = detail::gains(law, frames.size());
  for (const auto& lineage : detail::lineages(motion)) {
    detail::RestFilter<1> filter(law);
    double drifted = 0;
    for (std::size_t k = 0; k < lineage.samples.size(); ++k) {
      const auto& sample = lineage.samples[k];
      filter.measure(sample.travel - drifted, gains[k]);
      filter.advance(lane(0));
      const graph::Point v{model.drift_x.at(sample.position), model.drift_y.at(sample.position)};
      const double drift = graph::dot(v, sample.normal);
      const double expected = filter.place()[0] + drifted + drift;
      told[static_cast<std::size_t>(lineage.first) + k].push_back(
          {sample.vertex, sample.normal * (expected - sample.travel)});
      drifted += drift;
    }
  }
  std::vector<graph::AttributeGraph> result(frames.size());
  for (std::size_t t = 1; t < frames.size(); ++t) {
    const auto steps = detail::on_patches(frames[t - 1], told[t - 1]);
    std::vector<graph::Vertex> vertices(frames[t - 1].vertices().begin(), frames[t - 1].vertices().end());
    for (std::size_t v = 0; v < vertices.size(); ++v)
      vertices[v].patch.position = vertices[v].patch.position + steps[v];
    result[t] = {std::move(vertices), {frames[t - 1].edges().begin(), frames[t - 1].edges().end()}};
  }
  return result;
}

}  // namespace emberfold::mcmc
