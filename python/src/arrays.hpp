// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include <opencv2/core/mat.hpp>
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

// Between NumPy's arrays and OpenCV's images. Colours are red, green, blue in Python and blue, green, red in
// the library: they change places here and in clip_data, nowhere else.
namespace emberfold::python {

namespace py = pybind11;

/// Returns the type of elements of this depth (CV_8U, CV_16U, CV_32F). InputError for others.
py::dtype dtype_of(int depth);
/// Returns the depth of an array's elements. ValueError, naming the argument, for other types.
int depth_of(const py::array& array, const std::string& argument);

/// Frames in one new array, T × H × W or T × H × W × 3.
class FrameArray {
 public:
  FrameArray(int frames, int height, int width, int channels, int depth);
  /// Copies a frame to its place. Does not touch Python.
  void put(int t, const cv::Mat& frame);
  [[nodiscard]] py::array array() const { return array_; }

 private:
  py::array array_;
  std::byte* data_;
  int frames_, height_, width_, type_;
};

/// Copies an image to a new array, H × W or H × W × 3.
py::array to_array(const cv::Mat& image);
/// Copies frames of one size and type to a new array.
py::array to_array(const std::vector<cv::Mat>& frames);

/// Copies an array, H × W or H × W × 3, to an image of levels (CV_32F), its numbers as they are.
/// ValueError, naming the argument, for another shape or type.
cv::Mat to_levels(const py::array& array, const std::string& argument);
/// Copies an array, H × W, to an image of its depth. ValueError as above.
cv::Mat to_mask(const py::array& array, const std::string& argument);

/// Makes a view of memory that belongs to `owner`; it cannot be written to.
py::array view(const py::dtype& dtype, std::vector<py::ssize_t> shape, std::vector<py::ssize_t> strides,
               const void* data, const py::handle& owner);

}  // namespace emberfold::python

namespace pybind11::detail {

/// Sizes are (width, height) in Python.
template <>
struct type_caster<cv::Size> {
  PYBIND11_TYPE_CASTER(cv::Size, const_name("Tuple[int, int]"));
  bool load(handle source, bool) {
    if (!isinstance<sequence>(source) || isinstance<str>(source) || pybind11::len(source) != 2) return false;
    const auto pair = reinterpret_borrow<sequence>(source);
    try {
      value = {pair[0].cast<int>(), pair[1].cast<int>()};
    } catch (const cast_error&) {
      return false;
    }
    return true;
  }
  static handle cast(const cv::Size& size, return_value_policy, handle) {
    return make_tuple(size.width, size.height).release();
  }
};

}  // namespace pybind11::detail
