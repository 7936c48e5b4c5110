// SPDX-License-Identifier: Apache-2.0
#include "core/io/tiff/axes.hpp"

#include <algorithm>
#include <array>
#include <numeric>

#include "core/text/format_number.hpp"

namespace emberfold::io {

namespace {

constexpr double kUneven = 0.25;  // share of the interval by which frames may come early or late

struct Unit {
  std::string_view name;
  double size;
};

std::optional<double> find(std::string_view unit, const auto& known) {
  for (const Unit& one : known)
    if (one.name == unit) return one.size;
  return std::nullopt;
}

/// Program that wrote a description.
enum class Kind { none, imagej, ome, shaped };

Kind kind_of(const std::string& text) {
  if (text.starts_with("ImageJ=")) return Kind::imagej;
  if (text.find("<OME") != std::string::npos || text.find(":OME ") != std::string::npos) return Kind::ome;
  return text.starts_with('{') ? Kind::shaped : Kind::none;
}

}  // namespace

std::optional<double> um_of(std::string_view unit) {
  // µ is written as either of two characters, or as ImageJ's escape of the first.
  constexpr std::array<Unit, 18> kLengths{{{"um", 1},
                                           {"\u00b5m", 1},
                                           {"\u03bcm", 1},
                                           {"\\u00B5m", 1},
                                           {"micron", 1},
                                           {"microns", 1},
                                           {"micrometer", 1},
                                           {"micrometre", 1},
                                           {"nm", 1e-3},
                                           {"nanometer", 1e-3},
                                           {"\u00c5", 1e-4},
                                           {"mm", 1e3},
                                           {"cm", 1e4},
                                           {"m", 1e6},
                                           {"meter", 1e6},
                                           {"inch", 25400},
                                           {"in", 25400},
                                           {"millimeter", 1e3}}};
  return find(unit, kLengths);
}

std::optional<double> seconds_of(std::string_view unit) {
  constexpr std::array<Unit, 14> kTimes{{{"s", 1},
                                         {"sec", 1},
                                         {"second", 1},
                                         {"seconds", 1},
                                         {"ms", 1e-3},
                                         {"msec", 1e-3},
                                         {"us", 1e-6},
                                         {"\u00b5s", 1e-6},
                                         {"\u03bcs", 1e-6},
                                         {"ns", 1e-9},
                                         {"min", 60},
                                         {"h", 3600},
                                         {"hr", 3600},
                                         {"d", 86400}}};
  return find(unit, kTimes);
}

void take_frame_times(std::vector<std::pair<int, double>> times, TiffAxes& axes) {
  std::ranges::sort(times);
  std::vector<double> steps;
  for (std::size_t i = 1; i < times.size(); ++i)
    if (times[i].first == times[i - 1].first + 1) steps.push_back(times[i].second - times[i - 1].second);
  if (steps.empty()) return;
  const bool is_whole = std::ssize(times) == axes.frames && std::ssize(steps) + 1 == axes.frames;
  std::ranges::sort(steps);
  const double middle = steps[steps.size() / 2];
  if (middle <= 0) return;
  if (!axes.interval) axes.interval = middle;
  if (steps.front() >= (1 - kUneven) * middle && steps.back() <= (1 + kUneven) * middle) return;
  if (is_whole && steps.front() >= 0)
    for (const auto& [frame, time] : times) axes.times.push_back(time - times.front().second);
  axes.doubts.push_back("its frames are not evenly spaced in time (" +
                        core::significant_text(steps.front(), 3) + " to " +
                        core::significant_text(steps.back(), 3) + " s apart); " +
                        (axes.times.empty() ? "they are taken as if they were" : "each has its own time"));
}

TiffAxes plain_axes(const std::vector<TiffPage>& pages) {
  TiffAxes axes;
  axes.frames = static_cast<int>(pages.size());
  axes.planes.resize(pages.size());
  std::iota(axes.planes.begin(), axes.planes.end(), 0);
  return axes;
}

TiffAxes read_tiff_axes(const std::filesystem::path& path, const std::vector<TiffPage>& pages) {
  if (pages.empty()) return {};
  switch (kind_of(pages.front().description)) {
    case Kind::imagej:
      return read_imagej_axes(path, pages);
    case Kind::ome:
      return read_ome_axes(path, pages);
    case Kind::shaped:
      return read_shaped_axes(path, pages);
    case Kind::none:
      break;
  }
  TiffAxes axes = plain_axes(pages);
  std::vector<std::pair<int, double>> times;
  for (const double time : pages.front().times) times.emplace_back(static_cast<int>(times.size()), time);
  take_frame_times(std::move(times), axes);
  return axes;
}

std::uint64_t pages_by_head(const TiffPage& first) {
  switch (kind_of(first.description)) {
    case Kind::imagej:
      return pages_by_imagej(first);
    case Kind::ome:
      return pages_by_ome(first);
    case Kind::shaped:
      return pages_by_shape(first);
    case Kind::none:
      break;
  }
  return 0;
}

}  // namespace emberfold::io
