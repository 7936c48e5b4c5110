// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <deque>

#include <opencv2/core/mat.hpp>

#include "core/clip.hpp"
#include "core/context.hpp"
#include "graph/patch.hpp"

namespace emberfold::pipeline {

/// Holds one frame in a window's format.
struct WindowFrame {
  cv::Mat levels;  ///< CV_8U unchanged where that is white = 255, else CV_32F; 1 or 3 channels
  cv::Mat1f luma;
};
/// Converts a frame of a clip to this format. O(pixels).
WindowFrame make_window_frame(const cv::Mat& frame, const core::ClipInfo& info);

/// Returns the number of frames that a window takes before they are processed, 1…8: it holds their neighbours
/// as well.
int frames_at_once(const core::ClipInfo& info);

/// Holds consecutive frames of a clip, and the motion between neighbouring ones.
class FrameWindow {
 public:
  /// Appends the next frame.
  void push(WindowFrame frame);
  /// Computes the missing motion (optical flow, both senses) between frames, in parallel.
  void prepare(const core::Context& context);
  /// Drops the frames before `frame`.
  void drop_before(int frame);

  [[nodiscard]] int first() const { return first_; }                                    ///< frame held
  [[nodiscard]] int end() const { return first_ + static_cast<int>(entries_.size()); }  ///< one past the last
  [[nodiscard]] const cv::Mat& levels(int frame) const { return entry(frame).levels; }
  /// Returns where point p of frame `from` moves in the next frame or (`step` −1) in the previous one.
  [[nodiscard]] graph::Point carry(graph::Point p, int from, int step) const;

 private:
  struct Entry : WindowFrame {
    cv::Mat on, back;  // motion to the next frame, and from it; luma is dropped once both are known
  };
  [[nodiscard]] const Entry& entry(int frame) const {
    return entries_[static_cast<std::size_t>(frame - first_)];
  }

  int first_ = 0;
  cv::Size size_;
  std::deque<Entry> entries_;
};

}  // namespace emberfold::pipeline
