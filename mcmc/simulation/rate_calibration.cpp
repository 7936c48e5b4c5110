// SPDX-License-Identifier: Apache-2.0
#include "mcmc/simulation/rate_calibration.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include "graph/events/events.hpp"
#include "mcmc/simulation/simulation_step.hpp"

namespace emberfold::mcmc {

namespace {

using Sizes = std::array<double, kSizeClasses>;

constexpr int rounds = 60;

double sum(const Sizes& sizes) {
  return std::accumulate(sizes.begin(), sizes.end(), 0.0);
}

double births_a_frame(const CellMap& map) {
  return std::accumulate(map.values.begin(), map.values.end(), 0.0) * map.cell * map.cell;
}

// Robbins and Monro's step of the logarithm. It is linear in the counts, so that few events in a round leave
// no bias. `more` damps the correction of rare events.
void correct(double& rate, double want, double have, double more, double step) {
  rate *= std::exp(step * std::clamp((want - have) / (want + more), -1.5, 1.5));
}

// All corrected numbers. The result is their geometric mean over the later rounds (Polyak and Juditsky 1992),
// since a round has few events and strokes outlive it.
class Controls {
 public:
  Controls(Sizes& births, OperatorRates& rates) {
    for (double& birth : births) add(birth, 1e3);
    for (double& death : rates.death_by_size) add(death, 1);
    for (double* rate : {&rates.split, &rates.merge, &rates.connect, &rates.disconnect}) add(*rate, 1);
  }
  void bound() {
    for (auto& control : all_) *control.value = std::min(*control.value, control.most);
  }
  void note() {
    for (auto& control : all_) control.logs += std::log(*control.value);
    ++noted_;
  }
  void average() {
    for (auto& control : all_) *control.value = std::exp(control.logs / noted_);
  }

 private:
  struct Control {
    double* value = nullptr;
    double most = 1, logs = 0;
  };
  void add(double& value, double most) { all_.push_back({&value, most}); }
  std::vector<Control> all_;
  int noted_ = 0;
};

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
  for (std::size_t s = 0; s < kSizeClasses; ++s) model.rates.birth_by_size[s] = shares[s] / whole;
}

void calibrate_rates(MotionModel& model, EventStatistics wanted, std::uint64_t seed,
                     const core::Context& context) {
  reconcile_event_rates(wanted);
  Sizes births = births_by_size(model);
  if (sum(births) <= 0) return;
  auto& rates = model.rates;
  Controls controls(births, rates);
  const int frames = detail::frames_per_round(model, rounds);
  auto strokes = detail::initial_strokes(model, seed);
  for (int round = 0; round < rounds; ++round) {
    context.check();
    const auto first = static_cast<std::uint32_t>(1 + round * frames);
    const EventStatistics seen = detail::simulate_statistics(strokes, model, seed, first, frames);
    const double step = 0.4 / (1 + 0.05 * round);
    const auto keep_frequency = [&](graph::EventType type, double& rate) {
      const auto i = static_cast<std::size_t>(type);
      correct(rate, wanted.events[i], seen.events[i], 1.0 / frames, step);
    };
    // Sizes with too few strokes get more births and fewer deaths. The total number of patches counts, too,
    // as strokes unite and come apart.
    for (std::size_t s = 0; s < kSizeClasses; ++s) {
      correct(births[s], wanted.strokes[s], seen.strokes[s], 0.5, step);
      correct(births[s], wanted.patches, seen.patches, 5, step);
      keep_frequency(graph::EventType::birth, births[s]);
      correct(rates.death_by_size[s], wanted.strokes[s], seen.strokes[s], 0.5, -step);
      keep_frequency(graph::EventType::death, rates.death_by_size[s]);
    }
    keep_frequency(graph::EventType::split, rates.split);
    keep_frequency(graph::EventType::disconnect, rates.disconnect);
    keep_frequency(graph::EventType::merge, rates.merge);
    keep_frequency(graph::EventType::connect, rates.connect);
    controls.bound();
    if (round >= rounds / 2) controls.note();
    if (round + 1 == rounds) controls.average();
    set_births(model, births, wanted.strokes);
    context.report("balance", (round + 1.0) / rounds);
  }
}

}  // namespace emberfold::mcmc
