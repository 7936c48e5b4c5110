// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include <opencv2/core/types.hpp>

// Packs numbers as text for a page, which unpacks them with the browser's inflate (apps/page/unpack.js).
namespace emberfold::apps {

/// Packs bytes, deflated (zlib), as base64.
std::string packed_bytes(std::span<const unsigned char> bytes);

/// Packs doubles, least byte first, deflated (zlib), as base64.
std::string packed_numbers(std::span<const double> numbers);

/// Packs an image of whole numbers without loss. The number of channels, 1 or 3, is that of values per pixel.
/// Three channels become one of lightness and two of colour (YCoCg-R). Every value becomes its difference
/// from the median of left, upper and left + upper − upper left (LOCO-I), with the sign as lowest bit. All
/// low bytes come before all high ones; then deflated (zlib), as base64. Arithmetic is modulo 2^16.
std::string packed_image(std::span<const std::int16_t> values, cv::Size size);

}  // namespace emberfold::apps
