// SPDX-License-Identifier: Apache-2.0
#include "sketch/patches/profile_model.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>

#include "core/math/simd_clones.hpp"

namespace emberfold::sketch {

namespace {

constexpr int kLanes = 8;
// left, middle, right, offset, width, blur
constexpr std::size_t kNumbers = 6;

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

// Columns of a step of the fit: the model's derivatives by each number, then the residuals.
using Slopes = std::array<float, (kNumbers + 1) * kMostSamples>;

struct Shape {
  float offset, half_width, blur, left, middle, right;
};

// `by`: the columns of Slopes, one after the other, `padded` samples of each; the first sample lies at
// `first`.
EMBERFOLD_SIMD_CLONES void bar_slopes(const float* __restrict level, float first, int count, int padded,
                                      Shape s, float* __restrict by) {
  constexpr int k = static_cast<int>(kMostSamples);
  const float up = s.middle - s.left, down = s.right - s.middle, scale = 1 / s.blur;
  for (int block = 0; block < padded; block += kLanes)
    for (int i = block; i < block + kLanes; ++i) {
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

// Columns of a step. Its two edges are one; the columns of middle and width are left out.
EMBERFOLD_SIMD_CLONES void step_slopes(const float* __restrict level, float first, int count, int padded,
                                       Shape s, float* __restrict by) {
  constexpr int k = static_cast<int>(kMostSamples);
  const float up = s.right - s.left, scale = 1 / s.blur;
  for (int block = 0; block < padded; block += kLanes)
    for (int i = block; i < block + kLanes; ++i) {
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

// The columns of the three levels alone, and the section itself: what fitting levels needs.
EMBERFOLD_SIMD_CLONES void level_columns(const float* __restrict level, float first, int count, int padded,
                                         float half_width, float blur, float* __restrict by) {
  constexpr int k = static_cast<int>(kMostSamples);
  const float scale = 1 / blur;
  for (int block = 0; block < padded; block += kLanes)
    for (int i = block; i < block + kLanes; ++i) {
      const float there = i < count ? 1.0F : 0.0F;
      const float d = first + static_cast<float>(kSampleStep) * static_cast<float>(i);
      const float enter = normal_at((d + half_width) * scale).below;
      const float leave = normal_at((d - half_width) * scale).below;
      by[i] = there - there * enter;
      by[k + i] = there * (enter - leave);
      by[2 * k + i] = there * leave;
      by[6 * k + i] = there * level[i];
    }
}

// Columns of a step's levels, without the middle.
EMBERFOLD_SIMD_CLONES void step_level_columns(const float* __restrict level, float first, int count,
                                              int padded, float blur, float* __restrict by) {
  constexpr int k = static_cast<int>(kMostSamples);
  const float scale = 1 / blur;
  for (int block = 0; block < padded; block += kLanes)
    for (int i = block; i < block + kLanes; ++i) {
      const float there = i < count ? 1.0F : 0.0F;
      const float edge =
          normal_at((first + static_cast<float>(kSampleStep) * static_cast<float>(i)) * scale).below;
      by[i] = there - there * edge;
      by[2 * k + i] = there * edge;
      by[6 * k + i] = there * level[i];
    }
}

// Samples in whole vectors.
int padded(const Section& section) {
  return (static_cast<int>(section.count) + kLanes - 1) / kLanes * kLanes;
}

float first_place(const Section& section, float offset) {
  return -0.5F * static_cast<float>(kSampleStep) * static_cast<float>(static_cast<int>(section.count) - 1) -
         offset;
}

void slopes(const Section& section, Shape s, Slopes& out) {
  const int count = static_cast<int>(section.count), all = padded(section);
  const auto row = s.half_width > 0 ? bar_slopes : step_slopes;
  row(section.level.data(), first_place(section, s.offset), count, all, s, out.data());
}

void columns(const Section& section, float offset, float half_width, float blur, Slopes& out) {
  const int count = static_cast<int>(section.count), all = padded(section);
  const float first = first_place(section, offset);
  if (half_width > 0)
    level_columns(section.level.data(), first, count, all, half_width, blur, out.data());
  else
    step_level_columns(section.level.data(), first, count, all, blur, out.data());
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

// Index of the product of two columns, a ≥ b: first those of the free numbers, then those of the residuals.
constexpr std::size_t product_of(std::size_t a, std::size_t b) {
  return a * (a + 1) / 2 + b;
}
constexpr std::size_t kProducts = product_of(kNumbers, kNumbers) + 1;

using Lanes [[gnu::vector_size(4 * kLanes)]] = float;  // two registers where none is as wide

// lane[8·b …]: the sums of the products of column kLast with itself and those before it, in eight parts.
template <std::size_t kLast>
[[gnu::always_inline]] inline void sum_products(const float* const* column, int samples, float* lane) {
  Lanes sum[kLast + 1] = {};
  for (int i = 0; i < samples; i += kLanes) {
    Lanes x, y;
    std::memcpy(&x, column[kLast] + i, sizeof x);
    for (std::size_t b = 0; b <= kLast; ++b) {
      std::memcpy(&y, column[b] + i, sizeof y);
      sum[b] += x * y;
    }
  }
  std::memcpy(lane, sum, sizeof sum);
}

[[gnu::always_inline]] inline void add_pairs(const float* __restrict from, std::size_t count,
                                             float* __restrict to) {
  for (std::size_t i = 0; i < count; ++i) to[i] = from[2 * i] + from[2 * i + 1];
}

// Σ over the samples of each product of two of the columns, two to six of free numbers and the residuals, in
// eight partial sums added in order.
EMBERFOLD_SIMD_CLONES void products(const float* const* column, std::size_t columns, int samples,
                                    double* __restrict total) {
  float lane[kLanes * kProducts], pair[kLanes / 2 * kProducts];  // written as far as they are read
  sum_products<0>(column, samples, lane);
  sum_products<1>(column, samples, lane + kLanes * product_of(1, 0));
  sum_products<2>(column, samples, lane + kLanes * product_of(2, 0));
  if (columns > 3) sum_products<3>(column, samples, lane + kLanes * product_of(3, 0));
  if (columns > 4) sum_products<4>(column, samples, lane + kLanes * product_of(4, 0));
  if (columns > 5) sum_products<5>(column, samples, lane + kLanes * product_of(5, 0));
  if (columns > 6) sum_products<6>(column, samples, lane + kLanes * product_of(6, 0));
  const std::size_t sums = product_of(columns, 0);
  add_pairs(lane, 4 * sums, pair);
  add_pairs(pair, 2 * sums, lane);
  for (std::size_t i = 0; i < sums; ++i) total[i] = double{lane[2 * i] + lane[2 * i + 1]};
}

// The last of these sums alone, the same bits.
EMBERFOLD_SIMD_CLONES double squares(const float* column, int samples) {
  float lane[kLanes], pair[kLanes / 2];
  sum_products<0>(&column, samples, lane);
  add_pairs(lane, 4, pair);
  add_pairs(pair, 2, lane);
  return double{lane[0] + lane[1]};
}

// The normal equations of the free numbers, the moments and the residuals' squares below them.
using System = std::array<double, kProducts>;
using Solution = std::array<double, kNumbers>;  // of the free numbers, in order

// Solves the system by Cholesky. False where it is singular.
template <std::size_t kFree>
bool solve_all(const System& system, double damping, Solution& result) {
  double l[kFree][kFree], y[kFree], reciprocal[kFree];  // of the diagonal
  for (std::size_t a = 0; a < kFree; ++a) {
    double rest = system[product_of(kFree, a)];
    for (std::size_t b = 0; b < a; ++b) {
      double v = system[product_of(a, b)];
      for (std::size_t k = 0; k < b; ++k) v -= l[a][k] * l[b][k];
      l[a][b] = v * reciprocal[b];
      rest -= l[a][b] * y[b];
    }
    double v = system[product_of(a, a)];
    v += damping * v + 1e-9;
    for (std::size_t k = 0; k < a; ++k) v -= l[a][k] * l[a][k];
    if (!(v > 0)) return false;
    reciprocal[a] = 1 / std::sqrt(v);
    y[a] = rest * reciprocal[a];
  }
  for (std::size_t a = kFree; a-- > 0;) {
    double v = y[a];
    for (std::size_t k = a + 1; k < kFree; ++k) v -= l[k][a] * result[k];
    result[a] = v * reciprocal[a];
  }
  return true;
}

bool solve(const System& system, const Free& free, double damping, Solution& result) {
  switch (free.count) {
    case 2:
      return solve_all<2>(system, damping, result);
    case 3:
      return solve_all<3>(system, damping, result);
    case 4:
      return solve_all<4>(system, damping, result);
    case 5:
      return solve_all<5>(system, damping, result);
    default:
      return solve_all<6>(system, damping, result);
  }
}

System system_of(const Slopes& slopes, int samples, const Free& free) {
  std::array<const float*, kNumbers + 1> column{};
  for (std::size_t a = 0; a < free.count; ++a) column[a] = slopes.data() + free.number[a] * kMostSamples;
  column[free.count] = slopes.data() + kNumbers * kMostSamples;
  System system;  // written as far as it is read
  products(column.data(), free.count + 1, samples, system.data());
  return system;
}

void slopes_at(const Section& section, const Profile& p, Slopes& out) {
  slopes(section,
         {static_cast<float>(p.offset), static_cast<float>(0.5 * p.width), static_cast<float>(p.blur),
          static_cast<float>(p.left), static_cast<float>(p.middle), static_cast<float>(p.right)},
         out);
}

constexpr double square(double v) {
  return v * v;
}

/// A size that changes by 0.6 to 1.6 times a step, between the bounds whatever it was.
double limit_step(double wanted, double now, double least, double most) {
  const double low = std::clamp(0.6 * now, least, most), high = std::clamp(1.6 * now, low, most);
  return std::clamp(wanted, low, high);
}

}  // namespace

Profile fit_levels(const Section& section, Profile shape) {
  shape.left = shape.middle = shape.right = 0;
  Slopes work;  // written before it is read
  const bool bar = shape.width > 0;
  const Free free({true, bar, true, false, false, false});
  columns(section, static_cast<float>(shape.offset), static_cast<float>(0.5 * shape.width),
          static_cast<float>(shape.blur), work);
  const System system = system_of(work, padded(section), free);
  Solution level;
  shape.residual = system[product_of(free.count, free.count)];
  if (!solve(system, free, 0, level)) return shape;
  shape.left = level[0];
  shape.right = level[free.count - 1];
  shape.middle = bar ? level[1] : 0.5 * (shape.left + shape.right);
  for (std::size_t a = 0; a < free.count; ++a) shape.residual -= level[a] * system[product_of(free.count, a)];
  shape.residual = std::max(shape.residual, 0.0);
  return shape;
}

Profile refine_profile(const Section& section, Profile start, const ProfileBounds& bounds, int steps,
                       double prior, double usual_blur) {
  constexpr double kSettled = 0.01;  // px
  const bool bar = start.width > 0;
  const Free free({true, bar, true, bounds.offset > 0, bar, true});
  const auto strange = [&](const Profile& p) { return prior * square(std::log(p.blur / usual_blur)); };
  const std::size_t n = free.count;
  const int samples = padded(section);
  Slopes work;  // written before it is read
  const float* residuals = work.data() + kNumbers * kMostSamples;
  Profile best = start;
  slopes_at(section, best, work);
  System at = system_of(work, samples, free);
  double cost = at[product_of(n, n)] + strange(best), damping = 1e-3;
  for (int step = 0; step < steps; ++step) {
    System pulled = at;  // the blur is the last of the free numbers
    pulled[product_of(n - 1, n - 1)] += prior / square(best.blur);
    pulled[product_of(n, n - 1)] -= prior * std::log(best.blur / usual_blur) / best.blur;
    Solution solved;
    if (!solve(pulled, free, damping, solved)) break;
    std::array<double, kNumbers> change{};
    for (std::size_t a = 0; a < n; ++a) change[free.number[a]] = solved[a];
    Profile next = best;
    next.left += change[0];
    next.right += change[2];
    next.offset = std::clamp(best.offset + change[3], -bounds.offset, bounds.offset);
    next.blur = limit_step(best.blur + change[5], best.blur, bounds.least_blur, bounds.most_blur);
    if (bar) {
      next.middle += change[1];
      next.width = limit_step(best.width + change[4], best.width, bounds.least_width, bounds.most_width);
    } else {
      next.middle = 0.5 * (next.left + next.right);
    }
    slopes_at(section, next, work);
    const double next_cost = squares(residuals, samples) + strange(next);
    if (next_cost >= cost) {  // one in three: the other sums are of no use
      if ((damping *= 10) > 1e4) break;
      continue;
    }
    const double moved = std::max({std::abs(next.offset - best.offset), std::abs(next.width - best.width),
                                   std::abs(next.blur - best.blur)});
    best = next;
    at = system_of(work, samples, free);
    cost = next_cost;
    damping = std::max(0.2 * damping, 1e-6);
    if (moved < kSettled) break;
  }
  best.residual = at[product_of(n, n)];
  return best;
}

}  // namespace emberfold::sketch
