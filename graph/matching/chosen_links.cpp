// SPDX-License-Identifier: Apache-2.0
#include "graph/matching/chosen_links.hpp"

#include <algorithm>
#include <array>
#include <numeric>
#include <tuple>

#include <boost/pending/disjoint_sets.hpp>

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

/// What a set of links makes of a group of components.
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
  const Components parts_before = components(before), parts_after = components(after);
  const std::size_t count = parts_before.count + parts_after.count;
  const auto component_before = [&](const Link& link) -> std::size_t {
    return parts_before.of_vertex[before.index_of(link.before)];
  };
  const auto component_after = [&](const Link& link) -> std::size_t {
    return parts_before.count + parts_after.of_vertex[after.index_of(link.after)];
  };
  Clusters groups(count);
  std::array clusters{Clusters(count), Clusters(count)};
  for (std::size_t k = 0; k < sets.size(); ++k)
    for (const Link& link : *sets[k]) {
      groups.tie(component_before(link), component_after(link));
      clusters[k].tie(component_before(link), component_after(link));
    }
  std::array<std::vector<Explanation>, 2> of_group{std::vector<Explanation>(count),
                                                   std::vector<Explanation>(count)};
  for (std::size_t k = 0; k < sets.size(); ++k) {
    std::vector<bool> is_counted(count, false);
    for (const Link& link : *sets[k]) {
      const std::size_t from = component_before(link), cluster = clusters[k].of(from);
      Explanation& so_far = of_group[k][groups.of(from)];
      const Point way = after.patch(after.index_of(link.after)).position -
                        before.patch(before.index_of(link.before)).position;
      if (!is_counted[cluster]) ++so_far.clusters;
      is_counted[cluster] = true;
      ++so_far.links;
      so_far.squares += dot(way, way);
    }
  }
  std::vector<Link> chosen;
  for (std::size_t k = 0; k < sets.size(); ++k)
    for (const Link& link : *sets[k]) {
      const std::size_t group = groups.of(component_before(link));
      const bool is_other = of_group[1][group].is_better_than(of_group[0][group]);
      if (is_other == (k == 1)) chosen.push_back(link);
    }
  std::ranges::sort(chosen);
  return chosen;
}

}  // namespace emberfold::graph::detail
