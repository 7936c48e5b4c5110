// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/io/tiff_pages.hpp"

namespace emberfold::io {

/// Maps frame, slice and channel of a TIFF stack to its pages, with size of a pixel and rate.
struct TiffAxes {
  int channels = 1, slices = 1, frames = 1;
  bool slices_are_frames = false;  ///< the file calls its frames slices
  std::vector<int>
      planes;  ///< page of (frame, slice, channel), the channel fastest: its index among the pages given
  std::optional<double> pixel_um;        ///< side of a pixel, µm
  std::optional<double> interval;        ///< from frame to frame, s
  std::vector<double> times = {};        ///< of each frame, s from the first, where they are uneven
  std::vector<std::string> doubts = {};  ///< oddities in the metadata, as text that follows the file's name

  [[nodiscard]] int plane(int frame, int slice, int channel) const {
    const auto at = std::int64_t{frame} * slices + slice;
    return planes[static_cast<std::size_t>(at * channels + channel)];
  }
};

/// Reads the axes that OME-XML, ImageJ or tifffile left in the first page's description; without them, or
/// where they do not fit the number of pages (a doubt then), every page is a frame. Throws core::IoError that
/// names the file where its planes are in other files or are missing between others, or where an axis is
/// neither time, channel nor slice.
TiffAxes read_tiff_axes(const std::filesystem::path& path, const std::vector<TiffPage>& pages);

/// Reads the axes from one kind of description, which must be present.
TiffAxes read_imagej_axes(const std::filesystem::path& path, const std::vector<TiffPage>& pages);
TiffAxes read_ome_axes(const std::filesystem::path& path, const std::vector<TiffPage>& pages);
TiffAxes read_shaped_axes(const std::filesystem::path& path, const std::vector<TiffPage>& pages);

/// Returns the number of pages that the description of the first page declares; 0: unknown.
std::uint64_t pages_by_head(const TiffPage& first);
/// Returns the same from one kind of description.
std::uint64_t pages_by_imagej(const TiffPage& first);
std::uint64_t pages_by_ome(const TiffPage& first);
std::uint64_t pages_by_shape(const TiffPage& first);

/// Returns whether tifffile's description lists the planes of this single page as an axis of pages.
bool lists_planes(const TiffPage& page);

/// A run of pages and the plane that it begins with.
struct PageRun {
  std::optional<int> page, planes;  ///< none: the first; all, or one where `page` is given
  int channel = 0, slice = 0, frame = 0;
};

/// Fills `axes.planes` with the pages of the runs; `order`: of C, Z and T, the fastest first. Drops
/// incomplete frames at the end (a doubt). Throws core::IoError where a plane between others is missing.
void place_pages(const std::filesystem::path& path, const std::string& order,
                 const std::vector<PageRun>& runs, std::size_t pages, TiffAxes& axes);

/// Sets the usual interval between frames, unless it is known, from the times of single ones (frame, s).
/// Where these are uneven, also sets `times` and adds a doubt.
void take_frame_times(std::vector<std::pair<int, double>> times, TiffAxes& axes);

/// Returns axes in which every page is a frame.
TiffAxes plain_axes(const std::vector<TiffPage>& pages);

/// Returns µm of a unit of length, seconds of a unit of time; nothing for other words.
std::optional<double> um_of(std::string_view unit);
std::optional<double> seconds_of(std::string_view unit);

}  // namespace emberfold::io
