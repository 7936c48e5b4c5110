// SPDX-License-Identifier: Apache-2.0
#include "graph/matching/chosen_links.hpp"

#include <algorithm>
#include <array>
#include <numeric>
#include <tuple>

#include <boost/pending/disjoint_sets.hpp>

#include "graph/matching/frame_links.hpp"

namespace emberfold::graph::detail {

namespace {

/// The components of two frames, numbered together, and those that links tie.
class Clusters {
 public:
  explicit Clusters(std::size_t count) : rank_(count), parent_(count), sets_(rank_.data(), parent_.data()) {
    std::iota(parent_.begin(), parent_.end(), std::size_t{0});
  }
  void tie(std::size_t a, std::size_t b) { sets_.union_set(a, b); }
  std::size_t of(std::size_t component) { return sets_.find_set(component); }

 private:
  std::vector<std::size_t> rank_, parent_;
  boost::disjoint_sets<std::size_t*, std::size_t*> sets_;
};

/// Number of clusters, and quality, of a set of links in a group of components.
struct Explanation {
  std::size_t clusters = 0;  ///< of tied components: of n components n − 2 · clusters change
  std::size_t links = 0;
  double squares = 0;  ///< of their lengths, px²

  [[nodiscard]] bool is_better_than(const Explanation& other) const {
    return std::tuple(clusters, links, -squares) > std::tuple(other.clusters, other.links, -other.squares);
  }
};

}  // namespace

std::vector<Link> choose_links(const AttributeGraph& before, const AttributeGraph& after,
                               const std::vector<Link>& one, const std::vector<Link>& other) {
  if (one == other) return one;
  const std::array sets{&one, &other};
  const std::array indexed{index_links(before, after, one).links, index_links(before, after, other).links};
  const Components parts_before = components(before), parts_after = components(after);
  const std::size_t count = parts_before.count + parts_after.count;
  const auto component_before = [&](std::uint32_t i) -> std::size_t { return parts_before.of_vertex[i]; };
  const auto component_after = [&](std::uint32_t j) -> std::size_t {
    return parts_before.count + parts_after.of_vertex[j];
  };
  Clusters groups(count);
  std::array clusters{Clusters(count), Clusters(count)};
  for (std::size_t k = 0; k < sets.size(); ++k)
    for (const auto& [i, j] : indexed[k]) {
      groups.tie(component_before(i), component_after(j));
      clusters[k].tie(component_before(i), component_after(j));
    }
  std::array of_group{std::vector<Explanation>(count), std::vector<Explanation>(count)};
  for (std::size_t k = 0; k < sets.size(); ++k) {
    std::vector<bool> is_counted(count, false);
    for (const auto& [i, j] : indexed[k]) {
      const std::size_t from = component_before(i), cluster = clusters[k].of(from);
      Explanation& so_far = of_group[k][groups.of(from)];
      const Point way = after.patch(j).position - before.patch(i).position;
      if (!is_counted[cluster]) ++so_far.clusters;
      is_counted[cluster] = true;
      ++so_far.links;
      so_far.squares += dot(way, way);
    }
  }
  std::vector<Link> chosen;
  for (std::size_t k = 0; k < sets.size(); ++k)
    for (std::size_t n = 0; n < sets[k]->size(); ++n) {
      const std::size_t group = groups.of(component_before(indexed[k][n].first));
      const bool is_other = of_group[1][group].is_better_than(of_group[0][group]);
      if (is_other == (k == 1)) chosen.push_back((*sets[k])[n]);
    }
  std::ranges::sort(chosen);
  return chosen;
}

}  // namespace emberfold::graph::detail
