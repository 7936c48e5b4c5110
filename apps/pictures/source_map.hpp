// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <string>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "pipeline/footage/frame_sources.hpp"

namespace emberfold::apps {

/// Draws where in its clip the pixels of a new clip come from: six frames, each over its map, the clip's
/// frames by the time at which they are shown, and the shares of all kinds of sources.
class SourceMap {
 public:
  /// `frames`: of the new clip; `clip_frames`: of the clip that it is made of.
  SourceMap(int frames, int clip_frames);

  /// Returns whether the next frame is one of up to 400 that are looked at; pass() or add() it.
  [[nodiscard]] bool wants_next() const;
  void pass() { ++next_; }
  /// Takes the next frame, CV_8U, and its sources.
  void add(const cv::Mat& frame, const pipeline::FrameSources& sources);
  /// Returns the picture, CV_8UC3, of at least one frame.
  [[nodiscard]] cv::Mat draw() const;
  /// Returns the share of all frames' areas that is of each kind (pipeline::SourceKind).
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
  std::vector<std::vector<int>> shown_;  // cells by frame of the clip, of each frame that was taken
  std::array<double, pipeline::kSourceKinds> kinds_{};
};

/// Names the kinds of sources, in summary.json and in words.
std::string name(pipeline::SourceKind kind);

}  // namespace emberfold::apps
