// SPDX-License-Identifier: Apache-2.0
// Computes the shape and contrast of a scene's parts at a frame.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "apps/builtin/scene.hpp"

namespace emberfold::apps {

namespace {

using std::numbers::pi;

std::array<double, 3> mode_shapes(BuiltinScene scene, double s) {
  switch (scene) {
    case BuiltinScene::fire:
      return {0.25 + 0.75 * s, std::sin(pi * s), std::sin(2 * pi * s)};
    case BuiltinScene::cloth:
      return {1, std::cos(pi * s), std::cos(2 * pi * s)};
    case BuiltinScene::river:
      return {1, std::cos(2 * pi * s), std::sin(3 * pi * s)};
  }
  return {};
}

}  // namespace

double Change::progress(int at) const {
  return std::clamp(0.5 + (at - frame + 0.5) / fade, 0.0, 1.0);
}

double Presence::contrast_at(int frame) const {
  return std::min(begin ? begin->progress(frame) : 1.0, end ? 1 - end->progress(frame) : 1.0);
}

Line line_at(const BuiltinOptions& options, const Body& body, const RestCurve& curve, int frame) {
  const auto& q = body.modes.at(static_cast<std::size_t>(frame - body.first));
  Line line(curve.points.size());
  for (std::size_t i = 0; i < line.size(); ++i) {
    const auto mode = mode_shapes(options.scene, curve.along[i]);
    line[i] = curve.points[i] + (mode[0] * q[0] + mode[1] * q[1] + mode[2] * q[2]) * body.direction;
  }
  return line;
}

Line line_at(const Scene& scene, const Bridge& bridge, int frame) {
  const auto end = [&](const Anchor& anchor) {
    const Body& body = scene.bodies[anchor.body];
    return line_at(scene.options, body, body.curves[anchor.curve], frame)[anchor.point];
  };
  const cv::Point2d a = end(bridge.from), b = end(bridge.to), chord = b - a;
  const cv::Point2d control = 0.5 * (a + b) + 2 * bridge.bow * cv::Point2d(-chord.y, chord.x);
  const int steps = std::max(4, static_cast<int>(std::ceil(std::hypot(chord.x, chord.y) / 2)));
  Line line;
  for (int i = 0; i <= steps; ++i) {
    const double s = static_cast<double>(i) / steps;
    line.push_back((1 - s) * (1 - s) * a + 2 * s * (1 - s) * control + s * s * b);
  }
  return line;
}

double gap_contrast(const Body& body, double point, int frame) {
  double left = 1;
  for (const Gap& gap : body.gaps) {
    const double edge = gap.half_width - std::abs(point - gap.centre);
    left *= 1 - gap.open.contrast_at(frame) / (1 + std::exp(-edge / 0.4));
  }
  return left;
}

double line_length(const Line& line) {
  double sum = 0;
  for (std::size_t i = 1; i < line.size(); ++i) sum += cv::norm(line[i] - line[i - 1]);
  return sum;
}

cv::Point2d midpoint(const Line& line) {
  double rest = line_length(line) / 2;
  for (std::size_t i = 1; i < line.size(); ++i) {
    const double step = cv::norm(line[i] - line[i - 1]);
    if (step >= rest && step > 0) return line[i - 1] + rest / step * (line[i] - line[i - 1]);
    rest -= step;
  }
  return line.back();
}

std::optional<cv::Point2d> crossing_point(const Line& a, const Line& b) {
  for (std::size_t i = 1; i < a.size(); ++i)
    for (std::size_t j = 1; j < b.size(); ++j) {
      const cv::Point2d u = a[i] - a[i - 1], v = b[j] - b[j - 1], w = b[j - 1] - a[i - 1];
      const double area = u.cross(v);
      if (area == 0) continue;
      const double s = w.cross(v) / area, t = w.cross(u) / area;
      if (s >= 0 && s <= 1 && t >= 0 && t <= 1) return a[i - 1] + s * u;
    }
  return std::nullopt;
}

}  // namespace emberfold::apps
