// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stop_token>
#include <thread>

namespace emberfold::apps {

/// Turns Ctrl-C, SIGTERM and a hang-up (SIGHUP, unless nohup ignores it) into a stop request while it exists.
/// A second signal ends the process at once. Create it before any other thread, so that all threads block
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
