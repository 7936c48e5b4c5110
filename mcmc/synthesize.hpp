// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

#include "core/context.hpp"
#include "graph/motion_graph.hpp"
#include "mcmc/motion_model.hpp"

namespace emberfold::mcmc {

/// An endless clip of graphs drawn from a model, frame by frame. The same model and seed give the same graphs.
class Synthesis {
 public:
  Synthesis(const MotionModel& model, std::uint64_t seed);
  ~Synthesis();
  Synthesis(Synthesis&&) noexcept;
  Synthesis& operator=(Synthesis&&) noexcept;

  struct Frame {
    graph::AttributeGraph graph;  ///< ids are the patches' own, kept as long as they live
  };
  Frame next();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

struct SynthesisResult {
  graph::MotionGraph motion;  ///< with links and identified strokes
  core::Status status = core::Status::done;
};
/// `frames` ≥ 1 frames.
SynthesisResult synthesize(const MotionModel& model, int frames, std::uint64_t seed, const core::Context& context = {});

/// The graph expected one frame after `frame`, which is at least the second: every patch goes on by its AR
/// from where it is in frames `frame` − 1 and `frame`, nothing is born or dies.
graph::AttributeGraph predict(const MotionModel& model, const graph::MotionGraph& motion, int frame);

}  // namespace emberfold::mcmc
