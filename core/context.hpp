// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <exception>
#include <functional>
#include <memory>
#include <memory_resource>
#include <stop_token>
#include <string>
#include <string_view>
#include <utility>

namespace emberfold::core {

/// Holds how long a stage of a long call took.
struct StageTime {
  std::string name;
  double seconds = 0;  ///< wall time
};

/// Reports that a long call was asked to stop.
class Cancelled : public std::exception {
 public:
  explicit Cancelled(std::string kept_files = "nothing was kept") : kept(std::move(kept_files)) {}
  [[nodiscard]] const char* what() const noexcept override { return "cancelled"; }

  std::string kept;  ///< results that were kept, described for the user
};

/// Receives warnings, one line each, no newline; may be empty.
using Warn = std::function<void(const std::string&)>;

/// Memory for large, long-lived data, such as io::MappedMemory; thread-safe.
using LargeMemory = std::shared_ptr<std::pmr::memory_resource>;

/// Passes a stop token, sinks for progress and warnings, and memory for large data into a long call.
/// The default context never stops, discards both, and keeps everything on the heap.
class Context {
 public:
  /// Receives the name of a stage and its finished share, 0…1; called from one thread at a time.
  using Progress = std::function<void(std::string_view stage, double fraction)>;

  Context() = default;
  explicit Context(std::stop_token stop, Progress progress = {}, Warn warning = {});

  [[nodiscard]] bool cancelled() const { return stop_.stop_requested(); }
  /// Throws Cancelled once a stop was requested.
  void check() const;
  /// Reports the finished share of a stage, clamped to 0…1; from one thread at a time.
  void report(std::string_view stage, double fraction) const;
  /// Reports a warning; from one thread at a time.
  void warn(const std::string& text) const;
  /// Returns a copy of this context with another sink for progress.
  [[nodiscard]] Context with_progress(Progress progress) const;
  /// Returns a copy of this context that keeps data growing with the clip in other memory.
  [[nodiscard]] Context with_memory(LargeMemory memory) const;
  /// Returns the memory for data that grows with the clip; null: the heap.
  [[nodiscard]] const LargeMemory& memory() const { return memory_; }

 private:
  std::stop_token stop_;
  Progress progress_;
  Warn warning_;
  LargeMemory memory_;
};

}  // namespace emberfold::core
