// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "core/context.hpp"
#include "pipeline/footage/copied_share.hpp"
#include "pipeline/footage/motion_scale.hpp"
#include "pipeline/footage/played_frames.hpp"
#include "pipeline/footage/time_front.hpp"
#include "pipeline/frame_method.hpp"

namespace emberfold::pipeline {

/// Holds the settings of a FootageSynthesis.
struct FootageSynthesisOptions {
  std::uint64_t seed = 1;
  double speed = 1;              ///< frames of the footage per frame, −100…100, not 0; below 0 backwards
  std::optional<int> loop = {};  ///< frames after which the clip repeats itself exactly, ≥ 2
};

/// Draws an endless number of new frames of a footage.
/// The footage is played with jumps between similar frames (PlayOrder), and every place runs a little ahead
/// of or behind its neighbours (TimeFront), so frames are new compositions of the clip; between two of its
/// frames, pixels are moved along the motion. A loop after which the footage itself repeats is played
/// unchanged. The motion bounds how much times differ: content is stretched by about 15 %. The same at any
/// number of threads.
class FootageSynthesis final : public FrameMethod {
 public:
  /// `footage`: frames of a clip, CV_8U, 1 or 3 channels, of one size.
  /// Throws core::InputError for options out of range and a footage of fewer than two frames.
  FootageSynthesis(std::vector<cv::Mat> footage, const FootageSynthesisOptions& options,
                   const core::Context& context = {});

  void each(int count, const std::function<void(cv::Mat)>& take, const core::Context& context = {}) override;
  /// Returns the best number of frames per call: 1…16.
  [[nodiscard]] int batch() const override;
  /// Returns the visibility of the jumps so far: their cost over the change between neighbouring frames.
  [[nodiscard]] double jump_cost() const { return played_.jump_cost(); }
  /// Returns the share of moving pixels copied from one frame of the footage, 0…1, in every fourth frame so
  /// far.
  [[nodiscard]] double copied_share() const { return copied_.mean(); }
  /// Returns the number of plays of the footage shown side by side.
  [[nodiscard]] int plays() const { return played_.plays(); }
  /// Returns whether any frames so far were played backwards, since the footage has no similar frames.
  [[nodiscard]] bool plays_back() const { return played_.plays_back(); }
  /// Throws core::InputError: a clip of footage draws no strokes.
  [[nodiscard]] graph::MotionGraph motion(int count, const core::Context& context) const override;
  /// Returns the SD of the times that one frame shows, frames.
  [[nodiscard]] double amplitude() const { return front_.bound() / 3; }

 private:
  [[nodiscard]] double step() const;
  [[nodiscard]] double time(std::int64_t frame) const;
  [[nodiscard]] double bound(std::int64_t frame) const;

  std::shared_ptr<const std::vector<cv::Mat>> footage_;
  FootageSynthesisOptions options_;
  MotionScale scale_;
  LikeMoments moments_;
  TimeFront front_;
  PlayedFrames played_;
  CopiedShare copied_;
  std::int64_t next_ = 0;
};

}  // namespace emberfold::pipeline
