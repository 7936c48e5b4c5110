// SPDX-License-Identifier: Apache-2.0
#include "mcmc/sampler/candidate_weights.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/parallel.hpp"

namespace emberfold::mcmc {

void weigh_candidates(HiddenGraph& state, const Evidence& evidence, const core::Context& context) {
  const auto frames = static_cast<std::size_t>(state.frames());
  std::vector<std::vector<Index>> nodes(frames);
  for (Index i = 0; i < state.size(); ++i) nodes[static_cast<std::size_t>(state[i].frame)].push_back(i);
  core::parallel_for(frames, context, [&](std::size_t t) {
    for (const Index i : nodes[t]) {
      state.set_evidence(i, std::max(0.0, evidence.gain(static_cast<int>(t), state[i].patch)));
      for (const NeighbourCandidate& near : state.neighbours(i))
        if (i < near.node)
          state.set_edge_evidence(i, near.node,
                                  state[i].edges.has(near.node) ? kEdgeEvidence : -kEdgeEvidence);
    }
  });
}

void apply_maps(HiddenGraph& state, const MotionModel& model) {
  double mean = 0;
  for (const double v : model.rates.birth.values) mean += v;
  mean /= static_cast<double>(std::max<std::size_t>(1, model.rates.birth.values.size()));
  for (Index i = 0; i < state.size(); ++i) {
    const graph::Point at = state[i].patch.position;
    const double birth = mean > 0 ? std::max(0.05, model.rates.birth.at(at) / mean) : 1;
    const double death = std::clamp(model.rates.death.at(at), 0.25, 4.0);
    const auto level = static_cast<std::uint8_t>(std::lround(2 * std::log2(death)) + kPlaces / 2);
    state.set_map_values(i, std::log(birth), level, {model.drift_x.at(at), model.drift_y.at(at)});
  }
}

}  // namespace emberfold::mcmc
