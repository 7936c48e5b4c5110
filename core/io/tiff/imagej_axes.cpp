// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <map>

#include "core/io/tiff/axes.hpp"
#include "core/text/format_number.hpp"

namespace emberfold::io {

namespace {

constexpr std::int64_t kSmall = 10000;  // planes; a head that claims more is believed if a quarter exists

// Lines of KEY=VALUE.
using Fields = std::map<std::string, std::string>;

Fields read_fields(const std::string& text) {
  Fields fields;
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    const std::string line = text.substr(begin, end - begin);
    if (const auto equals = line.find('='); equals != std::string::npos)
      fields[line.substr(0, equals)] = line.substr(equals + 1);
    begin = end + 1;
  }
  return fields;
}

std::string word(const Fields& fields, const std::string& key) {
  const auto found = fields.find(key);
  return found == fields.end() ? std::string() : found->second;
}

double number(const Fields& fields, const std::string& key, double otherwise) {
  const auto found = fields.find(key);
  if (found == fields.end()) return otherwise;
  const double value = std::strtod(found->second.c_str(), nullptr);
  return std::isfinite(value) ? value : otherwise;
}

std::int64_t count(const Fields& fields, const std::string& key) {
  const double value = number(fields, key, 1);
  return value >= 1 && value < 1e9 ? std::llround(value) : 1;
}

/// Sets the time between frames. `fps` alone is the speed at which ImageJ plays the stack, not a measured
/// rate.
void read_interval(const Fields& fields, TiffAxes& axes) {
  const std::string named = word(fields, "tunit");
  const auto unit = seconds_of(named.empty() ? "s" : named);
  if (const double step = number(fields, "finterval", 0); step > 0 && unit)
    axes.interval = step * *unit;
  else if (const double fps = number(fields, "fps", 0); fps > 0)
    axes.doubts.push_back(
        "its head has a playback speed (fps=" + core::significant_text(fps, 5) +
        ") but no time between frames (finterval); the frame rate is unknown, --fps sets it");
}

/// Sets the side of a pixel. A resolution in inches is that of a screen or print, which every program writes.
void read_pixel_size(const Fields& fields, const TiffPage& first, TiffAxes& axes) {
  const std::string name = word(fields, "unit");
  const auto unit = um_of(name);
  if (!unit || first.pixels_a_unit <= 0) return;
  if (name == "inch" || name == "in") {
    axes.doubts.push_back("its resolution of " + core::significant_text(first.pixels_a_unit, 5) +
                          " pixels an inch is that of a screen or print; the size of a pixel is unknown, "
                          "--pixel-size sets it");
    return;
  }
  axes.pixel_um = *unit / first.pixels_a_unit;
  if (std::abs(first.aspect - 1) > 0.01)
    axes.doubts.push_back("its pixels are " + core::significant_text(1 / first.aspect, 3) +
                          " times as high as wide; they are taken as square, of the width");
}

bool fits(std::int64_t channels, std::int64_t slices, std::int64_t frames, std::int64_t pages) {
  return channels <= pages && slices <= pages && channels * slices <= pages &&
         channels * slices * frames == pages;
}

}  // namespace

std::uint64_t pages_by_imagej(const TiffPage& first) {
  return static_cast<std::uint64_t>(count(read_fields(first.description), "images"));
}

TiffAxes read_imagej_axes(const std::filesystem::path& path, const std::vector<TiffPage>& pages) {
  const Fields fields = read_fields(pages.front().description);
  TiffAxes axes = plain_axes(pages);
  const std::int64_t channels = count(fields, "channels"), slices = count(fields, "slices"),
                     frames = count(fields, "frames"), images = count(fields, "images");
  const auto in_file = static_cast<std::int64_t>(pages.size());
  if (channels * slices == 1 && frames == 1) {
    // "images" alone: a plain stack
  } else if (fits(channels, slices, frames, in_file) ||
             (in_file < images && images <= 4 * in_file + kSmall &&
              fits(channels, slices, frames, images))) {  // the file ends early
    axes.channels = static_cast<int>(channels), axes.slices = static_cast<int>(slices);
    axes.frames = static_cast<int>(frames);
    place_pages(path, "CZT", {{}}, pages.size(), axes);
    if (axes.frames == 1 && slices > 1) axes.slices_are_frames = true;
  } else {
    axes.doubts.push_back("its head tells of " + std::to_string(channels) + " channels, " +
                          std::to_string(slices) + " slices and " + std::to_string(frames) +
                          " frames, which are not the " + std::to_string(in_file) +
                          " pages that it has; every page is taken as a frame");
  }
  read_pixel_size(fields, pages.front(), axes);
  read_interval(fields, axes);
  return axes;
}

}  // namespace emberfold::io
