// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <vector>

#include <opencv2/core/types.hpp>

#include "apps/builtin/builtin_clip.hpp"

namespace emberfold::apps {

/// A change of contrast between none and full, spread over `fade` frames about the frame boundary before
/// `frame`, so that `frame` is the first one at or past half.
struct Change {
  int frame = 0;
  int fade = 1;  ///< 1: at once; 2 and 3: two frames in between

  /// Share of the change that is done at a frame: 0 before, 1 after, never exactly one half.
  [[nodiscard]] double done(int at) const;
};

/// When something is there: from `begin` (or ever since) to `end` (or for ever).
struct Presence {
  std::optional<Change> begin, end;

  /// Contrast at a frame, as a share of full contrast.
  [[nodiscard]] double at(int frame) const;
  [[nodiscard]] bool shows(int frame) const { return at(frame) > 0.5; }
};

/// A line at rest: points about 2 px apart, and for each its place along the body's modes, 0…1.
struct RestCurve {
  int id = 0;
  std::vector<cv::Point2d> points;
  std::vector<double> along;
};

/// A place where a line is torn for a while.
struct Gap {
  double centre = 0;      ///< index into the points, fractional
  double half_width = 5;  ///< in points, where the gap is half as deep as in its middle
  Presence open;
};

/// One stroke, or two that cross and live together. It sways about its rest shape: a point moves by
/// direction · Σ mode_m(along) q_m(frame), and each q_m follows q_t = ar[0] q_{t−1} + ar[1] q_{t−2} + noise.
struct Body {
  int polarity = 1;     ///< 1 ridge, −1 valley
  double contrast = 0;  ///< grey levels
  double sigma = 2;     ///< px, of the Gaussian profile, in the middle
  double phase = 0;     ///< of the flicker
  std::array<double, 2> ar{};
  cv::Point2d direction;
  Presence life;
  int first = 0;                             ///< frame of modes[0]
  std::vector<std::array<double, 3>> modes;  ///< q, px, for every frame of the life and its fades
  std::vector<RestCurve> curves;
  std::vector<Gap> gaps;  ///< of curves[0]; never where there are two curves
};

/// One end of a bridge: a point of a body's curve.
struct Anchor {
  std::size_t body = 0, curve = 0, point = 0;
};

/// A line between two bodies that comes and goes.
struct Bridge {
  int id = 0;
  Anchor from, to;
  double bow = 0;  ///< how far it bends sideways, as a share of its length
  double contrast = 0, sigma = 2;
  Presence there;
};

/// All that a built-in clip shows but its ground and its noise.
struct Scene {
  BuiltinOptions options;
  std::vector<Body> bodies;
  std::vector<Bridge> bridges;
};

/// Lays out strokes and times their events. At any frame, what does not touch is at least 10 px apart, and
/// what shows at once forms a forest of bodies and bridges; events of one body are 5 frames apart or more.
Scene plan_scene(const BuiltinOptions& options);

using Line = std::vector<cv::Point2d>;

/// Where a line is at a frame of its body's life.
Line shape(const BuiltinOptions& options, const Body& body, const RestCurve& curve, int frame);
Line shape(const Scene& scene, const Bridge& bridge, int frame);

/// The share of contrast that the gaps leave at a point of curves[0].
double left_by_gaps(const Body& body, double point, int frame);

double length(const Line& line);

/// The point half way along.
cv::Point2d middle(const Line& line);

/// Where two lines cross, if they do (the first place along `a`).
std::optional<cv::Point2d> crossing(const Line& a, const Line& b);

}  // namespace emberfold::apps
