// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <memory>

#include "core/context.hpp"
#include "graph/motion_graph.hpp"
#include "mcmc/model/motion_model.hpp"

namespace emberfold::mcmc {

/// Where a clip begins: with the two frames that the model's `first` was seen in, or in the stationary state:
/// run in for three lives of a stroke (60 to 1000 frames), so that nothing is left of them.
enum class Start { data, stationary };

/// An endless clip of graphs drawn from a model, frame by frame. The same model and seed give the same
/// graphs.
class Synthesis {
 public:
  Synthesis(const MotionModel& model, std::uint64_t seed, Start start = Start::data);
  ~Synthesis();
  Synthesis(Synthesis&&) noexcept;
  Synthesis& operator=(Synthesis&&) noexcept;

  /// Vertex ids are the patches' own: kept from frame to frame as long as they live, never used again.
  graph::AttributeGraph next();
  /// How many operators were carried out in the last frame: births, deaths, splits, merges, connects,
  /// disconnects.
  [[nodiscard]] const std::array<int, 6>& operators() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// Draws a clip of `frames` ≥ 1 graphs, with links and identified strokes. Throws core::InputError for fewer,
/// core::Cancelled.
graph::MotionGraph synthesize(const MotionModel& model, int frames, std::uint64_t seed,
                           const core::Context& context = {}, Start start = Start::data);

}  // namespace emberfold::mcmc
