// SPDX-License-Identifier: Apache-2.0
#include "mcmc/advance.hpp"

#include "mcmc/operators.hpp"
#include "mcmc/rates.hpp"

namespace emberfold::mcmc::detail {

namespace {

// The rest shapes travel, each as a whole.
void travel(Particles& particles, const MotionModel& model) {
  const auto graph = shape(particles);
  for (const auto& stroke : strokes(graph::components(graph))) {
    const graph::Point at = middle(graph, stroke);
    const graph::Point step{model.drift_x.at(at), model.drift_y.at(at)};
    for (const auto v : stroke) particles.list[v].rest.position = particles.list[v].rest.position + step;
  }
}

}  // namespace

Particles begin(const MotionModel& model, std::uint64_t seed) {
  Particles particles;
  add_settled(particles, model.first, {0, 0}, static_cast<int>(model.appearing.size()), model, seed);
  return particles;
}

std::array<int, 6> advance(Particles& particles, const MotionModel& model, std::uint64_t seed,
                           std::uint32_t frame) {
  sway(particles, model, seed, Purpose::motion, frame);
  travel(particles, model);
  age(particles, model);
  return operate(particles, model, seed, frame);
}

}  // namespace emberfold::mcmc::detail
