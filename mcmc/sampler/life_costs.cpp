// SPDX-License-Identifier: Apache-2.0
#include "mcmc/sampler/life_costs.hpp"

#include <algorithm>
#include <numeric>

#include <boost/pending/disjoint_sets.hpp>

#include "graph/events/believed_lives.hpp"

namespace emberfold::mcmc::detail {

namespace {

bool is_birth(const Change& change) {
  return change.before.empty();
}
bool is_death(const Change& change) {
  return change.after.empty();
}

}  // namespace

template <class Take>
void LifeCosts::for_lives(std::span<const std::uint32_t> strands, const ChangeState& state,
                          const Take& take) {
  const std::uint32_t before = call_;
  for (const std::uint32_t s : strands) {
    const std::uint32_t node = node_of_[s];
    if (seen_[node] > before) continue;
    ++call_;
    take(node, cost_of_life(node, state));
  }
}

void LifeCosts::Extent::add(const Extent& other) {
  comes_in = other.first < first ? other.comes_in : comes_in || (other.first == first && other.comes_in);
  goes_out = other.last > last ? other.goes_out : goes_out || (other.last == last && other.goes_out);
  first = std::min(first, other.first), last = std::max(last, other.last);
  patches += other.patches, closed += other.closed, frames += other.frames;
}

LifeCosts::LifeCosts(const ChangeField& field, const std::vector<bool>& open, const ChangeState& state)
    : field_(field), node_of_(field.strands.size()) {
  std::vector<bool> can_happen = open;
  for (std::size_t k = 0; k < can_happen.size(); ++k) can_happen[k] = can_happen[k] || state.happened[k];
  join_strands(can_happen);
  for (std::uint32_t k = 0; k < field.changes.size(); ++k) {
    const Change& change = field.changes[k];
    const auto nodes = [&](const std::vector<std::uint32_t>& side) {
      return side.empty() ? std::array{0u, 0u} : std::array{node_of_[side.front()], node_of_[side.back()]};
    };
    changes_.push_back(
        {change.frame, is_birth(change), is_death(change), nodes(change.before), nodes(change.after)});
    if (!can_happen[k]) continue;
    for (const auto* side : {&change.before, &change.after})
      for (const std::uint32_t s : *side)
        if (auto& changes = nodes_[node_of_[s]].changes; changes.empty() || changes.back() != k)
          changes.push_back(k);
  }
  for (std::uint32_t g = 0; g < field.gaps.size(); ++g)
    for (const std::uint32_t s :
         {field.changes[field.gaps[g].death].before[0], field.changes[field.gaps[g].birth].after[0]})
      nodes_[node_of_[s]].gaps.push_back(g);
  seen_.assign(nodes_.size(), 0), life_of_.assign(nodes_.size(), 0), cost_.assign(nodes_.size(), 0);
  std::vector<std::uint32_t> all(field.strands.size());
  std::iota(all.begin(), all.end(), 0u);
  note(all, state);
}

void LifeCosts::join_strands(const std::vector<bool>& can_happen) {
  const std::size_t count = field_.strands.size();
  std::vector<std::size_t> rank(count), parent(count);
  boost::disjoint_sets parts(rank.data(), parent.data());
  for (std::size_t s = 0; s < count; ++s) parts.make_set(s);
  // Strands that begin or end by no change, of which nothing is known, come in and go out.
  std::vector<bool> begins(count), ends(count);
  for (std::size_t k = 0; k < field_.changes.size(); ++k) {
    const Change& change = field_.changes[k];
    for (const std::uint32_t s : change.after) begins[s] = true;
    for (const std::uint32_t s : change.before) ends[s] = true;
    if (can_happen[k] || is_birth(change) || is_death(change)) continue;
    for (const auto* side : {&change.before, &change.after})
      for (const std::uint32_t s : *side) parts.union_set(std::size_t{change.before[0]}, std::size_t{s});
  }
  std::vector<std::size_t> node_of_root(count, count);
  for (std::uint32_t s = 0; s < count; ++s) {
    std::size_t& node = node_of_root[parts.find_set(std::size_t{s})];
    if (node == count) node = nodes_.size(), nodes_.emplace_back();
    node_of_[s] = static_cast<std::uint32_t>(node);
    const Strand& strand = field_.strands[s];
    nodes_[node].extent.add({strand.first, strand.last, strand.comes_in || !begins[s],
                             strand.goes_out || !ends[s], strand.patches, strand.closed,
                             static_cast<std::size_t>(strand.last - strand.first + 1)});
  }
}

void LifeCosts::visit(std::uint32_t node) {
  if (std::uint32_t& seen = seen_[node]; seen != call_) seen = call_, life_.push_back(node);
}

double LifeCosts::cost_of_life(std::uint32_t node, const ChangeState& state) {
  seen_[node] = call_;
  life_ = {node};
  happened_.clear();
  Extent life;
  for (std::size_t i = 0; i < life_.size(); ++i) {
    const Node& one = nodes_[life_[i]];
    life.add(one.extent);
    for (const std::uint32_t k : one.changes) {
      const NodesOfChange& change = changes_[k];
      if (state.happened[k])
        happened_.push_back(k);
      else if (!change.is_birth && !change.is_death)
        visit(change.before[0]), visit(change.before[1]), visit(change.after[0]), visit(change.after[1]);
    }
    for (const std::uint32_t g : one.gaps)
      if (state.bridged[g])
        visit(changes_[field_.gaps[g].death].before[0]), visit(changes_[field_.gaps[g].birth].after[0]);
  }
  const graph::detail::Life shape{.frames = life.frames, .patches = life.patches, .closed = life.closed};
  const bool is_thing = shape.is_thing();
  bool begins = life.comes_in, ends = life.goes_out;
  double beginning = 0, end = 0, misplaced = 0;  // costs
  for (const std::uint32_t k : happened_) {
    const NodesOfChange& change = changes_[k];
    const auto is_here = [&](std::uint32_t n) { return seen_[n] == call_; };
    const bool at_first = !change.is_death && change.frame == life.first &&
                          std::ranges::any_of(change.after, is_here),
               at_last = !change.is_birth && change.frame == life.last + 1 &&
                         std::ranges::any_of(change.before, is_here);
    begins |= at_first, ends |= at_last;
    if (at_first) beginning = std::max(beginning, change.is_birth ? kLifeCost : kPartCost);
    if (at_last) end = std::max(end, change.is_death ? kLifeCost : kPartCost);
    if ((change.is_birth && !at_first) || (change.is_death && !at_last)) misplaced += kLifeCost;
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
  for_lives(strands, state, [&](std::uint32_t node, double cost) {
    cost_[node] = cost;
    for (const std::uint32_t n : life_) life_of_[n] = node;
  });
}

double LifeCosts::of(std::span<const std::uint32_t> strands, const ChangeState& state) {
  double sum = 0;
  for_lives(strands, state, [&](std::uint32_t, double cost) { sum += cost; });
  return sum;
}

double LifeCosts::noted_of_all() const {
  double sum = 0;
  for (std::uint32_t node = 0; node < nodes_.size(); ++node)
    if (life_of_[node] == node) sum += cost_[node];
  return sum;
}

}  // namespace emberfold::mcmc::detail
