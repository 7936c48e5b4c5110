// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <vector>

#include <opencv2/core/types.hpp>

#include "apps/builtin/builtin_clip.hpp"

namespace emberfold::apps {

/// A change of contrast between none and full over `fade` frames, centred on the boundary before `frame`: the
/// first frame at or past half.
struct Change {
  int frame = 0;
  int fade = 1;  ///< 1: at once; 2 and 3: two frames in between

  /// Returns the share of the change done at a frame: 0 before, 1 after, never exactly one half.
  [[nodiscard]] double progress(int at) const;
};

/// The time in which something is present: from `begin` (or the first frame) to `end` (or the last).
struct Presence {
  std::optional<Change> begin, end;

  /// Returns the contrast at a frame as a share of full contrast.
  [[nodiscard]] double contrast_at(int frame) const;
  [[nodiscard]] bool shows(int frame) const { return contrast_at(frame) > 0.5; }
};

/// A line at rest: points about 2 px apart, each with its coordinate along the body's modes, 0…1.
struct RestCurve {
  int id = 0;
  std::vector<cv::Point2d> points;
  std::vector<double> along;
};

/// A place where a line is interrupted for some time.
struct Gap {
  double centre = 0;      ///< index of a point, fractional
  double half_width = 5;  ///< points from the centre at which the gap has half its depth
  Presence open;
};

/// One stroke, or two that cross and appear together.
/// A point moves about its rest position by direction · Σ mode_m(along) q_m(frame), and each q_m follows q_t
/// = ar[0] q_{t−1} + ar[1] q_{t−2} + noise.
struct Body {
  int polarity = 1;     ///< 1 ridge, −1 valley
  double contrast = 0;  ///< grey levels
  double sigma = 2;     ///< px, of the Gaussian profile, in the middle
  double phase = 0;     ///< of the flicker
  std::array<double, 2> ar{};
  cv::Point2d direction;
  Presence life;
  int first = 0;                             ///< frame of modes[0]
  std::vector<std::array<double, 3>> modes;  ///< q, px, for every frame of its presence and its fades
  std::vector<RestCurve> curves;
  std::vector<Gap> gaps;  ///< of curves[0]; none where there are two curves
};

/// One end of a bridge: a point of a body's curve.
struct Anchor {
  std::size_t body = 0, curve = 0, point = 0;
};

/// A line between two bodies, present for some time.
struct Bridge {
  int id = 0;
  Anchor from, to;
  double bow = 0;  ///< sideways deflection, as a share of its length
  double contrast = 0, sigma = 2;
  Presence presence;
};

/// The strokes of a built-in clip and all their events.
struct Scene {
  BuiltinOptions options;
  std::vector<Body> bodies;
  std::vector<Bridge> bridges;
};

/// Lays out strokes and times their events. In every frame, lines that do not touch are at least 10 px apart,
/// and bodies and bridges form a forest. Events of one body are at least 5 frames apart.
Scene plan_scene(const BuiltinOptions& options);

using Line = std::vector<cv::Point2d>;

/// Returns the points of a line in a frame in which its body is present.
Line line_at(const BuiltinOptions& options, const Body& body, const RestCurve& curve, int frame);
Line line_at(const Scene& scene, const Bridge& bridge, int frame);

/// Returns the share of contrast that remains at a point of curves[0] in the gaps.
double gap_contrast(const Body& body, double point, int frame);

/// Returns the length of a line, px.
double line_length(const Line& line);

/// Returns the point half way along a line.
cv::Point2d midpoint(const Line& line);

/// Returns the first crossing of two lines along `a`, if there is one.
std::optional<cv::Point2d> crossing_point(const Line& a, const Line& b);

}  // namespace emberfold::apps
