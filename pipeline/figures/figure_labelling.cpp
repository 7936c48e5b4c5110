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
  // Units of the second class are on the side of the source where they are 0, which makes rivals an arc.
  for (std::size_t i = 0; i < count; ++i) {
    const double on = i < of.second ? of.gain[i] : -of.gain[i];
    connect(network, source, i, std::max(0., on), 0);
    connect(network, i, sink, std::max(0., -on), 0);
  }
  for (const LabelStar& star : of.stars)
    for (const std::size_t part : star.parts) connect(network, star.whole, part, of.change, of.change);
  for (const LabelRivals& pair : of.rivals) connect(network, pair.first, pair.second, pair.cost, 0);
  boost::boykov_kolmogorov_max_flow(network, boost::get(&Arc::capacity, network),
                                    boost::get(&Arc::residual, network), boost::get(&Arc::reverse, network),
                                    boost::get(&Unit::predecessor, network),
                                    boost::get(&Unit::color, network), boost::get(&Unit::distance, network),
                                    boost::get(boost::vertex_index, network), source, sink);
  std::vector<char> labels;
  for (std::size_t i = 0; i < count; ++i) {
    const bool with_source = network[i].color == boost::black_color;
    labels.push_back(with_source == (i < of.second) ? 1 : 0);
  }
  return labels;
}

/// The terms of a labelling that each unit is in.
class Energy {
 public:
  explicit Energy(const Labelling& of) : of_(of), stars_of_(of.gain.size()), rivals_of_(of.gain.size()) {
    for (std::size_t k = 0; k < of.stars.size(); ++k) {
      stars_of_[of.stars[k].whole].push_back(k);
      for (const std::size_t part : of.stars[k].parts)
        if (stars_of_[part].empty() || stars_of_[part].back() != k) stars_of_[part].push_back(k);
    }
    for (std::size_t k = 0; k < of.rivals.size(); ++k)
      rivals_of_[of.rivals[k].first].push_back(k), rivals_of_[of.rivals[k].second].push_back(k);
  }

  /// Returns the sum of the terms that unit i is in.
  [[nodiscard]] double of_unit(std::size_t i, const std::vector<char>& labels) const {
    double sum = labels[i] != 0 ? -of_.gain[i] : 0;
    for (const std::size_t k : stars_of_[i]) sum += of_star(of_.stars[k], labels);
    for (const std::size_t k : rivals_of_[i]) sum += of_pair(of_.rivals[k], labels);
    return sum;
  }

 private:
  [[nodiscard]] double of_star(const LabelStar& star, const std::vector<char>& labels) const {
    int parts = 0;
    for (const std::size_t part : star.parts) parts += labels[part];
    return of_.change * std::abs(parts - labels[star.whole]);
  }
  static double of_pair(const LabelRivals& pair, const std::vector<char>& labels) {
    return labels[pair.first] != 0 && labels[pair.second] != 0 ? pair.cost : 0;
  }

  const Labelling& of_;
  std::vector<std::vector<std::size_t>> stars_of_, rivals_of_;  // by unit
};

}  // namespace

std::vector<char> best_labels(const Labelling& of) {
  std::vector<char> labels = minimum_cut(of);
  const Energy energy(of);
  const auto other = [](char label) { return label == 0 ? char{1} : char{0}; };
  for (bool better = true; better;) {
    better = false;
    for (std::size_t i = 0; i < labels.size(); ++i) {
      const double before = energy.of_unit(i, labels);
      labels[i] = other(labels[i]);
      if (energy.of_unit(i, labels) < before - kRounding)
        better = true;
      else
        labels[i] = other(labels[i]);
    }
  }
  return labels;
}

}  // namespace emberfold::pipeline
