// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>

#include <opencv2/core/mat.hpp>

#include "core/context.hpp"
#include "graph/motion_graph.hpp"
#include "pipeline/clip_synthesis.hpp"

namespace emberfold::pipeline {

/// A way of making the frames of a new clip, one after the other without end.
/// The frames are the same at any number of threads and calls.
class FrameMethod {
 public:
  virtual ~FrameMethod() = default;

  /// Draws the next `count` frames, CV_8U, on several threads and hands them to `take`.
  /// They are handed over in order and one at a time, while the next ones are drawn. Throws core::Cancelled.
  virtual void each(int count, const std::function<void(cv::Mat)>& take, const core::Context& context) = 0;
  /// Returns the best number of frames per call, at least 1.
  [[nodiscard]] virtual int batch() const = 0;
  /// Returns statistics of the strokes of the frames so far; null where none are drawn.
  [[nodiscard]] virtual const SynthesisStatistics* statistics() const { return nullptr; }
  /// Returns the graphs of the first `count` ≥ 1 frames with their links. Throws core::InputError where no
  /// strokes are drawn; core::Cancelled.
  [[nodiscard]] virtual graph::MotionGraph motion(int count, const core::Context& context) const = 0;

 protected:
  FrameMethod() = default;
  FrameMethod(const FrameMethod&) = default;
  FrameMethod(FrameMethod&&) = default;
  FrameMethod& operator=(const FrameMethod&) = default;
  FrameMethod& operator=(FrameMethod&&) = default;
};

}  // namespace emberfold::pipeline
