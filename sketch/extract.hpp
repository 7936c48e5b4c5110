// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "core/option_field.hpp"
#include "graph/attribute_graph.hpp"

namespace emberfold::sketch {

/// Holds the settings of extract().
struct ExtractOptions {
  double sensitivity = 0.5;
  double finest_scale = 1.2;
  int scales = 5;
  double min_contrast = 2;
  double min_length = 12;
  double spacing = 5;
  bool edges = true;
  bool outlines = false;
  bool boundaries = false;
  bool colour = false;
  int tile = 2048;

  /// Returns what checks, help and docstrings say of the fields.
  static auto fields() {
    using core::at_least, core::between, core::kOnOff;
    return std::to_array<core::OptionField<ExtractOptions>>({
        {"sensitivity", &ExtractOptions::sensitivity, "S", between(0, 1),
         "Draw what is sure (0) up to all there may be (1): a point on the curve of precision and recall"},
        {"finest_scale", &ExtractOptions::finest_scale, "PX", between(0.7, 20),
         "SD of the finest Gaussian in which creases are detected"},
        {"scales", &ExtractOptions::scales, "N", between(1, 12),
         "Number of scales, each sqrt(2) times the one before"},
        {"min_contrast", &ExtractOptions::min_contrast, "LEVELS", at_least(0),
         "Leave out fainter strokes (grey levels of 255)"},
        {"min_length", &ExtractOptions::min_length, "PX", at_least(0),
         "Leave out shorter curves that end freely"},
        {"spacing", &ExtractOptions::spacing, "PX", between(2, 100),
         "Distance of neighbouring patches along a curve"},
        {"edges", &ExtractOptions::edges, "", kOnOff, "Detect step edges next to ridges and valleys"},
        {"outlines", &ExtractOptions::outlines, "", kOnOff,
         "Trace step edges as closed outlines, and keep of them and of lines what explains the frame (not "
         "with colour)"},
        {"boundaries", &ExtractOptions::boundaries, "", kOnOff,
         "Sketch the boundaries of things in photographs instead: where brightness or texture differ"},
        {"colour", &ExtractOptions::colour, "", kOnOff,
         "Detect structure in two axes of colour too, not only in luma"},
        {"tile", &ExtractOptions::tile, "PX", between(64, 16384),
         "Sketch larger frames in parts of at most this side, with the thresholds of the whole"},
    });
  }
  /// Throws core::InputError naming field, value and range.
  void validate() const;
};

/// Estimates the SD of the pixel noise in grey levels. Median absolute deviation of the finest diagonal
/// wavelet; at least 0.29, the SD of quantisation. `luma`: CV_32F. O(pixels).
double estimate_noise(const cv::Mat& luma);

/// Extracts the primal sketch of one frame. `levels`: CV_32F, 1 or 3 channels, finite, white = 255. Structure
/// is found in luma, with `colour` also in red − green and blue − yellow, scaled so that white noise is as
/// strong in all three; a patch's contrast is that of the axis in which it is strongest. Patches carry their
/// cost and gain. Vertex ids count from 0. A frame without structure gives an empty graph. Throws
/// core::InputError. Steger 1998 (subpixel lines), Lindeberg 1998 (scale); docs/method/sketch.md has the
/// steps.
graph::AttributeGraph extract(const cv::Mat& levels, const ExtractOptions& options);

/// Extracts the sketch along curves that come from elsewhere, in place of those that are found.
/// `probability`: as large as the frame, 0…1, that a curve runs through a pixel; a curve begins where it
/// reaches 1 − sensitivity. Throws core::InputError.
graph::AttributeGraph extract(const cv::Mat& levels, const ExtractOptions& options,
                              const cv::Mat1f& probability);

}  // namespace emberfold::sketch
