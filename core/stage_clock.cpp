// SPDX-License-Identifier: Apache-2.0
#include "core/stage_clock.hpp"

#include <utility>

namespace emberfold::core {

namespace {

double seconds_since(std::chrono::steady_clock::time_point time) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - time).count();
}

}  // namespace

void StageClock::begin(std::string name) {
  end();
  name_ = std::move(name);
  began_ = Clock::now();
}

void StageClock::end() {
  if (!name_.empty()) ended_.push_back({name_, seconds_since(began_)});
  name_.clear();
}

void StageClock::add(const std::vector<StageTime>& stages) {
  ended_.insert(ended_.end(), stages.begin(), stages.end());
}

double StageClock::total() const {
  return seconds_since(first_);
}

}  // namespace emberfold::core
