// SPDX-License-Identifier: Apache-2.0
#include "dytex/quilting/quilt_map.hpp"

#include <algorithm>
#include <iterator>
#include <string>
#include <utility>

#include "core/error.hpp"
#include "core/text/size_text.hpp"

namespace emberfold::dytex {

namespace {

constexpr std::size_t kMostSide = 1 << 20;  // px, of a map that is read
constexpr std::int32_t kMovingVersion = 2;
constexpr std::size_t kColumns = 6;  // of a map whose seams move: t, y, x, source, x, y

std::string place_text(std::size_t pixel, std::size_t width) {
  return "the map's pixel " + std::to_string(pixel % width) + "," + std::to_string(pixel / width);
}

SourcePixel checked(const SourcePixel& p, std::span<const cv::Size> sources, std::size_t pixel,
                    std::size_t width) {
  if (p.source < 0 || static_cast<std::size_t>(p.source) >= sources.size())
    throw core::InputError(place_text(pixel, width) + " names source " + std::to_string(p.source) +
                           "; there " + (sources.size() == 1 ? "is" : "are") + " " +
                           std::to_string(sources.size()) + ", counted from 0");
  const cv::Size size = sources[static_cast<std::size_t>(p.source)];
  if (p.x < 0 || p.y < 0 || p.x >= size.width || p.y >= size.height)
    throw core::InputError(place_text(pixel, width) + " is taken from " + std::to_string(p.x) + "," +
                           std::to_string(p.y) + ", but source " + std::to_string(p.source) + " has " +
                           core::size_text(size) + " pixels");
  return p;
}

QuiltMap still_map(const std::vector<std::size_t>& shape, const std::vector<std::int32_t>& values,
                   std::span<const cv::Size> sources) {
  QuiltMap map{{static_cast<int>(shape[1]), static_cast<int>(shape[0])}, {}};
  map.pixels.reserve(values.size() / 3);
  for (std::size_t i = 0; i + 2 < values.size(); i += 3)
    map.pixels.push_back(checked({values[i], values[i + 1], values[i + 2]}, sources, i / 3, shape[1]));
  return map;
}

/// A row of a map whose seams move.
struct MapRow {
  std::int32_t frame, y, x;
  SourcePixel from;
};

MapRow row_at(const std::vector<std::int32_t>& values, std::size_t row) {
  const std::int32_t* v = values.data() + row * kColumns;
  return {v[0], v[1], v[2], {v[3], v[4], v[5]}};
}

// Reads a map whose first row is frames, height, width and the version.
QuiltMap moving_map(const std::vector<std::int32_t>& values, std::span<const cv::Size> sources) {
  const MapRow head = row_at(values, 0);
  const std::size_t rows = values.size() / kColumns;
  const auto most = static_cast<std::int32_t>(kMostSide);
  if (head.from != SourcePixel{kMovingVersion, 0, 0} || head.frame < 1 || head.y < 1 || head.x < 1 ||
      head.y > most || head.x > most)
    throw core::InputError("the map's first row is not frames, height, width, 2, 0, 0");
  const auto width = static_cast<std::size_t>(head.x), pixels = static_cast<std::size_t>(head.y) * width;
  if (rows <= pixels)
    throw core::InputError("the map has " + std::to_string(rows - 1) + " rows for " + std::to_string(pixels) +
                           " pixels");
  QuiltMap map{{head.x, head.y}, {}, {}, {}, head.frame};
  std::size_t row = 1;
  for (std::size_t i = 0; i < pixels; ++i) {
    std::int32_t last = -1;
    for (; row < rows; ++row) {
      const MapRow here = row_at(values, row);
      if (here.x != static_cast<std::int32_t>(i % width) || here.y != static_cast<std::int32_t>(i / width))
        break;
      if (here.frame >= head.frame || here.frame <= last || (last < 0 && here.frame != 0))
        throw core::InputError(place_text(i, width) + " changes at frame " + std::to_string(here.frame) +
                               "; its frames have to ascend from 0 to at most " +
                               std::to_string(head.frame - 1));
      const SourcePixel from = checked(here.from, sources, i, width);
      if (last < 0)
        map.pixels.push_back(from);
      else
        map.changes.push_back({here.frame, from});
      last = here.frame;
    }
    if (last < 0) throw core::InputError(place_text(i, width) + " is missing, or its rows are out of order");
    map.change_ends.push_back(map.changes.size());
  }
  if (row < rows) throw core::InputError("the map has rows behind its last pixel");
  return map;
}

core::NpyArray moving_array(const QuiltMap& map) {
  std::vector<std::int32_t> values{map.frames, map.size.height, map.size.width, kMovingVersion, 0, 0};
  values.reserve(kColumns * (1 + map.pixels.size() + map.changes.size()));
  std::size_t i = 0;
  for (std::int32_t y = 0; y < map.size.height; ++y)
    for (std::int32_t x = 0; x < map.size.width; ++x, ++i) {
      const SourcePixel& from = map.pixels[i];
      values.insert(values.end(), {0, y, x, from.source, from.x, from.y});
      for (const auto& change : map.changes_of(i))
        values.insert(values.end(), {change.frame, y, x, change.from.source, change.from.x, change.from.y});
    }
  return {{values.size() / kColumns, kColumns}, false, std::move(values)};
}

}  // namespace

std::span<const SourceChange> QuiltMap::changes_of(std::size_t pixel) const {
  if (is_still()) return {};
  const std::size_t begin = pixel > 0 ? change_ends[pixel - 1] : 0;
  return std::span(changes).subspan(begin, change_ends[pixel] - begin);
}

const SourcePixel& QuiltMap::at_frame(std::size_t pixel, int frame) const {
  const auto own = changes_of(pixel);
  const auto next = std::ranges::upper_bound(own, frame, {}, &SourceChange::frame);
  return next == own.begin() ? pixels[pixel] : std::prev(next)->from;
}

QuiltMap still_at(const QuiltMap& map, int frame) {
  QuiltMap still{map.size, {}};
  still.pixels.reserve(map.pixels.size());
  for (std::size_t i = 0; i < map.pixels.size(); ++i) still.pixels.push_back(map.at_frame(i, frame));
  return still;
}

core::NpyArray to_array(const QuiltMap& map) {
  if (!map.is_still()) return moving_array(map);
  std::vector<std::int32_t> values;
  values.reserve(3 * map.pixels.size());
  for (const auto& p : map.pixels) values.insert(values.end(), {p.source, p.x, p.y});
  return {{static_cast<std::size_t>(map.size.height), static_cast<std::size_t>(map.size.width), 3},
          false,
          std::move(values)};
}

QuiltMap quilt_map(const core::NpyArray& array, std::span<const cv::Size> sources) {
  const auto& shape = array.shape;
  const auto* values = std::get_if<std::vector<std::int32_t>>(&array.data);
  const bool whole = values != nullptr && !array.fortran_order;
  if (whole && shape.size() == 3 && shape[2] == 3 && shape[0] >= 1 && shape[1] >= 1 &&
      shape[0] <= kMostSide && shape[1] <= kMostSide)
    return still_map(shape, *values, sources);
  if (whole && shape.size() == 2 && shape[1] == kColumns && shape[0] >= 1)
    return moving_map(*values, sources);
  throw core::InputError(
      "a quilt's map is an int32 array of height x width x 3 (source, x, y) or, with seams that move, of "
      "rows "
      "x 6 (t, y, x, source, x, y)");
}

}  // namespace emberfold::dytex
