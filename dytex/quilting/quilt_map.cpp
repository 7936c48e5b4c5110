// SPDX-License-Identifier: Apache-2.0
#include "dytex/quilting/quilt_map.hpp"

#include <string>
#include <utility>

#include "core/error.hpp"

namespace emberfold::dytex {

namespace {

constexpr std::size_t kMostSide = 1 << 20;  // px, of a map that is read

}  // namespace

core::NpyArray to_array(const QuiltMap& map) {
  std::vector<std::int32_t> values;
  values.reserve(3 * map.pixels.size());
  for (const auto& p : map.pixels) values.insert(values.end(), {p.source, p.x, p.y});
  return {{static_cast<std::size_t>(map.size.height), static_cast<std::size_t>(map.size.width), 3},
          false,
          std::move(values)};
}

QuiltMap quilt_map(const core::NpyArray& array, std::span<const cv::Size> sources) {
  const auto* values = std::get_if<std::vector<std::int32_t>>(&array.data);
  if (array.shape.size() != 3 || array.shape[2] != 3 || values == nullptr || array.fortran_order ||
      array.shape[0] < 1 || array.shape[1] < 1 || array.shape[0] > kMostSide || array.shape[1] > kMostSide)
    throw core::InputError("a quilt's map is an int32 array of height x width x 3 (source, x, y)");
  QuiltMap map{{static_cast<int>(array.shape[1]), static_cast<int>(array.shape[0])}, {}};
  map.pixels.reserve(values->size() / 3);
  for (std::size_t i = 0; i + 2 < values->size(); i += 3) {
    const SourcePixel p{(*values)[i], (*values)[i + 1], (*values)[i + 2]};
    const auto place = [&] {
      const std::size_t pixel = i / 3, width = array.shape[1];
      return "the map's pixel " + std::to_string(pixel % width) + "," + std::to_string(pixel / width);
    };
    if (p.source < 0 || static_cast<std::size_t>(p.source) >= sources.size())
      throw core::InputError(place() + " names source " + std::to_string(p.source) + "; there " +
                             (sources.size() == 1 ? "is" : "are") + " " + std::to_string(sources.size()) +
                             ", counted from 0");
    const cv::Size size = sources[static_cast<std::size_t>(p.source)];
    if (p.x < 0 || p.y < 0 || p.x >= size.width || p.y >= size.height)
      throw core::InputError(place() + " is taken from " + std::to_string(p.x) + "," + std::to_string(p.y) +
                             ", but source " + std::to_string(p.source) + " has " +
                             std::to_string(size.width) + "x" + std::to_string(size.height) + " pixels");
    map.pixels.push_back(p);
  }
  return map;
}

}  // namespace emberfold::dytex
