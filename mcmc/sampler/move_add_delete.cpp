// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>

#include "mcmc/sampler/choose.hpp"
#include "mcmc/sampler/moves.hpp"

namespace emberfold::mcmc {

namespace {

/// Probability that an added patch is joined to one beside it.
constexpr std::array<double, kCloseness> kEdgeChance = {0.8, 0.4, 0.4, 0.1, 0.1, 0.05};
constexpr double kNoLinkChance = 0.15;  // probability of no predecessor although one is possible

struct Connections {
  ShortList<kMostEdges> edges;
  bool too_many = false;  ///< edges were drawn that it has no room for
  Index prev = kNone, next = kNone;
};

/// Draws the connections of a patch that is off, or computes the log probability of given ones.
class ConnectionChance {
 public:
  ConnectionChance(const HiddenGraph& g, Index i) : g_(g), i_(i) {}

  double draw(ChoiceSource& draws, Connections& connections) {
    double sum = 0;
    for (const NeighbourCandidate& b : g_.neighbours(i_)) {
      if (!can_add_edge(b.node)) continue;
      const double p = kEdgeChance[b.closeness];
      const bool join = draws.pick(std::array{1 - p, p}) == 1;
      sum += log_join(b.closeness, join);
      if (!join) continue;
      if (connections.edges.full())
        connections.too_many = true;
      else
        connections.edges.push(b.node);
    }
    connections.prev = draw_one(
        draws, g_.candidates_before(i_), [&](Index j) { return is_free_before(j); }, sum);
    connections.next = draw_one(
        draws, g_.candidates_after(i_), [&](Index j) { return is_free_after(j); }, sum);
    return sum;
  }
  [[nodiscard]] double log_chance(const Connections& connections) const {
    double sum = 0;
    for (const NeighbourCandidate& b : g_.neighbours(i_))
      if (can_add_edge(b.node)) sum += log_join(b.closeness, connections.edges.has(b.node));
    const std::size_t before = count_if(g_.candidates_before(i_), [&](Index j) { return is_free_before(j); });
    const std::size_t after = count_if(g_.candidates_after(i_), [&](Index j) { return is_free_after(j); });
    return sum + log_link_chance(before, connections.prev != kNone) +
           log_link_chance(after, connections.next != kNone);
  }

 private:
  [[nodiscard]] bool can_add_edge(Index j) const { return g_.is_active(j) && g_.has_room(j); }
  [[nodiscard]] bool is_free_before(Index j) const { return g_.is_active(j) && !g_.has_future(j); }
  [[nodiscard]] bool is_free_after(Index j) const { return g_.is_active(j) && !g_.has_past(j); }
  static double log_join(std::size_t closeness, bool join) {
    static const auto logs = [] {
      std::array<std::array<double, 2>, kCloseness> table{};
      for (std::size_t k = 0; k < kCloseness; ++k)
        table[k] = {std::log(1 - kEdgeChance[k]), std::log(kEdgeChance[k])};
      return table;
    }();
    return logs[closeness][join ? 1 : 0];
  }
  [[nodiscard]] static double log_link_chance(std::size_t choices, bool linked) {
    static const double untied = std::log(kNoLinkChance), not_untied = std::log1p(-kNoLinkChance);
    if (choices == 0) return 0;
    return linked ? not_untied - log_count(choices) : untied;
  }
  template <class Keep>
  static Index draw_one(ChoiceSource& draws, std::span<const Index> list, Keep keep, double& sum) {
    const std::size_t choices = count_if(list, keep);
    if (choices == 0) return kNone;
    const bool linked = draws.pick(std::array{kNoLinkChance, 1 - kNoLinkChance}) == 1;
    sum += log_link_chance(choices, linked);
    return linked ? nth(list, draws.below(choices), keep) : kNone;
  }

  const HiddenGraph& g_;
  Index i_;
};

/// Predicts the displacement of an added patch from those of its partners.
NormalProposal propose_displacement(const HiddenGraph& g, const Density& density, Index i,
                                    const Connections& connections) {
  double sum = 0, count = 0;
  for (const Index j : {connections.prev, connections.next})
    if (j != kNone) sum += sense(g[i], g[j]) * g[j].displacement, count += 1;
  const auto& displacement = density.theta().displacement;
  if (count > 0) return {sum / count, 2 * displacement.noise};
  for (const Index j : connections.edges) sum += sense(g[i], g[j]) * g[j].displacement, count += 1;
  return {count > 0 ? sum / count : 0, density.stationary_sd()};
}
std::optional<double> add_patch(StateChange& change, ChoiceSource& draws, int frame) {
  const HiddenGraph& g = change.state();
  const std::size_t choices = g.inactive(frame).size();
  if (choices == 0) return std::nullopt;
  const Index i = g.inactive(frame)[draws.below(choices)];
  if (!g.can_activate(i)) return std::nullopt;
  Connections connections;
  const double chance = ConnectionChance(g, i).draw(draws, connections);
  if (connections.too_many) return std::nullopt;
  const NormalProposal proposal = propose_displacement(g, change.density(), i, connections);
  const double displacement = draws.normal(proposal.mean, proposal.sd);
  change.activate(i);
  change.set_displacement(i, displacement);
  for (const Index j : connections.edges) change.add_edge(i, j);
  if (connections.prev != kNone) change.link(connections.prev, i);
  if (connections.next != kNone) change.link(i, connections.next);
  return log_count(choices) - log_count(g.active(frame).size()) - chance - proposal.log_density(displacement);
}

std::optional<double> delete_patch(StateChange& change, ChoiceSource& draws, int frame) {
  const HiddenGraph& g = change.state();
  const std::size_t choices = g.active(frame).size();
  if (choices == 0) return std::nullopt;
  const Index i = g.active(frame)[draws.below(choices)];
  Connections connections;
  for (const auto* links : {&g[i].prev, &g[i].next}) {
    if (links->empty()) continue;
    const Index j = (*links)[0];
    if (links->size() > 1 || (links == &g[i].prev ? g[j].next : g[j].prev).size() > 1) return std::nullopt;
    (links == &g[i].prev ? connections.prev : connections.next) = j;
  }
  connections.edges = g[i].edges;
  const double displacement = g[i].displacement;
  if (connections.prev != kNone) change.unlink(connections.prev, i);
  if (connections.next != kNone) change.unlink(i, connections.next);
  for (const Index j : connections.edges) change.remove_edge(i, j);
  change.deactivate(i);
  const NormalProposal proposal = propose_displacement(g, change.density(), i, connections);
  return log_count(choices) - log_count(g.inactive(frame).size()) +
         ConnectionChance(g, i).log_chance(connections) + proposal.log_density(displacement);
}

}  // namespace

std::optional<double> add_or_delete(StateChange& change, ChoiceSource& draws, int frame) {
  return draws.coin() ? add_patch(change, draws, frame) : delete_patch(change, draws, frame);
}

}  // namespace emberfold::mcmc
