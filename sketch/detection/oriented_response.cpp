// SPDX-License-Identifier: Apache-2.0
#include "sketch/detection/oriented_response.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>

#include <opencv2/imgproc.hpp>

#include "core/math/fast_round.hpp"
#include "core/math/simd_clones.hpp"
#include "sketch/detection/weighted_rows.hpp"

namespace emberfold::sketch {

using graph::Point;

namespace {

constexpr int kWays = 16, kTurned = kWays / 2, kStrip = 32;  // directions; rows that are worked on at once
constexpr int kCell = 4;                                     // px: cells of the ground
constexpr double kGroundReach = 10;  // px: SD of the window in which the ground is measured
constexpr int kUnit = 1 << 12;       // of a response that is averaged, against the greatest that counts

// Derivatives of a level with a margin to all sides, so that taps beyond the frame's border read its mirror
// image: xx, xy, yy, or x, y.
struct Derivatives {
  int margin;
  std::vector<cv::Mat1f> maps;
};

EMBERFOLD_SIMD_CLONES void hessian_row(const float* up, const float* mid, const float* down, int width,
                                       float* __restrict xx, float* __restrict xy, float* __restrict yy) {
  for (int x = 0; x < width; ++x) {
    xx[x] = (mid[x] + mid[x + 2]) - 2 * mid[x + 1];
    yy[x] = (up[x + 1] + down[x + 1]) - 2 * mid[x + 1];
    xy[x] = 0.25F * ((down[x + 2] + up[x]) - (down[x] + up[x + 2]));
  }
}

EMBERFOLD_SIMD_CLONES void gradient_row(const float* up, const float* mid, const float* down, int width,
                                        float* __restrict gx, float* __restrict gy) {
  for (int x = 0; x < width; ++x) {
    gx[x] = 0.5F * (mid[x + 2] - mid[x]);
    gy[x] = 0.5F * (down[x + 1] - up[x + 1]);
  }
}

Derivatives compute_derivatives(const ScaleLevel& level, Derivative order, int margin) {
  const cv::Rect inner(1, 1, level.smooth.cols - 2, level.smooth.rows - 2);
  cv::Mat1f smooth;
  cv::copyMakeBorder(level.smooth(inner), smooth, margin + 1, margin + 1, margin + 1, margin + 1,
                     cv::BORDER_REFLECT | cv::BORDER_ISOLATED);
  const cv::Size size(smooth.cols - 2, smooth.rows - 2);
  Derivatives d{margin, {}};
  for (int i = order == Derivative::first ? 1 : 0; i < 3; ++i) d.maps.emplace_back(size);
  for (int y = 0; y < size.height; ++y)
    if (order == Derivative::first)
      gradient_row(smooth[y], smooth[y + 1], smooth[y + 2], size.width, d.maps[0][y], d.maps[1][y]);
    else
      hessian_row(smooth[y], smooth[y + 1], smooth[y + 2], size.width, d.maps[0][y], d.maps[1][y],
                  d.maps[2][y]);
  return d;
}

// Derivatives along the normals of two directions at right angles.
EMBERFOLD_SIMD_CLONES void project_hessian_row(const float* xx, const float* xy, const float* yy, int width,
                                               float cc, float ss, float cs, float* __restrict a,
                                               float* __restrict b) {
  for (int x = 0; x < width; ++x) {
    const float mixed = 2 * cs * xy[x];
    a[x] = (ss * xx[x] + cc * yy[x]) - mixed;
    b[x] = (cc * xx[x] + ss * yy[x]) + mixed;
  }
}

EMBERFOLD_SIMD_CLONES void project_gradient_row(const float* gx, const float* gy, int width, float c, float s,
                                                float* __restrict a, float* __restrict b) {
  for (int x = 0; x < width; ++x) {
    a[x] = c * gy[x] - s * gx[x];
    b[x] = -(c * gx[x] + s * gy[x]);
  }
}

// The greatest responses so far, of a row: of both signs with their directions (whole numbers, but as wide as
// the responses, for vectors), and that across the strongest.
struct Greatest {
  float *negative, *positive, *negative_way, *positive_way, *strongest, *across;
};

EMBERFOLD_SIMD_CLONES void raise_row(const float* a, const float* b, int width, float first, float second,
                                     float* __restrict negative, float* __restrict positive,
                                     float* __restrict negative_way, float* __restrict positive_way,
                                     float* __restrict strongest, float* __restrict across) {
  for (int x = 0; x < width; ++x) {
    const bool less = a[x] < b[x];
    const float low = less ? a[x] : b[x], high = less ? b[x] : a[x];
    const float low_way = less ? first : second, high_way = less ? second : first;
    const bool lower = -low > negative[x], higher = high > positive[x];
    negative_way[x] = lower ? low_way : negative_way[x];
    negative[x] = lower ? -low : negative[x];
    positive_way[x] = higher ? high_way : positive_way[x];
    positive[x] = higher ? high : positive[x];
    const float size_low = std::abs(low), size_high = std::abs(high);
    const float more = size_low < size_high ? size_high : size_low,
                other = size_low < size_high ? size_low : size_high;
    const bool stronger = more > strongest[x];
    across[x] = stronger ? other : across[x];
    strongest[x] = stronger ? more : strongest[x];
  }
}

EMBERFOLD_SIMD_CLONES void narrow_row(const float* ways, int width, std::uint8_t* __restrict out) {
  for (int x = 0; x < width; ++x) out[x] = static_cast<std::uint8_t>(static_cast<int>(ways[x]));
}

// From the first octant, so that mirrored and turned directions have the same bits.
Point unit_vector(int way) {
  if (way > kWays / 2) {
    const Point u = unit_vector(kWays - way);
    return {-u.x, u.y};
  }
  if (way > kWays / 4) {
    const Point u = unit_vector(kWays / 2 - way);
    return {u.y, u.x};
  }
  if (way == kWays / 4) return {std::numbers::sqrt2 / 2, std::numbers::sqrt2 / 2};
  const double angle = way * std::numbers::pi / kWays;
  return {std::cos(angle), std::sin(angle)};
}

// Taps are as far apart as the level's smoothness allows.
void place_taps(OrientedResponse& r, double sigma, double along) {
  constexpr double kApart = 1.2, kReach = 2.2;
  const double extra = std::sqrt(std::max(along * along - sigma * sigma, 0.0)), apart = kApart * sigma;
  const int count = extra > 0.5 * sigma ? static_cast<int>(std::ceil(kReach * extra / apart)) : 0;
  double sum = 0;
  for (int i = 0; i <= count; ++i) {
    const double w = i == 0 ? 1 : std::exp(-0.5 * std::pow(i * apart / extra, 2));
    r.weights.push_back(static_cast<float>(w));
    sum += (i > 0 ? 2 : 1) * w;
  }
  for (float& w : r.weights) w = static_cast<float>(double{w} / sum);
  for (int way = 0; way < kWays; ++way) {
    r.ways.push_back(unit_vector(way));
    std::vector<cv::Point> taps;
    for (int i = 1; i <= count; ++i)
      taps.emplace_back(static_cast<int>(std::lround(i * apart * r.ways.back().x)),
                        static_cast<int>(std::lround(i * apart * r.ways.back().y)));
    r.taps.push_back(std::move(taps));
  }
}

// Averages along two directions at right angles, for a strip of rows.
class Strip {
 public:
  Strip(const Derivatives& d, const OrientedResponse& r, int width)
      : d_(d),
        r_(r),
        width_(width),
        a_(kStrip + 2 * d.margin, d.maps[0].cols),
        b_(a_.size()),
        along_a_(static_cast<std::size_t>(width)),
        along_b_(along_a_.size()),
        before_(r.weights.size()),
        after_(before_.size()) {}

