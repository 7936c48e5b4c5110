// SPDX-License-Identifier: Apache-2.0
#include "graph/matching/lasting.hpp"

#include <algorithm>
#include <cstdint>
#include <limits>
#include <span>
#include <utility>

#include <boost/pending/disjoint_sets.hpp>

#include "core/math/robust.hpp"

namespace emberfold::graph::detail {

namespace {

constexpr double kMostPersistence = 2;  // largest factor on how long a stroke of low gain has to last

using Sets = boost::disjoint_sets<std::uint8_t*, std::uint32_t*>;

/// Returns the factor on the least duration of a stroke: 1 for patches of median gain, up to 2 for lower
/// gains.
double persistence_factor(double gain, double usual) {
  if (!(usual > 0)) return 1;
  return gain * kMostPersistence <= usual ? kMostPersistence : std::max(1.0, usual / gain);
}

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

Lasting::Lasting(const MotionGraph& motion, int frames, bool weigh_gain) {
  const auto& graphs = motion.sketch.frames;
  std::vector<double> gains;
  for (const AttributeGraph& g : graphs) {
    begin_.push_back(gains.size());
    for (const Vertex& v : g.vertices()) gains.push_back(v.patch.gain);
  }
  const std::size_t n = gains.size();
  struct Whole {
    std::uint32_t first = std::numeric_limits<std::uint32_t>::max(), last = 0, patches = 0;
    double gain = 0;
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
      whole.gain += gains[i], ++whole.patches;
    }
  const double usual = gains.empty() ? 0 : core::median(std::move(gains));
  const std::size_t end = graphs.size() - 1;
  std::vector<bool> lasts;
  for (const Whole& whole : wholes) {
    // It may have lasted longer outside the clip.
    const double least =
        whole.first == 0 || whole.last == end
            ? 1
            : frames * (weigh_gain ? persistence_factor(whole.gain / whole.patches, usual) : 1);
    lasts.push_back(static_cast<double>(whole.last - whole.first + 1) > least);
  }
  for (const std::uint32_t whole : whole_of) lasts_.push_back(lasts[whole]);
}

}  // namespace emberfold::graph::detail
