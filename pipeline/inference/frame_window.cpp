// SPDX-License-Identifier: Apache-2.0
#include "pipeline/inference/frame_window.hpp"

#include <utility>
#include <vector>

#include "core/clip.hpp"
#include "core/parallel.hpp"
#include "dytex/measures/optical_flow.hpp"
#include "sketch/steadying/carried_sketch.hpp"

namespace emberfold::pipeline {

namespace {
constexpr double kMostVectors = 1 << 14;  // of the motion
}

void FrameWindow::push(cv::Mat levels) {
  cv::Mat1f luma = core::luma(levels);
  entries_.push_back({std::move(levels), std::move(luma), {}, {}});
}

void FrameWindow::prepare(const core::Context& context) {
  std::vector<std::size_t> pairs;
  for (std::size_t i = 0; i + 1 < entries_.size(); ++i)
    if (entries_[i].on.empty()) pairs.push_back(i);
  core::parallel_for(pairs.size(), context, [&](std::size_t k) {
    Entry& entry = entries_[pairs[k]];
    const cv::Mat1f& next = entries_[pairs[k] + 1].luma;
    entry.on = dytex::optical_flow(entry.luma, next, kMostVectors);
    entry.back = dytex::optical_flow(next, entry.luma, kMostVectors);
  });
}

void FrameWindow::drop_before(int frame) {
  for (; first_ < frame && !entries_.empty(); ++first_) entries_.pop_front();
}

graph::Point FrameWindow::carry(graph::Point p, int from, int step) const {
  const Entry& pair = entry(step > 0 ? from : from - 1);
  return p + sketch::sample_motion(step > 0 ? pair.on : pair.back, pair.luma.size(), p);
}

}  // namespace emberfold::pipeline
