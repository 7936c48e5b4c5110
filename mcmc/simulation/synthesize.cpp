// SPDX-License-Identifier: Apache-2.0
#include "mcmc/simulation/synthesize.hpp"

#include <algorithm>
#include <numeric>
#include <string>
#include <utility>

#include "core/error.hpp"
#include "mcmc/simulation/linked_frames.hpp"
#include "mcmc/simulation/simulation_step.hpp"

namespace emberfold::mcmc {

namespace {

// Frames until hardly any of the initial strokes is left: three mean lives, 60…1000.
std::uint32_t running_in(const MotionModel& model) {
  const auto& birth = model.rates.birth;
  const double births =
      std::accumulate(birth.values.begin(), birth.values.end(), 0.0) * birth.cell * birth.cell;
  const auto strokes = static_cast<double>(graph::components(model.first).count);
  return static_cast<std::uint32_t>(std::clamp(3 * strokes / std::max(births, 1e-3), 60.0, 1000.0));
}

}  // namespace

struct Synthesis::State {
  MotionModel model;
  std::uint64_t seed = 1;
  detail::SimulatedStrokes strokes;
  std::uint32_t frame = 0;
  bool shown = false;
  std::array<int, 6> operators{};
};

Synthesis::Synthesis(const MotionModel& model, std::uint64_t seed, Start start)
    : state_(std::make_unique<State>()) {
  validate(model);
  state_->model = model;
  state_->seed = seed;
  state_->strokes = detail::initial_strokes(model, seed);
  if (start == Start::data) return;
  for (auto left = running_in(model); left > 0; --left)
    (void)detail::advance_frame(state_->strokes, model, seed, ++state_->frame);
}

Synthesis::~Synthesis() = default;
Synthesis::Synthesis(Synthesis&&) noexcept = default;
Synthesis& Synthesis::operator=(Synthesis&&) noexcept = default;

graph::AttributeGraph Synthesis::next() {
  auto& [model, seed, strokes, frame, shown, operators] = *state_;
  if (shown) operators = detail::advance_frame(strokes, model, seed, ++frame);
  shown = true;
  return detail::drawn_graph(strokes, model);
}

const std::array<int, 6>& Synthesis::operators() const {
  return state_->operators;
}

graph::MotionGraph synthesize(const MotionModel& model, int frames, std::uint64_t seed,
                              const core::Context& context, Start start) {
  if (frames < 1) throw core::InputError("frames is " + std::to_string(frames) + "; allowed is 1 and more");
  detail::LinkedFrames linked;
  auto& motion = linked.motion;
  motion.sketch.width = model.width, motion.sketch.height = model.height, motion.sketch.fps = model.fps;
  Synthesis synthesis(model, seed, start);
  for (int t = 0; t < frames; ++t) {
    context.check();
    linked.append(synthesis.next());
    context.report("synthesize", (t + 1.0) / frames);
  }
  return graph::identify(std::move(motion));
}

}  // namespace emberfold::mcmc
