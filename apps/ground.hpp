// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include <opencv2/core/mat.hpp>

#include "apps/backdrop.hpp"
#include "apps/seen_levels.hpp"
#include "core/model_archive.hpp"
#include "graph/attribute_graph.hpp"
#include "sketch/render.hpp"

// What lies between strokes where it keeps still: a black sky behind a fire belongs to no stroke, and
// diffusion from the strokes alone would paint it in the fire's colour.
namespace emberfold::apps {

/// One frame's means over cells of kGroundCell px.
constexpr int kGroundCell = 16;
struct FrameGround {
  cv::Mat levels;  ///< CV_32F, 1 or 3 channels, a cell each, white = 255
  cv::Mat open;    ///< CV_8U, 255 where no patch lies in the cell or near it
  SeenLevels seen = {};
};
/// `levels`: the frame, CV_32F, white = 255.
FrameGround measure_ground(const cv::Mat& levels, const graph::AttributeGraph& graph);

/// The ground that is the same in all frames. Empty where none is known.
struct Ground {
  cv::Mat levels;  ///< CV_32F, 1 or 3 channels, a cell each, white = 255
  cv::Mat
      still;  ///< CV_8U, 255 where the ground was seen in a fifth of the frames and kept within a few levels
  SeenLevels seen = {};  ///< of all frames, strokes and all
  Backdrop backdrop = {};
  [[nodiscard]] bool empty() const { return levels.empty(); }
};
/// Of these frames, at least one. O(cells · frames).
Ground still_ground(std::span<const FrameGround> frames);

/// A still ground pixel by pixel, made once for all frames that hold it. Empty where nothing is still.
struct WholeGround {
  cv::Mat levels;      ///< CV_32F, 1 or 3 channels, white = 255; anything where it is not still
  cv::Mat still;       ///< CV_8U, 255 where it is
  cv::Mat fixed = {};  ///< CV_8U, 255 where nothing may cover it, the backdrop; may be empty
  cv::Mat share = {};  ///< CV_32F, as `fixed`: of the backdrop, 1 where it is fixed, less towards its edge
  [[nodiscard]] bool empty() const { return still.empty(); }
};
WholeGround whole_ground(const Ground& ground, cv::Size frame, int channels);

/// What patches show; what is fixed; and, farther than kGroundAway px from all patches, the still ground.
/// Channels as the part's. `presence` (CV_32F, 0…1): how much there is of what the part shows; what is there
/// in part keeps the ground off from so much nearer. Empty: all of it.
constexpr double kGroundAway = 12;
sketch::Sketchable with_ground(const sketch::Sketchable& part, const WholeGround& ground,
                               const cv::Mat& presence = {});

/// Lets the backdrop, where there is one, take its share of what was drawn.
void lay_backdrop(cv::Mat& levels, const WholeGround& ground);

/// At each pixel the greatest of `ranks` (CV_8U) that lie within kGroundAway px, by the distance that
/// with_ground goes by.
cv::Mat greatest_near(const cv::Mat& ranks);

/// The arrays "ground" and "ground_still" beside a motion model's own, and those of the levels seen.
void add_ground(core::ModelArchive& archive, const Ground& ground);
/// Empty where the archive has none; core::IoError, naming the array, where they do not fit the frame.
Ground read_ground(const core::ModelArchive& archive, cv::Size frame);

}  // namespace emberfold::apps
