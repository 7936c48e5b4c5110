// SPDX-License-Identifier: Apache-2.0
#include "sketch/creases.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "core/between_pixels.hpp"
#include "sketch/median.hpp"
#include "sketch/row_pass.hpp"

namespace emberfold::sketch {

using core::between_pixels;
using graph::Point;

namespace {

// A line of Gaussian profile with SD s and height h responds with h·s / (s² + σ²)^{3/2}; the normalised
// response σ^{3/2}·λ is greatest at σ = s, where h = 2^{3/2} σ² λ.
constexpr double kLineContrast = 2.8284271247461903;
// A step of height b blurred by σ has the gradient b / (√(2π)·√2·σ) when seen at scale σ.
constexpr double kStepContrast = 3.5449077018110318;
// How far from the pixel's centre the subpixel place may lie (Steger: 0.5; a margin keeps lines connected).
constexpr double kPixelReach = 0.6;

// Second derivatives at places of a row, of each its eigenvalue of greater magnitude and the direction of
// that.
struct Principals {
  std::vector<int> x;  // of the places
  std::vector<float> xx, xy, yy, value, nx, ny;
  explicit Principals(int width) : x(static_cast<std::size_t>(width)) {
    for (auto* column : {&xx, &xy, &yy, &value, &nx, &ny}) column->resize(x.size());
  }
};

// Squares of single precision neither overflow nor vanish in double precision.
inline float length_of(float x, float y) {
  return static_cast<float>(std::sqrt(double{x} * double{x} + double{y} * double{y}));
}

EMBERFOLD_ROW_PASS void principal_row(const float* __restrict xx, const float* __restrict xy,
                                      const float* __restrict yy, int count, float* __restrict values,
                                      float* __restrict along_x, float* __restrict along_y) {
  for (int i = 0; i < count; ++i) {
    const float half_trace = 0.5F * (xx[i] + yy[i]), half_difference = 0.5F * (xx[i] - yy[i]);
    const float radius = length_of(half_difference, xy[i]);
    const float value = half_trace >= 0 ? half_trace + radius : half_trace - radius;
    // Of the two rows of H − value·I, the one with the larger entries gives the direction without
    // cancellation.
    const float over_x = value - xx[i], over_y = value - yy[i];
    const bool other = std::abs(over_y) > std::abs(over_x);
    const float nx = other ? over_y : xy[i], ny = other ? xy[i] : over_x;
    const float length = length_of(nx, ny), divisor = length > 0 ? length : 1;
    values[i] = value;
    along_x[i] = length > 0 ? nx / divisor : 1;
    along_y[i] = length > 0 ? ny / divisor : 0;
  }
}

// visit(x) for the places in [first, last) where a row is not 0.
template <class Visit>
void visit_found(const std::vector<float>& row, int first, int last, Visit visit) {
  constexpr int kBlock = 16;
  const float* found = row.data();
  for (int x0 = first; x0 < last; x0 += kBlock) {
    const int end = std::min(x0 + kBlock, last);
    if (end == x0 + kBlock) {  // most blocks are empty
      int any = 0;
      for (int j = 0; j < kBlock; ++j) any |= found[x0 + j] != 0 ? 1 : 0;
      if (any == 0) continue;
    }
    int place[kBlock], count = 0;  // without branches: nobody can foretell which they are
    for (int x = x0; x < end; ++x) {
      place[count] = x;
      count += found[x] != 0 ? 1 : 0;
    }
    for (int i = 0; i < count; ++i) visit(place[i]);
  }
}

// A map to which points are added; their theta comes last, as most give way to others.
struct Growing {
  CreaseMap map;
  std::vector<Point> normals;  // of the map's points

  // Whether a point of this strength would be kept.
  [[nodiscard]] bool beats(int x, int y, double strength) const {
    const int slot = map.index(y, x);
    return slot < 0 || strength > map.points[static_cast<std::size_t>(slot)].strength;
  }

  void put(int x, int y, const CreasePoint& point, Point normal) {
    int& slot = map.index(y, x);
    if (slot < 0) {
      slot = static_cast<int>(map.points.size());
      map.points.push_back(point);
      normals.push_back(normal);
    } else if (const auto i = static_cast<std::size_t>(slot); point.strength > map.points[i].strength) {
      map.points[i] = point;
      normals[i] = normal;
    }
  }

