// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "pipeline/clip_model.hpp"

namespace emberfold::apps {

/// Maximum frame size of a page, px: larger ones would not play.
constexpr long long kMotionPagePixels = 4'000'000;

/// A motion model and its label on the page.
struct MotionPageInput {
  const pipeline::ClipModel* model = nullptr;  ///< with its rates corrected
  std::string folder;                          ///< of the model, as given by the user
  std::string version;
};

/// Makes a self-contained page that runs a motion model live in a browser.
/// The page contains the simulator, compiled to WebAssembly, so that its graphs are those of `emberfold
/// synth`. Throws core::InputError where the program was built without it, and for a model that cannot be
/// drawn or is too large.
std::string make_motion_page(const MotionPageInput& input);

}  // namespace emberfold::apps
