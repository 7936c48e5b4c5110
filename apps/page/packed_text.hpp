// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include <opencv2/core/types.hpp>

// Numbers as text for a page, which takes them apart again by the browser's own inflate
// (apps/page/unpack.js).
namespace emberfold::apps {

/// Doubles, least byte first, deflated (zlib), as base64.
std::string packed_numbers(std::span<const double> numbers);

/// An image of whole numbers, as many channels as there are values to a pixel (1 or 3), all losslessly: three
/// channels become one of lightness and two of colour (YCoCg-R), every value the difference from the median
/// of left, upper and left + upper − upper left (LOCO-I), its sign the lowest bit, all low bytes before all
/// high ones; then deflated (zlib), as base64. Arithmetic is modulo 2^16.
std::string packed_image(std::span<const std::int16_t> values, cv::Size size);

}  // namespace emberfold::apps
