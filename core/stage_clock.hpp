// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <string>
#include <vector>

#include "core/context.hpp"

namespace emberfold::core {

/// Measures how long the stages of a long call take.
class StageClock {
 public:
  /// Ends the stage before and begins the next one.
  void begin(std::string name);
  void end();
  /// Adds stages that were measured elsewhere after those that have ended.
  void add(const std::vector<StageTime>& stages);
  [[nodiscard]] const std::vector<StageTime>& ended() const { return ended_; }
  /// Returns the seconds since the clock was made.
  [[nodiscard]] double total() const;

 private:
  using Clock = std::chrono::steady_clock;
  std::vector<StageTime> ended_;
  std::string name_;
  Clock::time_point first_ = Clock::now(), began_ = first_;
};

}  // namespace emberfold::core
