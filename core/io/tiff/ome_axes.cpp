// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <set>
#include <utility>

#include "core/error.hpp"
#include "core/io/tiff/axes.hpp"
#include "core/io/tiff/xml_tags.hpp"
#include "core/text/format_number.hpp"

namespace emberfold::io {

namespace {

std::string word(const XmlTag& tag, const std::string& key) {
  const auto found = tag.attributes.find(key);
  return found == tag.attributes.end() ? std::string() : found->second;
}

std::optional<double> number(const XmlTag& tag, const std::string& key) {
  const std::string text = word(tag, key);
  char* stop = nullptr;
  const double value = std::strtod(text.c_str(), &stop);
  return text.empty() || *stop != '\0' || !std::isfinite(value) ? std::nullopt : std::optional(value);
}

std::optional<int> whole(const XmlTag& tag, const std::string& key) {
  const auto value = number(tag, key);
  if (!value || *value < 0 || *value > 1e9) return std::nullopt;
  return static_cast<int>(*value);
}

/// The fields of the first image's <Pixels> that are used.
struct Pixels {
  bool found = false;
  std::string order = "XYZCT";
  int channels = 1, slices = 1, frames = 1;
  std::optional<double> pixel_um, pixel_high_um, interval;
  std::vector<PageRun> runs;
  std::vector<std::pair<int, double>> times;  ///< frame, s
  std::set<std::string> files;
};

std::optional<double> measured(const XmlTag& tag, const std::string& key, const char* usual,
                               std::optional<double> (*size)(std::string_view)) {
  const auto value = number(tag, key);
  const std::string unit = word(tag, key + "Unit");
  const auto one = size(unit.empty() ? usual : unit);
  if (!value || *value <= 0 || !one) return std::nullopt;
  return *value * *one;
}

void take_pixels(const XmlTag& tag, Pixels& pixels) {
  pixels.found = true;
  const std::string order = word(tag, "DimensionOrder");
  constexpr std::string_view kDefault = "XYZCT";
  if (std::ranges::is_permutation(order, kDefault) && order.starts_with("XY")) pixels.order = order;
  pixels.channels = std::max(1, whole(tag, "SizeC").value_or(1));
  pixels.slices = std::max(1, whole(tag, "SizeZ").value_or(1));
  pixels.frames = std::max(1, whole(tag, "SizeT").value_or(1));
  pixels.pixel_um = measured(tag, "PhysicalSizeX", "um", um_of);
  pixels.pixel_high_um = measured(tag, "PhysicalSizeY", "um", um_of);
  pixels.interval = measured(tag, "TimeIncrement", "s", seconds_of);
}

void take_run(const XmlTag& tag, Pixels& pixels) {
  pixels.runs.push_back({whole(tag, "IFD"), whole(tag, "PlaneCount"), whole(tag, "FirstC").value_or(0),
                         whole(tag, "FirstZ").value_or(0), whole(tag, "FirstT").value_or(0)});
}

void take_time(const XmlTag& tag, Pixels& pixels) {
  const auto time = number(tag, "DeltaT");
  const std::string unit = word(tag, "DeltaTUnit");
  const auto seconds = seconds_of(unit.empty() ? "s" : unit);
  if (time && seconds && whole(tag, "TheC").value_or(0) == 0 && whole(tag, "TheZ").value_or(0) == 0)
    pixels.times.emplace_back(whole(tag, "TheT").value_or(0), *time * *seconds);
}

Pixels read_pixels(const std::string& text) {
  Pixels pixels;
  XmlTags tags(text);
  while (const auto tag = tags.next()) {
    if (tag->name == "/Pixels") break;  // of the first image
    if (tag->name == "Pixels") take_pixels(*tag, pixels);
    if (tag->name == "TiffData") take_run(*tag, pixels);
    if (tag->name == "Plane") take_time(*tag, pixels);
    if (tag->name == "UUID" && tag->attributes.contains("FileName"))
      pixels.files.insert(word(*tag, "FileName"));
  }
  return pixels;
}

/// Returns the channels that are pages of their own: a page of n samples counts as n channels.
int page_channels(const Pixels& pixels, const TiffPage& page) {
  const auto samples = static_cast<int>(std::clamp<std::uint64_t>(page.samples, 1, 4));
  return std::max(1, pixels.channels % samples == 0 ? pixels.channels / samples : pixels.channels);
}

}  // namespace

std::uint64_t pages_by_ome(const TiffPage& first) {
  const Pixels pixels = read_pixels(first.description);
  if (!pixels.found || pixels.files.size() > 1) return 0;
  const double planned = double(page_channels(pixels, first)) * pixels.slices * pixels.frames;
  return planned < 1e9 ? static_cast<std::uint64_t>(planned) : 0;
}

TiffAxes read_ome_axes(const std::filesystem::path& path, const std::vector<TiffPage>& pages) {
  const Pixels pixels = read_pixels(pages.front().description);
  if (pixels.files.size() > 1)
    throw core::IoError("cannot read " + path.string() + ": its planes lie in " +
                        std::to_string(pixels.files.size()) + " files (" + *pixels.files.begin() +
                        " …); read is one file that holds them all");
  TiffAxes axes = plain_axes(pages);
  if (!pixels.found) return axes;
  const auto in_file = static_cast<std::int64_t>(pages.size());
  const int channels = page_channels(pixels, pages.front());
  const double planned = double(channels) * pixels.slices * pixels.frames;
  if (planned > 4 * static_cast<double>(in_file) + 1e4 ||
      (pixels.runs.empty() && planned < static_cast<double>(in_file))) {
    axes.doubts.emplace_back(
        "its head tells of another number of planes than it has pages; every page is taken as a frame");
  } else {
    axes.channels = channels, axes.slices = pixels.slices, axes.frames = pixels.frames;
    place_pages(path, pixels.order.substr(2), pixels.runs.empty() ? std::vector<PageRun>(1) : pixels.runs,
                pages.size(), axes);
    axes.slices_are_frames = axes.frames == 1 && axes.slices > 1 && pixels.frames == 1;
  }
  axes.pixel_um = pixels.pixel_um;
  axes.interval = pixels.interval;
  if (pixels.pixel_um && pixels.pixel_high_um &&
      std::abs(*pixels.pixel_high_um / *pixels.pixel_um - 1) > 0.01)
    axes.doubts.push_back("its pixels are " +
                          core::significant_text(*pixels.pixel_high_um / *pixels.pixel_um, 3) +
                          " times as high as wide; they are taken as square, of the width");
  take_frame_times(pixels.times, axes);
  return axes;
}

}  // namespace emberfold::io
