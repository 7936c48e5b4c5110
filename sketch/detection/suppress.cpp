// SPDX-License-Identifier: Apache-2.0
// Removal of crease points: lobes, flanks, and parallel points.
#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>
#include <span>

#include "core/math/fast_round.hpp"
#include "core/math/simd_clones.hpp"
#include "sketch/detection/by_strength.hpp"
#include "sketch/detection/crease_map.hpp"
#include "sketch/detection/creases.hpp"

namespace emberfold::sketch {

using graph::Point;

namespace {

// Reads the entries of the pixels across a point, at every half pixel to both sides; −1 outside. `stride`:
// from row to row.
EMBERFOLD_SIMD_CLONES void entries_across(const int* entries, Point at, Point normal, int halves,
                                          cv::Size size, int stride, int* __restrict found) {
  for (int i = 0; i <= 2 * halves; ++i) {
    const double way = 0.5 * static_cast<double>(i - halves);
    const int x = core::fast_round(at.x + way * normal.x), y = core::fast_round(at.y + way * normal.y);
    const int outside = (x | y | (size.width - 1 - x) | (size.height - 1 - y)) >> 31;  // −1, or 0 inside
    found[i] = entries[(y * stride + x) & ~outside] | outside;
  }
}

// The points of a map on the way across other points.
class Across {
 public:
  explicit Across(const cv::Mat1i& index) : index_(index) {}

  // As far as `reach` to both sides of p, in order, each once: two halves often lie in one pixel.
  std::span<const int> points(const CreasePoint& p, Point normal, double reach) {
    const int halves = static_cast<int>(2 * reach);
    const auto count = 2 * static_cast<std::size_t>(halves) + 1;
    if (found_.size() < count) found_.resize(count);
    entries_across(index_[0], p.position, normal, halves, index_.size(), static_cast<int>(index_.step1()),
                   found_.data());
    int last = -1;
    std::size_t kept = 0;  // without branches, which the processor could not predict
    for (std::size_t i = 0; i < count; ++i) {
      const int here = found_[i];
      found_[kept] = here;
      kept += ((here >= 0) & (here != last)) ? 1 : 0;
      last = here;
    }
    return {found_.data(), kept};
  }

 private:
  const cv::Mat1i& index_;
  std::vector<int> found_;
};

// visit(x, y, the pixel's entry) for every pixel that refers to a point, in row order.
template <class Visit>
void visit_points(cv::Mat1i& index, Visit visit) {
  constexpr int kBlock = 16;
  for (int y = 0; y < index.rows; ++y) {
    int* row = index[y];
    for (int x0 = 0; x0 < index.cols; x0 += kBlock) {
      const int end = std::min(x0 + kBlock, index.cols);
      if (end == x0 + kBlock) {  // most blocks are empty: their entries are all −1
        int all = -1;
        for (int j = 0; j < kBlock; ++j) all &= row[x0 + j];
        if (all == -1) continue;
      }
      for (int x = x0; x < end; ++x)
        if (row[x] >= 0) visit(x, y, row[x]);
    }
  }
}

// Keeps the points for which keep(x, y, the pixel's entry), in row order.
template <class Keep>
void keep_where(CreaseMap& map, Keep keep) {
  std::vector<std::size_t> kept;
  kept.reserve(map.points.size());
  visit_points(map.index, [&](int x, int y, int& entry) {
    const auto old = static_cast<std::size_t>(entry);
    const bool stays = keep(x, y, old);
    entry = stays ? static_cast<int>(kept.size()) : -1;
    if (stays) kept.push_back(old);
  });
  if (std::is_sorted(kept.begin(), kept.end())) {
    for (std::size_t i = 0; i < kept.size(); ++i) map.points[i] = map.points[kept[i]];
    map.points.resize(kept.size());
    return;
  }
  std::vector<CreasePoint> points;
  points.reserve(kept.size());
  for (const std::size_t i : kept) points.push_back(map.points[i]);
  map.points = std::move(points);
}

void keep_unmarked(CreaseMap& map, const std::vector<char>& marked) {
  keep_where(map, [&](int, int, std::size_t entry) { return marked[entry] == 0; });
}

// to[x] = the greatest of itself and both others.
EMBERFOLD_SIMD_CLONES void raise_row(const float* a, const float* b, int width, float* __restrict to) {
  for (int x = 0; x < width; ++x) {
    const float more = a[x] > b[x] ? a[x] : b[x];
    to[x] = to[x] > more ? to[x] : more;
  }
}

EMBERFOLD_SIMD_CLONES void greater_row(const float* a, const float* b, int width, float* __restrict to) {
  for (int x = 0; x < width; ++x) to[x] = a[x] > b[x] ? a[x] : b[x];
}

// The greatest of many discs' values (≥ 0) at every pixel: all discs of one radius row by row. A disc's rows
// are intervals; each is covered by two of length 2^k.
class Shadow {
 public:
  Shadow(int width, int height) : width_(width), height_(height) {}

