// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core/mat.hpp>

#include "core/clip.hpp"
#include "core/context.hpp"
#include "core/model_archive.hpp"

// What a clip shows behind all that moves: a bridge behind a flag. Nothing moves in a new clip where nothing
// ever moved in its source.
namespace emberfold::sketch {

/// A frame of pixels that kept still through a whole clip. Empty where it is not known.
struct StaticPixels {
  cv::Mat levels;  ///< CV_8U, 1 or 3 channels: means; 0 where the clip did not keep still
  cv::Mat still;   ///< CV_8U, 255 where it did
  [[nodiscard]] bool empty() const { return levels.empty(); }
};

/// Still is what keeps to its mean, within 14 grey levels and what shaking by 1½ px does to an edge, in all
/// channels and all but a hundredth of the frames, where 2 px about it do too: what passes is seen even where
/// it rarely does. Reads the clip twice from its first frame, one frame in memory; of long clips some 240
/// frames tell. Throws core::Cancelled.
StaticPixels find_static_pixels(core::FrameSource& source, const core::Context& context);

/// The arrays "backdrop" and "backdrop_still" beside a motion model's own.
void add_static_pixels(core::ModelArchive& archive, const StaticPixels& static_pixels);
/// Empty where the archive has none; core::IoError, naming the array, where they do not fit the frame.
StaticPixels read_static_pixels(const core::ModelArchive& archive, cv::Size frame);

}  // namespace emberfold::sketch
