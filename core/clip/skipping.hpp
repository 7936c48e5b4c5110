// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "core/clip.hpp"

namespace emberfold::core {

/// Passes over frames without handing them out. A source that can do that cheaper than by reading them is
/// derived from this, too.
class Skipping {
 public:
  virtual ~Skipping() = default;
  /// Passes over the next `count` frames, or those that there are.
  virtual void skip(std::int64_t count) = 0;
};

/// Passes over the next `count` frames of a source, or those that there are; where the source cannot, by
/// reading them.
inline void skip_frames(FrameSource& source, std::int64_t count) {
  if (auto* const skipping = dynamic_cast<Skipping*>(&source)) return skipping->skip(count);
  for (; count > 0; --count)
    if (source.next().empty()) return;
}

}  // namespace emberfold::core
