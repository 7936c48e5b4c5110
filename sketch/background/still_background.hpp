// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include <opencv2/core/mat.hpp>

#include "core/model_archive.hpp"
#include "graph/attribute_graph.hpp"
#include "sketch/background/level_range.hpp"
#include "sketch/background/static_pixels.hpp"
#include "sketch/rendering/render.hpp"

// What lies between strokes where it keeps still: a black sky behind a fire belongs to no stroke, and
// diffusion from the strokes alone would paint it in the fire's colour.
namespace emberfold::sketch {

/// One frame's means over cells of kBackgroundCell px.
constexpr int kBackgroundCell = 16;
struct FrameBackground {
  cv::Mat levels;     ///< CV_32F, 1 or 3 channels, a cell each, white = 255
  cv::Mat uncovered;  ///< CV_8U, 255 where no patch lies in the cell or near it
  LevelRange level_range = {};
};
/// `levels`: the frame, CV_32F, white = 255.
FrameBackground measure_background(const cv::Mat& levels, const graph::AttributeGraph& graph);

/// The ground that is the same in all frames. Empty where none is known.
struct Background {
  cv::Mat levels;  ///< CV_32F, 1 or 3 channels, a cell each, white = 255
  cv::Mat
      still;  ///< CV_8U, 255 where the ground was seen in a fifth of the frames and kept within a few levels
  LevelRange level_range = {};  ///< of all frames, strokes and all
  StaticPixels static_pixels = {};
  [[nodiscard]] bool empty() const { return levels.empty(); }
};
/// Of these frames, at least one. O(cells · frames).
Background estimate_background(std::span<const FrameBackground> frames);

/// A still ground pixel by pixel, made once for all frames that hold it. Empty where nothing is still.
struct BackgroundImage {
  cv::Mat levels;      ///< CV_32F, 1 or 3 channels, white = 255; anything where it is not still
  cv::Mat still;       ///< CV_8U, 255 where it is
  cv::Mat fixed = {};  ///< CV_8U, 255 where nothing may cover it, the backdrop; may be empty
  cv::Mat share = {};  ///< CV_32F, as `fixed`: of the backdrop, 1 where it is fixed, less towards its edge
  [[nodiscard]] bool empty() const { return still.empty(); }
};
BackgroundImage expand_background(const Background& background, cv::Size frame, int channels);

/// What patches show; what is fixed; and, farther than kBackgroundDistance px from all patches, the still
/// ground. Channels as the part's. `opacity` (CV_32F, 0…1): how much there is of what the part shows; what
/// is there in part keeps the ground off from so much nearer. Empty: all of it.
constexpr double kBackgroundDistance = 12;
sketch::Sketchable add_background_pixels(const sketch::Sketchable& part, const BackgroundImage& background,
                                         const cv::Mat& opacity = {});

/// Lets the backdrop, where there is one, take its share of what was drawn.
void paste_static_pixels(cv::Mat& levels, const BackgroundImage& background);

/// At each pixel the greatest of `ranks` (CV_8U) that lie within kBackgroundDistance px, by the distance that
/// add_background_pixels goes by.
cv::Mat spread_maximum(const cv::Mat& ranks);

/// The arrays "ground" and "ground_still" beside a motion model's own, and those of the levels seen.
void add_background(core::ModelArchive& archive, const Background& background);
/// Empty where the archive has none; core::IoError, naming the array, where they do not fit the frame.
Background read_background(const core::ModelArchive& archive, cv::Size frame);

}  // namespace emberfold::sketch
