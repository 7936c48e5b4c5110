// SPDX-License-Identifier: Apache-2.0
#include "sketch/refinement/coding_length.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include <opencv2/core.hpp>

#include "core/clip.hpp"
#include "core/error.hpp"
#include "core/math/robust.hpp"
#include "core/math/simd_clones.hpp"
#include "sketch/detection/colour.hpp"
#include "sketch/patches/profile_shape.hpp"

namespace emberfold::sketch {

namespace {

constexpr int kHalf = 4, kSide = 2 * kHalf + 1, kStride = 7;  // px, of the windows that measure the noise
constexpr double kEnough = 1500;                              // windows
constexpr int kBarLength = 5;                                 // px
constexpr std::array<int, 2> kBars = {3, 6};                  // px
constexpr double kQuantisation = 0.29;                        // grey levels
constexpr double kAlong = 2.5;                                // px to each end
constexpr double kLeastReach = 3, kMostReach = 12;            // px to each side
constexpr double kBand = 2;                            // px more than the footprint's half, of each band
constexpr int kNumbersOfLine = 7, kNumbersOfStep = 5;  // beyond those of the ramp

/// visit(x, y) for the corners of windows of this size all over the frame, which lie alike seen from either
/// border.
template <class Visit>
void visit_windows(cv::Size frame, cv::Size window, Visit visit) {
  const int apart = std::max(kStride, static_cast<int>(std::sqrt(frame.area() / kEnough))) | 1;
  const int across = frame.width - window.width, down = frame.height - window.height;
  if (across < 0 || down < 0) return;
  const int step_x = std::clamp(across, 1, apart), step_y = std::clamp(down, 1, apart);
  const auto first = [](int range, int step) {
    int at = 0;
    while ((range - 2 * at) % step != 0) ++at;  // ends: the step is odd, or the range itself
    return at;
  };
  for (int y = first(down, step_y); y <= down; y += step_y)
    for (int x = first(across, step_x); x <= across; x += step_x) visit(x, y);
}

/// The mean square of a window about its plane.
double variance(const cv::Mat1f& luma, int x0, int y0) {
  constexpr double kCount = kSide * kSide, kMoment = kSide * 60;  // Σ x² over the window
  const double origin = double{luma(y0 + kHalf, x0 + kHalf)};
  double sum = 0, squares = 0, across = 0, down = 0;
  for (int y = 0; y < kSide; ++y)
    for (int x = 0; x < kSide; ++x) {
      const double v = double{luma(y0 + y, x0 + x)} - origin;
      sum += v;
      squares += v * v;
      across += v * (x - kHalf);
      down += v * (y - kHalf);
    }
  return std::max(squares - sum * sum / kCount - (across * across + down * down) / kMoment, 0.0) /
         (kCount - 3);
}

template <int kWide, int kHigh>
double box_sum(const cv::Mat1f& luma, cv::Point corner) {
  double sum = 0;
  for (int y = 0; y < kHigh; ++y) {
    const float* row = luma[corner.y + y] + corner.x;
    float along = 0;
    for (int x = 0; x < kWide; ++x) along += row[x];
    sum += double{along};
  }
  return sum;
}

/// The mean of a bar above those of its two sides of the same size, each `apart` from the last: no even slope
/// shows in it.
template <int kWide, int kHigh>
double bar_contrast(const cv::Mat1f& luma, cv::Point corner, cv::Point apart) {
  const auto part = [&](int i) { return box_sum<kWide, kHigh>(luma, corner + i * apart); };
  return (part(1) - 0.5 * (part(0) + part(2))) / (kWide * kHigh);
}

/// Variance of a bar's contrast, along rows and columns, over that in white noise of this SD. In white noise
/// it is 3/2 of the variance of a bar's mean.
template <int kWidth>
double measure_noise_correlation(const cv::Mat1f& luma, double noise) {
  std::vector<float> contrasts;
  const auto add = [&](double contrast) { contrasts.push_back(static_cast<float>(std::abs(contrast))); };
  visit_windows(luma.size(), {3 * kWidth, kBarLength}, [&](int x, int y) {
    add(bar_contrast<kWidth, kBarLength>(luma, {x, y}, {kWidth, 0}));
  });
  visit_windows(luma.size(), {kBarLength, 3 * kWidth}, [&](int x, int y) {
    add(bar_contrast<kBarLength, kWidth>(luma, {x, y}, {0, kWidth}));
  });
  if (contrasts.empty()) return 1;
  const double sd = core::kMadToSd * double{core::median_of_positive(std::move(contrasts))};
  return std::max(1.0, sd * sd * kBarLength * kWidth / (1.5 * noise * noise));
}

double along(const std::array<float, 3>& axis, const graph::Level& level) {
  return double{axis[0]} * double{level[0]} + double{axis[1]} * double{level[1]} +
         double{axis[2]} * double{level[2]};
}

/// Φ between −kFar and kFar, from a table and its first two derivatives there: within 1e-8. Without a branch,
/// so that a loop goes into vectors: beyond, the table has a node more at each end.
class BlurredStep {
 public:
  BlurredStep() {
    constexpr double kToDensity = 0.3989422804014327;  // 1 / √(2π)
    nodes_.front() = {0, 0};
    for (int i = 1; i + 1 < kNodes; ++i) {
      const double x = at(i);
      nodes_[static_cast<std::size_t>(i)] = {0.5 * std::erfc(-x / std::numbers::sqrt2),
                                             kToDensity * std::exp(-0.5 * x * x)};
    }
    nodes_.back() = {1, 0};
  }
  double operator()(double x) const {
    constexpr double kBeyond = kFar + 2.0 / kPerUnit;
    const double above = x > -kFar ? x : -kBeyond, near = above < kFar ? above : kBeyond;
    const int i =
        static_cast<int>((near + kFar) * kPerUnit + 0.5) + 1;  // NOLINT(bugprone-incorrect-roundings): ≥ 0
    const double from = at(i), d = near - from;
    const Node& node = nodes_[static_cast<std::size_t>(i)];
    return node.below + node.density * d * (1 - 0.5 * d * (from - d * (from * from - 1) / 3));
  }

