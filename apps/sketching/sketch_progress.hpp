// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <mutex>
#include <optional>
#include <string>

#include "core/context.hpp"

namespace emberfold::apps {

/// Reports a stage's progress over frames that are processed in parallel. Thread-safe; reports to the context
/// from one thread at a time.
class FrameProgress {
 public:
  /// Begins a stage of `frames` frames; if their number is unknown, only the stage is reported.
  FrameProgress(const core::Context& context, std::string stage, std::optional<std::int64_t> frames);

  /// Reports a frame's share 0…1; the total never decreases.
  void report(int frame, double share);
  /// Returns the context for a step of a frame's work: its 0…1 becomes the frame's from…1. Must not outlive
  /// this.
  [[nodiscard]] core::Context step(int frame, double from);

 private:
  const core::Context& context_;
  std::string stage_;
  std::optional<std::int64_t> frames_;
  std::mutex mutex_;
  std::map<int, double> shares_;  // of unfinished frames
  std::int64_t done_ = 0;
  double reported_ = 0;
};

}  // namespace emberfold::apps