  void project(int way, int y0, int rows) {
    const Point u = r_.ways[static_cast<std::size_t>(way)];
    const auto c = static_cast<float>(u.x), s = static_cast<float>(u.y), cc = static_cast<float>(u.x * u.x),
               ss = static_cast<float>(u.y * u.y), cs = static_cast<float>(u.x * u.y);
    for (int y = 0; y < rows + 2 * d_.margin; ++y)
      if (d_.maps.size() == 2)
        project_gradient_row(d_.maps[0][y0 + y], d_.maps[1][y0 + y], a_.cols, c, s, a_[y], b_[y]);
      else
        project_hessian_row(d_.maps[0][y0 + y], d_.maps[1][y0 + y], d_.maps[2][y0 + y], a_.cols, cc, ss, cs,
                            a_[y], b_[y]);
  }

  // Raises row y of the strip.
  void raise(int way, int y, const Greatest& g) {
    average(a_, y, way, along_a_);
    average(b_, y, way + kTurned, along_b_);
    raise_row(along_a_.data(), along_b_.data(), width_, static_cast<float>(way),
              static_cast<float>(way + kTurned), g.negative, g.positive, g.negative_way, g.positive_way,
              g.strongest, g.across);
  }

 private:
  void average(const cv::Mat1f& from, int y, int way, std::vector<float>& out) {
    const auto& taps = r_.taps[static_cast<std::size_t>(way)];
    const int row = y + d_.margin, column = d_.margin;
    before_[0] = after_[0] = from[row] + column;
    for (std::size_t i = 0; i < taps.size(); ++i) {
      before_[i + 1] = from[row - taps[i].y] + column - taps[i].x;
      after_[i + 1] = from[row + taps[i].y] + column + taps[i].x;
    }
    weigh_rows(before_.data(), after_.data(), r_.weights.data(), static_cast<int>(before_.size()), width_,
               out.data());
  }

