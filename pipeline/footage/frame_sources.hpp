// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include <opencv2/core/mat.hpp>

namespace emberfold::pipeline {

/// What a place of a drawn frame shows.
enum class SourceKind : std::uint8_t {
  still,    ///< what does not move in the clip
  played,   ///< a frame of the clip, or what lies between two neighbouring ones
  turning,  ///< the way from one frame to a like one, about a jump
  carried,  ///< pixels of a stroke from another place or time
  hiding    ///< pixels from beside a stroke that is not to be seen
};
constexpr int kSourceKinds = 5;

/// Tells where in the clip the pixels of a drawn frame come from, for cells of the frame, at most 80 a side.
struct FrameSources {
  cv::Mat1i frames;  ///< numbers of the clip's frames
  cv::Mat1b kinds;   ///< SourceKind

  [[nodiscard]] SourceKind kind(int y, int x) const { return static_cast<SourceKind>(kinds(y, x)); }
};

/// Returns the number of cells that a frame is told in.
cv::Size source_cells(cv::Size frame);

/// Returns sources of one kind and frame.
FrameSources same_sources(cv::Size cells, int frame, SourceKind kind);

/// Marks cells as still most of whose pixels do not move (moving_pixels), but for those of carried strokes.
void mark_still(FrameSources& sources, const cv::Mat1b& moves);

}  // namespace emberfold::pipeline
