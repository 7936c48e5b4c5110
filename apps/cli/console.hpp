// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "apps/cli/run_progress.hpp"

namespace emberfold::apps {

/// Names the format of progress and messages.
enum class ProgressForm {
  text,  ///< one line, rewritten, on a terminal; elsewhere one line per stage
  json   ///< one object per line: progress at most ten times a second, messages, warnings, errors
};

/// Writes progress and messages to standard error.
/// A progress line shows the stage, how much of it is done and the time left, of all stages where they are
/// planned. When quiet, only warnings and errors are written. Not thread-safe.
class Console {
 public:
  Console();
  ~Console();
  Console(const Console&) = delete;
  Console& operator=(const Console&) = delete;

  void set_quiet(bool quiet) { quiet_ = quiet; }
  void set_form(ProgressForm form) { form_ = form; }
  /// Sets the stages to come, so that progress covers all of them.
  void plan(std::vector<PlannedStage> stages) { plan_.emplace(std::move(stages)); }
  void progress(std::string_view stage, double fraction);
  void say(const std::string& text);
  void warn(const std::string& text);
  void error(const std::string& text);

 private:
  using Clock = std::chrono::steady_clock;
  void clear_line();
  void put_json(const std::string& kind, const std::string& text);
  /// Writes progress for display on a terminal.
  void show(const RunProgress::State& state);

  ProgressForm form_ = ProgressForm::text;
  std::optional<RunProgress> plan_;
  bool quiet_ = false, terminal_ = false, line_is_open_ = false;
  std::string stage_;
  Clock::time_point made_ = Clock::now(), began_, shown_;
};

/// Formats a duration: "7 s", "3 min 5 s", "2 h 10 min".
std::string duration_text(double seconds);

/// Replaces control characters by spaces, so that the text is one line and cannot control the terminal.
std::string one_line(std::string_view text);

}  // namespace emberfold::apps
