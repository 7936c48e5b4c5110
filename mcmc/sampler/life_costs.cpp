// SPDX-License-Identifier: Apache-2.0
#include "mcmc/sampler/life_costs.hpp"

#include <algorithm>
#include <numeric>
#include <set>

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
  list_changes(can_happen);
  seen_.assign(nodes_.size(), 0), life_of_.assign(nodes_.size(), 0), cost_.assign(nodes_.size(), 0);
  std::vector<std::uint32_t> all(field.strands.size());
  std::iota(all.begin(), all.end(), 0u);
  of(all, state);
  note();
}

void LifeCosts::list_changes(const std::vector<bool>& can_happen) {
  for (std::uint32_t k = 0; k < field_.changes.size(); ++k) {
    const Change& change = field_.changes[k];
    const auto nodes = [&](const std::vector<std::uint32_t>& side) {
      return side.empty() ? std::array{0u, 0u} : std::array{node_of_[side.front()], node_of_[side.back()]};
    };
    changes_.push_back(
        {change.frame, is_birth(change), is_death(change), nodes(change.before), nodes(change.after)});
    if (!can_happen[k]) continue;
    std::set<std::uint32_t> concerned;
    for (const auto* side : {&change.before, &change.after})
      for (const std::uint32_t s : *side) concerned.insert(node_of_[s]);
    for (const std::uint32_t n : concerned) {
      nodes_[n].changes.push_back(k);
      for (const std::uint32_t other : concerned)
        if (other != n && !is_birth(change) && !is_death(change)) nodes_[n].joints.push_back({k, other});
    }
  }
  for (std::uint32_t g = 0; g < field_.gaps.size(); ++g)
    for (const std::uint32_t s :
         {field_.changes[field_.gaps[g].death].before[0], field_.changes[field_.gaps[g].birth].after[0]})
      nodes_[node_of_[s]].gaps.push_back(g);
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

double LifeCosts::cost_of_life(std::uint32_t node, const ChangeState& state) {
  const std::size_t begin = found_nodes_.size();
  const std::uint32_t number = ++seen_lives_;
  const auto visit = [&](std::uint32_t n) {
    if (seen_[n] != number) seen_[n] = number, found_nodes_.push_back(n);
  };
  visit(node);
  Extent life;
  for (std::size_t i = begin; i < found_nodes_.size(); ++i) {
    const Node& one = nodes_[found_nodes_[i]];
    life.add(one.extent);
    for (const Joint& joint : one.joints)
      if (!state.happened[joint.change]) visit(joint.node);
    for (const std::uint32_t g : one.gaps)
      if (state.bridged[g])
        visit(changes_[field_.gaps[g].death].before[0]), visit(changes_[field_.gaps[g].birth].after[0]);
  }
  const graph::detail::Life shape{.frames = life.frames, .patches = life.patches, .closed = life.closed};
  const bool is_thing = shape.is_thing();
  bool begins = life.comes_in, ends = life.goes_out;
  double beginning = 0, end = 0, misplaced = 0;  // costs
  const auto is_here = [&](std::uint32_t n) { return seen_[n] == number; };
  const auto add = [&](const NodesOfChange& change) {
    const bool at_first = !change.is_death && change.frame == life.first &&
                          std::ranges::any_of(change.after, is_here),
               at_last = !change.is_birth && change.frame == life.last + 1 &&
                         std::ranges::any_of(change.before, is_here);
    begins |= at_first, ends |= at_last;
    if (at_first) beginning = std::max(beginning, change.is_birth ? kLifeCost : kPartCost);
    if (at_last) end = std::max(end, change.is_death ? kLifeCost : kPartCost);
    if ((change.is_birth && !at_first) || (change.is_death && !at_last)) misplaced += kLifeCost;
  };
  for (std::size_t i = begin; i < found_nodes_.size(); ++i)
    for (const std::uint32_t k : nodes_[found_nodes_[i]].changes)
      if (state.happened[k]) add(changes_[k]);
  return misplaced + (is_thing || ends ? 0 : beginning) + (is_thing || begins ? 0 : end);
}

double LifeCosts::of(std::span<const std::uint32_t> strands, const ChangeState& state) {
  double sum = 0;
  found_.clear(), found_nodes_.clear();
  const std::uint32_t before = seen_lives_;
  for (const std::uint32_t s : strands) {
    if (seen_[node_of_[s]] > before) continue;
    const double cost = cost_of_life(node_of_[s], state);
    found_.push_back({found_nodes_.size(), cost});
    sum += cost;
  }
  return sum;
}

void LifeCosts::note() {
  std::size_t i = 0;
  for (const Life& life : found_) {
    const std::uint32_t first = found_nodes_[i];
    cost_[first] = life.cost;
    for (; i < life.end; ++i) life_of_[found_nodes_[i]] = first;
  }
}

double LifeCosts::noted(std::span<const std::uint32_t> strands) {
  double sum = 0;
  ++seen_lives_;
  for (const std::uint32_t s : strands) {
    const std::uint32_t life = life_of_[node_of_[s]];
    if (seen_[life] != seen_lives_) seen_[life] = seen_lives_, sum += cost_[life];
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
