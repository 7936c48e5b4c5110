// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <memory>

#include "core/context.hpp"
#include "graph/motion_graph.hpp"
#include "mcmc/model/motion_model.hpp"

namespace emberfold::mcmc {

/// Start of a clip.
/// data: the two frames in which the model's `first` was observed. stationary: the state after three lives of
/// a stroke (60 to 1000 frames), in which nothing of them is left.
enum class Start { data, stationary };

/// Draws an endless clip of graphs from a model, frame by frame.
/// Equal models and seeds give equal graphs.
class Synthesis {
 public:
  Synthesis(const MotionModel& model, std::uint64_t seed, Start start = Start::data);
  ~Synthesis();
  Synthesis(Synthesis&&) noexcept;
  Synthesis& operator=(Synthesis&&) noexcept;

  /// Returns the next frame.
  /// Patches keep their vertex ids as long as they live; ids are never used again.
  graph::AttributeGraph next();
  /// Returns the operators of the last frame: births, deaths, splits, merges, connects, disconnects.
  [[nodiscard]] const std::array<int, 6>& operators() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// Draws a clip of `frames` ≥ 1 graphs, with links and identified strokes.
/// Throws core::InputError for fewer, core::Cancelled.
graph::MotionGraph synthesize(const MotionModel& model, int frames, std::uint64_t seed,
                              const core::Context& context = {}, Start start = Start::data);

}  // namespace emberfold::mcmc
