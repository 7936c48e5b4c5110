// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "graph/events/events.hpp"
#include "graph/matching/point_grid.hpp"
#include "graph/motion_graph.hpp"

namespace emberfold::pipeline {

/// A stroke of the clip from its birth on, with its patches in each frame until it ended or changed.
struct StrokeLife {
  int first = 0;                                    ///< frame
  std::vector<std::vector<std::uint32_t>> patches;  ///< by frame: vertex indices, ascending
};

/// A clip's frames with their strokes, and look-ups in both.
class SeenClip {
 public:
  /// `frames`: CV_8U, 1 or 3 channels; `strokes`: identified, of the same number of frames of that size.
  /// Throws core::InputError where they disagree.
  SeenClip(std::vector<cv::Mat> frames, graph::MotionGraph strokes);

  [[nodiscard]] int size() const { return static_cast<int>(frames_.size()); }
  [[nodiscard]] double fps() const { return strokes_.sketch.fps; }
  [[nodiscard]] const std::vector<cv::Mat>& frames() const { return frames_; }
  [[nodiscard]] const cv::Mat& frame(int t) const { return frames_[static_cast<std::size_t>(t)]; }
  [[nodiscard]] const graph::AttributeGraph& graph(int t) const {
    return strokes_.sketch.frames[static_cast<std::size_t>(t)];
  }
  /// Returns for each vertex of frame `to` the index of the vertex that it continues in frame `from`, or −1.
  /// Matches frames that are not neighbours. O(vertices log vertices).
  [[nodiscard]] std::vector<int> continued(int from, int to) const;
  /// Returns the levels of the pixel of frame t next to a place; beyond the border those at it.
  [[nodiscard]] const std::uint8_t* pixel(int t, graph::Point place) const;
  /// Returns the events between frame t − 1 and t ≥ 1, with the patches that appeared or vanished.
  [[nodiscard]] const std::vector<graph::TracedEvent>& events(int t) const {
    return events_[static_cast<std::size_t>(t)];
  }
  /// Returns the strokes of at least four frames that were born in the clip.
  [[nodiscard]] const std::vector<StrokeLife>& lives() const { return lives_; }
  /// Returns whether a patch of frame t is within kNear px of a place.
  [[nodiscard]] bool occupied(int t, graph::Point place) const {
    return !places_[static_cast<std::size_t>(t)].find_near(place).empty();
  }
  static constexpr double kNear = 5;
  /// Returns whether a patch belongs to something that stands still: over 20 frames and more it moves by less
  /// than 3 px across its curve.
  [[nodiscard]] bool stands_still(int t, std::uint32_t vertex) const {
    return still_[static_cast<std::size_t>(t)][vertex];
  }

 private:
  void find_still();

  std::vector<cv::Mat> frames_;
  graph::MotionGraph strokes_;
  std::vector<std::vector<graph::TracedEvent>> events_;
  std::vector<StrokeLife> lives_;
  std::vector<graph::detail::PointGrid> places_;
  std::vector<std::vector<bool>> still_;  // by frame and vertex
};

/// A stroke of the clip as it was in one of its frames, under ids of its own.
struct StrokeAgain {
  int frame = -1;                      ///< −1: not shown yet
  std::vector<std::uint32_t> patches;  ///< vertex indices, ascending
  std::vector<std::uint32_t> ids;      ///< of each patch

  /// Shows the stroke in another frame, with these patches. Those that links carry on keep their ids, others
  /// get new ones from `next_id` on.
  void go_to(const SeenClip& clip, int next_frame, const std::vector<std::uint32_t>& next_patches,
             std::uint32_t& next_id);
  /// Adds its patches, `offset` px from where they were, and the edges between them.
  void add_to(std::vector<graph::Vertex>& vertices, std::vector<graph::Edge>& edges, const SeenClip& clip,
              graph::Point offset) const;
};

/// Returns a clip in playing order, backwards where `reverse` is set.
std::shared_ptr<const SeenClip> played_clip(std::vector<cv::Mat> frames, graph::MotionGraph strokes,
                                            bool reverse);

}  // namespace emberfold::pipeline
