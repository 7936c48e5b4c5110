// SPDX-License-Identifier: Apache-2.0
#include "pipeline/inference/frame_window.hpp"

#include <utility>

#include "core/clip.hpp"
#include "core/clip/frame_stream.hpp"
#include "pipeline/frame_motion.hpp"

namespace emberfold::pipeline {

WindowFrame make_window_frame(const cv::Mat& frame, const core::ClipInfo& info) {
  WindowFrame made;
  const cv::Mat levels = core::to_levels(frame, info);
  made.luma = core::luma(levels);
  made.levels = frame.depth() == CV_8U && info.white == 255 ? frame : levels;
  return made;
}

int frames_at_once(const core::ClipInfo& info) {
  return static_cast<int>((core::frames_at_once(info.width, info.height, info.channels) + 1) / 2);
}

void FrameWindow::push(WindowFrame frame) {
  size_ = frame.luma.size();
  entries_.push_back({std::move(frame), {}, {}});
}

void FrameWindow::prepare(const core::Context& context) {
  compute_motion(entries_, context);
  for (Entry& entry : entries_)
    if (!entry.on.empty()) entry.luma.release();
}

void FrameWindow::drop_before(int frame) {
  for (; first_ < frame && !entries_.empty(); ++first_) entries_.pop_front();
}

graph::Point FrameWindow::carry(graph::Point p, int from, int step) const {
  const Entry& pair = entry(step > 0 ? from : from - 1);
  return p + sample_motion(step > 0 ? pair.on : pair.back, size_, p);
}

}  // namespace emberfold::pipeline
