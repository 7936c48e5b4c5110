// SPDX-License-Identifier: Apache-2.0
// The description that tifffile writes: {"shape": [50, 2, 120, 160], "axes": "TCYX"}; the axes may be
// missing.
#include <algorithm>
#include <cstddef>

#include <nlohmann/json.hpp>

#include "core/error.hpp"
#include "core/io/tiff/axes.hpp"
#include "core/text/json_reader.hpp"

namespace emberfold::io {

namespace {

struct Axis {
  char name = '?';  ///< ?: not named
  std::uint64_t size = 1;
};

constexpr std::uint64_t kMostPages = 1000000000;

std::vector<Axis> read_shape(const std::string& text) {
  std::vector<Axis> axes;
  try {
    const nlohmann::json head = core::parse_json(text);
    const auto shape = head.find("shape");
    if (shape == head.end() || !shape->is_array()) return {};
    for (const auto& size : *shape) {
      if (!size.is_number_unsigned()) return {};
      axes.push_back({'?', size.get<std::uint64_t>()});
    }
    const std::string names = head.value("axes", "");
    for (std::size_t i = 0; names.size() == axes.size() && i < axes.size(); ++i) axes[i].name = names[i];
  } catch (const core::IoError&) {
    return {};
  } catch (const nlohmann::json::exception&) {
    return {};
  }
  return axes;
}

/// Returns the number of axes inside a page: rows, columns and, where there are several, samples.
std::size_t axes_in_page(const TiffPage& page) {
  return page.samples > 1 && !page.sample ? 3 : 2;
}

/// Returns whether the last axes are those of the page.
bool fits(const std::vector<Axis>& axes, const TiffPage& page) {
  const std::size_t inside = axes_in_page(page);
  if (axes.size() < inside) return false;
  const auto end = axes.end();
  if (inside == 3 && page.planes != 2)
    return end[-1].size == page.samples && end[-2].size == page.width && end[-3].size == page.height;
  return end[-1].size == page.width && end[-2].size == page.height &&
         (inside == 2 || end[-3].size == page.samples);
}

/// The axes above the page that are longer than 1, the slowest first.
std::vector<Axis> axes_above(std::vector<Axis> axes, const TiffPage& page) {
  axes.resize(axes.size() - axes_in_page(page));
  std::erase_if(axes, [](const Axis& axis) { return axis.size == 1; });
  return axes;
}

/// The number of pages; 0 where it is out of range.
std::uint64_t product(const std::vector<Axis>& axes) {
  std::uint64_t pages = 1;
  for (const Axis& axis : axes) {
    if (axis.size == 0 || axis.size > kMostPages / pages) return 0;
    pages *= axis.size;
  }
  return pages;
}

std::string listed(const std::vector<Axis>& axes) {
  std::string text;
  for (const Axis& axis : axes) text += (text.empty() ? "" : " x ") + std::to_string(axis.size);
  return text;
}

/// Treats one axis of another name as time where there is none. Throws where that leaves an axis without
/// meaning, or two of one name.
void name_time(const std::filesystem::path& path, std::vector<Axis>& above) {
  const auto is_other = [](const Axis& axis) {
    return std::string_view("TCZ").find(axis.name) == std::string_view::npos;
  };
  const auto other = std::ranges::find_if(above, is_other);
  if (other != above.end() && std::ranges::find(above, 'T', &Axis::name) == above.end()) other->name = 'T';
  for (const Axis& axis : above)
    if (is_other(axis) || std::ranges::count(above, axis.name, &Axis::name) > 1)
      throw core::IoError("cannot read " + path.string() + ": its head has an axis " +
                          core::quoted(std::string(1, axis.name)) + " of size " + std::to_string(axis.size) +
                          " too many; read are one T (time), one C (channel) and one Z (slice)");
}

TiffAxes placed(const std::filesystem::path& path, const std::vector<Axis>& above, std::size_t pages) {
  TiffAxes axes;
  std::string order;
  for (const Axis& axis : above) {
    order.insert(order.begin(), axis.name);
    (axis.name == 'C'   ? axes.channels
     : axis.name == 'Z' ? axes.slices
                        : axes.frames) = static_cast<int>(axis.size);
  }
  for (const char name : {'C', 'Z', 'T'})
    if (order.find(name) == std::string::npos) order += name;
  place_pages(path, order, {{}}, pages, axes);
  axes.slices_are_frames = axes.frames == 1 && axes.slices > 1;
  return axes;
}

}  // namespace

std::uint64_t pages_by_shape(const TiffPage& first) {
  const auto axes = read_shape(first.description);
  return fits(axes, first) ? product(axes_above(axes, first)) : 0;
}

bool lists_planes(const TiffPage& page) {
  const auto axes = read_shape(page.description);
  return axes.size() == 3 && fits(axes, page) && axes.front().name != 'S';
}

TiffAxes read_shaped_axes(const std::filesystem::path& path, const std::vector<TiffPage>& pages) {
  const auto axes = read_shape(pages.front().description);
  TiffAxes plain = plain_axes(pages);
  if (!fits(axes, pages.front())) return plain;
  auto above = axes_above(axes, pages.front());
  const std::uint64_t planned = product(above);
  const bool named = !above.empty() && above.front().name != '?';
  if (above.empty() || (above.size() == 1 && !named)) return plain;
  const std::string doubt = "its head describes " + listed(above) + " pages";
  if (!named) {
    plain.doubts.push_back(doubt + " without naming these axes; every page is taken as a frame");
    return plain;
  }
  name_time(path, above);
  if (std::uint64_t{pages.size()} > planned && planned > 0 && pages.size() % planned == 0 &&
      std::ranges::find(above, 'T', &Axis::name) == above.end())
    above.insert(above.begin(), {'T', pages.size() / planned});  // written frame by frame
  else if (planned < pages.size() || planned > 4 * pages.size() + 10000) {
    plain.doubts.push_back(doubt + ", which are not the " + std::to_string(pages.size()) +
                           " that it has; every page is taken as a frame");
    return plain;
  }
  return placed(path, above, pages.size());
}

}  // namespace emberfold::io
