// SPDX-License-Identifier: Apache-2.0
#include "dytex/learning/frame_blocks.hpp"

#include <algorithm>
#include <limits>
#include <string>
#include <utility>

#include "core/error.hpp"

namespace emberfold::dytex::detail {

namespace {

constexpr std::size_t kNone = std::numeric_limits<std::size_t>::max();

std::string described(int width, int height, int type) {
  return std::to_string(width) + " × " + std::to_string(height) + " of OpenCV's type " + std::to_string(type);
}

}  // namespace

FrameBands::FrameBands(core::FrameSource& source, std::size_t memory, std::size_t most_frames,
                       const core::Context& context)
    : source_(source) {
  const core::ClipInfo& info = source.info();
  values_ = static_cast<std::size_t>(std::max(info.width, 0)) *
            static_cast<std::size_t>(std::max(info.height, 0)) * static_cast<std::size_t>(info.channels);
  if (values_ == 0) throw core::InputError("the clip's frames have no pixels");
  value_bytes_ = CV_ELEM_SIZE1(info.depth);
  const std::size_t fitting = memory / (values_ * value_bytes_);
  const std::size_t told = info.frames && *info.frames > 0 ? static_cast<std::size_t>(*info.frames) : 0;
  bool whole = told <= fitting,
       banded = !whole;  // what is kept in this pass: all, the first band, or nothing
  if (banded) plan(told, memory);
  source_.rewind();
  ++passes_;
  std::size_t count = 0;
  for (cv::Mat frame = next_frame(count); !frame.empty(); frame = next_frame(count)) {
    if (context.cancelled()) return;
    if (++count > most_frames)
      throw core::InputError("the clip has more than " + std::to_string(most_frames) +
                             " frames, the most that a linear dynamic texture is learned from");
    if (whole && count > fitting) whole = false, kept_ = {};
    if (banded && count > told) banded = false, parts_ = {};
    if (banded) keep_part(frame, 0);
    if (whole) kept_.push_back(std::move(frame));
    if (told > 0) context.report("reading", static_cast<double>(count) / static_cast<double>(told));
  }
  if (count < 2)
    throw core::InputError("the clip has " + std::to_string(count) + (count == 1 ? " frame" : " frames") +
                           ", at least 2 are needed");
  frames_ = count;
  if (whole) {
    band_values_ = values_;
  } else if (!banded || count != told) {
    parts_ = {};
    plan(count, memory);
    loaded_ = kNone;
  }
}

void FrameBands::plan(std::size_t frames, std::size_t memory) {
  // Bands begin at a whole block of every channel.
  const std::size_t block = kBlock * static_cast<std::size_t>(source_.info().channels),
                    blocks = memory / block / (frames * value_bytes_),
                    most = block * std::max<std::size_t>(blocks, 1);
  bands_ = (values_ + most - 1) / most;
  const std::size_t even = (values_ + bands_ - 1) / bands_;
  band_values_ = (even + block - 1) / block * block;
  bands_ = (values_ + band_values_ - 1) / band_values_;
}

void FrameBands::keep_part(const cv::Mat& frame, std::size_t band) {
  const std::size_t begin = band * band_values_, end = std::min(begin + band_values_, values_);
  parts_.emplace_back(frame.data + begin * value_bytes_, frame.data + end * value_bytes_);
}

cv::Mat FrameBands::next_frame(std::size_t index) {
  cv::Mat frame = source_.next();
  if (frame.empty()) return frame;
  const core::ClipInfo& info = source_.info();
  const int type = CV_MAKETYPE(info.depth, info.channels);
  if (frame.cols != info.width || frame.rows != info.height || frame.type() != type)
    throw core::IoError("frame " + std::to_string(index) + " is " +
                        described(frame.cols, frame.rows, frame.type()) + ", the clip's frames are " +
                        described(info.width, info.height, type));
  return frame.isContinuous() ? frame : frame.clone();
}

cv::Mat FrameBands::next_again(std::size_t index) {
  cv::Mat frame = next_frame(index);
  if (frame.empty() != (index == frames_))
    throw core::IoError("the clip had " + std::to_string(frames_) + " frames when it was read first, now " +
                        (frame.empty() ? std::to_string(index) : std::string("more")));
  return frame;
}

void FrameBands::release() {
  if (whole()) return;
  parts_ = {};
  loaded_ = kNone;
}

core::Status FrameBands::load(std::size_t band, const core::Context& context) {
  source_.rewind();
  ++passes_;
  loaded_ = kNone;
  parts_.clear();
  for (cv::Mat frame = next_again(0); !frame.empty(); frame = next_again(parts_.size())) {
    if (context.cancelled()) return core::Status::cancelled;
    keep_part(frame, band);
  }
  loaded_ = band;
  return core::Status::done;
}

core::Status FrameBands::for_each(const char* stage, bool backwards,
                                  const std::function<core::Status(std::size_t, const FrameValues&)>& body,
                                  const core::Context& context) {
  for (std::size_t i = 0; i < bands_; ++i) {
    const std::size_t band = backwards ? bands_ - 1 - i : i, begin = band * band_values_;
    context.report(stage, static_cast<double>(i) / static_cast<double>(bands_));
    if (band != loaded_ && load(band, context) == core::Status::cancelled) return core::Status::cancelled;
    FrameValues values{{}, std::min(band_values_, values_ - begin), source_.info().depth};
    for (const cv::Mat& frame : kept_) values.frames.push_back(frame.data);
    for (const auto& part : parts_) values.frames.push_back(part.data());
    if (context.cancelled() || body(begin, values) == core::Status::cancelled) return core::Status::cancelled;
  }
  context.report(stage, 1);
  return core::Status::done;
}

core::Status FrameBands::for_each_batch(
    const char* stage, std::size_t batch,
    const std::function<core::Status(std::size_t, const FrameValues&)>& body, const core::Context& context) {
  FrameValues values{{}, values_, source_.info().depth};
  if (whole()) {
    for (const cv::Mat& frame : kept_) values.frames.push_back(frame.data);
    context.report(stage, 0);
    if (context.cancelled() || body(0, values) == core::Status::cancelled) return core::Status::cancelled;
    context.report(stage, 1);
    return core::Status::done;
  }
  release();
  source_.rewind();
  ++passes_;
  std::vector<cv::Mat> some;
  for (std::size_t t = 0; t < frames_;) {
    some.push_back(next_again(t++));
    if (context.cancelled()) return core::Status::cancelled;
    if (some.size() < batch && t < frames_) continue;
    values.frames.clear();
    for (const cv::Mat& frame : some) values.frames.push_back(frame.data);
    if (body(t - some.size(), values) == core::Status::cancelled) return core::Status::cancelled;
    some.clear();
    context.report(stage, static_cast<double>(t) / static_cast<double>(frames_));
  }
  static_cast<void>(next_again(frames_));
  return core::Status::done;
}

}  // namespace emberfold::dytex::detail
