// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core/mat.hpp>

#include "graph/attribute_graph.hpp"
#include "sketch/detection/junctions.hpp"

namespace emberfold::sketch {

/// Places patches on curves about every `spacing` px, evenly between meetings and ends. Fits each one's
/// attributes to the image, and joins neighbours along a curve by edges. A meeting becomes one patch that its
/// curves share. Patches on a curve lie on their profile (fit_patch), those of meetings where the curves
/// meet. `noise`: grey levels, SD of the pixels. Ids count from 0. O(patches) fits.
graph::AttributeGraph place_patches(const CurveNetwork& network, const ScaleSpace& space,
                                    const cv::Mat& levels, double spacing, double noise);

}  // namespace emberfold::sketch
