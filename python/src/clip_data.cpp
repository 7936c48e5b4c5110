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

/// Reads every step-th frame of a source, a part of it.
class PartSource final : public core::FrameSource {
 public:
  PartSource(std::unique_ptr<core::FrameSource> source, const FilePart& part, const core::ClipInfo& info)
      : source_(std::move(source)), part_(part), info_(info) {}
  [[nodiscard]] const core::ClipInfo& info() const override { return info_; }
  void rewind() override {
    source_->rewind();
    is_first_ = true;
  }
  cv::Mat next() override {
    if (!std::exchange(is_first_, false))
      for (std::int64_t i = 1; i < part_.step; ++i)
        if (source_->next().empty()) return {};
    cv::Mat frame = source_->next();
    if (frame.empty() || !part_.roi) return frame;
    return frame(*part_.roi).clone();
  }

 private:
  std::unique_ptr<core::FrameSource> source_;
  FilePart part_;
  core::ClipInfo info_;
  bool is_first_ = true;
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

void set_fps(core::ClipInfo& info, std::optional<double> fps) {
  if (!fps) return;
  if (!(std::isfinite(*fps) && *fps > 0))
    throw py::value_error("fps is " + std::to_string(*fps) + "; allowed is a number above 0");
  info.fps = *fps;
}

io::ReadOptions reading(const FilePart& part) {
  io::ReadOptions read;
  read.first = part.first, read.last = part.last;
  return read;
}

}  // namespace

ClipData::ClipData(const py::array& array, std::optional<double> fps, std::optional<double> white)
    : array_(array), data_(static_cast<const std::byte*>(array.data())), info_(info_of(array)) {
  for (py::ssize_t i = 0; i < array.ndim(); ++i) strides_[static_cast<std::size_t>(i)] = array.strides(i);
  set_fps(info_, fps);
  if (white && !(std::isfinite(*white) && *white > 0))
    throw py::value_error("white is " + std::to_string(*white) + "; allowed is a number above 0");
  double found = 255;
  if (info_.depth != CV_8U)
    found = call(py::none(), [&](const core::Context& context) { return find_white(*open(), context); });
  info_.white = white.value_or(found);
}

ClipData::ClipData(FilePart part, std::optional<double> fps) : part_(std::move(part)) {
  std::optional<core::ClipInfo> info;
  run_interruptibly(py::none(), [&](const core::Context& context) {
    info = io::open_video(part_.path, reading(part_), [&](const std::string& text) {
             context.warn(text);
           })->info();
  });
  info_ = *info;
  if (part_.roi) {
    const auto& roi = *part_.roi;
    if ((roi & cv::Rect(0, 0, info_.width, info_.height)) != roi || roi.empty())
      throw py::value_error("roi is (" + std::to_string(roi.x) + ", " + std::to_string(roi.y) + ", " +
                            std::to_string(roi.width) + ", " + std::to_string(roi.height) + "); frames are " +
                            std::to_string(info_.width) + "x" + std::to_string(info_.height));
    info_.width = roi.width, info_.height = roi.height;
  }
  info_.fps /= static_cast<double>(part_.step);
  if (info_.frames) info_.frames = (*info_.frames + part_.step - 1) / part_.step;
  set_fps(info_, fps);
}

std::unique_ptr<core::FrameSource> ClipData::open(const core::Warn& warn) const {
  if (data_ != nullptr) return std::make_unique<ArraySource>(data_, strides_, info_);
  return std::make_unique<PartSource>(io::open_video(part_.path, reading(part_), warn), part_, info_);
}

}  // namespace emberfold::python
