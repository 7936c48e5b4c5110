// SPDX-License-Identifier: Apache-2.0
#include "dytex/learning/frame_blocks.hpp"

#include <algorithm>
#include <limits>
#include <string>
#include <utility>

#include "core/error.hpp"

namespace emberfold::dytex::detail {

namespace {

constexpr std::size_t kNothingLoaded = std::numeric_limits<std::size_t>::max();

std::string frame_text(int width, int height, int type) {
  return std::to_string(width) + " × " + std::to_string(height) + " of OpenCV's type " + std::to_string(type);
}

}  // namespace

std::size_t value_count(const core::ClipInfo& info) {
  const std::size_t count = static_cast<std::size_t>(std::max(info.width, 0)) *
                            static_cast<std::size_t>(std::max(info.height, 0)) *
                            static_cast<std::size_t>(info.channels);
  if (count == 0) throw core::InputError("the clip's frames have no pixels");
  return count;
}

cv::Mat next_frame(core::FrameSource& source, std::size_t index) {
  cv::Mat frame = source.next();
  if (frame.empty()) return frame;
  const core::ClipInfo& info = source.info();
  const int type = CV_MAKETYPE(info.depth, info.channels);
  if (frame.cols != info.width || frame.rows != info.height || frame.type() != type)
    throw core::IoError("frame " + std::to_string(index) + " is " +
                        frame_text(frame.cols, frame.rows, frame.type()) + ", the clip's frames are " +
                        frame_text(info.width, info.height, type));
  return frame.isContinuous() ? frame : frame.clone();
}

void check_least_frames(std::size_t frames) {
  if (frames < 2)
    throw core::InputError("the clip has " + std::to_string(frames) + (frames == 1 ? " frame" : " frames") +
                           ", at least 2 are needed");
}

FrameBlocks::FrameBlocks(core::FrameSource& source, std::size_t memory, std::size_t most_frames,
                         const core::Context& context)
    : source_(source) {
  const core::ClipInfo& info = source.info();
  values_ = value_count(info);
  value_bytes_ = CV_ELEM_SIZE1(info.depth);
  const std::size_t fitting = memory / (values_ * value_bytes_);
  const std::size_t told = info.frames && *info.frames > 0 ? static_cast<std::size_t>(*info.frames) : 0;
  bool whole = told <= fitting,
       by_blocks = !whole;  // kept in this pass: all, the first block, or nothing
  if (by_blocks) plan(told, memory);
  source_.rewind();
  ++passes_;
  std::size_t count = 0;
  for (cv::Mat frame = next_frame(source_, count); !frame.empty(); frame = next_frame(source_, count)) {
    context.check();
    if (++count > most_frames)
      throw core::InputError("the clip has more than " + std::to_string(most_frames) +
                             " frames, the most that are compared at once; 'dytex learn' takes longer ones "
                             "by blocks (learn.block)");
    if (whole && count > fitting) whole = false, kept_ = {};
    if (by_blocks && count > told) by_blocks = false, parts_ = {};
    if (by_blocks) keep_part(frame, 0);
    if (whole) kept_.push_back(std::move(frame));
    if (told > 0) context.report("reading", static_cast<double>(count) / static_cast<double>(told));
  }
  check_least_frames(count);
  frames_ = count;
  if (whole) {
    block_values_ = values_;
  } else if (!by_blocks || count != told) {
    parts_ = {};
    plan(count, memory);
    loaded_ = kNothingLoaded;
  }
}

void FrameBlocks::plan(std::size_t frames, std::size_t memory) {
  // Blocks begin at a whole sum block of every channel.
  const std::size_t block = kBlock * static_cast<std::size_t>(source_.info().channels),
                    blocks = memory / block / (frames * value_bytes_),
                    most = block * std::max<std::size_t>(blocks, 1);
  block_count_ = (values_ + most - 1) / most;
  const std::size_t even = (values_ + block_count_ - 1) / block_count_;
  block_values_ = (even + block - 1) / block * block;
  block_count_ = (values_ + block_values_ - 1) / block_values_;
}

void FrameBlocks::keep_part(const cv::Mat& frame, std::size_t block_index) {
  const std::size_t begin = block_index * block_values_, end = std::min(begin + block_values_, values_);
  parts_.emplace_back(frame.data + begin * value_bytes_, frame.data + end * value_bytes_);
}

cv::Mat FrameBlocks::next_again(std::size_t index) {
  cv::Mat frame = next_frame(source_, index);
  if (frame.empty() != (index == frames_))
    throw core::IoError("the clip had " + std::to_string(frames_) + " frames when it was read first, now " +
                        (frame.empty() ? std::to_string(index) : std::string("more")));
  return frame;
}

void FrameBlocks::release() {
  if (keeps_all()) return;
  parts_ = {};
  loaded_ = kNothingLoaded;
}

void FrameBlocks::load(std::size_t block_index, const core::Context& context) {
  source_.rewind();
  ++passes_;
  loaded_ = kNothingLoaded;
  parts_.clear();
  for (cv::Mat frame = next_again(0); !frame.empty(); frame = next_again(parts_.size())) {
    context.check();
    keep_part(frame, block_index);
  }
  loaded_ = block_index;
}

void FrameBlocks::for_each(const char* stage, bool backwards,
                           const std::function<void(std::size_t, const FrameValues&)>& body,
                           const core::Context& context) {
  for (std::size_t i = 0; i < block_count_; ++i) {
    const std::size_t block_index = backwards ? block_count_ - 1 - i : i, begin = block_index * block_values_;
    context.report(stage, static_cast<double>(i) / static_cast<double>(block_count_));
    if (block_index != loaded_) load(block_index, context);
    FrameValues values{{}, std::min(block_values_, values_ - begin), source_.info().depth};
    for (const cv::Mat& frame : kept_) values.frames.push_back(frame.data);
    for (const auto& part : parts_) values.frames.push_back(part.data());
    context.check();
    body(begin, values);
  }
  context.report(stage, 1);
}

void FrameBlocks::for_each_batch(const char* stage, std::size_t batch,
                                 const std::function<void(std::size_t, const FrameValues&)>& body,
                                 const core::Context& context) {
  FrameValues values{{}, values_, source_.info().depth};
  if (keeps_all()) {
    for (const cv::Mat& frame : kept_) values.frames.push_back(frame.data);
    context.report(stage, 0);
    context.check();
    body(0, values);
    context.report(stage, 1);
    return;
  }
  release();
  source_.rewind();
  ++passes_;
  std::vector<cv::Mat> some;
  for (std::size_t t = 0; t < frames_;) {
    some.push_back(next_again(t++));
    context.check();
    if (some.size() < batch && t < frames_) continue;
    values.frames.clear();
    for (const cv::Mat& frame : some) values.frames.push_back(frame.data);
    body(t - some.size(), values);
    some.clear();
    context.report(stage, static_cast<double>(t) / static_cast<double>(frames_));
  }
  static_cast<void>(next_again(frames_));
}

}  // namespace emberfold::dytex::detail
