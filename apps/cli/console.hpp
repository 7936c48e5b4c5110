// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <string>
#include <string_view>

namespace emberfold::apps {

/// Writes progress and messages to standard error. On a terminal progress is one line that is rewritten:
/// stage, percentage, time left; elsewhere one line for each stage. When quiet, only warnings and errors are
/// written. Use from one thread at a time.
class Console {
 public:
  Console();
  ~Console();
  Console(const Console&) = delete;
  Console& operator=(const Console&) = delete;

  void set_quiet(bool quiet) { quiet_ = quiet; }
  void progress(std::string_view stage, double fraction);
  void say(const std::string& text);
  void warn(const std::string& text);
  void error(const std::string& text);

 private:
  using Clock = std::chrono::steady_clock;
  void clear_line();

  bool quiet_ = false, terminal_ = false, line_is_open_ = false;
  std::string stage_;
  Clock::time_point began_, shown_;
};

/// Formats a duration: "7 s", "3 min 5 s", "2 h 10 min".
std::string duration_text(double seconds);

/// Replaces control characters by spaces, so that the text is one line and commands no terminal.
std::string one_line(std::string_view text);

}  // namespace emberfold::apps
