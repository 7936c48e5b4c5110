// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <string>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "pipeline/footage/frame_sources.hpp"

namespace emberfold::apps {

/// Draws the sources in its clip of a new clip's pixels: six frames, each over its map, the clip's frames
/// against the time at which they are shown, and the shares of all kinds of sources.
class SourceMap {
 public:
  /// `frames`: number in the new clip; `clip_frames`: number in the source clip.
  SourceMap(int frames, int clip_frames);

  /// Returns whether the next frame is one of up to 400 that are sampled; then call add(), otherwise pass().
  [[nodiscard]] bool wants_next() const;
  void pass() { ++next_; }
  /// Adds the next frame, CV_8U, and its sources.
  void add(const cv::Mat& frame, const pipeline::FrameSources& sources);
  /// Returns the picture, CV_8UC3, of at least one frame.
  [[nodiscard]] cv::Mat draw() const;
  /// Returns the share of each kind (pipeline::SourceKind) in the area of all frames.
  [[nodiscard]] std::array<double, pipeline::kSourceKinds> shares() const;

 private:
  [[nodiscard]] cv::Mat1f shown_areas() const;
  [[nodiscard]] cv::Mat draw_map(const cv::Mat& frame, const pipeline::FrameSources& sources) const;
  [[nodiscard]] cv::Mat draw_times(int width) const;

  struct Moment {
    int number = 0;
    cv::Mat frame;  // CV_8UC3
    pipeline::FrameSources sources;
  };
  int frames_, clip_frames_, step_, next_ = 0;
  std::vector<Moment> moments_;
  std::vector<std::vector<int>> shown_;  // cells by frame of the clip, for each sampled frame
  std::array<double, pipeline::kSourceKinds> kinds_{};
};

/// Returns the name of a kind of source, for summary.json and messages.
std::string name(pipeline::SourceKind kind);

}  // namespace emberfold::apps
