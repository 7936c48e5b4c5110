// SPDX-License-Identifier: Apache-2.0
#include "pipeline/footage/footage.hpp"

#include <algorithm>
#include <cstdint>
#include <span>
#include <string>
#include <utility>

#include <opencv2/core.hpp>

#include "core/error.hpp"
#include "core/io/frame_bytes.hpp"
#include "core/math/robust.hpp"
#include "core/parallel.hpp"
#include "core/text/size_text.hpp"
#include "pipeline/footage/footage_strokes.hpp"

namespace emberfold::pipeline {

namespace {

constexpr double kRepeat = 0.2;  // share of the median difference below which a frame repeats the one before

[[noreturn]] void refuse(const std::string& array, const std::string& why) {
  throw core::IoError("motion model: " + array + ".npy " + why);
}

template <class Number>
const std::vector<Number>& numbers(const core::ModelArchive& archive, const std::string& name) {
  const auto found = archive.arrays.find(name);
  if (found == archive.arrays.end()) refuse(name, "is missing");
  const auto* const data = std::get_if<std::vector<Number>>(&found->second.data);
  if (data == nullptr) refuse(name, "holds numbers of another kind");
  return *data;
}

int channels_of_stack(std::span<const std::uint8_t> bytes, cv::Size frame) {
  for (const int channels : {3, 1}) try {
      io::decode_frame(bytes, frame, channels);
      return channels;
    } catch (const core::IoError&) {
      continue;
    }
  refuse("footage", "holds no frames of " + core::size_text(frame));
}

}  // namespace

Footage gather_footage(core::FrameSource& source, const graph::MotionGraph& motion,
                       const core::Context& context, std::size_t most) {
  const auto& info = source.info();
  Footage all{{info.width, info.height}, info.channels, {}};
  const auto size = static_cast<std::size_t>(info.width) * static_cast<std::size_t>(info.height) *
                    static_cast<std::size_t>(info.channels);
  std::vector<double> change;
  std::size_t left_out = 0;
  cv::Mat last;
  source.rewind();
  for (cv::Mat read = source.next(); !read.empty(); read = source.next()) {
    context.check();
    if (all.frames.size() >= std::max<std::size_t>(2, most / size)) {
      ++left_out;
      continue;
    }
    cv::Mat frame = core::to_bytes(core::to_levels(read, info));
    if (!last.empty()) change.push_back(cv::norm(last, frame, cv::NORM_L1) / static_cast<double>(size));
    all.frames.push_back(io::encode_frame(frame));
    last = std::move(frame);
  }
  if (left_out > 0)
    context.warn("new clips are made of the first " + std::to_string(all.frames.size()) + " frames; " +
                 std::to_string(left_out) + " more take too much memory");
  const double least = all.frames.size() < 3 ? 0 : kRepeat * core::median(change);
  Footage kept{all.size, all.channels, {}};
  std::vector<int> moments;
  for (std::size_t t = 0; t < all.frames.size(); ++t) {
    if (t > 0 && change[t - 1] < least) continue;
    kept.frames.push_back(std::move(all.frames[t]));
    moments.push_back(static_cast<int>(t));
  }
  if (!motion.sketch.frames.empty()) kept.strokes = strokes_of_frames(motion, moments);
  return kept;
}

std::vector<cv::Mat> decode(const Footage& footage, const core::Context& context) {
  std::vector<cv::Mat> frames(footage.frames.size());
  core::parallel_for(frames.size(), context, [&](std::size_t i) {
    try {
      frames[i] = io::decode_frame(footage.frames[i], footage.size, footage.channels);
    } catch (const core::IoError& error) {
      refuse("footage", "is broken at frame " + std::to_string(i) + ": " + error.what());
    }
  });
  return frames;
}

void add_footage(core::ModelArchive& archive, const Footage& footage) {
  if (footage.empty()) return;
  std::vector<std::uint8_t> bytes;
  std::vector<std::int64_t> ends;
  for (const auto& frame : footage.frames) {
    bytes.insert(bytes.end(), frame.begin(), frame.end());
    ends.push_back(static_cast<std::int64_t>(bytes.size()));
  }
  archive.arrays["footage"] = {{bytes.size()}, false, std::move(bytes)};
  archive.arrays["footage_ends"] = {{ends.size()}, false, std::move(ends)};
  add_footage_strokes(archive, footage.strokes);
}

Footage read_footage(const core::ModelArchive& archive, cv::Size frame) {
  if (!archive.arrays.contains("footage")) return {};
  const auto& bytes = numbers<std::uint8_t>(archive, "footage");
  const auto& ends = numbers<std::int64_t>(archive, "footage_ends");
  if (ends.size() < 2 || ends.front() < 1 || ends.back() != static_cast<std::int64_t>(bytes.size()) ||
      !std::ranges::is_sorted(ends))
    refuse("footage_ends", "does not fit footage.npy");
  Footage footage{frame, 1, {}};
  for (std::size_t i = 0; i < ends.size(); ++i)
    footage.frames.emplace_back(bytes.begin() + (i == 0 ? 0 : ends[i - 1]), bytes.begin() + ends[i]);
  footage.channels = channels_of_stack(footage.frames.front(), frame);
  return footage;
}

}  // namespace emberfold::pipeline
