// SPDX-License-Identifier: Apache-2.0
#include "mcmc/sampler/life_costs.hpp"

#include <algorithm>
#include <numeric>

#include <boost/pending/disjoint_sets.hpp>

namespace emberfold::mcmc::detail {

namespace {

constexpr double kThing = 20;  // patches a frame, about 100 px

bool is_birth(const Change& change) {
  return change.before.empty();
}
bool is_death(const Change& change) {
  return change.after.empty();
}

}  // namespace

LifeCosts::LifeCosts(const ChangeField& field, const std::vector<bool>& open, const ChangeState& state)
    : field_(field), node_of_(field.strands.size()) {
  const std::size_t count = field.strands.size();
  std::vector<std::size_t> rank(count), parent(count);
  boost::disjoint_sets parts(rank.data(), parent.data());
  for (std::size_t s = 0; s < count; ++s) parts.make_set(s);
  // Strands that begin or end by no change, of which nothing is known, come in and go out.
  std::vector<bool> begins(count), ends(count);
  for (std::size_t k = 0; k < field.changes.size(); ++k) {
    const Change& change = field.changes[k];
    for (const std::uint32_t s : change.after) begins[s] = true;
    for (const std::uint32_t s : change.before) ends[s] = true;
    if (open[k] || state.happened[k] || is_birth(change) || is_death(change)) continue;
    for (const auto* side : {&change.before, &change.after})
      for (const std::uint32_t s : *side) parts.union_set(std::size_t{change.before[0]}, std::size_t{s});
  }
  std::vector<std::uint32_t> node_of_root(count, static_cast<std::uint32_t>(count));
  for (std::uint32_t s = 0; s < count; ++s) {
    std::uint32_t& node = node_of_root[parts.find_set(std::size_t{s})];
    const Strand& strand = field.strands[s];
    if (node == count) {
      node = static_cast<std::uint32_t>(nodes_.size());
      nodes_.push_back({.first = strand.first, .last = strand.last});
    }
    node_of_[s] = node;
    Node& all = nodes_[node];
    const bool comes_in = strand.comes_in || !begins[s], goes_out = strand.goes_out || !ends[s];
    all.comes_in =
        strand.first < all.first ? comes_in : all.comes_in || (strand.first == all.first && comes_in);
    all.goes_out = strand.last > all.last ? goes_out : all.goes_out || (strand.last == all.last && goes_out);
    all.first = std::min(all.first, strand.first), all.last = std::max(all.last, strand.last);
    all.patches += strand.patches, all.closed += strand.closed;
    all.frames += strand.last - strand.first + 1;
  }
  for (std::uint32_t k = 0; k < field.changes.size(); ++k) {
    if (!open[k] && !state.happened[k]) continue;
    for (const auto* side : {&field.changes[k].before, &field.changes[k].after})
      for (const std::uint32_t s : *side)
        if (auto& changes = nodes_[node_of_[s]].changes; changes.empty() || changes.back() != k)
          changes.push_back(k);
  }
  for (std::uint32_t g = 0; g < field.gaps.size(); ++g)
    for (const std::uint32_t s :
         {field.changes[field.gaps[g].death].before[0], field.changes[field.gaps[g].birth].after[0]})
      nodes_[node_of_[s]].gaps.push_back(g);
  seen_.assign(nodes_.size(), 0), life_of_.assign(nodes_.size(), 0), cost_.assign(nodes_.size(), 0);
  std::vector<std::uint32_t> all(count);
  std::iota(all.begin(), all.end(), 0u);
  note(all, state);
}

void LifeCosts::visit(std::span<const std::uint32_t> strands) {
  for (const std::uint32_t s : strands)
    if (std::uint32_t& seen = seen_[node_of_[s]]; seen != call_) seen = call_, life_.push_back(node_of_[s]);
}

double LifeCosts::cost_of_life(std::uint32_t node, const ChangeState& state) {
  seen_[node] = call_;
  life_ = {node};
  Node life = {.first = nodes_[node].first, .last = nodes_[node].last};
  for (std::size_t i = 0; i < life_.size(); ++i) {
    const Node& one = nodes_[life_[i]];
    life.comes_in =
        one.first < life.first ? one.comes_in : life.comes_in || (one.first == life.first && one.comes_in);
    life.goes_out =
        one.last > life.last ? one.goes_out : life.goes_out || (one.last == life.last && one.goes_out);
    life.first = std::min(life.first, one.first), life.last = std::max(life.last, one.last);
    life.patches += one.patches, life.closed += one.closed, life.frames += one.frames;
    for (const std::uint32_t k : one.changes)
      if (!state.happened[k] && !is_birth(field_.changes[k]) && !is_death(field_.changes[k]))
        visit(field_.changes[k].before), visit(field_.changes[k].after);
    for (const std::uint32_t g : one.gaps)
      if (state.bridged[g])
        visit(field_.changes[field_.gaps[g].death].before), visit(field_.changes[field_.gaps[g].birth].after);
  }
  const bool is_thing = 2 * life.closed > life.frames && life.patches > kThing * life.frames;
  bool begins = life.comes_in, ends = life.goes_out;
  double beginning = 0, end = 0, misplaced = 0;  // costs
  for (const std::uint32_t n : life_)
    for (const std::uint32_t k : nodes_[n].changes) {
      const Change& change = field_.changes[k];
      if (!state.happened[k]) continue;
      const auto is_here = [&](std::uint32_t s) { return seen_[node_of_[s]] == call_; };
      const bool at_first = change.frame == life.first && std::ranges::any_of(change.after, is_here),
                 at_last = change.frame == life.last + 1 && std::ranges::any_of(change.before, is_here);
      begins |= at_first, ends |= at_last;
      if (at_first) beginning = std::max(beginning, is_birth(change) ? kLifeCost : kPartCost);
      if (at_last) end = std::max(end, is_death(change) ? kLifeCost : kPartCost);
      if ((is_birth(change) && !at_first) || (is_death(change) && !at_last)) misplaced += kLifeCost;
    }
  return misplaced + (is_thing || ends ? 0 : beginning) + (is_thing || begins ? 0 : end);
}

double LifeCosts::noted(std::span<const std::uint32_t> strands) {
  double sum = 0;
  ++call_;
  for (const std::uint32_t s : strands) {
    const std::uint32_t life = life_of_[node_of_[s]];
    if (seen_[life] != call_) seen_[life] = call_, sum += cost_[life];
  }
  return sum;
}

void LifeCosts::note(std::span<const std::uint32_t> strands, const ChangeState& state) {
  const std::uint32_t before = call_;
  for (const std::uint32_t s : strands) {
    const std::uint32_t node = node_of_[s];
    if (seen_[node] > before) continue;
    ++call_;
    cost_[node] = cost_of_life(node, state);
    for (const std::uint32_t n : life_) life_of_[n] = node;
  }
}

double LifeCosts::of(std::span<const std::uint32_t> strands, const ChangeState& state) {
  double sum = 0;
  const std::uint32_t before = call_;
  for (const std::uint32_t s : strands) {
    if (seen_[node_of_[s]] > before) continue;
    ++call_;
    sum += cost_of_life(node_of_[s], state);
  }
  return sum;
}

double LifeCosts::noted_of_all() const {
  double sum = 0;
  for (std::uint32_t node = 0; node < nodes_.size(); ++node)
    if (life_of_[node] == node) sum += cost_[node];
  return sum;
}

}  // namespace emberfold::mcmc::detail
