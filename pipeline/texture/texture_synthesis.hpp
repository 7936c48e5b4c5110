// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "core/clip.hpp"
#include "core/context.hpp"
#include "dytex/synthesize.hpp"
#include "pipeline/frame_method.hpp"

namespace emberfold::pipeline {

/// Draws an endless number of new frames of the linear dynamic texture of a footage.
/// The texture is learned before the first frame (dytex::learn). The same at any number of threads.
class TextureSynthesis final : public FrameMethod {
 public:
  /// `footage`: frames of a clip, CV_8U, 1 or 3 channels, of one size. Throws core::InputError for fewer than
  /// two.
  TextureSynthesis(std::vector<cv::Mat> footage, std::uint64_t seed);

  void each(int count, const std::function<void(cv::Mat)>& take, const core::Context& context) override;
  /// Returns the number of frames that dytex::Synthesis makes at a time.
  [[nodiscard]] int batch() const override { return 8; }
  /// Throws core::InputError: pixels of a texture are not those of the clip.
  /// Throws core::InputError: a texture draws no strokes.
  [[nodiscard]] graph::MotionGraph motion(int count, const core::Context& context) const override;

 private:
  void learn(const core::Context& context);

  core::Clip footage_;  // empty once the texture is learned
  std::uint64_t seed_;
  std::unique_ptr<const dytex::LinearDynamicTexture> texture_;
  std::optional<dytex::Synthesis> synthesis_;  // refers to the texture
};

}  // namespace emberfold::pipeline
