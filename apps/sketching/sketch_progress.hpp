// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <mutex>
#include <optional>
#include <string>

#include "core/context.hpp"

namespace emberfold::apps {

/// One stage's progress from frames that are worked on at once, each telling how far it is. Used from any
/// thread; tells the context from one at a time.
class FrameProgress {
 public:
  /// `frames`: how many there are; where that is not known only the stage is told.
  FrameProgress(const core::Context& context, std::string stage, std::optional<std::int64_t> frames);

  /// The frame's share 0…1; what is told never goes back.
  void tell(int frame, double share);
  /// What a step of a frame's work is given: its 0…1 becomes the frame's from…1. Must not outlive this.
  [[nodiscard]] core::Context step(int frame, double from);

 private:
  const core::Context& context_;
  std::string stage_;
  std::optional<std::int64_t> frames_;
  std::mutex mutex_;
  std::map<int, double> shares_;  // of frames that are not done
  std::int64_t done_ = 0;
  double told_ = 0;
};

}  // namespace emberfold::apps
