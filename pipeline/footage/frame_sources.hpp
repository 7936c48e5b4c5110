// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include <opencv2/core/mat.hpp>

namespace emberfold::pipeline {

/// Names what a place of a drawn frame shows.
enum class SourceKind : std::uint8_t {
  still,    ///< static pixels of the clip
  played,   ///< a frame of the clip, or an interpolation of two neighbours
  turning,  ///< a transition between two similar frames, around a jump
  carried,  ///< pixels of a stroke from another place or time
  hiding    ///< pixels from next to a stroke that is hidden
};
constexpr int kSourceKinds = 5;

/// Names the source in the clip of a drawn frame's pixels, by cell, at most 80 cells a side.
struct FrameSources {
  cv::Mat1i frames;  ///< numbers of the clip's frames
  cv::Mat1b kinds;   ///< SourceKind

  [[nodiscard]] SourceKind kind(int y, int x) const { return static_cast<SourceKind>(kinds(y, x)); }
};

/// Returns the number of cells for a frame of this size.
cv::Size source_cells(cv::Size frame);

/// Returns sources of one kind and frame.
FrameSources same_sources(cv::Size cells, int frame, SourceKind kind);

/// Marks cells as still where most pixels do not move (moving_pixels), except those of transferred strokes.
void mark_still(FrameSources& sources, const cv::Mat1b& moves);

}  // namespace emberfold::pipeline
