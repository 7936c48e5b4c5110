// SPDX-License-Identifier: Apache-2.0
#include "graph/matching/lasting.hpp"

#include <algorithm>
#include <cstdint>
#include <limits>
#include <span>
#include <utility>

#include <boost/pending/disjoint_sets.hpp>

namespace emberfold::graph::detail {

namespace {

using Sets = boost::disjoint_sets<std::uint8_t*, std::uint32_t*>;

/// Joins what edges and links connect; vertices are numbered through the clip.
void unite_components(const MotionGraph& motion, std::span<const std::size_t> begin, Sets& wholes) {
  const auto& frames = motion.sketch.frames;
  const auto number = [&](std::size_t t, VertexId id) {
    return static_cast<std::uint32_t>(begin[t] + frames[t].index_of(id));
  };
  for (std::size_t t = 0; t < frames.size(); ++t) {
    for (const Edge& e : frames[t].edges()) wholes.union_set(number(t, e.a), number(t, e.b));
    for (const Link& l : motion.links[t]) wholes.union_set(number(t - 1, l.before), number(t, l.after));
  }
}

}  // namespace

Lasting::Lasting(const MotionGraph& motion, int frames) {
  const auto& graphs = motion.sketch.frames;
  std::size_t n = 0;
  for (const AttributeGraph& g : graphs) begin_.push_back(std::exchange(n, n + g.size()));
  struct Whole {
    std::uint32_t first = std::numeric_limits<std::uint32_t>::max(), last = 0;
  };
  std::vector<std::uint8_t> rank(n);
  std::vector<std::uint32_t> parent(n);
  Sets sets(rank.data(), parent.data());
  for (std::uint32_t i = 0; i < n; ++i) sets.make_set(i);
  unite_components(motion, begin_, sets);
  std::vector<std::uint32_t> whole_of(n);  // vertex
  std::vector<Whole> wholes;
  for (std::uint32_t i = 0; i < n; ++i)
    if (sets.find_set(i) == i) {
      whole_of[i] = static_cast<std::uint32_t>(wholes.size());
      wholes.emplace_back();
    }
  for (std::uint32_t i = 0; i < n; ++i) whole_of[i] = whole_of[sets.find_set(i)];
  for (std::uint32_t t = 0; t < graphs.size(); ++t)
    for (std::size_t i = begin_[t]; i < begin_[t] + graphs[t].size(); ++i) {
      Whole& whole = wholes[whole_of[i]];
      whole.first = std::min(whole.first, t), whole.last = std::max(whole.last, t);
    }
  const std::size_t end = graphs.size() - 1;
  std::vector<bool> lasts;
  for (const Whole& whole : wholes) {
    const bool may_be_cut_off = whole.first == 0 || whole.last == end;  // it may have lasted longer
    lasts.push_back(static_cast<int>(whole.last - whole.first) >= (may_be_cut_off ? 1 : frames));
  }
  for (const std::uint32_t whole : whole_of) lasts_.push_back(lasts[whole]);
}

}  // namespace emberfold::graph::detail
