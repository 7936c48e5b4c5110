// SPDX-License-Identifier: Apache-2.0
#include "apps/sketching/sketch_progress.hpp"

#include <algorithm>
#include <utility>

namespace emberfold::apps {

FrameProgress::FrameProgress(const core::Context& context, std::string stage,
                             std::optional<std::int64_t> frames)
    : context_(context), stage_(std::move(stage)), frames_(frames) {}

void FrameProgress::report(int frame, double share) {
  const std::scoped_lock lock(mutex_);
  if (share >= 1) {
    shares_.erase(frame);
    ++done_;
  } else {
    auto& own = shares_[frame];
    own = std::max(own, share);
  }
  if (!frames_ || *frames_ < 1) return context_.report(stage_, 0);
  auto sum = static_cast<double>(done_);
  for (const auto& entry : shares_) sum += entry.second;
  reported_ = std::max(reported_, sum / static_cast<double>(*frames_));
  context_.report(stage_, reported_);
}

core::Context FrameProgress::step(int frame, double from) {
  return context_.with_progress([this, frame, from](std::string_view, double share) {
    // A frame counts as done only when it ends.
    report(frame, std::min(0.999, from + (1 - from) * share));
  });
}

}  // namespace emberfold::apps
