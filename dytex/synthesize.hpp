// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>

#include "dytex/linear_dynamic_texture.hpp"

namespace emberfold::dytex {

struct SynthesisOptions {
  std::uint64_t seed = 1;
  /// Where x(0) comes from: drawn from the stationary distribution, or a training frame's state.
  std::optional<int> first_frame;
};

/// An endless clip drawn from a model, …
class Synthesis {
 public:
  Synthesis(const LinearDynamicTexture& texture, const SynthesisOptions& options);
  cv::Mat next();  // CV_8U frame of the texture's size and channels
};

}  // namespace emberfold::dytex
