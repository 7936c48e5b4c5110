// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include <opencv2/core/types.hpp>

#include "apps/cli/edit_options.hpp"
#include "mcmc/simulation/synthesize.hpp"
#include "pipeline/clip_model.hpp"

namespace emberfold::apps {

/// Request of `emberfold synth`.
struct SynthRequest {
  std::string model, output, overlay, motion, film, alpha;
  std::optional<pipeline::SynthesisMethod> method;
  int frames = 300;
  std::optional<int> loop, width, height;
  bool asked_frames = false;
  std::string drawn_since;  ///< why strokes are drawn instead of transferred
  std::string start = "data";
  EditOptions edit;

  [[nodiscard]] mcmc::Start first() const {
    return start == "stationary" ? mcmc::Start::stationary : mcmc::Start::data;
  }
};

/// Checks a request and chooses the method of its clip. Throws Misuse that names the option.
void check(SynthRequest& asked);

/// Returns the new clip's size: that of the model's frames, unless --width and --height change it. Throws
/// Misuse where they would distort it.
cv::Size output_size(const SynthRequest& asked, cv::Size frame);

}  // namespace emberfold::apps
