// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core/mat.hpp>

// The picture between the strokes of a clip.
namespace emberfold::sketch {

/// Holds the darkest and the brightest level around each cell, channel by channel. A cell counts the square
/// of pixels within kLevelRangeCell px of its middle. Empty where the range is not known.
struct LevelRange {
  cv::Mat low, high;  ///< CV_8U, 1 or 3 channels, one value a cell
  [[nodiscard]] bool empty() const { return low.empty(); }
};

/// Holds the pixels that keep still through a whole clip. Empty where they are not known.
struct StaticPixels {
  cv::Mat levels;  ///< CV_8U, 1 or 3 channels: means; 0 where the pixel is not still
  cv::Mat still;   ///< CV_8U, 255 where the pixel is still
  [[nodiscard]] bool empty() const { return levels.empty(); }
};

/// Holds the mean levels of one frame over cells of kBackgroundCell px.
struct FrameBackground {
  cv::Mat levels;     ///< CV_32F, 1 or 3 channels, a cell each, white = 255
  cv::Mat uncovered;  ///< CV_8U, 255 where no patch lies in the cell or near it
  LevelRange level_range = {};
};

/// Holds the still background of a clip and the range of its levels. Empty where it is not known.
struct Background {
  cv::Mat levels;  ///< CV_32F, 1 or 3 channels, a cell each, white = 255
  /// CV_8U, 255 where a cell is uncovered in a fifth of the frames and its SD over them is below 8 levels.
  cv::Mat still;
  LevelRange level_range = {};  ///< of all frames, strokes included
  StaticPixels static_pixels = {};
  [[nodiscard]] bool empty() const { return levels.empty(); }
};

/// Holds the still background pixel by pixel, made once for all frames that show it. Empty where nothing is
/// still.
struct BackgroundImage {
  cv::Mat levels;      ///< CV_32F, 1 or 3 channels, white = 255; anything where it is not still
  cv::Mat still;       ///< CV_8U, 255 where the background is still
  cv::Mat fixed = {};  ///< CV_8U, 255 at static pixels, which nothing covers; may be empty
  cv::Mat share = {};  ///< CV_32F: weight of static pixels, 1 where fixed, less at their edge
  [[nodiscard]] bool empty() const { return still.empty(); }
};

}  // namespace emberfold::sketch
