// SPDX-License-Identifier: Apache-2.0
#include "core/clip/frame_stream.hpp"

#include <tbb/global_control.h>

namespace emberfold::core {

std::size_t frames_in_work(int width, int height, int channels) {
  const auto threads = tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism);
  return std::min(2 * threads, frames_at_once(width, height, channels));
}

}  // namespace emberfold::core
