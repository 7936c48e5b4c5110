// SPDX-License-Identifier: Apache-2.0
#include "mcmc/simulation/edit_population.hpp"

#include <algorithm>
#include <cmath>

#include "graph/events/events.hpp"
#include "mcmc/learning/drift.hpp"
#include "mcmc/simulation/rate_calibration.hpp"
#include "mcmc/simulation/simulation_step.hpp"

namespace emberfold::mcmc::detail {

namespace {

using graph::EventType;

constexpr int rounds = 30, last_rounds = 15;  // the means of the last ones are what notes are made of
constexpr int looks = 20, first_looks = 5;    // at what a model shows; the first are not counted
constexpr double usual_spread = 2;            // cells, as density is learned

void scale_rate(MotionModel& model, EventType type, double factor) {
  auto& rates = model.rates;
  const auto to = [factor](double& rate) { rate = std::min(1.0, rate * factor); };
  switch (type) {
    case EventType::birth:
      for (double& value : rates.birth.values) value *= factor;
      break;
    case EventType::death:
      for (double& rate : rates.death_by_size) to(rate);
      break;
    case EventType::split:
      to(rates.split);
      break;
    case EventType::merge:
      to(rates.merge);
      break;
    case EventType::connect:
      to(rates.connect);
      break;
    case EventType::disconnect:
      to(rates.disconnect);
      break;
  }
}

// Makes the present strokes, without the fading ones, the first frame of the model.
void set_first_frame(MotionModel& model, SimulatedStrokes strokes) {
  std::vector<bool> fading;
  for (const auto& simulated : strokes.list) fading.push_back(simulated.frames_left >= 0);
  remove_patches(strokes, fading);
  for (SimulatedPatch& p : strokes.list) scale_contrast(p.rest, std::exp(p.gain));
  model.first = stroke_graph(strokes);
}

std::string two_decimals(double value) {
  std::string text = std::to_string(value);
  return text.substr(0, text.find('.') + 3);
}

}  // namespace

EventStatistics measure_event_statistics(const MotionModel& model, std::uint64_t seed,
                                         const core::Context& context) {
  const int frames = frames_per_round(model, rounds);
  auto strokes = initial_strokes(model, seed);
  EventStatistics mean;
  constexpr int counted = looks - first_looks;
  for (int round = 0; round < looks; ++round) {
    context.check();
    const auto first = static_cast<std::uint32_t>(1 + round * frames);
    const EventStatistics one = simulate_statistics(strokes, model, seed, first, frames);
    if (round < first_looks) continue;
    mean.patches += one.patches / counted;
    for (std::size_t s = 0; s < kSizeClasses; ++s) mean.strokes[s] += one.strokes[s] / counted;
    for (std::size_t i = 0; i < mean.events.size(); ++i) mean.events[i] += one.events[i] / counted;
  }
  return mean;
}

std::vector<std::string> calibrate_population(MotionModel& model, const TargetEvents& wanted,
                                              std::uint64_t seed, const core::Context& context) {
  const int frames = frames_per_round(model, rounds);
  auto strokes = initial_strokes(model, seed);
  std::array<double, 6> mean{};
  for (int round = 0; round < rounds; ++round) {
    context.check();
    const double step = 0.5 / (1 + 0.15 * round);
    CellMap where = model.density;
    std::ranges::fill(where.values, 0.0);
    const EventStatistics seen = simulate_statistics(
        strokes, model, seed, static_cast<std::uint32_t>(1 + round * frames), frames, &where);
    const auto smoothed = spread_over_cells(where, usual_spread);
    for (std::size_t c = 0; c < smoothed.size(); ++c)
      model.density.values[c] += step * (smoothed[c] - model.density.values[c]);
    const double one = 1.0 / frames;
    for (const auto type : {EventType::birth, EventType::death, EventType::split, EventType::merge,
                            EventType::connect, EventType::disconnect}) {
      const auto i = static_cast<std::size_t>(type);
      if (wanted[i] && *wanted[i] > 0)
        scale_rate(model, type,
                   std::pow(std::clamp((*wanted[i] + one) / (seen.events[i] + one), 0.25, 4.0), step));
      if (round >= rounds - last_rounds) mean[i] += seen.events[i] / last_rounds;
    }
    context.report("settle", (round + 1.0) / rounds);
  }
  set_first_frame(model, std::move(strokes));
  std::vector<std::string> notes;
  for (std::size_t i = 0; i < mean.size(); ++i) {
    if (!wanted[i]) continue;
    const double events = *wanted[i] * frames * last_rounds;
    if (std::abs(mean[i] - *wanted[i]) * frames * last_rounds > 0.15 * events + 4 * std::sqrt(events + 1))
      notes.push_back(two_decimals(mean[i]) + " " + std::string(graph::name(static_cast<EventType>(i))) +
                      " events a frame could be had, " + two_decimals(*wanted[i]) + " were asked for");
  }
  return notes;
}

}  // namespace emberfold::mcmc::detail
