// SPDX-License-Identifier: Apache-2.0
#include "mcmc/sampler/candidate_weights.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/parallel.hpp"

namespace emberfold::mcmc {

namespace {

/// Returns the evidence of an edge between two candidates.
double edge_evidence(std::span<const HiddenGraph> states, Index a, Index b) {
  double joined = 0.5, apart = 0.5;
  for (const HiddenGraph& state : states)
    if (state.is_active(a) && state.is_active(b)) (state[a].edges.has(b) ? joined : apart) += 1;
  return kEdgeEvidence * std::log(joined / apart);
}

}  // namespace

void weigh_candidates(std::span<HiddenGraph> states, const Evidence& evidence, const core::Context& context) {
  const HiddenGraph& first = states.front();
  std::vector<std::vector<Index>> nodes(static_cast<std::size_t>(first.frames()));
  for (Index i = 0; i < first.size(); ++i) nodes[static_cast<std::size_t>(first[i].frame)].push_back(i);
  core::parallel_for(nodes.size(), context, [&](std::size_t t) {
    for (const Index i : nodes[t]) {
      const double gain = kGainShare * evidence.gain(static_cast<int>(t), first[i].patch);
      for (HiddenGraph& state : states) state.set_evidence(i, std::clamp(gain, -kMostGain, kMostGain));
      for (const NeighbourCandidate& near : first.neighbours(i)) {
        if (near.node < i) continue;
        const double nats = edge_evidence(states, i, near.node);
        for (HiddenGraph& state : states) state.set_edge_evidence(i, near.node, nats);
      }
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
