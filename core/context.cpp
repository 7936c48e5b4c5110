// SPDX-License-Identifier: Apache-2.0
#include "core/context.hpp"

#include <algorithm>
#include <utility>

namespace emberfold::core {

Context::Context(std::stop_token stop, Progress progress)
    : stop_(std::move(stop)), progress_(std::move(progress)) {}

void Context::report(std::string_view stage, double fraction) const {
  if (progress_) progress_(stage, std::clamp(fraction, 0.0, 1.0));
}

Context Context::with_progress(Progress progress) const {
  return Context(stop_, std::move(progress));
}

}  // namespace emberfold::core
