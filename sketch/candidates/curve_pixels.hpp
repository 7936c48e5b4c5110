// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include <opencv2/core/types.hpp>

#include "sketch/detection/curve_tracing.hpp"

namespace emberfold::sketch {

/// Holds a pixel near a curve.
struct CurvePixel {
  std::int32_t index;  ///< y · width + x
  float across;        ///< px from the curve, positive to its right
};

/// Holds a part of a curve some px long: the points from `first` to before `last`.
struct CurveSection {
  std::uint32_t first = 0, last = 0;
};

/// Lets a closed curve begin at its point of most contrast. O(points).
void begin_at_strongest(Chain& chain);

/// Cuts a curve into sections of about `length` px. A closed curve is turned so that its point of most
/// contrast is in the middle of the first section: neither where it was entered nor its direction matters.
/// O(points).
std::vector<CurveSection> cut_into_sections(Chain& chain, double length);

/// Appends the pixels within `reach` px of a section that are nearest to its points, not to those of its
/// neighbours, and not beyond a free end. Right is the side of each point's normal (−sin θ, cos θ).
/// O(pixels · points).
void add_section_pixels(const Chain& chain, const CurveSection& section, double reach, cv::Size frame,
                        std::vector<CurvePixel>& pixels);

}  // namespace emberfold::sketch
