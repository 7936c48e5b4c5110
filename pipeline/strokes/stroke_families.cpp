// SPDX-License-Identifier: Apache-2.0
#include "pipeline/strokes/stroke_families.hpp"

#include <algorithm>
#include <cstdint>

#include <boost/pending/disjoint_sets.hpp>

namespace emberfold::pipeline {

namespace {

constexpr std::size_t kShortestFamily = 3;  // frames: shorter ones are flicker

/// Returns the strokes' ids, ascending.
std::vector<graph::SubgraphId> all_strokes(const SeenClip& clip) {
  std::vector<graph::SubgraphId> ids;
  for (int t = 0; t < clip.size(); ++t)
    for (const auto& vertex : clip.graph(t).vertices()) ids.push_back(vertex.subgraph);
  std::ranges::sort(ids);
  ids.erase(std::unique(ids.begin(), ids.end()), ids.end());
  return ids;
}

std::size_t number_of(graph::SubgraphId id, const std::vector<graph::SubgraphId>& strokes) {
  return static_cast<std::size_t>(std::ranges::lower_bound(strokes, id) - strokes.begin());
}

/// Returns for each of the strokes the index of one that stands for its family.
std::vector<std::size_t> unite_linked(const SeenClip& clip, const std::vector<graph::SubgraphId>& strokes) {
  std::vector<std::size_t> rank(strokes.size()), parent(strokes.size());
  boost::disjoint_sets sets(rank.data(), parent.data());
  for (std::size_t i = 0; i < strokes.size(); ++i) sets.make_set(i);
  for (int t = 1; t < clip.size(); ++t) {
    const auto before = clip.graph(t - 1).vertices(), now = clip.graph(t).vertices();
    const auto from = clip.continued(t - 1, t);
    for (std::size_t v = 0; v < now.size(); ++v)
      if (from[v] >= 0)
        sets.union_set(number_of(before[static_cast<std::size_t>(from[v])].subgraph, strokes),
                       number_of(now[v].subgraph, strokes));
  }
  std::vector<std::size_t> families;
  for (std::size_t i = 0; i < strokes.size(); ++i) families.push_back(sets.find_set(i));
  return families;
}

}  // namespace

StrokeFamilies stroke_families(const SeenClip& clip) {
  const auto strokes = all_strokes(clip);
  const auto families = unite_linked(clip, strokes);
  std::map<std::size_t, StrokeLife> found;
  for (int t = 0; t < clip.size(); ++t) {
    const auto vertices = clip.graph(t).vertices();
    for (std::uint32_t v = 0; v < vertices.size(); ++v) {
      const auto family = families[number_of(vertices[v].subgraph, strokes)];
      auto& life = found.try_emplace(family, StrokeLife{t, {}}).first->second;
      life.patches.resize(static_cast<std::size_t>(t - life.first) + 1);
      life.patches.back().push_back(v);
    }
  }
  std::erase_if(found, [](const auto& one) { return one.second.patches.size() < kShortestFamily; });
  StrokeFamilies result;
  std::map<std::size_t, std::size_t> place;
  for (auto& [family, life] : found) {
    place[family] = result.lives.size();
    result.lives.push_back(std::move(life));
  }
  for (std::size_t i = 0; i < strokes.size(); ++i)
    if (const auto at = place.find(families[i]); at != place.end()) result.of_stroke[strokes[i]] = at->second;
  return result;
}

}  // namespace emberfold::pipeline
