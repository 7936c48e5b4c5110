// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core/mat.hpp>

#include "core/clip.hpp"
#include "core/context.hpp"
#include "core/model_archive.hpp"
#include "sketch/background/background.hpp"

// Pixels that keep still through a whole clip, for instance a bridge behind a flag. In new clips nothing
// moves there.
namespace emberfold::sketch {

/// Finds the pixels that stay near their mean level through the whole clip. A pixel is still where in all
/// channels, and in all but a hundredth of the frames, it differs from its mean by at most 14 grey levels and
/// what shaking by 1.5 px does to an edge; so must all pixels within 2 px. Reads the clip twice from its
/// first frame, one frame in memory; about 240 evenly chosen frames of a long clip count. Throws
/// core::Cancelled.
StaticPixels find_static_pixels(core::FrameSource& source, const core::Context& context);

/// Adds the arrays "backdrop" and "backdrop_still" to a motion model's archive; nothing for an empty value.
void add_static_pixels(core::ModelArchive& archive, const StaticPixels& static_pixels);
/// Reads them from an archive; empty where it has none. Throws core::IoError, naming the array, where the
/// arrays do not fit the frame.
StaticPixels read_static_pixels(const core::ModelArchive& archive, cv::Size frame);

}  // namespace emberfold::sketch
