// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <optional>
#include <string_view>
#include <vector>

#include "core/clip.hpp"
#include "core/context.hpp"
#include "core/parallel.hpp"

namespace emberfold::core {

/// Returns the number of frames in a batch: those that fit in 192 MB of levels, 1…16.
inline std::size_t frames_at_once(int width, int height, int channels) {
  return static_cast<std::size_t>(std::clamp(192e6 / (4.0 * width * height * channels), 1.0, 16.0));
}

/// Returns the number of frames processed at once: two for each thread of the process, at most
/// frames_at_once().
std::size_t frames_in_work(int width, int height, int channels);

/// Processes a clip in batches of frames_in_work() frames, starting at its first frame.
/// Calls before(t, frame) in order, then work(t, frame) in parallel, then take(t, result) in order.
/// `expected`: number of frames, for the progress only. Returns the number of frames. Throws Cancelled.
template <class Before, class Work, class Take>
int stream_frames(core::FrameSource& source, std::string_view stage, std::optional<std::int64_t> expected,
                  const core::Context& context, const Before& before, const Work& work, const Take& take) {
  using Result = decltype(work(0, cv::Mat{}));
  const auto& info = source.info();
  const auto batch_size = frames_in_work(info.width, info.height, info.channels);
  source.rewind();
  int done = 0;
  context.report(stage, 0);
  while (true) {
    std::vector<cv::Mat> frames;
    while (frames.size() < batch_size) {
      cv::Mat frame = source.next();
      if (frame.empty()) break;
      before(done + static_cast<int>(frames.size()), frame);
      frames.push_back(std::move(frame));
      context.check();
    }
    if (frames.empty()) break;
    std::vector<std::optional<Result>> results(frames.size());
    core::parallel_for(frames.size(), context, [&](std::size_t i) {
      results[i].emplace(work(done + static_cast<int>(i), frames[i]));
    });
    for (auto& result : results) {
      take(done++, std::move(*result));
      context.check();
    }
    context.report(stage, expected && *expected > 0 ? double(done) / double(*expected) : 0);
  }
  return done;
}

/// Processes a clip as above, without before().
template <class Work, class Take>
int stream_frames(core::FrameSource& source, std::string_view stage, std::optional<std::int64_t> expected,
                  const core::Context& context, const Work& work, const Take& take) {
  return stream_frames(
      source, stage, expected, context, [](int, const cv::Mat&) {}, work, take);
}

}  // namespace emberfold::core