  void cast(cv::Point centre, int radius, float value) {
    const auto r = static_cast<std::size_t>(radius);
    if (discs_.size() <= r) discs_.resize(r + 1);
    Discs& discs = discs_[r];
    if (discs.any.empty()) {
      discs.value = cv::Mat1f(height_, width_ + 2 * radius, 0.0F);
      discs.any.resize(static_cast<std::size_t>(height_), 0);
    }
    const int y = std::clamp(centre.y, 0, height_ - 1);
    float& told = discs.value(y, radius + std::clamp(centre.x, 0, width_ - 1));
    told = std::max(told, value);
    discs.any[static_cast<std::size_t>(y)] = 1;
  }

  [[nodiscard]] cv::Mat1f finish() const {
    cv::Mat1f dark(height_, width_, 0.0F);
    Lengths lengths;
    for (std::size_t r = 0; r < discs_.size(); ++r)
      for (std::size_t y = 0; y < discs_[r].any.size(); ++y)
        if (discs_[r].any[y] != 0) spread(discs_[r], static_cast<int>(r), static_cast<int>(y), lengths, dark);
    return dark;
  }

 private:
  // Discs of one radius.
  struct Discs {
    cv::Mat1f value;        // (y, radius + x): the greatest cast from there
    std::vector<char> any;  // whether a row has some
  };
  using Lengths = std::vector<std::vector<float>>;  // [k][x]: the greatest from x on over 2^k pixels

  // A row of discs; `lengths`: to work in.
  void spread(const Discs& discs, int radius, int y, Lengths& lengths, cv::Mat1f& dark) const {
    const int all = width_ + 2 * radius;
    const std::size_t levels = last_level(radius) + 1;
    if (lengths.size() < levels) lengths.resize(levels);
    lengths[0].assign(discs.value[y], discs.value[y] + all);
    for (std::size_t k = 1; k < levels; ++k) {
      const int length = 1 << (k - 1);
      lengths[k].resize(lengths[0].size());
      greater_row(lengths[k - 1].data(), lengths[k - 1].data() + length, all - length, lengths[k].data());
    }
    for (int away = 0; away <= radius; ++away) {
      const int half = static_cast<int>(std::sqrt(double(radius) * radius - double(away) * away));
      const std::size_t k = last_level(half);
      const auto length = static_cast<int>(std::bit_floor(static_cast<unsigned>(2 * half + 1)));
      const float* first = lengths[k].data() + radius - half;
      const float* second = lengths[k].data() + radius + half + 1 - length;
      if (y - away >= 0) raise_row(first, second, width_, dark[y - away]);
      if (away > 0 && y + away < height_) raise_row(first, second, width_, dark[y + away]);
    }
  }

  // The greatest k for which 2^k pixels lie within `half` of a disc's middle.
  static std::size_t last_level(int half) {
    return static_cast<std::size_t>(std::bit_width(static_cast<unsigned>(2 * half + 1)) - 1);
  }

