// SPDX-License-Identifier: Apache-2.0
#include "sketch/detection/creases.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <utility>

#include "core/math/simd_clones.hpp"
#include "sketch/detection/crease_map.hpp"

namespace emberfold::sketch {

using graph::Point;

namespace {

// Derivatives at places of a row, and the eigenvalue of greater magnitude of each Hessian with its direction.
struct Principals {
  std::size_t count = 0;
  std::vector<int> x;  // of the places
  std::vector<Point> gradient;
  std::vector<float> xx, xy, yy, value, nx, ny;
  explicit Principals(int width) : x(static_cast<std::size_t>(width)), gradient(x.size()) {
    for (auto* column : {&xx, &xy, &yy, &value, &nx, &ny}) column->resize(x.size());
  }
};

// Squares of single precision neither overflow nor vanish in double precision.
inline float length_of(float x, float y) {
  return static_cast<float>(std::sqrt(double{x} * double{x} + double{y} * double{y}));
}

EMBERFOLD_SIMD_CLONES void principal_row(const float* __restrict xx, const float* __restrict xy,
                                         const float* __restrict yy, int count, float* __restrict values,
                                         float* __restrict along_x, float* __restrict along_y) {
  for (int i = 0; i < count; ++i) {
    const float half_trace = 0.5F * (xx[i] + yy[i]), half_difference = 0.5F * (xx[i] - yy[i]);
    const float radius = length_of(half_difference, xy[i]);
    const float value = half_trace >= 0 ? half_trace + radius : half_trace - radius;
    // The row of H − value·I with the larger entries gives the direction without cancellation.
    const float over_x = value - xx[i], over_y = value - yy[i];
    const bool other = std::abs(over_y) > std::abs(over_x);
    const float nx = other ? over_y : xy[i], ny = other ? xy[i] : over_x;
    const float length = length_of(nx, ny), divisor = length > 0 ? length : 1;
    values[i] = value;
    along_x[i] = length > 0 ? nx / divisor : 1;
    along_y[i] = length > 0 ? ny / divisor : 0;
  }
}

EMBERFOLD_SIMD_CLONES void mark_row(const float* values, int width, std::uint8_t* __restrict marks) {
  for (int x = 0; x < width; ++x) marks[x] = values[x] != 0 ? 1 : 0;
}

// A row of a level: what is found in it is not 0.
class FoundRow {
 public:
  explicit FoundRow(int width)
      : width_(width), values_(static_cast<std::size_t>(width)), marks_((values_.size() + 7) / 8 * 8) {}

  [[nodiscard]] float* values() { return values_.data(); }

  // visit(x) for what is found, from the left. Most of a row is empty: eight places are looked at at once.
  template <class Visit>
  void visit(Visit visit) {
    mark_row(values_.data(), width_, marks_.data());
    for (std::size_t first = 0; first < marks_.size(); first += 8) {
      std::uint64_t eight;
      std::memcpy(&eight, marks_.data() + first, sizeof eight);
      if constexpr (std::endian::native == std::endian::big) eight = __builtin_bswap64(eight);
      for (; eight != 0; eight &= eight - 1) visit(static_cast<int>(first) + std::countr_zero(eight) / 8);
    }
  }

