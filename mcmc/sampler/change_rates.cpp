// SPDX-License-Identifier: Apache-2.0
#include "mcmc/sampler/change_rates.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>
#include <utility>

#include "core/math/log_odds.hpp"

namespace emberfold::mcmc::detail {

namespace {

constexpr double kSquare = 32;   // px: the share differs little within
constexpr double kPseudo = 0.5;  // true and false changes that are counted beforehand, each
constexpr int kBrief = 3;        // frames that a stroke lasts at most which a detector may have made up
constexpr int kRounds = 60;      // of learn_alone(): each halves the error at least

/// Returns whether the change is the birth or the death of a stroke that lasts a short time.
bool is_brief(const ChangeField& field, const Change& change) {
  if (!change.before.empty() && !change.after.empty()) return false;
  const Strand& stroke = field.strands[change.before.empty() ? change.after[0] : change.before[0]];
  return stroke.last - stroke.first < kBrief;
}

}  // namespace

ChangeRates::ChangeRates(const ChangeField& field) : field_(field) {
  std::map<std::tuple<bool, long, long>, std::vector<std::uint32_t>> squares;
  for (std::uint32_t k = 0; k < field.changes.size(); ++k) {
    const Change& change = field.changes[k];
    log_odds_.push_back(change.log_odds);
    if (change.has_rate)
      squares[{is_brief(field, change), std::lround(change.place.x / kSquare),
               std::lround(change.place.y / kSquare)}]
          .push_back(k);
  }
  for (auto& [at, changes] : squares) {
    const auto [brief, x, y] = at;
    squares_.push_back({brief, kSquare * double(x), kSquare * double(y), std::move(changes)});
  }
}

void ChangeRates::learn(std::span<const double> happened) {
  std::vector<double> sums;
  for (const Square& square : squares_) {
    double sum = 0;
    for (const std::uint32_t k : square.changes) sum += happened[k];
    sums.push_back(sum);
  }
  for (const Square& here : squares_) {
    double sum = kPseudo, count = 2 * kPseudo;
    for (std::size_t i = 0; i < squares_.size(); ++i) {
      const Square& other = squares_[i];
      if (other.brief != here.brief) continue;
      const double dx = (other.x - here.x) / kRateReach, dy = (other.y - here.y) / kRateReach;
      const double apart = dx * dx + dy * dy;
      if (apart >= 1) continue;
      const double weight = (1 - apart) * (1 - apart);
      sum += weight * sums[i], count += weight * static_cast<double>(other.changes.size());
    }
    const double shift = core::log_odds(sum / count) - core::log_odds(kUsualShare);
    for (const std::uint32_t k : here.changes) log_odds_[k] = field_.changes[k].log_odds + shift;
  }
}

void ChangeRates::learn_alone() {
  std::vector<double> probability(log_odds_.size());
  for (int round = 0; round < kRounds; ++round) {
    for (std::size_t k = 0; k < probability.size(); ++k) probability[k] = core::from_log_odds(log_odds_[k]);
    learn(probability);
  }
}

}  // namespace emberfold::mcmc::detail
