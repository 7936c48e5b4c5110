// SPDX-License-Identifier: Apache-2.0
#include "python/src/clip_data.hpp"

#include <cmath>
#include <cstring>
#include <utility>

#include <opencv2/imgproc.hpp>

#include "core/error.hpp"
#include "core/io/clip_reader.hpp"
#include "python/src/arrays.hpp"
#include "python/src/calls.hpp"

namespace emberfold::python {

namespace {

using Strides = std::array<std::int64_t, 4>;

/// Reads the frames of an array in memory that somebody else holds.
class ArraySource final : public core::FrameSource {
 public:
  ArraySource(const std::byte* data, const Strides& strides, const core::ClipInfo& info)
      : data_(data), strides_(strides), info_(info) {}
  [[nodiscard]] const core::ClipInfo& info() const override { return info_; }
  void rewind() override { position_ = 0; }
  cv::Mat next() override {
    if (position_ >= *info_.frames) return {};
    const std::byte* frame = data_ + strides_[0] * position_++;
    if (lies_in_rows()) {
      // OpenCV has no view of memory that is constant; this one is only read from.
      const cv::Mat seen(info_.height, info_.width, type(), const_cast<std::byte*>(frame),
                         static_cast<std::size_t>(strides_[1]));
      return in_library_order(seen, true);
    }
    return in_library_order(gather(frame), false);
  }

 private:
  [[nodiscard]] int type() const { return CV_MAKETYPE(info_.depth, info_.channels); }
  [[nodiscard]] bool lies_in_rows() const {
    const std::int64_t size = CV_ELEM_SIZE1(info_.depth), pixel = size * info_.channels;
    return (info_.channels == 1 || strides_[3] == size) && strides_[2] == pixel &&
           strides_[1] >= pixel * info_.width && strides_[1] % size == 0;
  }
  [[nodiscard]] cv::Mat in_library_order(const cv::Mat& frame, bool is_view) const {
    if (info_.channels == 1) return is_view ? frame.clone() : frame;
    cv::Mat swapped;
    cv::cvtColor(frame, swapped, cv::COLOR_RGB2BGR);
    return swapped;
  }
  [[nodiscard]] cv::Mat gather(const std::byte* frame) const {
    cv::Mat out(info_.height, info_.width, type());
    const std::size_t size = out.elemSize1();
    for (int y = 0; y < info_.height; ++y) {
      auto* to = out.ptr(y);
      for (int x = 0; x < info_.width; ++x)
        for (int c = 0; c < info_.channels; ++c, to += size)
          std::memcpy(to, frame + y * strides_[1] + x * strides_[2] + c * strides_[3], size);
    }
    return out;
  }

  const std::byte* data_;
  Strides strides_;
  core::ClipInfo info_;
  std::int64_t position_ = 0;
};

core::ClipInfo info_of(const py::array& array) {
  const auto dimensions = array.ndim();
  const bool colour = dimensions == 4 && array.shape(3) == 3;
  if ((dimensions != 3 && !colour) || array.size() == 0) {
    const std::string shape = py::str(array.attr("shape"));
    throw py::value_error("clip has the shape " + shape + "; allowed are (T, H, W) and (T, H, W, 3), none 0");
  }
  core::ClipInfo info;
  info.depth = depth_of(array, "clip");
  info.height = static_cast<int>(array.shape(1)), info.width = static_cast<int>(array.shape(2));
  info.channels = colour ? 3 : 1;
  info.frames = array.shape(0);
  return info;
}

/// The value of white: 2^b - 1, b the bits that the largest value needs, at least 8; of floats up to 1 it is
/// 1. Also refuses what is no finite number.
double find_white(core::FrameSource& source, const core::Context& context) {
  const int depth = source.info().depth;
  double largest = 0;
  for (cv::Mat frame = source.next(); !frame.empty(); frame = source.next()) {
    context.check();
    if (depth == CV_32F && !cv::checkRange(frame))
      throw py::value_error("clip holds a value that is no finite number");
    double most = 0;
    cv::minMaxLoc(frame.reshape(1), nullptr, &most);
    largest = std::max(largest, most);
  }
  if (depth == CV_32F && largest <= 1) return 1;
  double white = 255;
  while (white < largest) white = 2 * white + 1;
  return white;
}

void check_positive(const char* name, std::optional<double> value) {
  if (value && !(std::isfinite(*value) && *value > 0))
    throw py::value_error(std::string(name) + " is " + std::to_string(*value) +
                          "; allowed is a number above 0");
}

}  // namespace

ClipData::ClipData(const py::array& array, std::optional<double> fps, std::optional<double> white,
                   std::optional<double> pixel_size, std::vector<double> times, const OriginTuple& origin)
    : array_(array), data_(static_cast<const std::byte*>(array.data())), info_(info_of(array)) {
  for (py::ssize_t i = 0; i < array.ndim(); ++i) strides_[static_cast<std::size_t>(i)] = array.strides(i);
  check_positive("fps", fps), check_positive("white", white), check_positive("pixel_size", pixel_size);
  info_.fps = fps.value_or(info_.fps), info_.fps_is_known = fps.has_value();
  info_.pixel_um = pixel_size, info_.times = std::move(times), info_.origin = to_origin(origin);
  double found = 255;
  if (info_.depth != CV_8U)
    found = call(py::none(), [&](const core::Context& context) { return find_white(*open(), context); });
  info_.white = white.value_or(found);
}

ClipData::ClipData(std::string path, io::ReadOptions reading)
    : path_(std::move(path)), reading_(std::move(reading)) {
  run_interruptibly(py::none(), [&](const core::Context& context) {
    info_ = open([&](const std::string& text) { context.warn(text); })->info();
  });
}

std::unique_ptr<core::FrameSource> ClipData::open(const core::Warn& warn) const {
  if (data_ != nullptr) return std::make_unique<ArraySource>(data_, strides_, info_);
  return io::open_video(path_, reading_, warn);
}

}  // namespace emberfold::python
