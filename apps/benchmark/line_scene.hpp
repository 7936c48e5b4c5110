// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "apps/builtin/scene.hpp"
#include "core/context.hpp"
#include "core/rng.hpp"
#include "graph/events/events.hpp"

namespace emberfold::apps {

/// A smooth motion of the whole picture: waves in space with oscillating amplitudes.
class SceneFlow {
 public:
  /// `strength`: px, SD of each component.
  SceneFlow(core::Rng& rng, double strength);
  /// Returns the displacement at a frame of the point with rest position `rest`, px.
  [[nodiscard]] cv::Point2d at(const cv::Point2d& rest, int frame) const;

 private:
  struct Wave {
    cv::Point2d vector;  ///< rad per px
    cv::Point2d way;     ///< px
    double phase = 0, turn = 0;
  };
  std::array<Wave, 5> waves_;
};

/// A line of a synthetic scene, at rest in the flow.
struct SceneLine {
  Line rest;             ///< points about 2 px apart
  double contrast = 60;  ///< grey levels; below 0: a dark line
  double sigma = 1.8;    ///< px, of the Gaussian profile
  Presence presence;
  /// Its own motion in addition to the flow, px: by the share of its length, 0…1, and the frame.
  std::function<cv::Point2d(double share, int frame)> move = {};
};

/// Lines that change at known times.
struct LineScene {
  int width = 320, height = 240, frames = 100;
  double noise = 3;  ///< grey levels, SD
  std::uint64_t seed = 1;
  SceneFlow flow;
  std::vector<SceneLine> lines;
  std::vector<graph::Event> events;  ///< the true events
};

/// Returns a straight line with a point every 2 px.
Line straight_line(const cv::Point2d& from, const cv::Point2d& to);

/// Returns a line's points at a frame.
Line line_at(const LineScene& scene, const SceneLine& line, int frame);

/// Adds an event at a line's point, given by the share of its length, at its place in the event's frame.
void tell(LineScene& scene, int frame, graph::EventType type, const SceneLine& line, double share);

/// Draws all frames (CV_8UC1) over a gently varying background, with noise. The same bytes at any number of
/// threads.
std::vector<cv::Mat> draw_scene(const LineScene& scene, const core::Context& context);

}  // namespace emberfold::apps
