// SPDX-License-Identifier: Apache-2.0
#include "mcmc/simulation/simulation_step.hpp"

#include <algorithm>

#include "graph/events/events.hpp"
#include "mcmc/learning/hard_core.hpp"
#include "mcmc/learning/operator_rates.hpp"
#include "mcmc/simulation/operators.hpp"

namespace emberfold::mcmc::detail {

namespace {

constexpr int long_ago = 1000;  // frames: nobody saw them being born

// Whether anything of a patch is drawn in the frame: it shows half its width and two blurs to each side.
bool in_sight(const graph::Patch& patch, graph::Point step, const MotionModel& model) {
  const double reach = std::clamp(patch.width / 2 + 2 * patch.blur, 1.5, 12.0);
  const graph::Point p = patch.position + step;
  return p.x >= -reach && p.y >= -reach && p.x <= model.width - 1 + reach && p.y <= model.height - 1 + reach;
}

// The rest shapes travel, each as a whole. What has faded goes, and strokes of which nothing is in sight, so
// that they cannot come back. Returns how many left like that: whoever watches sees them die.
int carry(Particles& particles, const MotionModel& model) {
  std::vector<bool> gone(particles.list.size());
  int left = 0;
  const auto graph = shape(particles);
  for (const auto& stroke : strokes(graph::components(graph))) {
    const graph::Point at = middle(graph, stroke);
    const graph::Point step{model.drift_x.at(at), model.drift_y.at(at)};
    const bool out =
        std::ranges::none_of(stroke, [&](std::uint32_t v) { return in_sight(graph.patch(v), step, model); });
    if (out && std::ranges::any_of(stroke, [&](std::uint32_t v) { return particles.list[v].leaving < 0; }))
      ++left;
    for (const auto v : stroke) {
      Particle& particle = particles.list[v];
      gone[v] = out || particle.leaving == 0;
      if (particle.leaving > 0) --particle.leaving;
      if (particle.held > 0) --particle.held;
      ++particle.age;
      particle.rest.position = particle.rest.position + step;
    }
  }
  remove(particles, gone);
  return left;
}

}  // namespace

Particles begin(const MotionModel& model, std::uint64_t seed) {
  Particles particles;
  add_settled(particles, model.first, {0, 0}, long_ago, model, seed);
  for (std::size_t v = 0; v < model.first_swing.size(); ++v) {
    const Swing& seen = model.first_swing[v];
    Particle& particle = particles.list[v];
    particle.offset = seen.offset, particle.offset_before = seen.offset_before;
    particle.gain = seen.gain, particle.gain_before = seen.gain_before;
  }
  return particles;
}

std::array<int, 6> advance(Particles& particles, const MotionModel& model, std::uint64_t seed,
                           std::uint32_t frame) {
  sway(particles, model, seed, Purpose::motion, frame);
  const int left = carry(particles, model);
  keep_apart(particles, model);
  auto done = operate(particles, model, seed, frame);
  done[static_cast<std::size_t>(graph::EventType::death)] += left;
  return done;
}

}  // namespace emberfold::mcmc::detail
