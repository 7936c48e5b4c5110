// SPDX-License-Identifier: Apache-2.0
#include "pipeline/figures/figure_labelling.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include <boost/graph/adjacency_list.hpp>
#include <boost/graph/boykov_kolmogorov_max_flow.hpp>

namespace emberfold::pipeline {

namespace {

constexpr double kRounding = 1e-9;  // nats

using Traits = boost::adjacency_list_traits<boost::vecS, boost::vecS, boost::directedS>;
struct Unit {
  boost::default_color_type color = boost::white_color;
  long distance = 0;
  Traits::edge_descriptor predecessor;
};
struct Arc {
  double capacity = 0, residual = 0;
  Traits::edge_descriptor reverse;
};
using Network = boost::adjacency_list<boost::vecS, boost::vecS, boost::directedS, Unit, Arc>;

void connect(Network& network, std::size_t from, std::size_t to, double there, double back) {
  const auto on = boost::add_edge(from, to, network).first,
             reverse = boost::add_edge(to, from, network).first;
  network[on].capacity = there, network[on].reverse = reverse;
  network[reverse].capacity = back, network[reverse].reverse = on;
}

std::vector<char> minimum_cut(const Labelling& of) {
  const std::size_t count = of.gain.size(), source = count, sink = count + 1;
  Network network(count + 2);
  for (std::size_t i = 0; i < count; ++i) {
    connect(network, source, i, std::max(0., of.gain[i]), 0);
    connect(network, i, sink, std::max(0., -of.gain[i]), 0);
  }
  for (const LabelStar& star : of.stars)
    for (const std::size_t part : star.parts) connect(network, star.whole, part, of.change, of.change);
  boost::boykov_kolmogorov_max_flow(network, boost::get(&Arc::capacity, network),
                                    boost::get(&Arc::residual, network), boost::get(&Arc::reverse, network),
                                    boost::get(&Unit::predecessor, network),
                                    boost::get(&Unit::color, network), boost::get(&Unit::distance, network),
                                    boost::get(boost::vertex_index, network), source, sink);
  std::vector<char> labels;
  for (std::size_t i = 0; i < count; ++i) labels.push_back(network[i].color == boost::black_color ? 1 : 0);
  return labels;
}

}  // namespace

std::vector<char> best_labels(const Labelling& of) {
  std::vector<char> labels = minimum_cut(of);
  std::vector<std::vector<std::size_t>> stars_of(labels.size());
  for (std::size_t k = 0; k < of.stars.size(); ++k) {
    stars_of[of.stars[k].whole].push_back(k);
    for (const std::size_t part : of.stars[k].parts)
      if (stars_of[part].empty() || stars_of[part].back() != k) stars_of[part].push_back(k);
  }
  // The terms of the energy that unit i is in.
  const auto energy = [&](std::size_t i) {
    double sum = labels[i] != 0 ? -of.gain[i] : 0;
    for (const std::size_t k : stars_of[i]) {
      int parts = 0;
      for (const std::size_t part : of.stars[k].parts) parts += labels[part];
      sum += of.change * std::abs(parts - labels[of.stars[k].whole]);
    }
    return sum;
  };
  const auto turn = [](char& label) { label = label == 0 ? char{1} : char{0}; };
  for (bool better = true; better;) {
    better = false;
    for (std::size_t i = 0; i < labels.size(); ++i) {
      const double before = energy(i);
      turn(labels[i]);
      if (energy(i) < before - kRounding)
        better = true;
      else
        turn(labels[i]);
    }
  }
  return labels;
}

}  // namespace emberfold::pipeline
