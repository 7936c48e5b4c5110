// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "core/clip.hpp"

namespace emberfold::core {

/// Skips frames without returning them. A source that can skip more cheaply than read also derives from this
/// class.
class Skipping {
 public:
  virtual ~Skipping() = default;
  /// Skips the next `count` frames, or those that remain.
  virtual void skip(std::int64_t count) = 0;
};

/// Skips the next `count` frames of a source, or those that remain; reads them where the source cannot skip.
inline void skip_frames(FrameSource& source, std::int64_t count) {
  if (auto* const skipping = dynamic_cast<Skipping*>(&source)) return skipping->skip(count);
  for (; count > 0; --count)
    if (source.next().empty()) return;
}

}  // namespace emberfold::core
