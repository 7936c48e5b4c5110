// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sketch/dictionary/dictionary.hpp"

namespace emberfold::sketch {

/// Holds a view with its colours.
struct ColourPatchView {
  PatchView view;
  std::array<std::vector<float>, 3> channel;  ///< blue, green, red, or the grey level three times
};
/// Returns the view of one patch, by index.
ColourPatchView view_patch(const cv::Mat& levels, const graph::AttributeGraph& graph, std::size_t vertex);

/// Checks a frame. Throws core::InputError unless it is CV_32F with 1 or 3 channels and not empty.
void check_levels(const cv::Mat& levels);

/// Returns the half side of a window, px.
inline double window_reach(const PatchView& view) {
  return view.type == graph::PatchType::blob ? view.reach : 1.5 * view.reach;
}

/// Returns the number of pixels that a view spans: reach to both sides and 5 px along, or the window.
inline double count_pixels(const PatchView& view) {
  if (!looks_like_window(view.type, view.degree)) return 2 * view.reach * 5;
  const double side = 2 * window_reach(view);
  return side * side;
}

/// Returns a patch's degree as the dictionary counts it, at most 4.
inline int counted_degree(const graph::AttributeGraph& graph, std::size_t vertex) {
  return static_cast<int>(std::min<std::size_t>(graph.degree(vertex), 4));
}

/// Returns the distance across the curve of a profile's sample, in reaches, −1…1.
inline double profile_position(std::size_t i) {
  return 2.0 * static_cast<double>(i) / static_cast<double>(kProfileSamples - 1) - 1;
}

}  // namespace emberfold::sketch
