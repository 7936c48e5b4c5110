// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stop_token>
#include <thread>

namespace emberfold::apps {

/// Turns Ctrl-C, SIGTERM and a hang-up (SIGHUP, unless nohup has it ignored) into a stop request while it
/// lives; the second one ends the process at once. Make it before any other thread, so that they all block
/// these signals.
class InterruptWatch {
 public:
  InterruptWatch();
  ~InterruptWatch();
  InterruptWatch(const InterruptWatch&) = delete;
  InterruptWatch& operator=(const InterruptWatch&) = delete;

  [[nodiscard]] std::stop_token token() const { return stop_.get_token(); }

 private:
  std::stop_source stop_;
  std::jthread waiter_;
};

}  // namespace emberfold::apps
