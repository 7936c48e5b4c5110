// SPDX-License-Identifier: Apache-2.0
#include "apps/cli/interrupt.hpp"

#include <csignal>
#include <ctime>

#include <pthread.h>
#include <unistd.h>

namespace emberfold::apps {

namespace {
constexpr int kInterruptedExit = 130;

sigset_t watched() {
  sigset_t set;
  sigemptyset(&set);
  sigaddset(&set, SIGINT);
  sigaddset(&set, SIGTERM);
  // Under nohup a hang-up stays ignored: blocked signals would still be delivered.
  struct sigaction hang_up {};
  if (::sigaction(SIGHUP, nullptr, &hang_up) == 0 && hang_up.sa_handler != SIG_IGN) sigaddset(&set, SIGHUP);
  return set;
}
}  // namespace

InterruptWatch::InterruptWatch() {
  const sigset_t set = watched();
  pthread_sigmask(SIG_BLOCK, &set, nullptr);
  // Signal handlers may do very little; a thread that waits for the signal is unrestricted.
  waiter_ = std::jthread([this, set](const std::stop_token& done) {
    const timespec pause{0, 100'000'000};
    while (!done.stop_requested()) {
      if (sigtimedwait(&set, nullptr, &pause) <= 0) continue;
      if (stop_.stop_requested()) _exit(kInterruptedExit);
      stop_.request_stop();
    }
  });
}

InterruptWatch::~InterruptWatch() {
  waiter_.request_stop();
  waiter_.join();
}

}  // namespace emberfold::apps
