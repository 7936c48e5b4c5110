// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include <opencv2/core/mat.hpp>

#include "core/model_archive.hpp"
#include "graph/attribute_graph.hpp"
#include "sketch/background/background.hpp"
#include "sketch/rendering/render.hpp"

// The still background between strokes. A black sky behind a fire belongs to no stroke; diffusion from the
// strokes alone would paint it in the colour of the fire.
namespace emberfold::sketch {

constexpr int kBackgroundCell = 16;  ///< px, side of a cell

/// Measures a frame's cells and which of them its patches leave open. `levels`: CV_32F, 1 or 3 channels,
/// white = 255. O(pixels).
FrameBackground measure_background(const cv::Mat& levels, const graph::AttributeGraph& graph);

/// Estimates the still background from the cells of at least one frame. Leaves `static_pixels` empty: see
/// find_static_pixels. O(cells · frames).
Background estimate_background(std::span<const FrameBackground> frames);

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
