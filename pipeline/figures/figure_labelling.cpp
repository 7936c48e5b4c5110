// SPDX-License-Identifier: Apache-2.0
#include "pipeline/figures/figure_labelling.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "core/math/minimum_cut.hpp"

namespace emberfold::pipeline {

namespace {

constexpr double kRounding = 1e-9;  // nats

// A unit has its label where it is on the first side.
std::vector<char> minimum_cut(const Labelling& of) {
  core::MinimumCut cut(of.gain.size());
  for (std::size_t i = 0; i < of.gain.size(); ++i)
    cut.add_costs(i, std::max(0., -of.gain[i]), std::max(0., of.gain[i]));
  for (const LabelStar& star : of.stars)
    for (const std::size_t part : star.parts) cut.add_edge(star.whole, part, of.change, of.change);
  cut.solve();
  std::vector<char> labels;
  for (std::size_t i = 0; i < of.gain.size(); ++i) labels.push_back(cut.is_second(i) ? 0 : 1);
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
