// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

#include <opencv2/core/mat.hpp>

#include "graph/attribute_graph.hpp"

namespace emberfold::pipeline {

/// Holds the summed gain of the patches of some frames.
struct GainTotals {
  double nats = 0;
  std::size_t patches = 0, positive = 0;

  void add(const GainTotals& other);
};
/// Sums the gain in coding length (sketch::code_patch) of all patches of one frame's graph. `levels`: CV_32F,
/// white = 255.
GainTotals total_gain(const cv::Mat& levels, const graph::AttributeGraph& graph);

}  // namespace emberfold::pipeline
