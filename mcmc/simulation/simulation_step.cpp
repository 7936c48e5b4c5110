// SPDX-License-Identifier: Apache-2.0
#include "mcmc/simulation/simulation_step.hpp"

#include <algorithm>
#include <cmath>

#include "graph/events/events.hpp"
#include "mcmc/learning/hard_core.hpp"
#include "mcmc/learning/stroke_places.hpp"
#include "mcmc/simulation/operators.hpp"

namespace emberfold::mcmc::detail {

namespace {

constexpr int unknown_age = 1000;  // frames: nobody saw them being born

// True if a part of a patch lies in the frame: half its width and two blurs to each side are drawn.
bool is_visible(const graph::Patch& patch, graph::Point step, const MotionModel& model) {
  const double reach = std::clamp(patch.width / 2 + 2 * patch.blur, 1.5, 12.0);
  const graph::Point p = patch.position + step;
  return p.x >= -reach && p.y >= -reach && p.x <= model.width - 1 + reach && p.y <= model.height - 1 + reach;
}

// Moves each rest shape by the drift, as a whole. Removes faded patches, and strokes that are out of sight,
// so that they cannot come back. Returns the number of the latter, which count as deaths.
int carry_strokes(SimulatedStrokes& strokes, const MotionModel& model) {
  std::vector<bool> gone(strokes.list.size());
  int left = 0;
  const auto graph = stroke_graph(strokes);
  for (const auto& stroke : vertices_by_stroke(graph::components(graph))) {
    const graph::Point at = stroke_middle(graph, stroke);
    const graph::Point step{model.drift_x.at(at), model.drift_y.at(at)};
    const bool out = std::ranges::none_of(
        stroke, [&](std::uint32_t v) { return is_visible(graph.patch(v), step, model); });
    if (out && std::ranges::any_of(stroke, [&](std::uint32_t v) { return strokes.list[v].frames_left < 0; }))
      ++left;
    for (const auto v : stroke) {
      SimulatedPatch& simulated = strokes.list[v];
      gone[v] = out || simulated.frames_left == 0;
      if (simulated.frames_left > 0) --simulated.frames_left;
      if (simulated.refractory_left > 0) --simulated.refractory_left;
      ++simulated.age;
      simulated.rest.position = simulated.rest.position + step;
    }
  }
  remove_patches(strokes, gone);
  return left;
}

}  // namespace

SimulatedStrokes initial_strokes(const MotionModel& model, std::uint64_t seed) {
  SimulatedStrokes strokes;
  add_stationary(strokes, model.first, {0, 0}, unknown_age, model, seed);
  for (SimulatedPatch& simulated : strokes.list) scale_contrast(simulated.rest, std::exp(-simulated.gain));
  return strokes;
}

std::array<int, 6> advance_frame(SimulatedStrokes& strokes, const MotionModel& model, std::uint64_t seed,
                                 std::uint32_t frame) {
  step_motion(strokes, model, seed, Purpose::motion, frame);
  const int left = carry_strokes(strokes, model);
  enforce_hard_core(strokes, model);
  auto done = apply_operators(strokes, model, seed, frame);
  done[static_cast<std::size_t>(graph::EventType::death)] += left;
  return done;
}

}  // namespace emberfold::mcmc::detail
