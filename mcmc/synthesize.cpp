// SPDX-License-Identifier: Apache-2.0
#include "mcmc/synthesize.hpp"

#include <string>

#include "core/error.hpp"
#include "mcmc/advance.hpp"

namespace emberfold::mcmc {

namespace {

// What goes on from one frame to the next: the ids that both have.
std::vector<graph::Link> links_between(const graph::AttributeGraph& before,
                                       const graph::AttributeGraph& after) {
  std::vector<graph::Link> links;
  for (const auto& vertex : before.vertices())
    if (after.index_of(vertex.id) < after.size()) links.push_back({vertex.id, vertex.id});
  return links;
}

}  // namespace

struct Synthesis::State {
  MotionModel model;
  std::uint64_t seed = 1;
  detail::Particles particles;
  std::uint32_t frame = 0;
  std::array<int, 6> operators{};
};

Synthesis::Synthesis(const MotionModel& model, std::uint64_t seed) : state_(std::make_unique<State>()) {
  validate(model);
  state_->model = model;
  state_->seed = seed;
  state_->particles = detail::begin(model, seed);
}

Synthesis::~Synthesis() = default;
Synthesis::Synthesis(Synthesis&&) noexcept = default;
Synthesis& Synthesis::operator=(Synthesis&&) noexcept = default;

graph::AttributeGraph Synthesis::next() {
  auto& [model, seed, particles, frame, operators] = *state_;
  if (frame > 0) operators = detail::advance(particles, model, seed, frame);
  ++frame;
  return detail::appearance(particles, model);
}

const std::array<int, 6>& Synthesis::operators() const {
  return state_->operators;
}

SynthesisResult synthesize(const MotionModel& model, int frames, std::uint64_t seed,
                           const core::Context& context) {
  if (frames < 1) throw core::InputError("frames is " + std::to_string(frames) + "; allowed is 1 and more");
  SynthesisResult result;
  auto& motion = result.motion;
  motion.sketch.width = model.width, motion.sketch.height = model.height, motion.sketch.fps = model.fps;
  Synthesis synthesis(model, seed);
  graph::AttributeGraph before;
  for (int t = 0; t < frames; ++t) {
    if (context.cancelled()) {
      result.status = core::Status::cancelled;
      break;
    }
    const graph::AttributeGraph graph = synthesis.next();
    auto links = t > 0 ? links_between(before, graph) : std::vector<graph::Link>{};
    motion.sketch.append(graph);
    // Ids as the sequence numbers them.
    if (t > 0) {
      const auto& frame_before = motion.sketch.frames[static_cast<std::size_t>(t) - 1];
      for (auto& link : links)
        link = {frame_before.vertices()[before.index_of(link.before)].id,
                motion.sketch.frames.back().vertices()[graph.index_of(link.after)].id};
    }
    motion.links.push_back(std::move(links));
    before = graph;
    context.report("synthesize", (t + 1.0) / frames);
  }
  motion = graph::identify(std::move(motion));
  return result;
}

}  // namespace emberfold::mcmc
