// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <deque>
#include <optional>
#include <string_view>
#include <utility>

#include <opencv2/core/mat.hpp>

#include "core/clip.hpp"
#include "core/clip/frame_stream.hpp"
#include "core/clip/masked_source.hpp"
#include "core/context.hpp"
#include "graph/attribute_graph.hpp"

namespace emberfold::pipeline {

/// Returns the graph without the patches outside the mask (CV_8U, 0 outside; empty: all stay).
graph::AttributeGraph inside_mask(const graph::AttributeGraph& graph, const cv::Mat& mask);

/// Sketches the frames of a clip, some at once on several threads.
/// Calls before(t) for each frame in order, then make(t, levels, mask) in parallel for those that are not
/// among the first `known`, then take(t, result) in order. `levels`: CV_32F, 1 or 3 channels, white = 255;
/// `mask`: where the source's structure counts (core::mask_of); empty: everywhere. Returns the number of
/// frames. Throws core::Cancelled.
template <class Before, class Make, class Take>
int stream_sketches(core::FrameSource& source, std::string_view stage, const core::Context& context,
                    int known, const Before& before, const Make& make, const Take& take) {
  using Result = decltype(make(0, cv::Mat{}, cv::Mat{}));
  const auto& info = source.info();
  std::deque<cv::Mat> masks;  // of the frames read but not yet taken
  int taken = 0;
  return core::stream_frames(
      source, stage, info.frames, context,
      [&](int t, const cv::Mat&) {
        masks.push_back(core::mask_of(source));
        before(t);
      },
      [&](int t, const cv::Mat& frame) {
        if (t < known) return std::optional<Result>();
        const cv::Mat& mask = masks[static_cast<std::size_t>(t - taken)];
        return std::optional<Result>(make(t, core::to_levels(frame, info), mask));
      },
      [&](int t, std::optional<Result> result) {
        masks.pop_front();
        ++taken;
        if (result) take(t, std::move(*result));
      });
}

}  // namespace emberfold::pipeline
