// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <tuple>
#include <vector>

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include "core/clip.hpp"
#include "core/context.hpp"
#include "core/io/read_options.hpp"

namespace emberfold::python {

namespace py = pybind11;

/// A core::ClipOrigin as Python has it: x, y, seconds, counted_from.
using OriginTuple = std::tuple<double, double, double, std::string>;

inline OriginTuple to_tuple(const core::ClipOrigin& origin) {
  return {origin.x, origin.y, origin.seconds, origin.counted_from};
}
inline core::ClipOrigin to_origin(const OriginTuple& origin) {
  const auto& [x, y, seconds, counted_from] = origin;
  return {x, y, seconds, counted_from};
}

/// A clip as a value: an array that somebody holds, of which nothing is copied, or a part of a file.
/// Every call opens it anew, so that several may read it at once.
class ClipData {
 public:
  /// `array`: T × H × W or T × H × W × 3, of any strides. ValueError for others. `times`, `origin`: as in
  /// core::ClipInfo.
  ClipData(const py::array& array, std::optional<double> fps, std::optional<double> white,
           std::optional<double> pixel_size, std::vector<double> times, const OriginTuple& origin);
  /// A file, or what else io::open_video opens.
  ClipData(std::string path, io::ReadOptions reading);

  [[nodiscard]] const core::ClipInfo& info() const { return info_; }
  /// Opens the clip; it must outlive the source. Touches no Python.
  [[nodiscard]] std::unique_ptr<core::FrameSource> open(const core::Warn& warn = {}) const;
  /// Returns the array; None of a file.
  [[nodiscard]] const py::object& array() const { return array_; }

 private:
  py::object array_ = py::none();
  const std::byte* data_ = nullptr;
  std::array<std::int64_t, 4> strides_{};  // bytes: frame, row, column, channel
  std::string path_;
  io::ReadOptions reading_;
  core::ClipInfo info_;
};

}  // namespace emberfold::python
