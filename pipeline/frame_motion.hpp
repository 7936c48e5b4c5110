// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "core/context.hpp"
#include "core/parallel.hpp"
#include "dytex/measures/optical_flow.hpp"
#include "graph/patch.hpp"

namespace emberfold::pipeline {

/// Computes the missing motion between neighbouring entries, in parallel: `on`, from the frame `luma` to the
/// next, and `back`, from the next to it. At most 2^14 vectors each: more do not make sketches more
/// consistent. `entries`: by index, in order of the frames. Throws core::Cancelled.
template <class Entries>
void compute_motion(Entries& entries, const core::Context& context) {
  constexpr double kMostVectors = 1 << 14;
  std::vector<std::size_t> pairs;
  for (std::size_t i = 0; i + 1 < entries.size(); ++i)
    if (entries[i].on.empty()) pairs.push_back(i);
  core::parallel_for(pairs.size(), context, [&](std::size_t k) {
    auto& entry = entries[pairs[k]];
    const cv::Mat1f& next = entries[pairs[k] + 1].luma;
    entry.on = dytex::optical_flow(entry.luma, next, kMostVectors);
    entry.back = dytex::optical_flow(next, entry.luma, kMostVectors);
  });
}

/// Returns the motion at a place of a frame of `size` px. `motion`: CV_32FC2, px; it may be smaller than the
/// frame, and is interpolated bilinearly.
graph::Point sample_motion(const cv::Mat& motion, cv::Size size, graph::Point p);

}  // namespace emberfold::pipeline
