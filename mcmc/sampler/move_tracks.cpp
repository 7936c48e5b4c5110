// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <vector>

#include "mcmc/sampler/choose.hpp"
#include "mcmc/sampler/moves.hpp"

namespace emberfold::mcmc {

namespace {

constexpr double kEnd = 0.2;               // probability that a drawn track ends in a frame
constexpr double kAcross = 1, kAlong = 3;  // px: spread of the next candidate about the last one

/// The candidates that may go on a track, and the probability of each; the first is of no candidate, the end.
struct Steps {
  std::vector<Index> to;
  std::vector<double> chances;
};

Steps next_steps(const HiddenGraph& g, Index from) {
  Steps steps{{kNone}, {kEnd}};
  double sum = 0;
  for (std::size_t k = 0; k < g.candidates_after(from).size(); ++k) {
    const Index to = g.candidates_after(from)[k];
    if (!g.can_activate(to)) continue;
    const TransitionOffset& offset = g.offsets(from)[k];
    const double across = offset.across / kAcross, along = offset.along / kAlong;
    steps.to.push_back(to);
    steps.chances.push_back(std::exp(-0.5 * (across * across + along * along)));
    sum += steps.chances.back();
  }
  if (sum < 1e-12) return {{kNone}, {1}};
  for (std::size_t k = 1; k < steps.chances.size(); ++k) steps.chances[k] *= (1 - kEnd) / sum;
  return steps;
}

NormalProposal propose_displacement(const HiddenGraph& g, const Density& density, Index i) {
  const auto law = density.displacement_given_past(g, i);
  return {law.mean, std::sqrt(law.variance)};
}

std::optional<double> add_track(StateChange& change, ChoiceSource& draws, int frame) {
  const HiddenGraph& g = change.state();
  const std::size_t choices = g.inactive(frame).size();
  if (choices == 0) return std::nullopt;
  Index i = g.inactive(frame)[draws.below(choices)], before = kNone;
  if (!g.can_activate(i)) return std::nullopt;
  double chance = 0;
  while (i != kNone) {
    change.activate(i);
    if (before != kNone) change.link(before, i);
    const NormalProposal proposal = propose_displacement(g, change.density(), i);
    const double displacement = draws.normal(proposal.mean, proposal.sd);
    change.set_displacement(i, displacement);
    const Steps steps = next_steps(g, i);
    const std::size_t step = draws.pick(steps.chances);
    chance += proposal.log_density(displacement) + std::log(steps.chances[step]);
    before = i, i = steps.to[step];
  }
  return log_count(choices) - log_count(g.active(frame).size()) - chance;
}

/// Returns the patches of a track from its first one on; none if one of them is joined to others, or linked
/// with several.
std::vector<Index> whole_track(const HiddenGraph& g, Index first) {
  if (!g[first].prev.empty()) return {};
  std::vector<Index> track{first};
  while (g[track.back()].edges.empty() && g[track.back()].next.size() == 1 &&
         g[g[track.back()].next[0]].prev.size() == 1)
    track.push_back(g[track.back()].next[0]);
  const Node& last = g[track.back()];
  return last.edges.empty() && last.next.empty() ? track : std::vector<Index>{};
}

std::optional<double> delete_track(StateChange& change, ChoiceSource& draws, int frame) {
  const HiddenGraph& g = change.state();
  const std::size_t choices = g.active(frame).size();
  if (choices == 0) return std::nullopt;
  auto track = whole_track(g, g.active(frame)[draws.below(choices)]);
  if (track.empty()) return std::nullopt;
  double chance = 0;
  Index after = kNone;
  for (std::size_t k = track.size(); k-- > 0;) {
    const Index i = track[k];
    const Steps steps = next_steps(g, i);
    const auto step = std::ranges::find(steps.to, after) - steps.to.begin();
    if (step == static_cast<std::ptrdiff_t>(steps.to.size())) return std::nullopt;
    chance += propose_displacement(g, change.density(), i).log_density(g[i].displacement) +
              std::log(steps.chances[static_cast<std::size_t>(step)]);
    if (k > 0) change.unlink(track[k - 1], i);
    change.deactivate(i);
    after = i;
  }
  return log_count(choices) - log_count(g.inactive(frame).size()) + chance;
}

}  // namespace

std::optional<double> add_or_delete_track(StateChange& change, ChoiceSource& draws, int frame) {
  return draws.coin() ? add_track(change, draws, frame) : delete_track(change, draws, frame);
}

}  // namespace emberfold::mcmc
