// SPDX-License-Identifier: Apache-2.0
#include "mcmc/sampler/change_moves.hpp"

#include <algorithm>
#include <set>
#include <utility>

namespace emberfold::mcmc::detail {

namespace {

using Pair = std::pair<std::uint32_t, std::uint32_t>;
using Lists = std::vector<std::vector<std::uint32_t>>;

/// Members of changes and gaps that begin and end strands, in one direction of time.
struct Direction {
  std::vector<std::uint32_t> Change::*from, Change::*to;
  std::uint32_t Gap::*leaves, Gap::*enters;
};
constexpr Direction kForward = {&Change::before, &Change::after, &Gap::death, &Gap::birth},
                    kBackward = {&Change::after, &Change::before, &Gap::birth, &Gap::death};

/// Pairs each open change with those that end what it begins, in this direction of time.
void add_pairs(const ChangeField& field, const std::vector<bool>& open, const Direction& way,
               std::set<Pair>& pairs) {
  Lists ends(field.strands.size()), gaps(field.strands.size());
  for (std::uint32_t k = 0; k < field.changes.size(); ++k)
    for (const std::uint32_t s : field.changes[k].*way.from) ends[s].push_back(k);
  for (const Gap& gap : field.gaps)
    gaps[(field.changes[gap.*way.leaves].*way.from)[0]].push_back(
        (field.changes[gap.*way.enters].*way.to)[0]);
  for (std::uint32_t k = 0; k < field.changes.size(); ++k) {
    if (!open[k]) continue;
    std::vector<std::uint32_t> strands = field.changes[k].*way.to;
    std::size_t found = 0;
    const auto add = [&](std::uint32_t s) {
      if (std::ranges::find(strands, s) == strands.end()) strands.push_back(s);
    };
    for (std::size_t i = 0; i < std::min(strands.size(), kMostStrands) && found < kMostPairs; ++i) {
      const std::uint32_t strand = strands[i];
      for (const std::uint32_t end : ends[strand]) {
        if (open[end] && end != k) pairs.insert(std::minmax(k, end)), ++found;
        for (const std::uint32_t s : field.changes[end].*way.to) add(s);
      }
      for (const std::uint32_t s : gaps[strand]) add(s);
    }
  }
}

/// Completes a move: its kind and its strands.
ChangeMove make_move(const ChangeField& field, std::vector<std::uint32_t> changes,
                     std::optional<std::uint32_t> gap) {
  std::set<std::uint32_t> strands;
  const auto add = [&](const std::vector<std::uint32_t>& some) { strands.insert(some.begin(), some.end()); };
  for (const std::uint32_t k : changes) add(field.changes[k].before), add(field.changes[k].after);
  if (gap)
    add(field.changes[field.gaps[*gap].death].before), add(field.changes[field.gaps[*gap].birth].after);
  const std::size_t kind =
      gap ? kMoveNames.size() - 1 : static_cast<std::size_t>(field.changes[changes.front()].type);
  return {kind, std::move(changes), gap, {strands.begin(), strands.end()}};
}

}  // namespace

std::vector<ChangeMove> change_moves(const ChangeField& field, const std::vector<bool>& open) {
  std::vector<ChangeMove> moves;
  for (std::uint32_t k = 0; k < field.changes.size(); ++k)
    if (open[k]) moves.push_back(make_move(field, {k}, {}));
  std::set<Pair> pairs;
  add_pairs(field, open, kForward, pairs);
  add_pairs(field, open, kBackward, pairs);
  for (const Gap& gap : field.gaps)
    if (open[gap.death] && open[gap.birth]) pairs.insert(std::minmax(gap.death, gap.birth));
  for (const auto& [a, b] : pairs) moves.push_back(make_move(field, {a, b}, {}));
  for (std::uint32_t g = 0; g < field.gaps.size(); ++g) {
    const Pair ends = std::minmax(field.gaps[g].death, field.gaps[g].birth);
    moves.push_back(make_move(field, {}, g));
    for (const std::uint32_t k : {ends.first, ends.second})
      if (open[k]) moves.push_back(make_move(field, {k}, g));
    if (open[ends.first] && open[ends.second])
      moves.push_back(make_move(field, {ends.first, ends.second}, g));
  }
  return moves;
}

}  // namespace emberfold::mcmc::detail
