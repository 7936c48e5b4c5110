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

constexpr int rounds = 30, frames_a_round = 60;
constexpr double most_patches = 8e5;  // in all frames: of dense clips fewer are simulated

// What some frames of a simulated clip show, a frame.
struct Shown {
  Sizes strokes{};
  std::array<double, 6> operators{};
  double patches = 0;
};

Shown simulate(detail::Particles& particles, const MotionModel& model, std::uint64_t seed,
               std::uint32_t first, int frames) {
  Shown shown;
  for (int t = 0; t < frames; ++t) {
    const auto done = detail::advance(particles, model, seed, first + static_cast<std::uint32_t>(t));
    shown.patches += static_cast<double>(particles.list.size()) / frames;
    for (std::size_t i = 0; i < done.size(); ++i) shown.operators[i] += double(done[i]) / frames;
    for (const auto& stroke : strokes(graph::components(detail::shape(particles))))
      shown.strokes[size_class(stroke.size())] += 1.0 / frames;
  }
  return shown;
}

double sum(const Sizes& sizes) {
  return std::accumulate(sizes.begin(), sizes.end(), 0.0);
}

// Births a frame, of each size.
void set_births(MotionModel& model, const Sizes& births, const Sizes& usual) {
  auto& map = model.rates.birth;
  double mass = 0;
  for (const double value : map.values) mass += value * map.cell * map.cell;
  const double all = sum(births);
  if (mass <= 0) {
    mass = static_cast<double>(map.values.size()) * map.cell * map.cell;
    std::ranges::fill(map.values, 1.0);
  }
  for (double& value : map.values) value *= all / mass;
  // Where nothing is ever born, what is lost is made up for by what is usual.
  const Sizes& shares = all > 0 ? births : usual;
  const double whole = std::max(sum(shares), 1e-300);
  for (std::size_t s = 0; s < kSizes; ++s) model.rates.birth_by_size[s] = shares[s] / whole;
}

}  // namespace

std::vector<std::string> balance(MotionModel& model, const Sizes& seen, const OperatorCounts& counts,
                                 std::uint64_t seed, const core::Context& context) {
  Sizes wanted{}, births{};
  std::array<bool, kSizes> known{};
  for (const auto& exemplar : model.exemplars) known[size_class(exemplar.graph.size())] = true;
  for (std::size_t s = 0; s < kSizes; ++s) {
    wanted[s] = counts.death[s].could / counts.gaps;
    // Of a size nobody saw being born, as many as die.
    if (known[s]) births[s] = std::max(seen[s] / counts.gaps, wanted[s] * model.rates.death_by_size[s]);
  }
  const double usual = std::accumulate(model.density.values.begin(), model.density.values.end(), 0.0);
  const double measured = sum(seen) / counts.gaps;
  set_births(model, births, wanted);
  auto& rates = model.rates;
  const OperatorRates learned = rates;
  const double patches = std::max(1.0, static_cast<double>(model.first.size()));
  const int frames = std::clamp(static_cast<int>(most_patches / rounds / patches), 4, frames_a_round);
  auto particles = detail::begin(model, seed);
  // One clip is simulated on and on while its rates are corrected, by less and less.
  for (int round = 0; round < rounds && !context.cancelled() && sum(births) > 0; ++round) {
    const auto first = static_cast<std::uint32_t>(1 + round * frames);
    const Shown shown = simulate(particles, model, seed, first, frames);
    const double step = 0.5 / (1 + 0.15 * round);
    // One stroke, or event, more on both sides: what hardly occurs is not worth chasing.
    const auto correct = [&](double& rate, double want, double have, double more) {
      rate *= std::pow(std::clamp((want + more) / (have + more), 0.25, 4.0), step);
    };
    // Each size by itself and, as strokes grow together and fall into pieces, with more weight the patches of
    // all together.
    for (std::size_t s = 0; s < kSizes; ++s) {
      correct(births[s], wanted[s], shown.strokes[s], 0.5);
      correct(births[s], usual * usual, shown.patches * shown.patches, 25);
    }
    // Where it is crowded patches are taken away more often than was learned: not so as to shorten lives, ...
    const auto keep_frequency = [&](graph::EventType type, double& rate, double most) {
      const auto i = static_cast<std::size_t>(type);
      correct(rate, counts.events[i] / counts.gaps, shown.operators[i], 1.0 / frames);
      rate = std::min(rate, most);
    };
    for (std::size_t s = 0; s < kSizes; ++s)
      keep_frequency(graph::EventType::death, rates.death_by_size[s], learned.death_by_size[s]);
    keep_frequency(graph::EventType::split, rates.split, learned.split);
    keep_frequency(graph::EventType::disconnect, rates.disconnect, learned.disconnect);
    // ... and what brings some is to happen as often as it was seen.
    keep_frequency(graph::EventType::merge, rates.merge, 1);
    keep_frequency(graph::EventType::connect, rates.connect, 1);
    set_births(model, births, wanted);
    context.report("balance", (round + 1.0) / rounds);
  }
  const double ratio = measured > 0 ? sum(births) / measured : 1;
  if (ratio < 0.5 || ratio > 1.5)
    return {"births are drawn " + std::to_string(ratio) +
            " times as often as they were seen, so that the number of strokes stays"};
  return {};
}

}  // namespace emberfold::mcmc