  CreaseMap finish() {
    for (std::size_t i = 0; i < normals.size(); ++i)
      map.points[i].theta = std::atan2(-normals[i].x, normals[i].y);
    return std::move(map);
  }
};

// The frame is mirrored at its border, which makes a line there of any slope: a line must show both its
// sides.
bool inside(const cv::Mat1i& frame, Point p) {
  return p.x >= 0 && p.y >= 0 && p.x <= frame.cols - 1 && p.y <= frame.rows - 1;
}

Growing empty_map(const ScaleSpace& space, CreaseKind kind) {
  const cv::Mat1f& smooth = space.front().smooth;
  return {{kind, {}, cv::Mat1i(smooth.rows - 2, smooth.cols - 2, -1)}, {}};
}

// find_lines for a whole row in single precision: the eigenvalue of greater magnitude where it reaches
// `least` and the subpixel place lies near enough, 0 elsewhere. The thousandth given away is more than single
// precision loses.
EMBERFOLD_ROW_PASS void line_row(const float* up, const float* mid, const float* down, int width, float least,
                                 float* __restrict out) {
  const float enough = 0.999F * least, reach = 1.001F * static_cast<float>(kPixelReach);
  for (int x = 0; x < width; ++x) {
    const float left = mid[x], here = 2 * mid[x + 1], right = mid[x + 2], above = up[x + 1],
                below = down[x + 1];
    const float xx = (left + right) - here, yy = (above + below) - here;
    const float xy = 0.25F * ((down[x + 2] + up[x]) - (down[x] + up[x + 2]));
    const float gx = 0.5F * (right - left), gy = 0.5F * (below - above);
    const float half_trace = 0.5F * (xx + yy), half_difference = 0.5F * (xx - yy);
    const float radius = std::sqrt(half_difference * half_difference + xy * xy);
    const float excess = half_trace >= 0 ? radius : -radius, value = half_trace + excess;
    // As in principal(): value − yy and value − xx, of which one is free of cancellation.
    const float over_y = half_difference + excess, over_x = excess - half_difference;
    const bool flat = std::abs(over_y) > std::abs(over_x);
    const float nx = flat ? over_y : xy, ny = flat ? xy : over_x;
    const float slope = std::abs(gx * nx + gy * ny), size = std::abs(value);
    const float longer = std::max(std::abs(nx), std::abs(ny));
    const bool is_line = (size >= enough) & (slope * longer <= reach * (size * (nx * nx + ny * ny)));
    out[x] = is_line ? value : 0.0F;
  }
}

EMBERFOLD_ROW_PASS void magnitude_row(const float* up, const float* mid, const float* down, int width,
                                      float* __restrict out) {
  for (int x = 0; x < width; ++x) {
    const float gx = 0.5F * (mid[x + 2] - mid[x]), gy = 0.5F * (down[x + 1] - up[x + 1]);
    out[x] = std::sqrt(gx * gx + gy * gy);
  }
}

// The gradient's magnitude, here and one pixel on and back along the gradient, between four pixels each.
struct Along {
  float here, ahead, behind, nx, ny;
};

// The four pixels lie on the side where the direction points: no side is favoured.
inline Along look_along(const float* up, const float* mid, const float* down, float gx, float gy) {
  const float here = mid[0], scale = 1 / here;
  const float nx = gx * scale, ny = gy * scale, wx = std::abs(nx), wy = std::abs(ny);
  const float left = mid[-1], right = mid[1];
  const float ul = up[-1], uc = up[0], ur = up[1], dl = down[-1], dc = down[0], dr = down[1];
  const bool to_right = gx > 0, to_down = gy > 0;
  const float side_a = to_right ? right : left, side_b = to_right ? left : right;
  const float edge_a = to_down ? dc : uc, edge_b = to_down ? uc : dc;
  const float right_a = to_down ? dr : ur, right_b = to_down ? ur : dr;
  const float left_a = to_down ? dl : ul, left_b = to_down ? ul : dl;
  const float corner_a = to_right ? right_a : left_a, corner_b = to_right ? left_b : right_b;
  const float none = (1 - wx) * (1 - wy), across = wx * (1 - wy), along = wy * (1 - wx), both = wx * wy;
  return {here, (none * here + both * corner_a) + (across * side_a + along * edge_a),
          (none * here + both * corner_b) + (across * side_b + along * edge_b), nx, ny};
}

// find_steps for a row from its second to its last pixel but one: 1 where the magnitude reaches `least` and
// is greatest along the gradient within the pixel. Rows of magnitudes and of the level's own values.
EMBERFOLD_ROW_PASS void step_row(const std::array<const float*, 3>& magnitude,
                                 const std::array<const float*, 3>& smooth, int width, float least,
                                 float* __restrict out) {
  const float enough = std::max(0.999F * least, 1e-30F), reach = 2.002F * static_cast<float>(kPixelReach);
  const float *up = magnitude[0], *mid = magnitude[1], *down = magnitude[2];
  const float *above = smooth[0], *level = smooth[1], *below = smooth[2];
  for (int x = 1; x < width - 1; ++x) {
    const float gx = 0.5F * (level[x + 2] - level[x]), gy = 0.5F * (below[x + 1] - above[x + 1]);
    const Along a = look_along(up + x, mid + x, down + x, gx, gy);
    const float bend = 2 * a.here - (a.ahead + a.behind), lean = std::abs(a.ahead - a.behind);
    const bool is_step =
        (a.here >= enough) & (bend > 0) & (lean * std::max(std::abs(a.nx), std::abs(a.ny)) <= reach * bend);
    out[x] = is_step ? 1.0F : 0.0F;
  }
}

// From one sample to the next, odd, so that samples can lie alike seen from either border.
int sample_step(double sigma, cv::Size frame) {
  constexpr double kEnough = 19000;
  const double step = std::max(1.5 * sigma, std::sqrt(frame.area() / kEnough));
  return 2 * static_cast<int>(std::min(0.5 * step, 50.0)) + 1;
}

// The first sample, as far from its border as the last is from the other.
int first_sample(int size, int step) {
  int first = 0;
  while ((size - 1 - 2 * first) % step != 0) ++first;
  return first;
}

double line_contrast(double sigma) {
  return kLineContrast * sigma * sigma;
}

struct Principal {
  float value;   // the eigenvalue of greater magnitude
  float nx, ny;  // its direction
};

// Of the level at which points are looked for.
struct AtLevel {
  int number;
  double ground, least, normalise;
};

// Puts the line through a pixel into the map, if there is one.
void put_line(Growing& map, const ScaleLevel& level, cv::Point at, const Principal& p, const AtLevel& of) {
  const double response = std::abs(double{p.value});
  if (response < of.least) return;
  const double strength = response * of.normalise;
  if (!map.beats(at.x, at.y, strength)) return;
  const Point g = level.gradient(at.x, at.y);
  const double nx = double{p.nx}, ny = double{p.ny};
  const double t = -(g.x * nx + g.y * ny) / double{p.value};
  if (std::abs(t * nx) > kPixelReach || std::abs(t * ny) > kPixelReach) return;
  const cv::Mat1i& frame = map.map.index;
  if (!inside(frame, {at.x + level.sigma * nx, at.y + level.sigma * ny}) ||
      !inside(frame, {at.x - level.sigma * nx, at.y - level.sigma * ny}))
    return;
  map.put(at.x, at.y,
          {{at.x + t * nx, at.y + t * ny},
           0,
           response / of.ground,
           strength,
           response * line_contrast(level.sigma),
           of.number},
          {nx, ny});
}

double step_contrast(double sigma) {
  return kStepContrast * sigma;
}

// Puts the step through a pixel into the map, if there is one. `magnitude`: of the level's gradients.
void put_step(Growing& map, const ScaleLevel& level, cv::Point at, const cv::Mat1f& magnitude,
              const AtLevel& of) {
  const double here = double{magnitude(at)};
  if (here < of.least || !map.beats(at.x, at.y, here * of.normalise)) return;
  const Point g = level.gradient(at.x, at.y);
  const double nx = g.x / here, ny = g.y / here;
  const auto both = [&](double away) {
    return std::pair(between_pixels(magnitude, at.x + away * nx, at.y + away * ny),
                     between_pixels(magnitude, at.x - away * nx, at.y - away * ny));
  };
  const auto [ahead, behind] = both(1);
  const double bend = 2 * here - (ahead + behind);
  if (bend <= 0) return;
  const double t = 0.5 * (ahead - behind) / bend;
  if (std::abs(t * nx) > kPixelReach || std::abs(t * ny) > kPixelReach) return;
  // A slope that goes on to both sides is shading, not a step: only what rises above it counts.
  const auto [far_ahead, far_behind] = both(2.5 * level.sigma);
  const double slope = 0.5 * (far_ahead + far_behind);
  const double rise = here - slope;
  if (rise < of.least) return;
  map.put(at.x, at.y,
          {{at.x + t * nx, at.y + t * ny},
           0,
           rise / of.ground,
           rise * of.normalise,
           rise * step_contrast(level.sigma),
           of.number},
          {nx, ny});
}

}  // namespace

Ground measure_ground(const ScaleSpace& space, double noise) {
  constexpr double kMedianToSd = 1.4826;
  Ground ground;
  for (const ScaleLevel& level : space) {
    const int width = level.smooth.cols - 2, height = level.smooth.rows - 2;
    // Neighbours nearer than 1.5 σ hardly differ, and some 20 000 values tell their median to a hundredth.
    const int step = sample_step(level.sigma, {width, height});
    std::vector<float> second, first;
    const auto samples =
        2 * static_cast<std::size_t>(width / step + 1) * static_cast<std::size_t>(height / step + 1);
    second.reserve(samples);
    first.reserve(samples);
    const int down = std::min(step, std::max(height - 1, 1)), across = std::min(step, std::max(width - 1, 1));
    for (int y = first_sample(height, down); y < height; y += down)
      for (int x = first_sample(width, across); x < width; x += across) {
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

Lines find_lines(const ScaleSpace& space, const Ground& ground, CreaseLimits limits) {
  Growing ridges = empty_map(space, CreaseKind::ridge), valleys = empty_map(space, CreaseKind::valley);
  const int width = ridges.map.index.cols, height = ridges.map.index.rows;
  std::vector<float> found(static_cast<std::size_t>(width));
  Principals places(width);
  for (std::size_t k = 0; k < space.size(); ++k) {
    const ScaleLevel& level = space[k];
    const double least =
        std::max(limits.significance * ground.second[k], limits.contrast / line_contrast(level.sigma));
    const double normalise = std::pow(level.sigma, 1.5);
    for (int y = 0; y < height; ++y) {
      line_row(level.smooth[y], level.smooth[y + 1], level.smooth[y + 2], width, static_cast<float>(least),
               found.data());
      std::size_t count = 0;
      visit_found(found, 0, width, [&](int x) {
        const double roughly = double{found[static_cast<std::size_t>(x)]};
        const Growing& map = roughly < 0 ? ridges : valleys;
        if (!map.beats(x, y, 1.001 * normalise * std::abs(roughly))) return;
        const Hessian h = level.hessian(x, y);
        places.x[count] = x;
        places.xx[count] = h.xx, places.xy[count] = h.xy, places.yy[count] = h.yy;
        ++count;
      });
      principal_row(places.xx.data(), places.xy.data(), places.yy.data(), static_cast<int>(count),
                    places.value.data(), places.nx.data(), places.ny.data());
      for (std::size_t i = 0; i < count; ++i) {
        Growing& map = found[static_cast<std::size_t>(places.x[i])] < 0 ? ridges : valleys;
        put_line(map, level, {places.x[i], y}, {places.value[i], places.nx[i], places.ny[i]},
                 {static_cast<int>(k), ground.second[k], least, normalise});
      }
    }
  }
  return {ridges.finish(), valleys.finish()};
}

CreaseMap find_steps(const ScaleSpace& space, const Ground& ground, CreaseLimits limits) {
  Growing map = empty_map(space, CreaseKind::step);
  const int width = map.map.index.cols, height = map.map.index.rows;
  std::vector<float> found(static_cast<std::size_t>(width));
  cv::Mat1f magnitude(height, width);
  for (std::size_t k = 0; k < space.size(); ++k) {
    const ScaleLevel& level = space[k];
    const double least =
        std::max(limits.significance * ground.first[k], limits.contrast / step_contrast(level.sigma));
    const AtLevel of{static_cast<int>(k), ground.first[k], least, std::sqrt(level.sigma)};
    for (int y = 0; y < height; ++y)
      magnitude_row(level.smooth[y], level.smooth[y + 1], level.smooth[y + 2], width, magnitude[y]);
    for (int y = 1; y + 1 < height; ++y) {
      step_row({magnitude[y - 1], magnitude[y], magnitude[y + 1]},
               {level.smooth[y], level.smooth[y + 1], level.smooth[y + 2]}, width, static_cast<float>(least),
               found.data());
      visit_found(found, 1, width - 1, [&](int x) { put_step(map, level, {x, y}, magnitude, of); });
    }
  }
  return map.finish();
}

}  // namespace emberfold::sketch