  int width_, height_;
  std::vector<Discs> discs_;  // by radius
};

}  // namespace

void remove_lobes(CreaseMap& lines, const CreaseMap& opposite, const ScaleSpace& space) {
  constexpr double kLobeShare = 0.35;  // of the line's contrast: a lobe has at most a tenth, the curl round a
                                       // bend or an end up to a third
  constexpr double kReach = 4.0;       // in σ of the line
  const int width = lines.index.cols, height = lines.index.rows;
  // In cells of 2 × 2 px: a lobe's rim is not that sharp.
  Shadow shadow((width + 1) / 2, (height + 1) / 2);
  for (const CreasePoint& p : opposite.points) {
    const double reach = 0.5 * kReach * space[static_cast<std::size_t>(p.level)].sigma;
    shadow.cast({core::fast_round(p.position.x) / 2, core::fast_round(p.position.y) / 2},
                static_cast<int>(std::ceil(reach)), static_cast<float>(kLobeShare * p.contrast));
  }
  const cv::Mat1f dark = shadow.finish();
  keep_where(lines, [&](int x, int y, std::size_t entry) {
    return lines.points[entry].contrast >= double{dark(y / 2, x / 2)};
  });
}

void remove_coinciding(CreaseMap& lines, const CreaseMap& opposite, const ScaleSpace& space) {
  const auto channel = [&](const CreasePoint& p) { return space[static_cast<std::size_t>(p.level)].channel; };
  std::vector<char> marked(lines.points.size(), 0);
  for (std::size_t i = 0; i < lines.points.size(); ++i) {
    const CreasePoint& p = lines.points[i];
    const int cx = core::fast_round(p.position.x), cy = core::fast_round(p.position.y);
    const int reach = static_cast<int>(1 + 0.5 * space[static_cast<std::size_t>(p.level)].sigma);
    for (int y = std::max(0, cy - reach); y <= std::min(lines.index.rows - 1, cy + reach); ++y)
      for (int x = std::max(0, cx - reach); x <= std::min(lines.index.cols - 1, cx + reach); ++x) {
        if (opposite.index(y, x) < 0) continue;
        const CreasePoint& q = opposite.points[static_cast<std::size_t>(opposite.index(y, x))];
        if (channel(q) != channel(p) && q.strength > p.strength) marked[i] = 1;
      }
  }
  keep_unmarked(lines, marked);
}

void remove_flanks(CreaseMap& steps, const CreaseMap& lines, const ScaleSpace& space, double of_flank) {
  std::vector<int> owner(steps.points.size(), -1);  // of each step's point beside a line: the strongest such
                                                    // line's point
  Across across(steps.index);
  const auto point = [&](int i) -> const CreasePoint& { return lines.points[static_cast<std::size_t>(i)]; };
  for (std::size_t i = 0; i < lines.points.size(); ++i) {
    const CreasePoint& p = lines.points[i];
    const double reach = 2.5 * space[static_cast<std::size_t>(p.level)].sigma + 1.5;
    const double nx = -std::sin(p.theta), ny = std::cos(p.theta);
    for (const int step : across.points(p, {nx, ny}, reach)) {
      int& line = owner[static_cast<std::size_t>(step)];
      if (line < 0 || point(line).contrast < p.contrast) line = static_cast<int>(i);
    }
  }
  std::vector<char> marked(steps.points.size(), 0);
  for (std::size_t at = 0; at < steps.points.size(); ++at) {
    if (owner[at] < 0) continue;
    const CreasePoint& line = point(owner[at]);
    // The steepest slope of a Gaussian line, h s / S² · e^{−1/2}, read as a step at the step's own scale.
    const double s = space[static_cast<std::size_t>(line.level)].sigma,
                 sigma = space[static_cast<std::size_t>(steps.points[at].level)].sigma;
    const double slope = 0.607 * line.contrast * s / (s * s + sigma * sigma);
    marked[at] = steps.points[at].contrast < of_flank * slope * step_contrast(sigma) ? 1 : 0;
  }
  keep_unmarked(steps, marked);
}

void thin_parallel_points(CreaseMap& map, const ScaleSpace& space) {
  std::vector<char> marked(map.points.size(), 0);
  Across across(map.index);
  std::vector<char> settled(map.points.size(), 0);  // marked, or had their turn
  for (const std::size_t i : sort_by_strength(map.points, &CreasePoint::strength, map.index.size())) {
    if (marked[i] != 0) continue;
    settled[i] = 1;
    const CreasePoint& p = map.points[i];
    const double reach = std::max(1.5, 1.25 * space[static_cast<std::size_t>(p.level)].sigma);
    const Point normal{-std::sin(p.theta), std::cos(p.theta)};
    for (const int other : across.points(p, normal, reach)) {
      const auto j = static_cast<std::size_t>(other);
      if (settled[j] != 0) continue;
      const CreasePoint& q = map.points[j];
      if (q.strength >= p.strength) continue;
      const Point v = q.position - p.position;
      const double aside = std::abs(v.x * normal.x + v.y * normal.y),
                   along = std::abs(v.x * normal.y - v.y * normal.x);
      if (aside > 0.5 && aside <= reach && along < 1 &&
          graph::orientation_difference(p.theta, q.theta) < std::numbers::pi / 4)
        settled[j] = 1, marked[j] = 1;
    }
  }
  keep_unmarked(map, marked);
}

}  // namespace emberfold::sketch
