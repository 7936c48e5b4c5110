// SPDX-License-Identifier: Apache-2.0
#include "dytex/quilting/trajectories.hpp"

#include <algorithm>
#include <cstring>
#include <string>
#include <utility>

#include "core/error.hpp"
#include "core/parallel.hpp"

namespace emberfold::dytex {

int chunk_length(const core::ClipInfo& info) {
  const double frame = static_cast<double>(info.width) * info.height * info.channels *
                       static_cast<double>(CV_ELEM_SIZE1(info.depth));
  return static_cast<int>(std::clamp(64e6 / frame, 1.0, 16.0));
}

void pack_chunk(const std::vector<cv::Mat>& frames, int chunk_frames, std::byte* out) {
  const cv::Mat& first = frames.front();
  const std::size_t value = first.elemSize(), width = static_cast<std::size_t>(first.cols);
  const std::size_t pixel = value * static_cast<std::size_t>(chunk_frames);
  core::parallel_for(static_cast<std::size_t>(first.rows), {}, [&](std::size_t y) {
    std::byte* const row = out + y * width * pixel;
    if (static_cast<int>(frames.size()) < chunk_frames) std::memset(row, 0, width * pixel);
    for (std::size_t t = 0; t < frames.size(); ++t) {
      const auto* in = frames[t].ptr<std::byte>(static_cast<int>(y));
      std::byte* to = row + t * value;
      for (std::size_t x = 0; x < width; ++x, in += value, to += pixel)
        for (std::size_t i = 0; i < value; ++i) to[i] = in[i];
    }
  });
}

Trajectories::Trajectories(const core::ClipInfo& info, ChunkMemory memory, int chunk_frames)
    : info_(info),
      memory_(std::move(memory)),
      chunk_frames_(chunk_frames > 0 ? chunk_frames : chunk_length(info)) {}

void Trajectories::add(const cv::Mat& frame) {
  if (frame.size() != size() || frame.type() != CV_MAKETYPE(info_.depth, info_.channels))
    throw core::InputError("frame " + std::to_string(frames_) + " is of another size or type than its clip");
  pending_.push_back(frame);
  ++frames_;
  if (static_cast<int>(pending_.size()) == chunk_frames_) flush();
}

void Trajectories::finish() {
  if (frames_ == 0) throw core::InputError("a time-lapse needs at least one frame");
  info_.frames = frames_;
  if (pending_.empty()) return;
  // A short clip has one chunk of its own length: nothing to pad.
  if (chunks_.empty()) chunk_frames_ = static_cast<int>(pending_.size());
  flush();
}

void Trajectories::flush() {
  const std::size_t bytes = course() * pixels() * CV_ELEM_SIZE1(info_.depth);
  std::byte* memory = nullptr;
  if (memory_)
    memory = memory_(chunks(), bytes);
  else
    memory = heap_.emplace_back(bytes).data();
  pack_chunk(pending_, chunk_frames_, memory);
  pending_.clear();
  chunks_.push_back(memory);
}

Trajectories read_trajectories(core::FrameSource& source, ChunkMemory memory, const core::Context& context,
                               int chunk_frames) {
  Trajectories result(source.info(), std::move(memory), chunk_frames);
  source.rewind();
  const auto expected = source.info().frames.value_or(0);
  context.report("read", 0);
  for (;;) {
    context.check();
    const cv::Mat frame = source.next();
    if (frame.empty()) break;
    result.add(frame);
    if (expected > 0)
      context.report("read", static_cast<double>(result.frames()) / static_cast<double>(expected));
  }
  if (result.frames() > 0) result.finish();
  return result;
}

}  // namespace emberfold::dytex
