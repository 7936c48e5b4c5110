// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include <opencv2/core/mat.hpp>

#include "core/model_archive.hpp"
#include "graph/attribute_graph.hpp"
#include "sketch/background/level_range.hpp"
#include "sketch/background/patch_distance.hpp"
#include "sketch/background/static_pixels.hpp"
#include "sketch/rendering/render.hpp"

// The still background between strokes. A black sky behind a fire belongs to no stroke; diffusion from the
// strokes alone would paint it in the colour of the fire.
namespace emberfold::sketch {

constexpr int kBackgroundCell = 16;  ///< px, side of a cell

/// Holds the mean levels of one frame over cells of kBackgroundCell px.
struct FrameBackground {
  cv::Mat levels;     ///< CV_32F, 1 or 3 channels, a cell each, white = 255
  cv::Mat uncovered;  ///< CV_8U, 255 where no patch lies in the cell or near it
  LevelRange level_range = {};
};
/// Measures a frame's cells and which of them its patches leave open. `levels`: CV_32F, 1 or 3 channels,
/// white = 255. O(pixels).
FrameBackground measure_background(const cv::Mat& levels, const graph::AttributeGraph& graph);

/// Holds the still background of a clip and the range of its levels. Empty where it is not known.
struct Background {
  cv::Mat levels;  ///< CV_32F, 1 or 3 channels, a cell each, white = 255
  /// CV_8U, 255 where a cell is uncovered in a fifth of the frames and its SD over them is below 8 levels.
  cv::Mat still;
  LevelRange level_range = {};  ///< of all frames, strokes included
  StaticPixels static_pixels = {};
  [[nodiscard]] bool empty() const { return levels.empty(); }
};
/// Estimates the still background from the cells of at least one frame. Leaves `static_pixels` empty: see
/// find_static_pixels. O(cells · frames).
Background estimate_background(std::span<const FrameBackground> frames);

/// Holds the still background pixel by pixel, made once for all frames that show it. Empty where nothing is
/// still.
struct BackgroundImage {
  cv::Mat levels;      ///< CV_32F, 1 or 3 channels, white = 255; anything where it is not still
  cv::Mat still;       ///< CV_8U, 255 where the background is still
  cv::Mat fixed = {};  ///< CV_8U, 255 at static pixels, which nothing covers; may be empty
  cv::Mat share = {};  ///< CV_32F: weight of static pixels, 1 where fixed, less at their edge
  [[nodiscard]] bool empty() const { return still.empty(); }
};
/// Spreads the still background over the pixels of a frame. `channels`: 1 or 3.
BackgroundImage expand_background(const Background& background, cv::Size frame, int channels);

/// Adds the pixels of the still background to the drawn patches of a frame.
/// Added are the static pixels and, farther than kBackgroundDistance px from all patches, the still cells.
/// `part`: as many channels as the background. `opacity`: CV_32F, 0…1, of the part's pixels; a patch of
/// opacity a keeps the background off as if it were (1 − a)·kBackgroundDistance px farther away. Empty: all
/// opaque.
sketch::Sketchable add_background_pixels(const sketch::Sketchable& part, const BackgroundImage& background,
                                         const cv::Mat& opacity = {});

/// Blends the static pixels over a drawn frame by their share. `levels`: CV_32F, changed in place.
void paste_static_pixels(cv::Mat& levels, const BackgroundImage& background);

/// Returns at each pixel the greatest of the ranks within kBackgroundDistance px. `ranks`: CV_8U. Distances
/// are those of add_background_pixels.
cv::Mat spread_maximum(const cv::Mat& ranks);

/// Adds the arrays "ground" and "ground_still" to a motion model's archive, and those of the level range and
/// the static pixels.
void add_background(core::ModelArchive& archive, const Background& background);
/// Reads the background from an archive; empty where it has none. Throws core::IoError, naming the array,
/// where the arrays do not fit the frame.
Background read_background(const core::ModelArchive& archive, cv::Size frame);

}  // namespace emberfold::sketch
