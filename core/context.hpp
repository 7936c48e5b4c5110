// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <exception>
#include <functional>
#include <stop_token>
#include <string>
#include <string_view>
#include <utility>

namespace emberfold::core {

/// How a long call ended. A cancelled call returns what it had finished, which is valid.
enum class Status { done, cancelled };

/// Thrown where a long call notices that it was asked to stop; caught at the program's door.
class Cancelled : public std::exception {
 public:
  explicit Cancelled(std::string kept_files = "nothing was kept") : kept(std::move(kept_files)) {}
  [[nodiscard]] const char* what() const noexcept override { return "cancelled"; }

  std::string kept;  ///< what remains of the work, in words for the user
};

/// Receives warnings, one line each, no newline; may be empty.
using Warn = std::function<void(const std::string&)>;

/// Carries what a long call is given from outside: a way to be stopped, and sinks for progress and warnings.
/// The default one never stops and tells nobody.
class Context {
 public:
  /// Called with the stage's name and the finished share of it, 0…1; from one thread at a time.
  using Progress = std::function<void(std::string_view stage, double fraction)>;

  Context() = default;
  explicit Context(std::stop_token stop, Progress progress = {}, Warn warning = {});

  [[nodiscard]] bool cancelled() const { return stop_.stop_requested(); }
  /// Throws Cancelled once a stop was requested.
  void check() const;
  void report(std::string_view stage, double fraction) const;
  /// Passes on a warning; from one thread at a time.
  void warn(const std::string& text) const;
  /// Returns a context that is stopped and warns with this one, and reports progress to another sink.
  [[nodiscard]] Context with_progress(Progress progress) const;

 private:
  std::stop_token stop_;
  Progress progress_;
  Warn warning_;
};

}  // namespace emberfold::core
