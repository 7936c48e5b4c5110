// SPDX-License-Identifier: Apache-2.0
#include "mcmc/balance.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "graph/events.hpp"
#include "mcmc/advance.hpp"

namespace emberfold::mcmc {

namespace {

using Sizes = std::array<double, kSizes>;

constexpr int rounds = 30;

double sum(const Sizes& sizes) {
  return std::accumulate(sizes.begin(), sizes.end(), 0.0);
}

double births_a_frame(const CellMap& map) {
  return std::accumulate(map.values.begin(), map.values.end(), 0.0) * map.cell * map.cell;
}

// One stroke, or event, more on both sides: what hardly occurs is not worth chasing.
void correct(double& rate, double want, double have, double more, double step) {
  rate *= std::pow(std::clamp((want + more) / (have + more), 0.25, 4.0), step);
}

}  // namespace

Sizes births_by_size(const MotionModel& model) {
  Sizes births = model.rates.birth_by_size;
  for (double& value : births) value *= births_a_frame(model.rates.birth);
  return births;
}

void set_births(MotionModel& model, const Sizes& births, const Sizes& otherwise) {
  auto& map = model.rates.birth;
  double mass = births_a_frame(map);
  const double all = sum(births);
  if (mass <= 0) {
    mass = static_cast<double>(map.values.size()) * map.cell * map.cell;
    std::ranges::fill(map.values, 1.0);
  }
  for (double& value : map.values) value *= all / mass;
  const Sizes& shares = all > 0 ? births : otherwise;
  const double whole = std::max(sum(shares), 1e-300);
  for (std::size_t s = 0; s < kSizes; ++s) model.rates.birth_by_size[s] = shares[s] / whole;
}

void balance(MotionModel& model, Census wanted, std::uint64_t seed, const core::Context& context) {
  reconcile(wanted);
  Sizes births = births_by_size(model);
  auto& rates = model.rates;
  const int frames = detail::frames_a_round(model, rounds);
  auto particles = detail::begin(model, seed);
  for (int round = 0; round < rounds && !context.cancelled() && sum(births) > 0; ++round) {
    const auto first = static_cast<std::uint32_t>(1 + round * frames);
    const Census shown = detail::simulate(particles, model, seed, first, frames);
    const double step = 0.5 / (1 + 0.15 * round);
    // Each size by itself and, as strokes grow together and fall into pieces, with more weight the patches of
    // all together.
    for (std::size_t s = 0; s < kSizes; ++s) {
      correct(births[s], wanted.strokes[s], shown.strokes[s], 0.5, step);
      correct(births[s], wanted.patches * wanted.patches, shown.patches * shown.patches, 25, step);
    }
    const auto keep_frequency = [&](graph::EventType type, double& rate) {
      const auto i = static_cast<std::size_t>(type);
      correct(rate, wanted.events[i], shown.events[i], 1.0 / frames, step);
      rate = std::min(rate, 1.0);
    };
    for (double& rate : rates.death_by_size) keep_frequency(graph::EventType::death, rate);
    keep_frequency(graph::EventType::split, rates.split);
    keep_frequency(graph::EventType::disconnect, rates.disconnect);
    keep_frequency(graph::EventType::merge, rates.merge);
    keep_frequency(graph::EventType::connect, rates.connect);
    set_births(model, births, wanted.strokes);
    context.report("balance", (round + 1.0) / rounds);
  }
}

}  // namespace emberfold::mcmc
