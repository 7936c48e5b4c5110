// SPDX-License-Identifier: Apache-2.0
#include "sketch/profile.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace emberfold::sketch {

using graph::Level;
using graph::Patch;
using graph::PatchType;
using graph::Point;

namespace {

constexpr double kSampleStep = 0.5;  // px
constexpr std::size_t kMostSamples = 81;

double normal_cdf(double x) {
  return 0.5 * std::erfc(-x * 0.70710678118654752);
}

// Signed distance of sample i of `count` across the patch.
double sample_place(std::size_t i, std::size_t count) {
  return kSampleStep * (static_cast<double>(i) - 0.5 * static_cast<double>(count - 1));
}

// The image across the patch: means over its length, of each channel and of luma.
struct Section {
  std::array<std::array<double, kMostSamples>, 3> value{};
  std::array<double, kMostSamples> luma{};
};

Section cut_across(const cv::Mat& levels, Point p, double theta, std::size_t count, double length) {
  const Point along{std::cos(theta), std::sin(theta)}, across{-along.y, along.x};
  const int channels = levels.channels(), rows = std::max(1, static_cast<int>(std::lround(length)));
  Section section;
  for (std::size_t at = 0; at < count; ++at) {
    const double d = sample_place(at, count);
    for (int r = 0; r < rows; ++r) {
      const Point q = p + across * d + along * (r - 0.5 * (rows - 1));
      const double x = std::clamp(q.x, 0.0, levels.cols - 1.0), y = std::clamp(q.y, 0.0, levels.rows - 1.0);
      const int x0 = static_cast<int>(x), y0 = static_cast<int>(y);
      const int x1 = std::min(x0 + 1, levels.cols - 1), y1 = std::min(y0 + 1, levels.rows - 1);
      const double fx = x - x0, fy = y - y0;
      const float* top = levels.ptr<float>(y0);
      const float* bottom = levels.ptr<float>(y1);
      for (int c = 0; c < channels; ++c) {
        const double upper = (1 - fx) * double{top[x0 * channels + c]} + fx * double{top[x1 * channels + c]};
        const double lower =
            (1 - fx) * double{bottom[x0 * channels + c]} + fx * double{bottom[x1 * channels + c]};
        section.value[static_cast<std::size_t>(c)][at] += ((1 - fy) * upper + fy * lower) / rows;
      }
    }
    if (channels == 1) section.value[1][at] = section.value[2][at] = section.value[0][at];
    section.luma[at] = channels == 1 ? section.value[0][at]
                                     : 0.114 * section.value[0][at] + 0.587 * section.value[1][at] +
                                           0.299 * section.value[2][at];
  }
  return section;
}

using Samples = std::array<double, kMostSamples>;

// One shape of profile: the shares of left, middle and right level at each sample (they sum to 1), and the
// inverse of their normal matrix. A step has no middle: the small ridge term keeps its system regular.
struct Shape {
  double width = 0, blur = 1;
  std::array<Samples, 3> share{};
  double inverse[3][3] = {};
};

void invert_normal_matrix(Shape& shape, std::size_t count) {
  double m[3][6] = {};
  for (std::size_t a = 0; a < 3; ++a) {
    for (std::size_t b = 0; b < 3; ++b)
      for (std::size_t i = 0; i < count; ++i) m[a][b] += shape.share[a][i] * shape.share[b][i];
    m[a][a] += 1e-9;
    m[a][3 + a] = 1;
  }
  for (std::size_t a = 0; a < 3; ++a) {
    const double pivot = m[a][a];
    for (double& v : m[a]) v /= pivot;
    for (std::size_t r = 0; r < 3; ++r) {
      if (r == a) continue;
      const double f = m[r][a];
      for (std::size_t c = 0; c < 6; ++c) m[r][c] -= f * m[a][c];
    }
  }
  for (std::size_t a = 0; a < 3; ++a)
    for (std::size_t b = 0; b < 3; ++b) shape.inverse[a][b] = m[a][3 + b];
}

Shape make_shape(double width, double blur, std::size_t count) {
  Shape shape;
  shape.width = width;
  shape.blur = blur;
  for (std::size_t i = 0; i < count; ++i) {
    const double d = sample_place(i, count);
    const double entered = normal_cdf((d + 0.5 * width) / blur);
    const double left = width > 0 ? normal_cdf((d - 0.5 * width) / blur) : entered;
    shape.share[0][i] = 1 - entered;
    shape.share[1][i] = entered - left;
    shape.share[2][i] = left;
  }
  invert_normal_matrix(shape, count);
  return shape;
}

struct Fit {
  std::array<double, 3> level{};  // left, middle, right
  double explained = 0;           // of the sum of squares
};

Fit solve(const Shape& shape, const Samples& y, std::size_t count) {
  std::array<double, 3> moment{};
  for (std::size_t a = 0; a < 3; ++a)
    for (std::size_t i = 0; i < count; ++i) moment[a] += shape.share[a][i] * y[i];
  Fit fit;
  for (std::size_t a = 0; a < 3; ++a) {
    for (std::size_t b = 0; b < 3; ++b) fit.level[a] += shape.inverse[a][b] * moment[b];
    fit.explained += fit.level[a] * moment[a];
  }
  return fit;
}

// The shapes that are tried. A blurred bar's variance is blur² + width²/12; the squareness says how much of
// it is the bar's.
std::vector<Shape> make_shapes(CreaseKind kind, double spread, std::size_t count) {
  constexpr std::array<double, 9> kScales = {0.45, 0.55, 0.67, 0.82, 1.0, 1.22, 1.5, 1.8, 2.2};
  constexpr std::array<double, 4> kSquareness = {1.2, 2.0, 2.8, 3.3};
  std::vector<Shape> shapes;
  for (const double scale : kScales) {
    const double sd = scale * spread;
    if (kind == CreaseKind::step) {
      shapes.push_back(make_shape(0, std::max(sd, 0.3), count));
      continue;
    }
    for (const double squareness : kSquareness) {
      const double width = squareness * sd;
      shapes.push_back(make_shape(width, std::sqrt(std::max(sd * sd - width * width / 12, 0.09)), count));
    }
  }
  return shapes;
}

}  // namespace

