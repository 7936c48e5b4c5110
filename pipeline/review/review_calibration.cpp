// SPDX-License-Identifier: Apache-2.0
#include "pipeline/review/review_calibration.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/error.hpp"
#include "core/math/log_odds.hpp"
#include "core/rng.hpp"

namespace emberfold::pipeline {

namespace {

using graph::Answer;
using graph::Event;

constexpr double kMostOdds = 7;  // nats: before any answer, a probability of 1 is not certain
constexpr double kShiftSpread = 1.5, kSlopeSpread = 0.4;  // SD of the priors of a and of log b
constexpr double kShiftStep = 0.1, kSlopeStep = 0.1;
constexpr int kShifts = 60, kSlopes = 12;  // steps on each side of a = 0 and of log b = 0
constexpr int kDraws = 1000;
constexpr double kLevel = 0.9;
constexpr std::size_t kClasses = 7;  // the six classes, and their total

double log_odds(double p) {
  return std::clamp(std::log(p / (1 - p)), -kMostOdds, kMostOdds);
}
std::size_t group_of(graph::EventType type) {
  return type == graph::EventType::birth || type == graph::EventType::death ? 0 : 1;
}

/// An answered event: its log odds before the answer, and whether it happened.
struct Fact {
  double odds = 0;
  bool is_true = false;
};

struct Line {
  double shift = 0, slope = 1;
  [[nodiscard]] double probability(double p) const {
    return p <= 0 ? 0 : core::from_log_odds(shift + slope * log_odds(p));
  }
};

/// The posterior of the linear map of log odds, on a grid.
struct LinePosterior {
  std::vector<Line> lines;
  std::vector<double> weights;
  Line mode;
};

LinePosterior infer_line(std::span<const Fact> facts) {
  LinePosterior result;
  if (facts.empty()) return {{Line{}}, {1.0}, {}};
  double most = -1e300;
  for (int i = -kShifts; i <= kShifts; ++i) {
    for (int k = -kSlopes; k <= kSlopes; ++k) {
      const double a = i * kShiftStep, log_b = k * kSlopeStep;
      const Line line{a, std::exp(log_b)};
      const double za = a / kShiftSpread, zb = log_b / kSlopeSpread;
      double sum = -0.5 * (za * za + zb * zb);
      for (const Fact& fact : facts) {
        const double odds = line.shift + line.slope * fact.odds;
        sum -= std::log1p(std::exp(fact.is_true ? -odds : odds));
      }
      result.lines.push_back(line);
      result.weights.push_back(sum);
      if (sum > most) most = sum, result.mode = line;
    }
  }
  for (double& weight : result.weights) weight = std::exp(weight - most);
  return result;
}

/// The answers, and the events without an answer.
struct Answered {
  ReviewedClip clip;
  std::array<std::vector<Fact>, 2> facts;  ///< by group
  std::vector<std::size_t> open;           ///< indices in clip.events
};

Answered take_answers(std::span<const Event> events, std::span<const graph::ReviewedEvent> review) {
  Answered result;
  ReviewedClip& clip = result.clip;
  clip.asked = std::vector(events.begin(), events.end());
  const auto entries = graph::find_answers(events, review);
  std::vector<bool> is_found(review.size(), false);
  for (std::size_t k = 0; k < events.size(); ++k) {
    clip.events.push_back(events[k]);
    Event& event = clip.events.back();
    const bool answered = entries[k] < review.size() && review[entries[k]].answer != Answer::none;
    if (!answered) {
      result.open.push_back(k);
      continue;
    }
    const graph::ReviewedEvent& said = review[entries[k]];
    is_found[entries[k]] = true;
    const auto happened = graph::told_event(said);
    const bool is_true = happened && group_of(happened->type) == group_of(event.type);
    result.facts[group_of(event.type)].push_back({log_odds(event.probability), is_true});
    (said.answer == Answer::yes ? clip.yes : said.answer == Answer::no ? clip.no : clip.other) += 1;
    event.probability = happened ? 1 : 0;
    if (happened) event.type = happened->type;
  }
  for (std::size_t k = 0; k < review.size(); ++k) {
    if (is_found[k] || review[k].answer == Answer::none) continue;
    auto told = graph::told_event(review[k]);
    if (!told) {
      ++clip.unmatched;
      continue;
    }
    told->before.clear(), told->after.clear();
    clip.events.push_back(std::move(*told));
    ++clip.added;
  }
  return result;
}

/// Draws a Gamma(shape, 1) variate, shape ≥ ½ (Marsaglia & Tsang 2000).
double draw_gamma(core::Rng& rng, double shape) {
  if (shape < 1) return draw_gamma(rng, shape + 1) * std::pow(1 - rng.uniform(), 1 / shape);
  const double d = shape - 1.0 / 3, c = 1 / std::sqrt(9 * d);
  while (true) {
    const double x = rng.normal(), v = std::pow(1 + c * x, 3);
    if (v <= 0) continue;
    const double u = 1 - rng.uniform();
    if (std::log(u) < 0.5 * x * x + d - d * v + d * std::log(v)) return d * v;
  }
}

core::Interval interval_of(std::vector<double> draws) {
  const double mean = std::accumulate(draws.begin(), draws.end(), 0.0) / static_cast<double>(draws.size());
  std::ranges::sort(draws);
  const auto at = [&](double share) {
    return draws[static_cast<std::size_t>(share * static_cast<double>(draws.size() - 1))];
  };
  return {mean, at((1 - kLevel) / 2), at((1 + kLevel) / 2)};
}

/// Draws the counts of all classes, and their rates, from the posterior. `before`: the events' own
/// probabilities.
void draw_counts(Answered& answered, std::span<const Event> before,
                 const std::array<LinePosterior, 2>& posteriors, std::size_t gaps, std::uint64_t seed) {
  std::array<double, kClasses> known{};
  ReviewedClip& clip = answered.clip;
  std::vector<bool> is_open(clip.events.size(), false);
  for (const std::size_t k : answered.open) is_open[k] = true;
  for (std::size_t k = 0; k < clip.events.size(); ++k)
    if (!is_open[k]) known[static_cast<std::size_t>(clip.events[k].type)] += clip.events[k].probability;
  std::array<std::vector<double>, kClasses> counts, rates;
  for (std::uint32_t draw = 0; draw < kDraws; ++draw) {
    core::Rng rng(seed, {draw, 0x72657669});  // "revi"
    const std::array<Line, 2> lines{posteriors[0].lines[rng.categorical(posteriors[0].weights)],
                                    posteriors[1].lines[rng.categorical(posteriors[1].weights)]};
    auto count = known;
    for (const std::size_t k : answered.open) {
      const Event& event = before[k];
      const double p = lines[group_of(event.type)].probability(event.probability);
      if (rng.uniform() < p) count[static_cast<std::size_t>(event.type)] += 1;
    }
    count.back() = std::accumulate(count.begin(), count.end() - 1, 0.0);
    for (std::size_t c = 0; c < kClasses; ++c) {
      counts[c].push_back(count[c]);
      rates[c].push_back(draw_gamma(rng, count[c] + 0.5) / static_cast<double>(gaps));
    }
  }
  for (std::size_t c = 0; c < kClasses; ++c) {
    clip.counts[c] = interval_of(counts[c]);
    clip.rates[c] = interval_of(rates[c]);
    clip.rates[c].mean = clip.counts[c].mean / static_cast<double>(gaps);
  }
}

}  // namespace

ReviewedClip apply_review(std::span<const Event> events, std::span<const graph::ReviewedEvent> review,
                          std::size_t gaps, std::uint64_t seed) {
  if (gaps < 1) throw core::InputError("review: the clip has fewer than two frames");
  Answered answered = take_answers(events, review);
  std::array<LinePosterior, 2> posteriors;
  for (std::size_t group = 0; group < 2; ++group) {
    posteriors[group] = infer_line(answered.facts[group]);
    const Line& mode = posteriors[group].mode;
    answered.clip.shift[group] = mode.shift, answered.clip.slope[group] = mode.slope;
    if (answered.facts[group].empty()) continue;
    for (const std::size_t k : answered.open) {
      Event& event = answered.clip.events[k];
      if (group_of(event.type) == group) event.probability = mode.probability(event.probability);
    }
  }
  draw_counts(answered, events, posteriors, gaps, seed);
  graph::sort_events(answered.clip.events);
  return std::move(answered.clip);
}

}  // namespace emberfold::pipeline
