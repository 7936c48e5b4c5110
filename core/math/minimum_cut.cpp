// SPDX-License-Identifier: Apache-2.0
#include "core/math/minimum_cut.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>

#include <boost/graph/boykov_kolmogorov_max_flow.hpp>
#include <boost/graph/compressed_sparse_row_graph.hpp>

namespace emberfold::core {

namespace {

using Network = boost::compressed_sparse_row_graph<boost::directedS, boost::no_property, boost::no_property,
                                                   boost::no_property, std::uint32_t, std::uint32_t>;
using NetworkEdge = boost::graph_traits<Network>::edge_descriptor;

}  // namespace

void MinimumCut::add_costs(std::size_t node, double on_first, double on_second) {
  // A node on the first side is cut from the second terminal.
  double& room = room_[node];
  if (room > 0)
    on_second += room;
  else
    on_first -= room;
  common_ += std::min(on_first, on_second);
  room = on_second - on_first;
}

void MinimumCut::add_edge(std::size_t a, std::size_t b, double cost, double reverse_cost) {
  arcs_.push_back({a, b, cost});
  arcs_.push_back({b, a, reverse_cost});
}

double MinimumCut::solve() {
  const std::size_t nodes = room_.size(), first = nodes, second = nodes + 1;
  for (std::size_t i = 0; i < nodes; ++i)
    if (room_[i] != 0) add_edge(room_[i] > 0 ? first : i, room_[i] > 0 ? i : second, std::abs(room_[i]), 0);
  // Arcs by the node that they leave: of the k-th, place[k] is the index in the network.
  std::vector<std::uint32_t> next(nodes + 3), place(arcs_.size());
  for (const Arc& arc : arcs_) ++next[arc.from + 1];
  for (std::size_t i = 1; i < next.size(); ++i) next[i] += next[i - 1];
  for (std::size_t k = 0; k < arcs_.size(); ++k) place[k] = next[arcs_[k].from]++;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> ends(arcs_.size());
  std::vector<double> capacity(arcs_.size()), left(arcs_.size());
  std::vector<NetworkEdge> reverse(arcs_.size());
  for (std::size_t k = 0; k < arcs_.size(); ++k) {
    const Arc& arc = arcs_[k];
    ends[place[k]] = {static_cast<std::uint32_t>(arc.from), static_cast<std::uint32_t>(arc.to)};
    capacity[place[k]] = arc.capacity;
    reverse[place[k]] = NetworkEdge(static_cast<std::uint32_t>(arc.to), place[k ^ 1]);
  }
  const Network network(boost::edges_are_sorted, ends.begin(), ends.end(),
                        static_cast<std::uint32_t>(nodes + 2));
  const auto edge_index = boost::get(boost::edge_index, network);
  const auto vertex_index = boost::get(boost::vertex_index, network);
  std::vector<NetworkEdge> parent(nodes + 2);
  std::vector<boost::default_color_type> side(nodes + 2);
  std::vector<std::uint32_t> distance(nodes + 2);
  const auto of_edge = [&](auto& values) {
    return boost::make_iterator_property_map(values.begin(), edge_index);
  };
  const auto of_vertex = [&](auto& values) {
    return boost::make_iterator_property_map(values.begin(), vertex_index);
  };
  const double flow = boost::boykov_kolmogorov_max_flow(
      network, of_edge(capacity), of_edge(left), of_edge(reverse), of_vertex(parent), of_vertex(side),
      of_vertex(distance), vertex_index, static_cast<std::uint32_t>(first),
      static_cast<std::uint32_t>(second));
  second_.resize(nodes);
  for (std::size_t i = 0; i < nodes; ++i) second_[i] = side[i] != boost::black_color;
  return common_ + flow;
}

}  // namespace emberfold::core
