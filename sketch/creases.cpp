// SPDX-License-Identifier: Apache-2.0
#include "sketch/creases.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include <opencv2/imgproc.hpp>

#include "sketch/median.hpp"

namespace emberfold::sketch {

using graph::Point;

namespace {

// A line of Gaussian profile with SD s and height h responds with h·s / (s² + σ²)^{3/2}; the normalised
// response σ^{3/2}·λ is greatest at σ = s, where h = 2^{3/2} σ² λ.
constexpr double kLineContrast = 2.8284271247461903;
// A step of height b blurred by σ has the gradient b / (√(2π)·√2·σ) when seen at scale σ.
constexpr double kStepContrast = 3.5449077018110318;
// How far from the pixel's centre the subpixel place may lie (Steger: 0.5; a margin keeps lines connected).
constexpr double kPixelReach = 0.6;

struct Principal {
  float value;   // the eigenvalue of greater magnitude
  float nx, ny;  // its direction
};

// The nearest whole number, as std::lround has it, without a call.
int nearest(double v) {
  const int whole = static_cast<int>(v);
  const double rest = v - whole;
  return whole + (rest >= 0.5 ? 1 : 0) - (rest <= -0.5 ? 1 : 0);
}

// Squares of single precision neither overflow nor vanish in double precision.
float length_of(float x, float y) {
  return static_cast<float>(std::sqrt(double{x} * double{x} + double{y} * double{y}));
}

Principal principal(const Hessian& h) {
  const float half_trace = 0.5F * (h.xx + h.yy), half_difference = 0.5F * (h.xx - h.yy);
  const float radius = length_of(half_difference, h.xy);
  const float value = half_trace >= 0 ? half_trace + radius : half_trace - radius;
  // Of the two rows of H − value·I, the one with the larger entries gives the direction without cancellation.
  float nx = h.xy, ny = value - h.xx;
  if (std::abs(value - h.yy) > std::abs(ny)) {
    nx = value - h.yy;
    ny = h.xy;
  }
  const float length = length_of(nx, ny);
  return length > 0 ? Principal{value, nx / length, ny / length} : Principal{value, 1, 0};
}

void put(CreaseMap& map, int x, int y, const CreasePoint& point) {
  int& slot = map.index(y, x);
  if (slot < 0) {
    slot = static_cast<int>(map.points.size());
    map.points.push_back(point);
  } else if (point.strength > map.points[static_cast<std::size_t>(slot)].strength) {
    map.points[static_cast<std::size_t>(slot)] = point;
  }
}

// The frame is mirrored at its border, which makes a line there of any slope: a line must show both its
// sides.
bool inside(const cv::Mat1i& frame, Point p) {
  return p.x >= 0 && p.y >= 0 && p.x <= frame.cols - 1 && p.y <= frame.rows - 1;
}

CreaseMap empty_map(const ScaleSpace& space, CreaseKind kind) {
  const cv::Mat1f& smooth = space.front().smooth;
  return {kind, {}, cv::Mat1i(smooth.rows - 2, smooth.cols - 2, -1)};
}

// Drops the points that are marked and numbers the rest anew, in row order.
void keep_unmarked(CreaseMap& map, const std::vector<bool>& marked) {
  std::vector<CreasePoint> kept;
  kept.reserve(map.points.size());
  for (int y = 0; y < map.index.rows; ++y) {
    int* row = map.index[y];
    for (int x = 0; x < map.index.cols; ++x) {
      if (row[x] < 0) continue;
      const auto old = static_cast<std::size_t>(row[x]);
      row[x] = marked[old] ? -1 : static_cast<int>(kept.size());
      if (!marked[old]) kept.push_back(map.points[old]);
    }
  }
  map.points = std::move(kept);
}

// The bound that find_lines asks of a response, for a whole row at once: not negative wherever half trace +
// radius may reach `least`; the thousandth that it gives away is more than single precision loses.
void may_respond(const ScaleLevel& level, int y, float sign, double least, std::vector<float>& margin) {
  const float* up = level.smooth[y];
  const float* mid = level.smooth[y + 1];
  const float* down = level.smooth[y + 2];
  float* __restrict out = margin.data();
  const float lower = static_cast<float>(0.999 * least);
  const int width = level.smooth.cols - 2;
  for (int x = 0; x < width; ++x) {
    const float xx = mid[x + 2] - 2 * mid[x + 1] + mid[x], yy = down[x + 1] - 2 * mid[x + 1] + up[x + 1];
    const float xy = 0.25F * (down[x + 2] - down[x] - up[x + 2] + up[x]), half_difference = 0.5F * (xx - yy);
    const float short_of = lower - 0.5F * sign * (xx + yy);
    const float missing = 0.5F * (short_of + std::abs(short_of));  // at least 0, without a branch
    out[x] = half_difference * half_difference + xy * xy - missing * missing;
  }
}

cv::Mat1f gradient_magnitude(const ScaleLevel& level) {
  const int width = level.smooth.cols - 2, height = level.smooth.rows - 2;
  cv::Mat1f magnitude(height, width);
  for (int y = 0; y < height; ++y) {
    const float* up = level.smooth[y];
    const float* mid = level.smooth[y + 1];
    const float* down = level.smooth[y + 2];
    float* __restrict row = magnitude[y];
    for (int x = 0; x < width; ++x) {
      const float gx = 0.5F * (mid[x + 2] - mid[x]), gy = 0.5F * (down[x + 1] - up[x + 1]);
      row[x] = gx * gx + gy * gy;
    }
  }
  cv::sqrt(magnitude, magnitude);
  return magnitude;
}

}  // namespace

Ground measure_ground(const ScaleSpace& space, double noise) {
  constexpr double kMedianToSd = 1.4826;
  Ground ground;
  for (const ScaleLevel& level : space) {
    const int width = level.smooth.cols - 2, height = level.smooth.rows - 2;
    // A sample every 1.5 σ pixels is as good as all, for neighbours hardly differ.
    const int step = std::max(1, static_cast<int>(1.5 * level.sigma));
    std::vector<float> second, first;
    const auto samples = 2 * static_cast<std::size_t>((width + step - 1) / step) *
                         static_cast<std::size_t>((height + step - 1) / step);
    second.reserve(samples);
    first.reserve(samples);
    for (int y = 0; y < height; y += step)
      for (int x = 0; x < width; x += step) {
        const Hessian h = level.hessian(x, y);
        const Point g = level.gradient(x, y);
        second.push_back(std::abs(h.xx));
        second.push_back(std::abs(h.yy));
        first.push_back(static_cast<float>(std::abs(g.x)));
        first.push_back(static_cast<float>(std::abs(g.y)));
      }
    ground.second.push_back(
        std::max(noise * level.hessian_sd, kMedianToSd * double{median(std::move(second))}));
    ground.first.push_back(
        std::max(noise * level.gradient_sd, kMedianToSd * double{median(std::move(first))}));
  }
  return ground;
}

CreaseMap find_lines(const ScaleSpace& space, const Ground& ground, CreaseKind kind, CreaseLimits limits) {
  CreaseMap map = empty_map(space, kind);
  const float sign = kind == CreaseKind::ridge ? -1.0F : 1.0F;
  std::vector<float> margin(static_cast<std::size_t>(map.index.cols));
  for (std::size_t k = 0; k < space.size(); ++k) {
    const ScaleLevel& level = space[k];
    const double to_contrast = kLineContrast * level.sigma * level.sigma;
    const double least = std::max(limits.significance * ground.second[k], limits.contrast / to_contrast);
    const double normalise = std::pow(level.sigma, 1.5);
    for (int y = 0; y < map.index.rows; ++y) {
      may_respond(level, y, sign, least, margin);
      for (int x = 0; x < map.index.cols; ++x) {
        if (margin[static_cast<std::size_t>(x)] < 0) continue;
        const Hessian h = level.hessian(x, y);
        // Most pixels end here, before any root is taken: half trace + radius is the response.
        const double half_trace = 0.5 * double{sign * (h.xx + h.yy)}, missing = least - half_trace;
        if (half_trace < 0) continue;
        const double half_difference = 0.5 * (double{h.xx} - double{h.yy});
        if (missing > 0 &&
            half_difference * half_difference + double{h.xy} * double{h.xy} < missing * missing)
          continue;
        const Principal p = principal(h);
        const double response = double{sign * p.value};
        const Point g = level.gradient(x, y);
        const double nx = double{p.nx}, ny = double{p.ny};
        const double t = -(g.x * nx + g.y * ny) / double{p.value};
        if (std::abs(t * nx) > kPixelReach || std::abs(t * ny) > kPixelReach) continue;
        if (!inside(map.index, {x + level.sigma * nx, y + level.sigma * ny}) ||
            !inside(map.index, {x - level.sigma * nx, y - level.sigma * ny}))
          continue;
        put(map, x, y,
            {{x + t * nx, y + t * ny},
             std::atan2(-nx, ny),
             response / ground.second[k],
             response * normalise,
             response * to_contrast,
             static_cast<int>(k)});
      }
    }
  }
  return map;
}

CreaseMap find_steps(const ScaleSpace& space, const Ground& ground, CreaseLimits limits) {
  CreaseMap map = empty_map(space, CreaseKind::step);
  for (std::size_t k = 0; k < space.size(); ++k) {
    const ScaleLevel& level = space[k];
    const int width = map.index.cols, height = map.index.rows;
    const double to_contrast = kStepContrast * level.sigma;
    const double least = std::max(limits.significance * ground.first[k], limits.contrast / to_contrast);
    const cv::Mat1f magnitude = gradient_magnitude(level);
    const auto at = [&](double px, double py) {
      px = std::clamp(px, 0.0, width - 1.001);
      py = std::clamp(py, 0.0, height - 1.001);
      const int ix = static_cast<int>(px), iy = static_cast<int>(py);
      const double fx = px - ix, fy = py - iy;
      return (1 - fy) * ((1 - fx) * double{magnitude(iy, ix)} + fx * double{magnitude(iy, ix + 1)}) +
             fy * ((1 - fx) * double{magnitude(iy + 1, ix)} + fx * double{magnitude(iy + 1, ix + 1)});
    };
    for (int y = 1; y + 2 < height; ++y)
      for (int x = 1; x + 2 < width; ++x) {
        const double here = double{magnitude(y, x)};
        if (here < least) continue;
        const Point g = level.gradient(x, y);
        const double nx = g.x / here, ny = g.y / here;
        const double ahead = at(x + nx, y + ny), behind = at(x - nx, y - ny);
        const double bend = 2 * here - ahead - behind;
        if (bend <= 0) continue;
        const double t = 0.5 * (ahead - behind) / bend;
        if (std::abs(t * nx) > kPixelReach || std::abs(t * ny) > kPixelReach) continue;
        // A slope that goes on to both sides is shading, not a step: only what rises above it counts.
        const double far = 2.5 * level.sigma;
        const double slope = 0.5 * (at(x + far * nx, y + far * ny) + at(x - far * nx, y - far * ny));
        const double rise = here - slope;
        if (rise < least) continue;
        put(map, x, y,
            {{x + t * nx, y + t * ny},
             std::atan2(-nx, ny),
             rise / ground.first[k],
             rise * std::sqrt(level.sigma),
             rise * to_contrast,
             static_cast<int>(k)});
      }
  }
  return map;
}

void remove_lobes(CreaseMap& lines, const CreaseMap& opposite, const ScaleSpace& space) {
  constexpr double kLobeShare = 0.35;  // of the line's contrast: a lobe has at most a tenth, the curl round a
                                       // bend or an end up to a third
  constexpr double kReach = 4.0;       // in σ of the line
  const int width = lines.index.cols, height = lines.index.rows;
  cv::Mat1f shadow(height, width, 0.0F);
  for (const CreasePoint& p : opposite.points) {
    const int reach = static_cast<int>(std::ceil(kReach * space[static_cast<std::size_t>(p.level)].sigma));
    const auto cast = static_cast<float>(kLobeShare * p.contrast);
    const int cx = nearest(p.position.x), cy = nearest(p.position.y);
    for (int y = std::max(0, cy - reach); y <= std::min(height - 1, cy + reach); ++y) {
      const int half = static_cast<int>(std::sqrt(double(reach) * reach - double(y - cy) * (y - cy)));
      float* row = shadow[y];
      const int last = std::min(width - 1, cx + half);
      for (int x = std::max(0, cx - half); x <= last; ++x) row[x] = row[x] < cast ? cast : row[x];
    }
  }
  std::vector<bool> marked(lines.points.size(), false);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      if (const int i = lines.index(y, x); i >= 0)
        marked[static_cast<std::size_t>(i)] =
            lines.points[static_cast<std::size_t>(i)].contrast < double{shadow(y, x)};
  keep_unmarked(lines, marked);
}

void remove_flanks(CreaseMap& steps, const CreaseMap& lines, const ScaleSpace& space) {
  constexpr double kMargin = 1.6;  // a line whose sides differ by half has one flank that is a third higher
  const int width = steps.index.cols, height = steps.index.rows;
  cv::Mat1i owner(height, width, -1);  // of each pixel beside a line: the strongest such line's point
  const auto point = [&](int i) -> const CreasePoint& { return lines.points[static_cast<std::size_t>(i)]; };
  for (std::size_t i = 0; i < lines.points.size(); ++i) {
    const CreasePoint& p = lines.points[i];
    const double reach = 2.5 * space[static_cast<std::size_t>(p.level)].sigma + 1.5;
    const double nx = -std::sin(p.theta), ny = std::cos(p.theta);
    for (double d = -reach; d <= reach; d += 0.5) {
      const int x = nearest(p.position.x + d * nx), y = nearest(p.position.y + d * ny);
      if (x < 0 || y < 0 || x >= width || y >= height) continue;
      int& pixel = owner(y, x);
      if (pixel < 0 || point(pixel).contrast < p.contrast) pixel = static_cast<int>(i);
    }
  }
  std::vector<bool> marked(steps.points.size(), false);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      if (steps.index(y, x) < 0 || owner(y, x) < 0) continue;
      const auto at = static_cast<std::size_t>(steps.index(y, x));
      const CreasePoint& line = point(owner(y, x));
      // The steepest slope of a Gaussian line, h s / S² · e^{−1/2}, read as a step at the step's own scale.
      const double s = space[static_cast<std::size_t>(line.level)].sigma,
                   sigma = space[static_cast<std::size_t>(steps.points[at].level)].sigma;
      const double slope = 0.607 * line.contrast * s / (s * s + sigma * sigma);
      marked[at] = steps.points[at].contrast < kMargin * slope * kStepContrast * sigma;
    }
  keep_unmarked(steps, marked);
}