 private:
  static constexpr int kFar = 6, kPerUnit = 32, kNodes = 2 * kFar * kPerUnit + 4;
  static double at(int node) { return double(node - 1) / kPerUnit - kFar; }
  struct Node {
    double below, density;
  };
  std::array<Node, kNodes> nodes_{};
};

const BlurredStep& table_of_steps() {
  static const BlurredStep step;
  return step;
}

/// A patch's profile in luma.
struct Profile {
  const BlurredStep& step = table_of_steps();
  double left, middle, right;
  ProfileShape shape;
  double reach;

  Profile(const graph::Patch& patch, const std::array<float, 3>& axis)
      : left(along(axis, patch.left)),
        middle(along(axis, patch.middle)),
        right(along(axis, patch.right)),
        shape(patch),
        reach(std::clamp(shape.half_width + 2 * shape.blur, kLeastReach, kMostReach)) {}

  [[nodiscard]] double level_of(const ProfileShape::Reached& reached) const {
    return reached.level(left, middle, right);
  }
};

/// The share of a pixel that lies within `limit` of a line that is `distance` away from its middle.
double share_within(double distance, double limit) {
  return std::min(std::max(limit - std::abs(distance) + 0.5, 0.0), 1.0);
}

/// Weighted sums over pixels; v the distance across, i the level above the patch's middle.
struct Band {
  double w = 0, v = 0, i = 0;

  void add(double weight, double across, double level) {
    w += weight;
    v += weight * across;
    i += weight * level;
  }
};

struct Sums : Band {
  double vv = 0, vi = 0, ii = 0;
  double profile = 0;  // of the squared difference between the level and the profile

