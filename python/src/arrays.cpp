// SPDX-License-Identifier: Apache-2.0
#include "python/src/arrays.hpp"

#include <opencv2/imgproc.hpp>

#include "core/error.hpp"

namespace emberfold::python {

py::dtype dtype_of(int depth) {
  if (depth == CV_8U) return py::dtype::of<std::uint8_t>();
  if (depth == CV_16U) return py::dtype::of<std::uint16_t>();
  if (depth == CV_32F) return py::dtype::of<float>();
  throw core::InputError("depth is " + std::to_string(depth) + "; allowed are 8 and 16 bits and floats");
}

int depth_of(const py::array& array, const std::string& argument) {
  for (const int depth : {CV_8U, CV_16U, CV_32F})
    if (array.dtype().equal(dtype_of(depth))) return depth;
  throw py::value_error(argument + " has the dtype " + py::str(array.dtype()).cast<std::string>() +
                        "; allowed are uint8, uint16 and float32");
}

namespace {

std::vector<py::ssize_t> shape_of(int frames, int height, int width, int channels) {
  if (channels == 1) return {frames, height, width};
  return {frames, height, width, channels};
}

[[noreturn]] void refuse_shape(const py::array& array, const std::string& argument, const char* allowed) {
  const std::string shape = py::str(array.attr("shape"));
  throw py::value_error(argument + " has the shape " + shape + "; allowed is " + allowed);
}

}  // namespace

FrameArray::FrameArray(int frames, int height, int width, int channels, int depth)
    : array_(dtype_of(depth), shape_of(frames, height, width, channels)),
      data_(static_cast<std::byte*>(array_.mutable_data())),
      frames_(frames),
      height_(height),
      width_(width),
      type_(CV_MAKETYPE(depth, channels)) {}

void FrameArray::put(int t, const cv::Mat& frame) {
  if (t >= frames_ || frame.type() != type_ || frame.rows != height_ || frame.cols != width_)
    throw core::InputError("frame " + std::to_string(t) + " is of another size or type than the first");
  const std::size_t bytes = frame.total() * frame.elemSize();
  cv::Mat place(height_, width_, type_, data_ + static_cast<std::size_t>(t) * bytes);
  if (frame.channels() == 3)
    cv::cvtColor(frame, place, cv::COLOR_BGR2RGB);
  else
    frame.copyTo(place);
}

py::array to_array(const std::vector<cv::Mat>& frames) {
  if (frames.empty()) throw core::InputError("there is no frame");
  const auto& first = frames.front();
  FrameArray out(static_cast<int>(frames.size()), first.rows, first.cols, first.channels(), first.depth());
  for (std::size_t t = 0; t < frames.size(); ++t) out.put(static_cast<int>(t), frames[t]);
  return out.array();
}

py::array to_array(const cv::Mat& image) {
  FrameArray out(1, image.rows, image.cols, image.channels(), image.depth());
  out.put(0, image);
  return out.array()[py::int_(0)].cast<py::array>();
}

cv::Mat to_levels(const py::array& array, const std::string& argument) {
  const bool colour = array.ndim() == 3 && array.shape(2) == 3;
  if ((array.ndim() != 2 && !colour) || array.size() == 0)
    refuse_shape(array, argument, "(H, W) or (H, W, 3)");
  depth_of(array, argument);
  const py::array_t<float, py::array::c_style | py::array::forcecast> floats(array);
  const int rows = static_cast<int>(array.shape(0)), columns = static_cast<int>(array.shape(1));
  // OpenCV has no view of memory that is constant; this one is only read from.
  const cv::Mat seen(rows, columns, colour ? CV_32FC3 : CV_32FC1, const_cast<float*>(floats.data()));
  cv::Mat levels;
  if (colour)
    cv::cvtColor(seen, levels, cv::COLOR_RGB2BGR);
  else
    levels = seen.clone();
  return levels;
}

cv::Mat to_mask(const py::array& array, const std::string& argument) {
  if (array.ndim() != 2 || array.size() == 0) refuse_shape(array, argument, "(H, W)");
  const int depth = depth_of(array, argument);
  const auto whole = py::array::ensure(array, py::array::c_style);
  const int rows = static_cast<int>(array.shape(0)), columns = static_cast<int>(array.shape(1));
  return cv::Mat(rows, columns, CV_MAKETYPE(depth, 1), const_cast<void*>(whole.data())).clone();
}

py::array view(const py::dtype& dtype, std::vector<py::ssize_t> shape, std::vector<py::ssize_t> strides,
               const void* data, const py::handle& owner) {
  py::array seen(dtype, std::move(shape), std::move(strides), data, owner);
  py::detail::array_proxy(seen.ptr())->flags &= ~py::detail::npy_api::NPY_ARRAY_WRITEABLE_;
  return seen;
}

}  // namespace emberfold::python