  const Derivatives& d_;
  const OrientedResponse& r_;
  int width_;
  cv::Mat1f a_, b_;
  std::vector<float> along_a_, along_b_;
  std::vector<const float*> before_, after_;
};

// Cells from one border of the frame to the other, all of one size.
int cells(int size) {
  return std::max(1, core::fast_round(static_cast<double>(size) / kCell));
}

// Gaussian blur of a small map, mirrored at its border; pairs are summed first.
cv::Mat1d blurred(const cv::Mat1d& map, double sigma) {
  const auto along = [sigma](const cv::Mat1d& from) {  // along columns; transposed
    const int reach = static_cast<int>(std::ceil(3 * sigma));
    cv::Mat1d to(from.cols, from.rows);
    const auto mirrored = [&](int at) { return cv::borderInterpolate(at, from.rows, cv::BORDER_REFLECT); };
    for (int x = 0; x < from.cols; ++x)
      for (int y = 0; y < from.rows; ++y) {
        double sum = from(y, x), weight = 1;
        for (int i = 1; i <= reach; ++i) {
          const double w = std::exp(-0.5 * i * i / (sigma * sigma));
          sum += w * (from(mirrored(y - i), x) + from(mirrored(y + i), x));
          weight += 2 * w;
        }
        to(x, y) = sum / weight;
      }
    return to;
  };
  return along(along(map));
}

// Local RMS of the responses across, of which single great ones (crossings, corners) count as three medians.
cv::Mat1f local_ground(const cv::Mat1f& across, double usual, double least) {
  const int columns = cells(across.cols), rows = cells(across.rows);
  const double most = std::max(3 * usual, least);
  cv::Mat1d sum(rows, columns, 0.0), count(rows, columns, 0.0);
  // Whole numbers: their sums are the same in any order, and so in a mirrored frame.
  for (int y = 0; y < across.rows; ++y)
    for (int x = 0; x < across.cols; ++x) {
      const double share = std::min(double{across(y, x)} / most, 1.0);
      const int row = (2 * y + 1) * rows / (2 * across.rows),
                column = (2 * x + 1) * columns / (2 * across.cols);
      sum(row, column) += std::round(kUnit * share * share);
      count(row, column) += 1;
    }
  const double sigma = kGroundReach / kCell;
  const cv::Mat1d total = blurred(sum, sigma), pixels = blurred(count, sigma);
  cv::Mat1f ground(rows, columns);
  for (int y = 0; y < rows; ++y)
    for (int x = 0; x < columns; ++x)
      ground(y, x) =
          static_cast<float>(std::max(least, most * std::sqrt(total(y, x) / (pixels(y, x) * kUnit))));
  return ground;
}

}  // namespace

void sample_across(const cv::Mat1f& across, const FramePart& part, std::vector<float>& samples) {
  constexpr std::size_t kEnough = 20000;
  const auto total = static_cast<double>(part.frame.width) * part.frame.height;
  const int step = 2 * static_cast<int>(0.5 * std::sqrt(total / kEnough)) + 1;
  const auto first = [step](int size) {  // as far from its border as the last is from the other
    int at = 0;
    while (at + 1 < size && (size - 1 - 2 * at) % step != 0) ++at;
    return std::min(at, std::max(0, (size - 1) / 2));
  };
  for (int y = first(part.frame.height); y < part.frame.height; y += step)
    for (int x = first(part.frame.width); x < part.frame.width; x += step)
      if (part.core.contains({x, y})) samples.push_back(across(y - part.origin.y, x - part.origin.x));
}

double usual_response(std::vector<float> samples) {
  const auto middle = samples.begin() + static_cast<std::ptrdiff_t>(samples.size() / 2);
  std::nth_element(samples.begin(), middle, samples.end());
  return double{*middle};
}

void OrientedResponse::ground_row(int y, std::vector<float>& row) const {
  const auto place = [](int at, int size, int count) {  // between the middles of cells
    return std::clamp((at + 0.5) * count / size - 0.5, 0.0, count - 1.0);
  };
  const double v = place(y, negative.rows, ground.rows);
  const int top = static_cast<int>(v), below = std::min(top + 1, ground.rows - 1);
  const auto fy = static_cast<float>(v - top);
  std::vector<float> cell;
  for (int x = 0; x < ground.cols; ++x) cell.push_back((1 - fy) * ground(top, x) + fy * ground(below, x));
  cell.push_back(cell.back());
  row.resize(static_cast<std::size_t>(negative.cols));
  const auto share = static_cast<float>(ground.cols) / static_cast<float>(negative.cols),
             last = static_cast<float>(ground.cols - 1);
  for (int x = 0; x < negative.cols; ++x) {
    const float u = std::clamp((static_cast<float>(x) + 0.5F) * share - 0.5F, 0.0F, last);
    const auto left = static_cast<std::size_t>(u);
    const float fx = u - static_cast<float>(left);
    row[static_cast<std::size_t>(x)] = (1 - fx) * cell[left] + fx * cell[left + 1];
  }
}

OrientedResponse compute_oriented_response(const ScaleLevel& level, Derivative order, double along,
                                           double noise, double usual) {
  OrientedResponse r;
  place_taps(r, level.sigma, along);
  const cv::Size size(level.smooth.cols - 2, level.smooth.rows - 2);
  for (const auto& taps : r.taps)
    for (const cv::Point tap : taps) r.reach = std::max({r.reach, std::abs(tap.x), std::abs(tap.y)});
  const Derivatives d = compute_derivatives(level, order, r.reach);
  r.negative = cv::Mat1f(size, 0.0F), r.positive = cv::Mat1f(size, 0.0F);
  r.negative_way = cv::Mat1b(size, std::uint8_t{0}), r.positive_way = cv::Mat1b(size, std::uint8_t{0});
  r.across = cv::Mat1f(size, 0.0F);
  cv::Mat1f strongest(kStrip, size.width), negative_way(kStrip, size.width), positive_way(kStrip, size.width);
  Strip strip(d, r, size.width);
  for (int y0 = 0; y0 < size.height; y0 += kStrip) {
    const int rows = std::min(kStrip, size.height - y0);
    strongest = 0.0F, negative_way = 0.0F, positive_way = 0.0F;
    for (int way = 0; way < kTurned; ++way) {
      strip.project(way, y0, rows);
      for (int y = 0; y < rows; ++y)
        strip.raise(way, y,
                    {r.negative[y0 + y], r.positive[y0 + y], negative_way[y], positive_way[y], strongest[y],
                     r.across[y0 + y]});
    }
    for (int y = 0; y < rows; ++y) {
      narrow_row(negative_way[y], size.width, r.negative_way[y0 + y]);
      narrow_row(positive_way[y], size.width, r.positive_way[y0 + y]);
    }
  }
  const double sd = order == Derivative::first ? level.gradient_sd : level.hessian_sd,
               total = std::max(along, level.sigma);
  if (usual <= 0) {
    std::vector<float> samples;
    sample_across(r.across, whole_frame(size), samples);
    usual = usual_response(std::move(samples));
  }
  r.ground = local_ground(r.across, usual, noise * sd * std::sqrt(level.sigma / total));
  return r;
}

}  // namespace emberfold::sketch
