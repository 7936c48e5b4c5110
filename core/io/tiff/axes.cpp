// SPDX-License-Identifier: Apache-2.0
#include "core/io/tiff/axes.hpp"

#include <array>
#include <numeric>

namespace emberfold::io {

namespace {

struct Unit {
  std::string_view name;
  double size;
};

std::optional<double> find(std::string_view unit, const auto& known) {
  for (const Unit& one : known)
    if (one.name == unit) return one.size;
  return std::nullopt;
}

/// Who wrote a description.
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
  return plain_axes(pages);
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
