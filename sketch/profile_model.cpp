// SPDX-License-Identifier: Apache-2.0
#include "sketch/profile_model.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>

#include "sketch/row_pass.hpp"

namespace emberfold::sketch {

namespace {

constexpr std::size_t kLanes = 8;
// left, middle, right, offset, width, blur
constexpr std::size_t kNumbers = 6;
constexpr std::size_t kProducts = kNumbers * (kNumbers + 1) / 2;

// exp(−x²/2) and the normal distribution's density and share below x (Abramowitz & Stegun 26.2.17: within
// 1e-7), without a branch or a call, so that loops over it go into vectors.
struct Normal {
  float density, below;
};

inline Normal normal(float x) {
  const float a = std::min(std::abs(x), 9.0F);
  // e^y = 2^n·e^r with |r| ≤ ln 2 / 2, the rest by its series.
  const float y = -0.5F * a * a, scaled = y * 1.44269504F;
  const int n = static_cast<int>(scaled - 0.5F);
  const float r = (scaled - static_cast<float>(n)) * 0.69314718F;
  const float series =
      1 +
      r * (1 + r * (0.5F + r * (0.16666667F + r * (0.041666667F + r * (0.0083333333F + r * 0.0013888889F)))));
  const float power = std::bit_cast<float>(static_cast<std::uint32_t>((n + 127) << 23));
  const float density = 0.39894228F * series * power;
  const float t = 1 / (1 + 0.2316419F * a);
  const float tail =
      density * t *
      (0.319381530F + t * (-0.356563782F + t * (1.781477937F + t * (-1.821255978F + t * 1.330274429F))));
  return {density, x >= 0 ? 1 - tail : tail};
}

// What a step of the fit needs: the model's residuals, and how the model changes with each of its numbers.
struct Slopes {
  std::array<Samples, kNumbers> by{};
  Samples residual{};
};

struct Shape {
  float offset, half_width, blur, left, middle, right;
};

EMBERFOLD_ROW_PASS void slopes(const float* level, std::size_t count, Shape s, Slopes& out) {
  const float first = -0.5F * static_cast<float>(kSampleStep) * static_cast<float>(count - 1);
  const float scale = 1 / s.blur, up = s.middle - s.left, down = s.right - s.middle;
  float* __restrict by_left = out.by[0].data();
  float* __restrict by_middle = out.by[1].data();
  float* __restrict by_right = out.by[2].data();
  float* __restrict by_offset = out.by[3].data();
  float* __restrict by_width = out.by[4].data();
  float* __restrict by_blur = out.by[5].data();
  float* __restrict residual = out.residual.data();
  const int padded = static_cast<int>((count + kLanes - 1) / kLanes * kLanes), n = static_cast<int>(count);
  for (int i = 0; i < padded; ++i) {
    const float there = i < n ? 1.0F : 0.0F;
    const float d = first + static_cast<float>(kSampleStep) * static_cast<float>(i) - s.offset;
    const float a = (d + s.half_width) * scale, b = (d - s.half_width) * scale;
    const Normal enter = normal(a), leave = normal(b);
    const float rise = up * enter.density * scale, fall = down * leave.density * scale;
    by_left[i] = there * (1 - enter.below);
    by_middle[i] = there * (enter.below - leave.below);
    by_right[i] = there * leave.below;
    by_offset[i] = -there * (rise + fall);
    by_width[i] = there * 0.5F * (rise - fall);
    by_blur[i] = -there * (rise * a + fall * b);
    residual[i] = there * (level[i] - (s.left + up * enter.below + down * leave.below));
  }
}

// Σ over the samples of each product of two columns, in eight partial sums added in order.
EMBERFOLD_ROW_PASS void products(const Slopes& slopes, std::size_t count, double* normal_matrix,
                                 double* moment, double* squares) {
  const std::size_t padded = (count + kLanes - 1) / kLanes * kLanes;
  const auto sum = [&](const Samples& a, const Samples& b) {
    float lane[kLanes] = {};
    for (std::size_t i = 0; i < padded; i += kLanes)
      for (std::size_t l = 0; l < kLanes; ++l) lane[l] += a[i + l] * b[i + l];
    double total = 0;
    for (const float v : lane) total += double{v};
    return total;
  };
  for (std::size_t a = 0, at = 0; a < kNumbers; ++a) {
    for (std::size_t b = 0; b <= a; ++b) normal_matrix[at++] = sum(slopes.by[a], slopes.by[b]);
    moment[a] = sum(slopes.by[a], slopes.residual);
  }
  *squares = sum(slopes.residual, slopes.residual);
}

std::size_t product_of(std::size_t a, std::size_t b) {
  return a >= b ? a * (a + 1) / 2 + b : b * (b + 1) / 2 + a;
}

// Solves the system of the numbers in `use` by Cholesky; the others' results are 0. False where it is
// singular.
bool solve(const std::array<double, kProducts>& matrix, const std::array<double, kNumbers>& right,
           const std::array<bool, kNumbers>& use, double damping, std::array<double, kNumbers>& result) {
  double l[kNumbers][kNumbers] = {};
  std::array<double, kNumbers> y{};
  result = {};
  for (std::size_t a = 0; a < kNumbers; ++a) {
    if (!use[a]) continue;
    for (std::size_t b = 0; b <= a; ++b) {
      if (!use[b]) continue;
      double v = matrix[product_of(a, b)];
      if (a == b) v += damping * v + 1e-9;
      for (std::size_t k = 0; k < b; ++k) v -= l[a][k] * l[b][k];
      if (a != b) {
        l[a][b] = v / l[b][b];
      } else {
        if (!(v > 0)) return false;
        l[a][a] = std::sqrt(v);
      }
    }
    double v = right[a];
    for (std::size_t k = 0; k < a; ++k) v -= l[a][k] * y[k];
    y[a] = v / l[a][a];
  }
  for (std::size_t a = kNumbers; a-- > 0;) {
    if (!use[a]) continue;
    double v = y[a];
    for (std::size_t k = a + 1; k < kNumbers; ++k) v -= l[k][a] * result[k];
    result[a] = v / l[a][a];
  }
  return true;
}

struct System {
  std::array<double, kProducts> matrix{};
  std::array<double, kNumbers> moment{};
  double squares = 0;
};

System system_at(const Section& section, const Profile& p, Slopes& work) {
  slopes(section.level.data(), section.count,
         {static_cast<float>(p.offset), static_cast<float>(0.5 * p.width), static_cast<float>(p.blur),
          static_cast<float>(p.left), static_cast<float>(p.middle), static_cast<float>(p.right)},
         work);
  System s;
  products(work, section.count, s.matrix.data(), s.moment.data(), &s.squares);
  return s;
}

constexpr double square(double v) {
  return v * v;
}

}  // namespace

Profile with_levels(const Section& section, Profile shape) {
  shape.left = shape.middle = shape.right = 0;
  Slopes work;
  const System s = system_at(section, shape, work);
  std::array<double, kNumbers> level{};
  const bool bar = shape.width > 0;
  shape.residual = s.squares;
  if (!solve(s.matrix, s.moment, {true, bar, true, false, false, false}, 0, level)) return shape;
  shape.left = level[0];
  shape.right = level[2];
  shape.middle = bar ? level[1] : 0.5 * (level[0] + level[2]);
  for (std::size_t a = 0; a < 3; ++a) shape.residual -= level[a] * s.moment[a];
  shape.residual = std::max(shape.residual, 0.0);
  return shape;
}

Profile refine(const Section& section, Profile start, const ProfileBounds& bounds, int steps, double prior,
               double usual_blur) {
  constexpr double kSettled = 0.003;  // px
  const bool bar = start.width > 0;
  const std::array<bool, kNumbers> use = {true, bar, true, bounds.offset > 0, bar, true};
  const auto strange = [&](const Profile& p) { return prior * square(std::log(p.blur / usual_blur)); };
  Slopes work;
  Profile best = start;
  System at = system_at(section, best, work);
  double cost = at.squares + strange(best), damping = 1e-3;
  for (int step = 0; step < steps; ++step) {
    System pulled = at;
    pulled.matrix[product_of(5, 5)] += prior / square(best.blur);
    pulled.moment[5] -= prior * std::log(best.blur / usual_blur) / best.blur;
    std::array<double, kNumbers> change{};
    if (!solve(pulled.matrix, pulled.moment, use, damping, change)) break;
    Profile next = best;
    next.left += change[0];
    next.right += change[2];
    next.offset = std::clamp(best.offset + change[3], -bounds.offset, bounds.offset);
    next.blur = std::clamp(best.blur + change[5], std::max(bounds.least_blur, 0.6 * best.blur),
                           std::min(bounds.most_blur, 1.6 * best.blur));
    if (bar) {
      next.middle += change[1];
      next.width = std::clamp(best.width + change[4], std::max(bounds.least_width, 0.6 * best.width),
                              std::min(bounds.most_width, 1.6 * best.width));
    } else {
      next.middle = 0.5 * (next.left + next.right);
    }
    const System there = system_at(section, next, work);
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
