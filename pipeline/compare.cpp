// SPDX-License-Identifier: Apache-2.0
#include "pipeline/compare.hpp"

#include <string>

#include "core/error.hpp"

namespace emberfold::pipeline {

void CompareOptions::validate() const {
  if (!(learn_share > 0) || learn_share > 1)
    throw core::InputError("CompareOptions.learn_share is " + std::to_string(learn_share) +
                           "; allowed is above 0, up to 1");
  if (steps < 1 || steps > 64)
    throw core::InputError("CompareOptions.steps is " + std::to_string(steps) + "; allowed is 1 to 64");
  if (frames != 0 && (frames < kFewestFrames || frames > 1000000))
    throw core::InputError("CompareOptions.frames is " + std::to_string(frames) + "; allowed is " +
                           std::to_string(kFewestFrames) + " to 1000000, or 0 for as many as the source has");
}

}  // namespace emberfold::pipeline
