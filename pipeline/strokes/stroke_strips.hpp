// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core/mat.hpp>

#include "pipeline/strokes/stroke_play.hpp"

namespace emberfold::pipeline {

/// The part of a frame that strips of strokes show.
struct StrokeStrips {
  cv::Mat levels;  ///< CV_8U, as the clip's frames; anything where not shown
  cv::Mat1b mask;  ///< 255 where a strip shows its pixels
};

/// Draws the strips of a moment's strokes: the clip's pixels within 16 px of each stroke's curves.
/// Where strips overlap, the nearest curve's is seen; a gap of some pixels stays open between strips of
/// different moments, so that no seam is seen. `head`: the frame that strokes which last are drawn from.
/// O(pixels about the strokes).
StrokeStrips draw_strips(const SeenClip& clip, const StrokeFamilies& families, const StrokeMoment& moment,
                         const cv::Mat& head);

}  // namespace emberfold::pipeline
