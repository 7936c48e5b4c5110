// SPDX-License-Identifier: Apache-2.0
#include "mcmc/inference/change_posterior.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <span>
#include <string>

#include "core/error.hpp"
#include "core/math/log_odds.hpp"

namespace emberfold::mcmc {

namespace {

namespace tuning {
constexpr double kSpread = 0.25;         // SD of an amplitude about 1 or 0
constexpr double kImageSpread = 0.2;     // its part that does not scale with the level
constexpr double kOutlier = 0.05;        // share of amplitudes that may be anything
constexpr double kOutlierRange = 3;      // of amplitudes
constexpr double kPerMeasurement = 0.7;  // neighbouring patches are not independent
constexpr double kMostOfFrame = 6;       // nats that one frame counts
constexpr double kOfReading = 0.1;       // nats a frame for what the graphs say
constexpr double kSwitch = 0.02;         // prior probability of a change, a frame
constexpr std::size_t kTolerance = 2;    // frames

// Weights of the log-linear model, fitted by tests/bench/fit_event_weights.py (docs/method/events.md).
constexpr double kIntercept = -3.64;
constexpr double kStrokeFactor = 0.48, kJointFactor = 0.26;  // of a nat
constexpr double kShortSide = 1.37;  // of a logarithm of frames without opposite change
// Changes of faint strokes are less likely to be seen (docs/method/events.md).
constexpr double kFaint = 4, kPlainContrast = 16;  // of a logarithm of grey levels, below so many
}  // namespace tuning

double log_sum(double a, double b) {
  const double larger = std::max(a, b);
  return larger + std::log1p(std::exp(std::min(a, b) - larger));
}

/// The logarithm of the ratio of an amplitude's density where the patches are there to that where not.
double log_ratio(double amplitude, double level) {
  using namespace tuning;
  const double x = amplitude / level, part = kImageSpread / level;
  const double variance = kSpread * kSpread + part * part;
  const auto density = [&](double mean) {
    return (1 - kOutlier) * std::exp(-0.5 * (x - mean) * (x - mean) / variance) /
               std::sqrt(2 * std::numbers::pi * variance) +
           kOutlier / kOutlierRange;
  };
  return std::log(density(1)) - std::log(density(0));
}

/// Returns for each frame the log ratio of "there" to "not there".
std::vector<double> frame_evidence(const ChangeSeries& series) {
  std::vector<double> result;
  for (std::size_t i = 0; i < series.amplitude.size(); ++i) {
    double nats = tuning::kPerMeasurement * series.weight * log_ratio(series.amplitude[i], series.level);
    const bool there = series.appears ? i >= series.at : i < series.at;
    nats = std::clamp(nats, -tuning::kMostOfFrame, tuning::kMostOfFrame);
    if (!series.in_view.empty()) nats *= series.in_view[i];
    result.push_back(nats + (there ? tuning::kOfReading : -tuning::kOfReading));
  }
  return result;
}

/// Returns the probability of a change to `to_on` in one of the frames first…last, given the evidence.
double change_probability(std::span<const double> evidence, bool to_on, std::size_t first, std::size_t last) {
  const double stay = std::log1p(-tuning::kSwitch), change = std::log(tuning::kSwitch);
  const std::size_t count = evidence.size();
  const auto emitted = [&](std::size_t i, std::size_t on) { return on == 1 ? evidence[i] : 0.0; };
  using States = std::array<double, 2>;
  std::vector<States> before(count), after(count);
  before[0] = {emitted(0, 0), emitted(0, 1)};
  for (std::size_t i = 1; i < count; ++i)
    for (std::size_t on = 0; on < 2; ++on)
      before[i].at(on) =
          emitted(i, on) + log_sum(before[i - 1].at(on) + stay, before[i - 1].at(1 - on) + change);
  after[count - 1] = {0, 0};
  for (std::size_t i = count - 1; i-- > 0;)
    for (std::size_t on = 0; on < 2; ++on)
      after[i].at(on) = log_sum(after[i + 1].at(on) + stay + emitted(i + 1, on),
                                after[i + 1].at(1 - on) + change + emitted(i + 1, 1 - on));
  const double total = log_sum(before[count - 1][0], before[count - 1][1]);
  const std::size_t to = to_on ? 1 : 0;
  double sum = 0;
  for (std::size_t i = first; i <= last; ++i)
    sum += std::exp(before[i - 1].at(1 - to) + change + emitted(i, to) + after[i].at(to) - total);
  return std::clamp(sum, 1e-9, 1 - 1e-9);
}

}  // namespace

double log_change_factor(const ChangeSeries& series) {
  const std::size_t count = series.amplitude.size();
  if (series.at < 1 || series.at >= count)
    throw core::InputError("change: frame " + std::to_string(series.at) + " of " + std::to_string(count) +
                           "; allowed is 1 to one less than their number");
  if (!std::ranges::all_of(series.amplitude, [](double a) { return std::isfinite(a); }))
    throw core::InputError("change: an amplitude is not finite");
  if (!series.in_view.empty() && series.in_view.size() != count)
    throw core::InputError("change: " + std::to_string(series.in_view.size()) + " shares in view of " +
                           std::to_string(count) + " frames");
  if (!(series.level > 0 && series.weight > 0))
    throw core::InputError("change: level and weight must be positive");
  const std::size_t first = series.at - std::min(series.at - 1, tuning::kTolerance);
  const std::size_t last = std::min(series.at + tuning::kTolerance, count - 1);
  const std::vector<double> nothing(count, 0.0);
  const double posterior = change_probability(frame_evidence(series), series.appears, first, last);
  const double prior = change_probability(nothing, series.appears, first, last);
  return std::clamp(core::log_odds(posterior) - core::log_odds(prior), -kMostChangeFactor, kMostChangeFactor);
}

double change_log_odds(const ChangeEvidence& evidence) {
  using namespace tuning;
  const double frames = std::clamp(std::min(evidence.since, evidence.until), 1.0, double{kFramesUntilLong});
  return kIntercept + (evidence.of_stroke ? kStrokeFactor : kJointFactor) * evidence.log_factor +
         kShortSide * std::log(frames) +
         kFaint * std::log(std::clamp(evidence.contrast / kPlainContrast, 0.1, 1.0));
}

}  // namespace emberfold::mcmc
