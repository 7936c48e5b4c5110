// SPDX-License-Identifier: Apache-2.0
#include "mcmc/simulation/simulation_step.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "core/rng.hpp"
#include "graph/events/events.hpp"
#include "mcmc/learning/hard_core.hpp"
#include "mcmc/learning/stroke_places.hpp"
#include "mcmc/learning/velocity_modes.hpp"
#include "mcmc/simulation/operators.hpp"
#include "mcmc/simulation/rounding.hpp"

namespace emberfold::mcmc::detail {

namespace {

constexpr int unknown_age = 1000;  // frames: nobody saw them being born
constexpr double kReturn = 0.05;   // a frame, of what carries a patch: without it long strokes crumple

// True if a part of a patch lies in the frame: half its width and two blurs to each side are drawn.
bool is_visible(const graph::Patch& patch, graph::Point step, const MotionModel& model) {
  const double reach = std::clamp(patch.width / 2 + 2 * patch.blur, 1.5, 12.0);
  const graph::Point p = patch.position + step;
  return p.x >= -reach && p.y >= -reach && p.x <= model.width - 1 + reach && p.y <= model.height - 1 + reach;
}

std::vector<double> white(std::size_t count, std::uint64_t seed, std::uint32_t frame) {
  core::Rng rng(seed, {0, 0, (frame << 4U) | (static_cast<std::uint32_t>(Purpose::velocity) << 1U)});
  std::vector<double> values(count);
  for (double& value : values) value = rng.normal();
  return values;
}

std::vector<double> next_amplitudes(const VelocityModes& modes, const std::vector<double>& now,
                                    std::uint64_t seed, std::uint32_t frame) {
  const auto noise = white(modes.count, seed, frame);
  std::vector<double> next(modes.count);
  for (std::size_t i = 0; i < modes.count; ++i) {
    for (std::size_t k = 0; k < modes.count; ++k)
      next[i] += modes.step[i * modes.count + k] * now[k] + modes.noise[i * modes.count + k] * noise[k];
    next[i] = rounded(next[i]);
  }
  return next;
}

// Steps the amplitudes of the velocity modes on by one drawn frame, which may be more or less than one of the
// clip's. Returns the field of velocities about the drift, px a drawn frame; nothing where there are no
// modes.
std::optional<Drift> step_velocity(ModeAmplitudes& amplitudes, const MotionModel& model, std::uint64_t seed,
                                   std::uint32_t frame) {
  const VelocityModes& modes = model.velocity;
  if (modes.count == 0) return {};
  const double pace = model.rates.modifiers.pace;
  if (amplitudes.before.empty()) {
    amplitudes.before = white(modes.count, seed, 0);
    amplitudes.after = next_amplitudes(modes, amplitudes.before, seed, frame << 8U);
  }
  amplitudes.between += pace;
  for (std::uint32_t k = 1; amplitudes.between >= 1; amplitudes.between -= 1, ++k)
    amplitudes.before =
        std::exchange(amplitudes.after, next_amplitudes(modes, amplitudes.after, seed, (frame << 8U) + k));
  std::vector<double> now(modes.count);
  for (std::size_t k = 0; k < now.size(); ++k)
    now[k] = pace * std::lerp(amplitudes.before[k], amplitudes.after[k], amplitudes.between);
  return combine_modes(modes, model.drift_x, now);
}

// Moves each rest shape by the drift, as a whole, and its patches by `velocity`. Removes faded patches, and
// strokes that are out of sight, so that they cannot come back. Returns the number of the latter, which count
// as deaths.
int carry_strokes(SimulatedStrokes& strokes, const MotionModel& model, const std::optional<Drift>& velocity) {
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
      if (!velocity) continue;
      const graph::Point place = graph.patch(v).position,
                         shared{interpolate(velocity->x, place), interpolate(velocity->y, place)},
                         carried = rounded((simulated.carried + shared) * (1 - kReturn));
      simulated.rest.position = simulated.rest.position + carried - simulated.carried;
      simulated.carried = carried;
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
  const int left = carry_strokes(strokes, model, step_velocity(strokes.amplitudes, model, seed, frame));
  enforce_hard_core(strokes, model);
  auto done = apply_operators(strokes, model, seed, frame);
  done[static_cast<std::size_t>(graph::EventType::death)] += left;
  return done;
}

}  // namespace emberfold::mcmc::detail