  void add(double weight, double across, double level, double difference) {
    Band::add(weight, across, level);
    vv += weight * across * across;
    vi += weight * across * level;
    ii += weight * level * level;
    profile += weight * difference * difference;
  }
  /// Least sum of squares of a ramp of this slope, over its level.
  [[nodiscard]] double ramp(double slope) const {
    const double mean = (i - slope * v) / w;
    const double squares = ii - 2 * slope * vi + slope * slope * vv;
    return std::max(squares - w * mean * mean, 0.0);
  }
};

struct Footprint {
  Sums inside;
  Band left, right;  // of it

  /// Levels per px from one band to the other; level where one of them is hardly there.
  [[nodiscard]] double slope() const {
    const Band &a = left, &b = right;
    if (a.w < 1 || b.w < 1) return 0;
    return (b.i / b.w - a.i / a.w) / (b.v / b.w - a.v / a.w);
  }
};

/// 6 px along and 53 across hold at most their area, half their edge and one.
constexpr std::size_t kMostPixels = 400;
using Column = std::array<double, kMostPixels>;

/// The pixels that a patch and its bands may lie on.
struct Pixels {  // NOLINT(cppcoreguidelines-pro-type-member-init): filling columns would cost time
  int count = 0;
  Column along, across, level;  // distances from the patch; the level above its middle
};
struct Weights {
  Column inside, left, right;
  Column difference;  // from the level to the profile
};

/// Finds the footprint's pixels.
void place(const cv::Mat1f& luma, const graph::Patch& patch, const Profile& profile, double outer,
           Pixels& pixels) {
  const double c = std::cos(patch.theta), s = std::sin(patch.theta);
  const double wide = std::abs(c) * (kAlong + 0.5) + std::abs(s) * (outer + 0.5);
  const double high = std::abs(s) * (kAlong + 0.5) + std::abs(c) * (outer + 0.5);
  // Clamped while still a double: a position may lie anywhere.
  const auto first = [](double at) { return static_cast<int>(std::ceil(std::max(at, 0.0))); };
  const auto last = [](double at, int size) {
    return static_cast<int>(std::floor(std::min(at, size - 1.0)));
  };
  const auto [px, py] = patch.position;
  if (!(px - wide < luma.cols && px + wide > -1 && py - high < luma.rows && py + high > -1)) return;
  // A row meets the footprint where it is near enough along it and across it.
  const auto narrow = [](double& from, double& to, double rate, double offset, double limit) {
    if (std::abs(rate) < 1e-9) return;
    const double a = (-limit - offset) / rate, b = (limit - offset) / rate;
    from = std::max(from, std::min(a, b));
    to = std::min(to, std::max(a, b));
  };
  std::size_t count = 0;
  for (int y = first(py - high), end_y = last(py + high, luma.rows); y <= end_y; ++y) {
    const double dy = y - py;
    double from = -wide, to = wide;
    narrow(from, to, c, dy * s, kAlong + 0.5);
    narrow(from, to, -s, dy * c, outer + 0.5);
    const float* row = luma[y];
    const int end_x = last(px + to, luma.cols);
    for (int x = first(px + from); x <= end_x && count < kMostPixels; ++x, ++count) {
      const double dx = x - px;
      pixels.along[count] = dx * c + dy * s;
      pixels.across[count] = dy * c - dx * s;
      pixels.level[count] = double{row[x]} - profile.middle;
    }
  }
  pixels.count = static_cast<int>(count);
}

/// Computes the pixels' weights and differences from the profile; `shape`: the profile's.
[[gnu::always_inline]] inline void weigh_as(const ProfileShape shape, const Profile profile, double outer,
                                            const Pixels& pixels, Weights& weights) {
  for (int i = 0; i < pixels.count; ++i) {
    const auto at = static_cast<std::size_t>(i);
    const double along = share_within(pixels.along[at], kAlong), across = pixels.across[at];
    const double within = share_within(across, profile.reach);
    const double beside = along * (share_within(across, outer) - within);
    weights.inside[at] = along * within;
    weights.left[at] = across > 0 ? 0 : beside;
    weights.right[at] = across > 0 ? beside : 0;
    weights.difference[at] =
        pixels.level[at] + profile.middle - profile.level_of(shape.at(across, profile.step));
  }
}

/// Lines and steps each in a loop of their own, without a branch.
EMBERFOLD_SIMD_CLONES void weigh(const Profile& profile, double outer, const Pixels& pixels,
                                 Weights& __restrict weights) {
  ProfileShape shape;
  shape.blur = profile.shape.blur;
  if (!(profile.shape.half_width > 0)) return weigh_as(shape, profile, outer, pixels, weights);
  shape.half_width = profile.shape.half_width;
  weigh_as(shape, profile, outer, pixels, weights);
}

Footprint look(const cv::Mat1f& luma, const graph::Patch& patch, const Profile& profile) {
  const double outer = 2 * profile.reach + kBand;
  Pixels pixels;    // the columns are written before they are read
  Weights weights;  // NOLINT(cppcoreguidelines-pro-type-member-init): likewise
  place(luma, patch, profile, outer, pixels);
  weigh(profile, outer, pixels, weights);
  Footprint seen;
  for (std::size_t i = 0; i < static_cast<std::size_t>(pixels.count); ++i) {
    const double across = pixels.across[i], level = pixels.level[i];
    seen.inside.add(weights.inside[i], across, level, weights.difference[i]);
    seen.left.add(weights.left[i], across, level);
    seen.right.add(weights.right[i], across, level);
  }
  return seen;
}

}  // namespace

CodingContext prepare_coding(const cv::Mat& levels) {
  if (levels.empty() || levels.depth() != CV_32F || (levels.channels() != 1 && levels.channels() != 3))
    throw core::InputError("coding_gain: the frame must be CV_32F with 1 or 3 channels and not empty");
  if (!cv::checkRange(levels, true))
    throw core::InputError("coding_gain: the frame holds a value that is not finite");
  return prepare_coding(core::luma(levels), kColourAxes[0]);
}

CodingContext prepare_coding(cv::Mat1f mixture, const std::array<float, 3>& axis) {
  CodingContext frame;
  frame.luma = std::move(mixture);
  frame.axis = axis;
  frame.noise = kQuantisation;
  std::vector<float> variances;
  visit_windows(frame.luma.size(), {kSide, kSide},
                [&](int x, int y) { variances.push_back(static_cast<float>(variance(frame.luma, x, y))); });
  if (variances.empty()) return frame;
  constexpr double kMedian = 0.9915;  // of χ²/78 with 78 degrees of freedom
  frame.noise =
      std::max(kQuantisation, std::sqrt(double{core::median_of_positive(std::move(variances))} / kMedian));
  frame.noise_correlation = {measure_noise_correlation<kBars[0]>(frame.luma, frame.noise),
                             measure_noise_correlation<kBars[1]>(frame.luma, frame.noise)};
  return frame;
}

Coding code_patch(const CodingContext& frame, const graph::Patch& patch) {
  const Profile profile(patch, frame.axis);
  const Footprint seen = look(frame.luma, patch, profile);
  if (seen.inside.w <= 0) return {};
  // A bar with its sides lies within 1.5 widths of its middle, a step's two sides within one.
  const bool step = graph::on_step(patch);
  const double bar = profile.reach / (step ? 1.0 : 1.5);
  const double wider = std::clamp((bar - kBars[0]) / (kBars[1] - kBars[0]), 0.0, 1.0);
  const double noise_correlation =
      frame.noise_correlation[0] + wider * (frame.noise_correlation[1] - frame.noise_correlation[0]);
  const double saved = seen.inside.ramp(seen.slope()) - seen.inside.profile;
  const double cost =
      0.5 * (step ? kNumbersOfStep : kNumbersOfLine) * std::log1p(seen.inside.w / noise_correlation);
  return {cost, saved / (2 * frame.noise * frame.noise * noise_correlation) - cost};
}

}  // namespace emberfold::sketch
