// SPDX-License-Identifier: Apache-2.0
#include "apps/builtin/style.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

namespace emberfold::apps {

namespace {

using std::numbers::pi;
constexpr double step = 2;  // px between points at rest

using Heading = std::function<double(const cv::Point2d& at, double travelled)>;  ///< rad, x right, y down

RestCurve follow_heading(cv::Point2d at, double length, const Heading& heading) {
  RestCurve curve;
  const int steps = static_cast<int>(std::round(length / step));
  for (int i = 0; i <= steps; ++i) {
    curve.points.push_back(at);
    curve.along.push_back(static_cast<double>(i) / steps);
    const double angle = heading(at, step * i);
    at += step * cv::Point2d(std::cos(angle), std::sin(angle));
  }
  return curve;
}

// Moves a curve so that its point at a share of its length comes to where its beginning was.
void shift_back(RestCurve& curve, double share) {
  const auto there = static_cast<std::size_t>(share * static_cast<double>(curve.points.size()));
  const cv::Point2d shift = curve.points.front() - curve.points[there];
  for (auto& point : curve.points) point += shift;
}

// Draws a tongue of flame: from its foot upwards, leaning towards the middle with height.
void draw_tongue(Body& body, const BuiltinOptions& o, const std::array<double, 4>& flow,
                 std::optional<cv::Point2d> beside, core::Rng& rng) {
  const double w = o.width, h = o.height;
  double up = std::pow(rng.uniform(), 1.25);  // 0 at the bottom: more flames there
  const double half = w * (0.47 - 0.27 * up);
  cv::Point2d foot(w / 2 + half * rng.uniform(-1, 1), h * (0.955 - 0.68 * up));
  if (beside) {
    foot = *beside + cv::Point2d(rng.uniform(12, 20) * (rng.uniform() < 0.5 ? 1 : -1), rng.uniform(-15, 30));
    up = std::clamp((0.955 - foot.y / h) / 0.68, 0.0, 1.0);
    if (std::abs(foot.x - w / 2) > w * (0.47 - 0.27 * up) || foot.y > 0.96 * h) return;
  }
  const double length = std::min(rng.uniform(34, 92) * (1.15 - 0.4 * up), foot.y - 9);
  if (length < 32) return;
  const double wave = rng.uniform(45, 90), phase = rng.uniform(0, 2 * pi), bend = rng.uniform(0.1, 0.32);
  body.curves.push_back(follow_heading(foot, length, [&](const cv::Point2d& p, double s) {
    const double lean = -0.5 * (p.x - w / 2) / (w / 2) * (0.35 + 0.65 * (1 - p.y / h));
    const double gust = 0.22 * std::sin(2 * pi * p.y / 120 + 2.5 * p.x / 160 + flow[0]);
    return -pi / 2 + lean + gust + bend * std::sin(2 * pi * s / wave + phase);
  }));
  body.direction = {1, 0};
}

// Draws a long hanging fold; one drape bends all folds.
void draw_fold(Body& body, const BuiltinOptions& o, const std::array<double, 4>& flow,
               std::optional<cv::Point2d> beside, core::Rng& rng) {
  const double w = o.width, h = o.height;
  const double length = rng.uniform(60, 165) * std::min(1.0, h / 240);
  if (length < 32) return;
  cv::Point2d at(rng.uniform(0, w), rng.uniform(0, h));
  if (beside)
    at = *beside + cv::Point2d(rng.uniform(15, 28) * (rng.uniform() < 0.5 ? 1 : -1), rng.uniform(-60, 60));
  const double own = rng.uniform(-0.08, 0.08), phase = rng.uniform(0, 2 * pi);
  body.curves.push_back(follow_heading(at, length, [&](const cv::Point2d& p, double s) {
    const double drape = 0.34 * std::sin(2 * pi * p.x / 330 + flow[0]) * (0.5 + 0.5 * p.y / h);
    const double sag = 0.16 * std::sin(2 * pi * p.y / 260 + flow[1]);
    return pi / 2 + 0.28 * std::sin(flow[2]) + drape + sag + own + 0.07 * std::sin(2 * pi * s / 110 + phase);
  }));
  shift_back(body.curves[0], 0.5);
  const cv::Point2d along = body.curves[0].points.back() - body.curves[0].points.front();
  body.direction = cv::Point2d(along.y, -along.x) / cv::norm(along);
}

// Draws a nearly level, undulating crest, or two that cross.
void draw_crest(Body& body, const BuiltinOptions& o, const std::array<double, 4>& flow,
                std::optional<cv::Point2d> beside, core::Rng& rng) {
  cv::Point2d at(rng.uniform(0, o.width), rng.uniform(0, o.height));
  if (beside)
    at = *beside + cv::Point2d(rng.uniform(-50, 50), rng.uniform(12, 20) * (rng.uniform() < 0.5 ? 1 : -1));
  const bool crossed = rng.uniform() < 0.3;
  const double side = rng.uniform() < 0.5 ? 1 : -1;
  const double near = at.y / o.height;  // nearer crests are larger
  const double most = std::min(1.0, o.width / 160.0) * (0.75 + 0.45 * near);
  body.sigma *= 0.85 + 0.35 * near;
  if (body.polarity < 0) body.contrast *= 0.65;
  for (int arm = 0; arm < (crossed ? 2 : 1); ++arm) {
    const double length = most * (crossed ? rng.uniform(50, 100) : rng.uniform(36, 125));
    if (length < 32) {
      body.curves.clear();
      return;
    }
    const double tilt =
        (arm == 0 ? side : -side) * (crossed ? rng.uniform(0.28, 0.42) : rng.uniform(0.02, 0.3));
    const double wave = rng.uniform(34, 70), phase = rng.uniform(0, 2 * pi);
    body.curves.push_back(follow_heading(at, length, [&](const cv::Point2d& p, double s) {
      const double swell = 0.1 * std::sin(2 * pi * p.x / 150 + 2 * pi * p.y / 210 + flow[0]);
      return tilt + swell + (crossed ? 0.16 : 0.28) * std::sin(2 * pi * s / wave + phase);
    }));
    shift_back(body.curves.back(), crossed ? rng.uniform(0.32, 0.68) : 0.5);
  }
  if (crossed) {
    // Both arms move by the same function of x, so that they always cross.
    const double left = std::min(body.curves[0].points.front().x, body.curves[1].points.front().x);
    const double right = std::max(body.curves[0].points.back().x, body.curves[1].points.back().x);
    for (auto& curve : body.curves)
      for (std::size_t i = 0; i < curve.points.size(); ++i)
        curve.along[i] = (curve.points[i].x - left) / (right - left);
  }
  body.direction = {0, 1};
}

}  // namespace

const Style& style_of(BuiltinScene scene) {
  static const Style fire{.area_per_body = 1500,
                          .births = 1.6,
                          .gaps = 0.17,
                          .bridges = 0.5,
                          .life = 60,
                          .pole_radius = 0.965,
                          .period = 15,
                          .sway = {3.4, 1.5, 0.9},
                          .contrast_low = 80,
                          .contrast_high = 165,
                          .sigma_low = 1.5,
                          .sigma_high = 2.3,
                          .valleys = 0,
                          .flicker = 0.14,
                          .flicker_wave = 38,
                          .flicker_period = 11};
  static const Style cloth{.area_per_body = 2400,
                           .births = 0.8,
                           .gaps = 0.13,
                           .bridges = 0.25,
                           .life = 110,
                           .pole_radius = 0.985,
                           .period = 36,
                           .sway = {2.4, 1.3, 0.7},
                           .contrast_low = 20,
                           .contrast_high = 38,
                           .sigma_low = 2.6,
                           .sigma_high = 3.8,
                           .valleys = 0.5,
                           .flicker = 0,
                           .flicker_wave = 60,
                           .flicker_period = 30};
  static const Style river{.area_per_body = 1700,
                           .births = 1.6,
                           .gaps = 0.16,
                           .bridges = 0.45,
                           .life = 55,
                           .pole_radius = 0.975,
                           .period = 22,
                           .sway = {1.6, 1.2, 0.8},
                           .contrast_low = 24,
                           .contrast_high = 58,
                           .sigma_low = 1.25,
                           .sigma_high = 2.0,
                           .valleys = 0.12,
                           .flicker = 0.2,
                           .flicker_wave = 15,
                           .flicker_period = 8};
  switch (scene) {
    case BuiltinScene::cloth:
      return cloth;
    case BuiltinScene::river:
      return river;
    case BuiltinScene::fire:
      break;
  }
  return fire;
}

Body draw_body(const BuiltinOptions& options, const std::array<double, 4>& flow,
               std::optional<cv::Point2d> beside, core::Rng& rng) {
  const Style& style = style_of(options.scene);
  Body body;
  body.polarity = rng.uniform() < style.valleys ? -1 : 1;
  body.contrast = rng.uniform(style.contrast_low, style.contrast_high);
  body.sigma = rng.uniform(style.sigma_low, style.sigma_high);
  body.phase = rng.uniform(0, 2 * pi);
  const double angle = 2 * pi / (style.period * rng.uniform(0.97, 1.03));
  body.ar = {2 * style.pole_radius * std::cos(angle), -style.pole_radius * style.pole_radius};
  switch (options.scene) {
    case BuiltinScene::fire:
      draw_tongue(body, options, flow, beside, rng);
      break;
    case BuiltinScene::cloth:
      draw_fold(body, options, flow, beside, rng);
      break;
    case BuiltinScene::river:
      draw_crest(body, options, flow, beside, rng);
      break;
  }
  return body;
}

}  // namespace emberfold::apps
