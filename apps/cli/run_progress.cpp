// SPDX-License-Identifier: Apache-2.0
#include "apps/cli/run_progress.hpp"

#include <algorithm>

namespace emberfold::apps {

void RunProgress::enter(std::size_t stage, double now) {
  if (at_) {
    spent_ += now - began_;
    planned_spent_ += stages_[*at_].seconds;
  }
  at_ = stage, share_ = 0, began_ = now;
}

double RunProgress::planned(std::size_t from, std::size_t to) const {
  double sum = 0;
  for (std::size_t i = from; i < to; ++i) sum += stages_[i].seconds;
  return sum;
}

RunProgress::State RunProgress::report(std::string_view name, double share, double now) {
  double done = std::clamp(share, 0., 1.);
  for (std::size_t i = at_.value_or(0); i < stages_.size(); ++i) {
    const auto& reports = stages_[i].reports;
    const auto found = std::ranges::find(reports, name);
    if (stages_[i].name != name && found == reports.end()) continue;
    if (at_ != i) enter(i, now);
    if (found != reports.end())
      done = (static_cast<double>(found - reports.begin()) + done) / static_cast<double>(reports.size());
    share_ = std::max(share_, done);
    break;
  }
  State state;
  state.of = static_cast<int>(stages_.size());
  if (!at_) return state;
  const auto& stage = stages_[*at_];
  state.stage = stage.name, state.number = static_cast<int>(*at_) + 1, state.share = share_;
  const double all = planned(0, stages_.size()), before = planned(0, *at_);
  state.whole = (before + stage.seconds * share_) / all;
  constexpr double kLeast = 0.02;  // of the total: below it the pace is a guess
  const double measured = planned_spent_ + stage.seconds * share_;
  if (measured >= kLeast * all)
    state.seconds_left = (spent_ + now - began_) / measured * (all - before - stage.seconds * share_);
  return state;
}

}  // namespace emberfold::apps
