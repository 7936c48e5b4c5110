// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstddef>
#include <deque>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "core/clip.hpp"
#include "core/clip/frame_stream.hpp"
#include "core/clip/masked_source.hpp"
#include "core/context.hpp"
#include "core/parallel.hpp"
#include "graph/attribute_graph.hpp"
#include "sketch/extract.hpp"

namespace emberfold::pipeline {

/// Holds a frame, perhaps with added noise, and its sketch.
struct FrameReading {
  cv::Mat levels;  ///< CV_32F, 1 or 3 channels, white = 255
  graph::AttributeGraph graph;
};

/// Returns levels (CV_32F) in a quarter of the memory, CV_8U, where they are whole numbers up to 255; others
/// unchanged. O(pixels).
cv::Mat packed_levels(const cv::Mat& levels);
/// Returns packed levels as CV_32F.
cv::Mat unpacked_levels(const cv::Mat& packed);

/// Returns the graph without the patches outside the mask (CV_8U, 0 outside; empty: all stay).
graph::AttributeGraph inside_mask(const graph::AttributeGraph& graph, const cv::Mat& mask);

/// Holds the frames of a clip whose sketches need later frames to become temporally consistent.
/// Each sketch is made to agree with those of the three frames before and the three after it, both senses of
/// time alike (sketch::steady_sketch). Motion is optical flow of the luma in the first version of each frame.
class SteadyFrames {
 public:
  static constexpr int kNeighbours = 3;  ///< frames on each side

  /// Leaves sketches unchanged where `options.steady` is off, or patches are chosen by gain (budget).
  explicit SteadyFrames(const sketch::ExtractOptions& options)
      : options_(options), is_on_(options.steady && options.budget <= 0) {}

  /// Appends the next frame, with the same number of versions as the others; their levels may be packed.
  /// `mask`: where structure counts; empty: everywhere.
  void push(std::vector<FrameReading> readings, cv::Mat mask = {});
  /// Returns the number of waiting frames.
  [[nodiscard]] std::size_t waiting() const { return entries_.size() - first_; }

  /// Prepares the frames whose neighbours are available; `last`: no more frames come, so all. Returns their
  /// number. Throws core::Cancelled.
  std::size_t prepare(bool last, const core::Context& context);
  /// Returns the versions of the i-th prepared frame with temporally consistent sketches, without the parts
  /// outside the mask. Thread-safe.
  [[nodiscard]] std::vector<FrameReading> steady(std::size_t i) const;
  /// Drops the first `count` prepared frames, except those that are neighbours of others.
  void drop(std::size_t count);

 private:
  struct Entry {
    std::vector<FrameReading> readings;
    cv::Mat mask;
    cv::Mat1f luma;
    cv::Mat on, back;  // motion to the next frame, and from it
  };
  [[nodiscard]] cv::Mat motion(std::size_t from, std::size_t to) const;

  sketch::ExtractOptions options_;
  bool is_on_;
  std::vector<Entry> entries_;
  std::size_t first_ = 0;  // first unfinished entry; those before are neighbours
};

/// Sketches a clip in batches, from its first frame that is not among the `known` ones.
/// Of the known frames only the last three are read again, as neighbours, without calls for their results.
/// Strokes outside the source's mask (core::mask_of) are removed from the sketches. Calls before(t) for each
/// frame in order, then read(t, levels) in parallel, which returns its versions, then finish(t, readings) in
/// parallel with the temporally consistent sketches, then take(t, result) in order. Returns the number of
/// frames. Throws core::Cancelled.
template <class Before, class Read, class Finish, class Take>
int stream_steady_frames(core::FrameSource& source, std::string_view stage,
                         const sketch::ExtractOptions& options, const core::Context& context, int known,
                         const Before& before, const Read& read, const Finish& finish, const Take& take) {
  using Result = decltype(finish(0, std::vector<FrameReading>{}));
  const auto& info = source.info();
  const std::size_t at_once = core::frames_at_once(info.width, info.height, info.channels);
  SteadyFrames frames(options);
  std::deque<cv::Mat> masks;  // of the frames read but not yet pushed
  const int first = std::max(0, known - SteadyFrames::kNeighbours);
  int done = first;
  const auto settle = [&](bool last) {
    const std::size_t count = frames.prepare(last, context);
    std::vector<std::optional<Result>> results(count);
    core::parallel_for(count, context, [&](std::size_t i) {
      const int t = done + static_cast<int>(i);
      if (t >= known) results[i].emplace(finish(t, frames.steady(i)));
    });
    for (auto& result : results) {
      if (result) take(done, std::move(*result));
      ++done;
      context.check();
    }
    frames.drop(count);
  };
  core::stream_frames(
      source, stage, info.frames, context,
      [&](int t, const cv::Mat&) {
        masks.push_back(core::mask_of(source));
        before(t);
      },
      [&](int t, const cv::Mat& frame) {
        std::vector<FrameReading> readings;
        if (t >= first) readings = read(t, core::to_levels(frame, info));
        for (FrameReading& reading : readings) reading.levels = packed_levels(reading.levels);
        return readings;
      },
      [&](int t, std::vector<FrameReading> readings) {
        if (t < first) {
          masks.pop_front();
          return;
        }
        frames.push(std::move(readings), std::move(masks.front()));
        masks.pop_front();
        if (frames.waiting() > at_once) settle(false);
      });
  settle(true);
  return done;
}

/// Sketches a clip as above, without before() or known frames.
template <class Read, class Finish, class Take>
int stream_steady_frames(core::FrameSource& source, std::string_view stage,
                         const sketch::ExtractOptions& options, const core::Context& context,
                         const Read& read, const Finish& finish, const Take& take) {
  return stream_steady_frames(
      source, stage, options, context, 0, [](int) {}, read, finish, take);
}

}  // namespace emberfold::pipeline
