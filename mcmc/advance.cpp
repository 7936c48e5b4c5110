// SPDX-License-Identifier: Apache-2.0
#include "mcmc/advance.hpp"

#include <algorithm>

#include "mcmc/operators.hpp"
#include "mcmc/rates.hpp"

namespace emberfold::mcmc::detail {

namespace {

constexpr double margin = 8;  // px beyond the frame where nothing is seen any more

bool in_sight(graph::Point p, const MotionModel& model) {
  return p.x >= -margin && p.y >= -margin && p.x <= model.width - 1 + margin &&
         p.y <= model.height - 1 + margin;
}

// The rest shapes travel, each as a whole. What has faded goes, and strokes of which nothing is in sight.
void carry(Particles& particles, const MotionModel& model) {
  std::vector<bool> gone(particles.list.size());
  const auto graph = shape(particles);
  for (const auto& stroke : strokes(graph::components(graph))) {
    const graph::Point at = middle(graph, stroke);
    const graph::Point step{model.drift_x.at(at), model.drift_y.at(at)};
    const bool out = std::ranges::none_of(
        stroke, [&](std::uint32_t v) { return in_sight(graph.patch(v).position + step, model); });
    for (const auto v : stroke) {
      Particle& particle = particles.list[v];
      gone[v] = out || particle.leaving == 0;
      if (particle.leaving > 0) --particle.leaving;
      ++particle.age;
      particle.rest.position = particle.rest.position + step;
    }
  }
  remove(particles, gone);
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
  carry(particles, model);
  return operate(particles, model, seed, frame);
}

}  // namespace emberfold::mcmc::detail