void thin(CreaseMap& map, const ScaleSpace& space) {
  std::vector<std::size_t> order(map.points.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return map.points[a].strength > map.points[b].strength;
  });
  std::vector<bool> marked(map.points.size(), false);
  for (const std::size_t i : order) {
    if (marked[i]) continue;
    const CreasePoint& p = map.points[i];
    const double reach = std::max(1.5, 1.25 * space[static_cast<std::size_t>(p.level)].sigma);
    const Point normal{-std::sin(p.theta), std::cos(p.theta)};
    for (double d = -reach; d <= reach; d += 0.5) {
      const int x = nearest(p.position.x + d * normal.x), y = nearest(p.position.y + d * normal.y);
      if (x < 0 || y < 0 || x >= map.index.cols || y >= map.index.rows || map.index(y, x) < 0) continue;
      const auto j = static_cast<std::size_t>(map.index(y, x));
      const CreasePoint& q = map.points[j];
      const Point v = q.position - p.position;
      const double across = std::abs(graph::dot(v, normal)),
                   along = std::abs(graph::dot(v, {normal.y, -normal.x}));
      if (j != i && q.strength < p.strength && across > 0.5 && across <= reach && along < 1 &&
          graph::orientation_difference(p.theta, q.theta) < std::numbers::pi / 4)
        marked[j] = true;
    }
  }
  keep_unmarked(map, marked);
}

}  // namespace emberfold::sketch