struct PatchFitter::Family {
  CreaseKind kind;
  int octave_eighths;
  std::size_t count;
  std::vector<Shape> shapes;
};

PatchFitter::PatchFitter() = default;
PatchFitter::~PatchFitter() = default;

const PatchFitter::Family& PatchFitter::family(CreaseKind kind, double spread) {
  const bool step = kind == CreaseKind::step;
  const int eighths = static_cast<int>(std::lround(8 * std::log2(spread)));
  for (const auto& known : families_)
    if ((known->kind == CreaseKind::step) == step && known->octave_eighths == eighths) return *known;
  const double rounded = std::exp2(eighths / 8.0);
  const auto half =
      std::min(static_cast<std::size_t>(std::ceil((2.8 * rounded + 1.5) / kSampleStep)), kMostSamples / 2);
  const std::size_t count = 2 * half + 1;
  families_.push_back(
      std::make_unique<Family>(Family{kind, eighths, count, make_shapes(kind, rounded, count)}));
  return *families_.back();
}

Patch PatchFitter::fit(const cv::Mat& levels, Point position, double theta, CreaseKind kind, double spread,
                       double length) {
  const Family& family = this->family(kind, spread);
  const Section section = cut_across(levels, position, theta, family.count, length);
  const Shape* best = nullptr;
  double most = 0;
  for (const Shape& shape : family.shapes) {
    const double explained = solve(shape, section.luma, family.count).explained;
    if (best == nullptr || explained > most) {
      most = explained;
      best = &shape;
    }
  }
  Patch patch;
  patch.type = kind == CreaseKind::ridge    ? PatchType::ridge
               : kind == CreaseKind::valley ? PatchType::valley
                                            : PatchType::step;
  patch.position = position;
  patch.theta = theta;
  patch.width = best->width;
  patch.blur = best->blur;
  for (std::size_t c = 0; c < 3; ++c) {
    const Fit fitted = solve(*best, section.value[c], family.count);
    patch.left[c] = static_cast<float>(fitted.level[0]);
    patch.right[c] = static_cast<float>(fitted.level[2]);
    patch.middle[c] = static_cast<float>(kind == CreaseKind::step ? 0.5 * (fitted.level[0] + fitted.level[2])
                                                                  : fitted.level[1]);
  }
  const Fit fitted = solve(*best, section.luma, family.count);
  if (kind == CreaseKind::step) {
    patch.contrast = fitted.level[2] - fitted.level[0];
  } else {
    const double core =
        1 - 2 * normal_cdf(-0.5 * best->width / best->blur);  // what is seen of it at the centre
    patch.contrast = core * (fitted.level[1] - 0.5 * (fitted.level[0] + fitted.level[2]));
  }
  return patch;
}

}  // namespace emberfold::sketch
