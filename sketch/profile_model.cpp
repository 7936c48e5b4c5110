// SPDX-License-Identifier: Apache-2.0
#include "sketch/profile_model.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

#include "sketch/row_pass.hpp"

namespace emberfold::sketch {

namespace {

constexpr std::size_t kLanes = 8;
// left, middle, right, offset, width, blur
constexpr std::size_t kNumbers = 6;
constexpr std::size_t kProducts = kNumbers * (kNumbers + 1) / 2;

struct Normal {
  float density, below;
};

// The normal distribution's density and share below x (Abramowitz & Stegun 26.2.17: within 1e-7), without a
// branch or a call, so that a loop goes into vectors.
inline Normal normal_at(float x) {
  const float size = std::abs(x), a = size < 9.0F ? size : 9.0F;
  // e^y = 2^n·e^r with |r| ≤ ln 2 / 2, the rest by its series.
  const float y = -0.5F * a * a, scaled = y * 1.44269504F;
  const int n = static_cast<int>(scaled - 0.5F);
  const float r = (scaled - static_cast<float>(n)) * 0.69314718F;
  const float series =
      1 +
      r * (1 + r * (0.5F + r * (0.16666667F + r * (0.041666667F + r * (0.0083333333F + r * 0.0013888889F)))));
  const float f = 0.39894228F * series * std::bit_cast<float>((n + 127) * (1 << 23));
  const float t = 1 / (1 + 0.2316419F * a);
  const float tail =
      f * t *
      (0.319381530F + t * (-0.356563782F + t * (1.781477937F + t * (-1.821255978F + t * 1.330274429F))));
  return {f, 0.5F + std::copysign(0.5F - tail, x)};
}

// What a step of the fit needs: how the model changes with each of its numbers, and the model's residuals.
// After the columns by number, the residuals.
using Slopes = std::array<float, (kNumbers + 1) * kMostSamples>;

struct Shape {
  float offset, half_width, blur, left, middle, right;
};

// `by`: the columns of Slopes, one after the other, `padded` samples of each; the first sample lies at
// `first`.
EMBERFOLD_ROW_PASS void bar_slopes(const float* __restrict level, float first, int count, int padded, Shape s,
                                   float* __restrict by) {
  constexpr int k = static_cast<int>(kMostSamples);
  const float up = s.middle - s.left, down = s.right - s.middle, scale = 1 / s.blur;
  for (int i = 0; i < padded; ++i) {
    const float there = i < count ? 1.0F : 0.0F;
    const float d = first + static_cast<float>(kSampleStep) * static_cast<float>(i);
    const float enter_at = (d + s.half_width) * scale, leave_at = (d - s.half_width) * scale;
    const Normal enter = normal_at(enter_at), leave = normal_at(leave_at);
    const float rise = there * up * scale * enter.density, fall = there * down * scale * leave.density;
    by[i] = there - there * enter.below;
    by[k + i] = there * (enter.below - leave.below);
    by[2 * k + i] = there * leave.below;
    by[3 * k + i] = -(rise + fall);
    by[4 * k + i] = 0.5F * (rise - fall);
    by[5 * k + i] = -(rise * enter_at + fall * leave_at);
    by[6 * k + i] = there * (level[i] - (s.left + up * enter.below + down * leave.below));
  }
}

// The same of a step, whose two edges are one, without the columns of its middle and width.
EMBERFOLD_ROW_PASS void step_slopes(const float* __restrict level, float first, int count, int padded,
                                    Shape s, float* __restrict by) {
  constexpr int k = static_cast<int>(kMostSamples);
  const float up = s.right - s.left, scale = 1 / s.blur;
  for (int i = 0; i < padded; ++i) {
    const float there = i < count ? 1.0F : 0.0F;
    const float at = (first + static_cast<float>(kSampleStep) * static_cast<float>(i)) * scale;
    const Normal edge = normal_at(at);
    const float rise = there * up * scale * edge.density;
    by[i] = there - there * edge.below;
    by[2 * k + i] = there * edge.below;
    by[3 * k + i] = -rise;
    by[5 * k + i] = -(rise * at);
    by[6 * k + i] = there * (level[i] - (s.left + up * edge.below));
  }
}

void slopes(const Section& section, Shape s, Slopes& out) {
  const int count = static_cast<int>(section.count), lanes = static_cast<int>(kLanes);
  const int padded = (count + lanes - 1) / lanes * lanes;
  const float first = -0.5F * static_cast<float>(kSampleStep) * static_cast<float>(count - 1) - s.offset;
  const auto row = s.half_width > 0 ? bar_slopes : step_slopes;
  row(section.level.data(), first, count, padded, s, out.data());
}

constexpr std::size_t product_of(std::size_t a, std::size_t b) {
  return a >= b ? a * (a + 1) / 2 + b : b * (b + 1) / 2 + a;
}

// Which of the model's numbers a fit is free to choose.
struct Free {
  std::array<std::size_t, kNumbers> number;
  std::size_t count = 0;
  explicit Free(const std::array<bool, kNumbers>& use) : number{} {
    for (std::size_t a = 0; a < kNumbers; ++a)
      if (use[a]) number[count++] = a;
  }
};

// Σ over the samples of each product of the free columns, in eight partial sums added in order.
EMBERFOLD_ROW_PASS void products(const Slopes& slopes, std::size_t count, const Free& free,
                                 double* normal_matrix, double* moment, double* squares) {
  const std::size_t padded = (count + kLanes - 1) / kLanes * kLanes;
  const auto sum = [&](std::size_t a, std::size_t b) {
    const float* x = slopes.data() + a * kMostSamples;
    const float* y = slopes.data() + b * kMostSamples;
    float lane[kLanes] = {};
    for (std::size_t i = 0; i < padded; i += kLanes)
      for (std::size_t l = 0; l < kLanes; ++l) lane[l] += x[i + l] * y[i + l];
    return double{((lane[0] + lane[1]) + (lane[2] + lane[3])) + ((lane[4] + lane[5]) + (lane[6] + lane[7]))};
  };
  for (std::size_t i = 0; i < free.count; ++i) {
    const std::size_t a = free.number[i];
    for (std::size_t j = 0; j <= i; ++j)
      normal_matrix[product_of(a, free.number[j])] = sum(a, free.number[j]);
    moment[a] = sum(a, kNumbers);
  }
  *squares = sum(kNumbers, kNumbers);
}

// Solves the system of the free numbers by Cholesky; the others' results are 0. False where it is
// singular.
bool solve(const std::array<double, kProducts>& matrix, const std::array<double, kNumbers>& right,
           const Free& free, double damping, std::array<double, kNumbers>& result) {
  const std::size_t n = free.count;
  const auto& used = free.number;
  double l[kNumbers][kNumbers];                // written as far as it is read, as are the others
  std::array<double, kNumbers> y, reciprocal;  // of the diagonal
  for (std::size_t a = 0; a < n; ++a) {
    double rest = right[used[a]];
    for (std::size_t b = 0; b < a; ++b) {
      double v = matrix[product_of(used[a], used[b])];
      for (std::size_t k = 0; k < b; ++k) v -= l[a][k] * l[b][k];
      l[a][b] = v * reciprocal[b];
      rest -= l[a][b] * y[b];
    }
    double v = matrix[product_of(used[a], used[a])];
    v += damping * v + 1e-9;
    for (std::size_t k = 0; k < a; ++k) v -= l[a][k] * l[a][k];
    if (!(v > 0)) return result = {}, false;
    reciprocal[a] = 1 / std::sqrt(v);
    y[a] = rest * reciprocal[a];
  }
  result = {};
  for (std::size_t a = n; a-- > 0;) {
    double v = y[a];
    for (std::size_t k = a + 1; k < n; ++k) v -= l[k][a] * result[used[k]];
    result[used[a]] = v * reciprocal[a];
  }
  return true;
}

struct System {
  std::array<double, kProducts> matrix{};
  std::array<double, kNumbers> moment{};
  double squares = 0;
};

System system_at(const Section& section, const Profile& p, const Free& free, Slopes& work) {
  slopes(section,
         {static_cast<float>(p.offset), static_cast<float>(0.5 * p.width), static_cast<float>(p.blur),
          static_cast<float>(p.left), static_cast<float>(p.middle), static_cast<float>(p.right)},
         work);
  System s;
  products(work, section.count, free, s.matrix.data(), s.moment.data(), &s.squares);
  return s;
}

constexpr double square(double v) {
  return v * v;
}

/// A size that changes by 0.6 to 1.6 times a step, between the bounds whatever it was.
double within(double wanted, double now, double least, double most) {
  const double low = std::clamp(0.6 * now, least, most), high = std::clamp(1.6 * now, low, most);
  return std::clamp(wanted, low, high);
}

}  // namespace

Profile with_levels(const Section& section, Profile shape) {
  shape.left = shape.middle = shape.right = 0;
  Slopes work;  // written before it is read
  const bool bar = shape.width > 0;
  const Free free({true, bar, true, false, false, false});
  const System s = system_at(section, shape, free, work);
  std::array<double, kNumbers> level{};
  shape.residual = s.squares;
  if (!solve(s.matrix, s.moment, free, 0, level)) return shape;
  shape.left = level[0];
  shape.right = level[2];
  shape.middle = bar ? level[1] : 0.5 * (level[0] + level[2]);
  for (std::size_t a = 0; a < 3; ++a) shape.residual -= level[a] * s.moment[a];
  shape.residual = std::max(shape.residual, 0.0);
  return shape;
}

Profile refine(const Section& section, Profile start, const ProfileBounds& bounds, int steps, double prior,
               double usual_blur) {
  constexpr double kSettled = 0.01;  // px
  const bool bar = start.width > 0;
  const Free free({true, bar, true, bounds.offset > 0, bar, true});
  const auto strange = [&](const Profile& p) { return prior * square(std::log(p.blur / usual_blur)); };
  Slopes work;  // written before it is read
  Profile best = start;
  System at = system_at(section, best, free, work);
  double cost = at.squares + strange(best), damping = 1e-3;
  for (int step = 0; step < steps; ++step) {
    System pulled = at;
    pulled.matrix[product_of(5, 5)] += prior / square(best.blur);
    pulled.moment[5] -= prior * std::log(best.blur / usual_blur) / best.blur;
    std::array<double, kNumbers> change{};
    if (!solve(pulled.matrix, pulled.moment, free, damping, change)) break;
    Profile next = best;
    next.left += change[0];
    next.right += change[2];
    next.offset = std::clamp(best.offset + change[3], -bounds.offset, bounds.offset);
    next.blur = within(best.blur + change[5], best.blur, bounds.least_blur, bounds.most_blur);
    if (bar) {
      next.middle += change[1];
      next.width = within(best.width + change[4], best.width, bounds.least_width, bounds.most_width);
    } else {
      next.middle = 0.5 * (next.left + next.right);
    }
    const System there = system_at(section, next, free, work);
    const double next_cost = there.squares + strange(next);
    if (next_cost >= cost) {
      if ((damping *= 10) > 1e4) break;
      continue;
    }
    const double moved = std::max({std::abs(next.offset - best.offset), std::abs(next.width - best.width),
                                   std::abs(next.blur - best.blur)});
    best = next;
    at = there;
    cost = next_cost;
    damping = std::max(0.2 * damping, 1e-6);
    if (moved < kSettled) break;
  }
  best.residual = at.squares;
  return best;
}

}  // namespace emberfold::sketch