 private:
  int width_;
  std::vector<float> values_;
  std::vector<std::uint8_t> marks_;
};

// find_lines for a whole row in single precision: the eigenvalue of greater magnitude where it reaches
// `least` and the subpixel place lies near enough, 0 elsewhere. The thousandth given away is more than single
// precision loses.
EMBERFOLD_SIMD_CLONES void line_row(const float* up, const float* mid, const float* down, int width,
                                    float least, float* __restrict out) {
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

EMBERFOLD_SIMD_CLONES void magnitude_row(const float* up, const float* mid, const float* down, int width,
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
EMBERFOLD_SIMD_CLONES void step_row(const std::array<const float*, 3>& magnitude,
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

// Level at which points are searched, and its limits.
struct AtLevel {
  int number;
  double ground, least, normalise;
};

// Growth of the second derivative along the normal, in that direction, t px from a pixel where it is `value`.
// Estimated from the pixels around: its curvature is that across the line, since it hardly varies along the
// line.
double third_derivative(const ScaleLevel& level, int x, int y, Point normal, double value, double t) {
  const cv::Mat1f& smooth = level.smooth;
  if (x < 1 || y < 1 || x + 4 > smooth.cols || y + 4 > smooth.rows) return 0;
  const auto at = [&](int u, int v) { return level.hessian(u, v).along(normal); };
  const double left = at(x - 1, y), right = at(x + 1, y), above = at(x, y - 1), below = at(x, y + 1);
  const double slope = 0.5 * (normal.x * (right - left) + normal.y * (below - above));
  return slope + t * ((left + right) + (above + below) - 4 * value);
}

// Puts the line through a pixel of row y into the map, if there is one. On a slope the response rises to one
// side, so that the pixel's own depends on where in it the line runs; scales, whose lines lie beside each
// other there, would take turns. What the rise at the line's subpixel place adds is taken for that.
void put_line(CreaseMapBuilder& map, const Principals& row, std::size_t i, int y, const ScaleLevel& level,
              const AtLevel& of) {
  constexpr double kLeastShare = 0.7, kMostShare = 1.4;  // of the pixel's own response
  const double value = double{row.value[i]}, sigma = level.sigma;
  if (std::abs(value) < of.least) return;
  const int x = row.x[i];
  if (!map.beats(x, y, kMostShare * std::abs(value) * of.normalise)) return;
  const Point g = row.gradient[i];
  const double nx = double{row.nx[i]}, ny = double{row.ny[i]};
  const double t = -(g.x * nx + g.y * ny) / value;
  if (std::abs(t * nx) > kPixelReach || std::abs(t * ny) > kPixelReach) return;
  if (!lies_inside(map.size(), {x + sigma * nx, y + sigma * ny}) ||
      !lies_inside(map.size(), {x - sigma * nx, y - sigma * ny}))
    return;
  const double risen = 1 + t * third_derivative(level, x, y, {nx, ny}, value, t) / value;
  const double response = std::abs(value) * std::clamp(risen, kLeastShare, kMostShare);
  if (response < of.least) return;
  map.put(x, y,
          {{x + t * nx, y + t * ny},
           0,
           response / of.ground,
           response * of.normalise,
           response * line_contrast(sigma),
           of.number,
           point_evidence(response / of.ground, sigma)},
          {nx, ny});
}

// Steps to be, in a row: their pixels, and of each the gradient's direction and its magnitude there and to
// both sides along it, near and far.
struct StepRow {
  std::size_t count = 0;
  std::vector<int> x;
  std::vector<double> here, nx, ny, ahead, behind, far_ahead, far_behind;
  explicit StepRow(int width) : x(static_cast<std::size_t>(width)) {
    for (auto* column : {&here, &nx, &ny, &ahead, &behind, &far_ahead, &far_behind}) column->resize(x.size());
  }
};

EMBERFOLD_SIMD_CLONES void divide_row(const double* by, int count, double* __restrict x,
                                      double* __restrict y) {
  for (int i = 0; i < count; ++i) x[i] /= by[i], y[i] /= by[i];
}

// core::sample_bilinear at places of a row, moved by `away` along their directions.
EMBERFOLD_SIMD_CLONES void between_row(const float* values, int stride, cv::Size size, const int* x, int y,
                                       const double* nx, const double* ny, double away, int count,
                                       double* __restrict out) {
  const double right_end = size.width - 1.0, lower_end = size.height - 1.0;
  for (int i = 0; i < count; ++i) {
    const double px = std::min(std::max(x[i] + away * nx[i], 0.0), right_end);
    const double py = std::min(std::max(y + away * ny[i], 0.0), lower_end);
    const int left = static_cast<int>(px), top = static_cast<int>(py);
    const int right = left + 1 < size.width ? 1 : 0, below = top + 1 < size.height ? stride : 0;
    const double u = px - left, v = py - top;
    const int at = top * stride + left;
    const double a = double{values[at]}, b = double{values[at + right]}, c = double{values[at + below]},
                 d = double{values[at + below + right]};
    out[i] = (1 - v) * ((1 - u) * a + u * b) + v * ((1 - u) * c + u * d);
  }
}

void look_ahead(const cv::Mat1f& magnitude, int y, double sigma, StepRow& row) {
  const int count = static_cast<int>(row.count), stride = static_cast<int>(magnitude.step1());
  divide_row(row.here.data(), count, row.nx.data(), row.ny.data());
  const auto look = [&](double away, std::vector<double>& out) {
    between_row(magnitude[0], stride, magnitude.size(), row.x.data(), y, row.nx.data(), row.ny.data(), away,
                count, out.data());
  };
  look(1, row.ahead), look(-1, row.behind);
  look(2.5 * sigma, row.far_ahead), look(-2.5 * sigma, row.far_behind);
}

// Puts a step of a row into the map, if it is one.
void put_step(CreaseMapBuilder& map, const StepRow& row, std::size_t i, int y, double sigma,
              const AtLevel& of) {
  const double here = row.here[i], nx = row.nx[i], ny = row.ny[i];
  const double bend = 2 * here - (row.ahead[i] + row.behind[i]);
  if (bend <= 0) return;
  const double t = 0.5 * (row.ahead[i] - row.behind[i]) / bend;
  if (std::abs(t * nx) > kPixelReach || std::abs(t * ny) > kPixelReach) return;
  // A slope that goes on to both sides is shading, not a step: only what rises above it counts.
  const double slope = 0.5 * (row.far_ahead[i] + row.far_behind[i]);
  const double rise = here - slope;
  if (rise < of.least) return;
  map.put(row.x[i], y,
          {{row.x[i] + t * nx, y + t * ny},
           0,
           rise / of.ground,
           rise * of.normalise,
           rise * step_contrast(sigma),
           of.number,
           point_evidence(rise / of.ground, sigma)},
          {nx, ny});
}

}  // namespace

cv::Mat1i make_empty_index(cv::Size frame) {
  cv::Mat1i index(frame);
  std::fill_n(index[0], index.total(), -1);
  return index;
}

CreaseLines find_lines(const ScaleSpace& space, const NoiseLevels& ground, CreaseLimits limits) {
  CreaseMapBuilder ridges(space, CreaseKind::ridge), valleys(space, CreaseKind::valley);
  const int width = ridges.size().width, height = ridges.size().height;
  FoundRow found(width);
  Principals places(width);
  for (std::size_t k = 0; k < space.size(); ++k) {
    const ScaleLevel& level = space[k];
    const double least =
        std::max(limits.significance * ground.second[k], limits.contrast / line_contrast(level.sigma));
    const AtLevel of{static_cast<int>(k), ground.second[k], least, std::pow(level.sigma, 1.5)};
    for (int y = 0; y < height; ++y) {
      const float *up = level.smooth[y], *mid = level.smooth[y + 1], *down = level.smooth[y + 2];
      line_row(up, mid, down, width, static_cast<float>(least), found.values());
      places.count = 0;
      found.visit([&](int x) {
        const float *above = up + x, *here = mid + x, *below = down + x;
        const Hessian h = hessian_of(above, here, below);
        places.x[places.count] = x;
        places.gradient[places.count] = gradient_of(above, here, below);
        places.xx[places.count] = h.xx, places.xy[places.count] = h.xy, places.yy[places.count] = h.yy;
        ++places.count;
      });
      principal_row(places.xx.data(), places.xy.data(), places.yy.data(), static_cast<int>(places.count),
                    places.value.data(), places.nx.data(), places.ny.data());
      for (std::size_t i = 0; i < places.count; ++i)
        put_line(places.value[i] < 0 ? ridges : valleys, places, i, y, level, of);
    }
  }
  return {ridges.finish(), valleys.finish()};
}

CreaseMap find_steps(const ScaleSpace& space, const NoiseLevels& ground, CreaseLimits limits) {
  CreaseMapBuilder map(space, CreaseKind::step);
  const int width = map.size().width, height = map.size().height;
  FoundRow found(width);
  StepRow steps(width);
  cv::Mat1f magnitude(height, width);
  for (std::size_t k = 0; k < space.size(); ++k) {
    const ScaleLevel& level = space[k];
    const double least =
        std::max(limits.significance * ground.first[k], limits.contrast / step_contrast(level.sigma));
    const AtLevel of{static_cast<int>(k), ground.first[k], least, std::sqrt(level.sigma)};
    for (int y = 0; y < height; ++y)
      magnitude_row(level.smooth[y], level.smooth[y + 1], level.smooth[y + 2], width, magnitude[y]);
    for (int y = 1; y + 1 < height; ++y) {
      const float *up = level.smooth[y], *mid = level.smooth[y + 1], *down = level.smooth[y + 2];
      const float* sizes = magnitude[y];
      step_row({magnitude[y - 1], sizes, magnitude[y + 1]}, {up, mid, down}, width, static_cast<float>(least),
               found.values());
      steps.count = 0;
      found.visit([&](int x) {
        const double here = double{sizes[x]};
        if (here < of.least || !map.beats(x, y, here * of.normalise)) return;
        const Point g = gradient_of(up + x, mid + x, down + x);
        steps.x[steps.count] = x;
        steps.here[steps.count] = here, steps.nx[steps.count] = g.x, steps.ny[steps.count] = g.y;
        ++steps.count;
      });
      look_ahead(magnitude, y, level.sigma, steps);
      for (std::size_t i = 0; i < steps.count; ++i) put_step(map, steps, i, y, level.sigma, of);
    }
  }
  return map.finish();
}

}  // namespace emberfold::sketch
