// SPDX-License-Identifier: Apache-2.0
#include "core/context.hpp"

#include <algorithm>
#include <utility>

namespace emberfold::core {

Context::Context(std::stop_token stop, Progress progress, Warn warning)
    : stop_(std::move(stop)), progress_(std::move(progress)), warning_(std::move(warning)) {}

void Context::check() const {
  if (cancelled()) throw Cancelled{};
}

void Context::report(std::string_view stage, double fraction) const {
  if (progress_) progress_(stage, std::clamp(fraction, 0.0, 1.0));
}

void Context::warn(const std::string& text) const {
  if (warning_) warning_(text);
}

Context Context::with_progress(Progress progress) const {
  Context changed = *this;
  changed.progress_ = std::move(progress);
  return changed;
}

Context Context::with_memory(LargeMemory memory) const {
  Context changed = *this;
  changed.memory_ = std::move(memory);
  return changed;
}

}  // namespace emberfold::core
