// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include <opencv2/core/types.hpp>
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include "core/clip.hpp"
#include "core/context.hpp"

namespace emberfold::python {

namespace py = pybind11;

/// Where a file's frames are read from, and which part of them.
struct FilePart {
  std::string path;
  std::int64_t first = 0;
  std::optional<std::int64_t> last;
  std::int64_t step = 1;
  std::optional<cv::Rect> roi;
};

/// A clip as a value: an array that somebody holds, of which nothing is copied, or a part of a file.
/// Every call opens it anew, so that several may read it at once.
class ClipData {
 public:
  /// `array`: T × H × W or T × H × W × 3, of any strides. ValueError for others.
  ClipData(const py::array& array, std::optional<double> fps, std::optional<double> white);
  ClipData(FilePart part, std::optional<double> fps);

  [[nodiscard]] const core::ClipInfo& info() const { return info_; }
  /// Opens the clip; it must outlive the source. Touches no Python.
  [[nodiscard]] std::unique_ptr<core::FrameSource> open(const core::Warn& warn = {}) const;
  /// Returns the array; None of a file.
  [[nodiscard]] const py::object& array() const { return array_; }
  [[nodiscard]] const FilePart& part() const { return part_; }

 private:
  py::object array_ = py::none();
  const std::byte* data_ = nullptr;
  std::array<std::int64_t, 4> strides_{};  // bytes: frame, row, column, channel
  FilePart part_;
  core::ClipInfo info_;
};

}  // namespace emberfold::python
