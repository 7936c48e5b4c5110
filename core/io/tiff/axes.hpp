// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/io/tiff_pages.hpp"

namespace emberfold::io {

/// Says which page of a TIFF stack shows which channel and slice of which frame, and how large and fast it
/// is.
struct TiffAxes {
  int channels = 1, slices = 1, frames = 1;
  bool slices_are_frames = false;  ///< the file calls its frames slices
  std::vector<int>
      planes;  ///< page of (frame, slice, channel), the channel fastest: its index among the pages given
  std::optional<double> pixel_um;  ///< side of a pixel, µm
  std::optional<double> interval;  ///< from frame to frame, s
  std::vector<std::string> doubts =
      {};  ///< what of the metadata is odd, in words that follow the file's name

  [[nodiscard]] int plane(int frame, int slice, int channel) const {
    const auto at = std::int64_t{frame} * slices + slice;
    return planes[static_cast<std::size_t>(at * channels + channel)];
  }
};

/// Reads the axes that OME-XML or ImageJ left in the first page's description; without them, or where they
/// do not fit the number of pages (a doubt then), every page is a frame. Throws core::IoError that names the
/// file where its planes lie in other files or are missing between others.
TiffAxes read_tiff_axes(const std::filesystem::path& path, const std::vector<TiffPage>& pages);

/// The same from one kind of description, which must be of it.
TiffAxes read_imagej_axes(const std::vector<TiffPage>& pages);
TiffAxes read_ome_axes(const std::filesystem::path& path, const std::vector<TiffPage>& pages);

/// Every page is a frame.
TiffAxes plain_axes(const std::vector<TiffPage>& pages);

/// Returns µm of a unit of length, seconds of a unit of time; nothing for other words.
std::optional<double> um_of(std::string_view unit);
std::optional<double> seconds_of(std::string_view unit);

}  // namespace emberfold::io
