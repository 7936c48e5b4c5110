// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "core/io/tiff_pages.hpp"

namespace emberfold::io {

/// Note on a dropped alpha channel, as for other images.
inline constexpr std::string_view kAlphaDropped = "its alpha channel is dropped";

/// Meaning of the numbers of a page, from its head.
struct SampleMeaning {
  bool is_colour = false;     ///< red, green and blue
  bool is_converted = false;  ///< into red, green and blue, by libtiff: CMYK, YCbCr, Lab
  bool is_inverted = false;   ///< 0 is white
  int channels = 1;           ///< grey: samples that are separate channels
  int depth = CV_8U;          ///< CV_8U (1 to 8 bits), CV_16U (9 to 16) or CV_32F (real, signed, 32 bits)
  std::vector<std::string> notes = {};  ///< as text that follows the file's name
};

/// Interprets a page's values. Throws core::IoError (without a prefix) where their kind is not supported.
SampleMeaning meaning_of(const TiffPage& page);

/// Returns the samples that make the picture, in its order: blue, green and red, or one.
std::vector<int> samples_of(const TiffPage& page, const SampleMeaning& meaning);

/// Chooses the sample that is read where samples are separate channels, or follow red, green and blue;
/// `channel`: the requested one. Warns where the first of several is chosen by default. Throws
/// core::InputError where there is no such channel.
void choose_sample(const std::filesystem::path& path, TiffPage& page, std::optional<int> channel,
                   const core::Warn& warn);

/// Returns the value that becomes 0 where 0 is white.
double white_of(const TiffPage& page, const SampleMeaning& meaning);

/// Turns stored values into a picture: white is bright, the first row is the top one.
cv::Mat upright_picture(cv::Mat stored, const TiffPage& page, const SampleMeaning& meaning);

}  // namespace emberfold::io
