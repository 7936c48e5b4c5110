// SPDX-License-Identifier: Apache-2.0
#include "pipeline/inference/frame_window.hpp"

#include <utility>

#include <opencv2/imgproc.hpp>

#include "core/clip.hpp"
#include "pipeline/frame_motion.hpp"
#include "sketch/steadying/carried_sketch.hpp"

namespace emberfold::pipeline {

void FrameWindow::push(cv::Mat levels) {
  cv::Mat1f luma = core::luma(levels), halved;
  cv::pyrDown(luma, halved);
  entries_.push_back({std::move(levels), std::move(luma), std::move(halved), {}, {}});
}

void FrameWindow::prepare(const core::Context& context) {
  compute_motion(entries_, context);
}

void FrameWindow::drop_before(int frame) {
  for (; first_ < frame && !entries_.empty(); ++first_) entries_.pop_front();
}

graph::Point FrameWindow::carry(graph::Point p, int from, int step) const {
  const Entry& pair = entry(step > 0 ? from : from - 1);
  return p + sketch::sample_motion(step > 0 ? pair.on : pair.back, pair.luma.size(), p);
}

}  // namespace emberfold::pipeline
