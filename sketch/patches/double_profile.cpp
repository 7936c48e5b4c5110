// SPDX-License-Identifier: Apache-2.0
#include "sketch/patches/double_profile.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Dense>
#include <unsupported/Eigen/NonLinearOptimization>
#include <unsupported/Eigen/NumericalDiff>

#include "sketch/detection/colour.hpp"
#include "sketch/patches/profile_shape.hpp"
#include "sketch/patches/sections.hpp"

namespace emberfold::sketch {

using graph::Patch;

namespace {

constexpr double kBlurSpread = 0.4;  // SD of the blur's logarithm
constexpr double kBeyond = 2;        // px of either side, two blurs more
constexpr double kLeastDip = 0.25;   // of the contrast
constexpr double kThinnest = 0.8;    // px, of each line: thinner ones look like fainter ones

/// Offset (px), and the logarithms of the hollow, each line's width beyond the thinnest, and the blur.
using Shape = Eigen::Vector4d;
/// left, middle, right, between
using Levels = Eigen::Vector4d;

ProfileShape shape_of(const Shape& x) {
  ProfileShape shape;
  shape.half_hollow = std::exp(x[1]) / 2;
  shape.half_width = shape.half_hollow + kThinnest + std::exp(x[2]);
  shape.blur = std::exp(x[3]);
  return shape;
}

Eigen::VectorXd values_of(const Section& section) {
  Eigen::VectorXd values(static_cast<Eigen::Index>(section.count));
  for (std::size_t i = 0; i < section.count; ++i)
    values[static_cast<Eigen::Index>(i)] = double{section.level[i]};
  return values;
}

/// Weight of each level at each sample.
Eigen::MatrixX4d shares(const Section& section, const Shape& x) {
  const ProfileShape shape = shape_of(x);
  Eigen::MatrixX4d share(static_cast<Eigen::Index>(section.count), 4);
  for (std::size_t i = 0; i < section.count; ++i) {
    const auto [enter, leave, hollow] = shape.at(section.place(i) - x[0]);
    share.row(static_cast<Eigen::Index>(i)) << 1 - enter, enter - leave - hollow, leave, hollow;
  }
  return share;
}

Levels best_levels(const Eigen::MatrixX4d& share, const Eigen::VectorXd& values) {
  return share.colPivHouseholderQr().solve(values);
}

/// Residuals of the section at the best levels, and the deviation of the blur from the start's.
struct Residual {
  using Scalar = double;
  using InputType = Eigen::VectorXd;
  using ValueType = Eigen::VectorXd;
  using JacobianType = Eigen::MatrixXd;
  enum { InputsAtCompileTime = Eigen::Dynamic, ValuesAtCompileTime = Eigen::Dynamic };

  const Section& section;
  Eigen::VectorXd seen;
  Shape start;
  int free;  // of its numbers, the first ones
  double prior;

  [[nodiscard]] Shape shape(const Eigen::VectorXd& x) const {
    Shape all = start;
    all.head(free) = x;
    return all;
  }
  [[nodiscard]] int inputs() const { return free; }
  [[nodiscard]] int values() const { return static_cast<int>(section.count) + 1; }
  int operator()(const Eigen::VectorXd& x, Eigen::VectorXd& left_over) const {
    const Shape tried = shape(x);
    const Eigen::MatrixX4d share = shares(section, tried);
    left_over.head(seen.size()) = seen - share * best_levels(share, seen);
    left_over[seen.size()] = prior * (tried[3] - start[3]);
    return 0;
  }
};

/// True if the fit stayed near its start and shows two lines.
bool plausible(const Shape& x, const Shape& start) {
  const ProfileShape shape = shape_of(x);
  return x.allFinite() && std::abs(x[0]) <= 0.5 * shape_of(start).half_width &&
         2 * shape.half_width <= kWidestDouble && shape.half_hollow > 0.25 && x[3] < start[3] + 1;
}

/// Both lines stand out from their sides, and from what is between them.
bool shows_two(const ProfileShape& shape, const Levels& level, double sign, double& contrast) {
  const auto at = [&](double d) { return shape.at(d).level(level[0], level[1], level[2], level[3]); };
  const double line = (shape.half_width + shape.half_hollow) / 2;
  const double lower = std::min(sign * at(line), sign * at(-line));
  contrast = (at(line) + at(-line)) / 2 - (level[0] + level[2]) / 2;
  const double least = kLeastDip * std::abs(contrast);
  return sign * contrast > 0 && lower - sign * at(0) > least && lower - sign * level[0] > least &&
         lower - sign * level[2] > least;
}

}  // namespace

std::optional<Patch> fit_double_ridge(const cv::Mat& levels, const Patch& start, std::span<const Rib> ribs,
                                      double noise, DoubleFit fit) {
  const double reach = start.width / 2 + kBeyond + 2 * start.blur;
  const auto half =
      std::min(static_cast<std::size_t>(std::ceil(reach / kSampleStep)), (kMostSamples - 1) / 2);
  const Sections sections = sample_sections(levels, ribs, 2 * half + 1, kColourAxes[0]);
  const double start_blur = std::hypot(start.blur, std::sqrt(kInterpolationVariance));
  const Shape from(
      0, std::log(std::max(start.hollow, 0.5)),
      std::log(std::max((start.width - start.hollow) / 2 - kThinnest, fit == DoubleFit::all ? 0.2 : 1e-6)),
      std::log(start_blur));
  const Residual residual{sections.seen, values_of(sections.seen), from, fit == DoubleFit::all ? 4 : 2,
                          std::sqrt(section_variance(ribs, noise)) / kBlurSpread};
  Eigen::NumericalDiff<Residual> model(residual);
  Eigen::LevenbergMarquardt<Eigen::NumericalDiff<Residual>> solver(model);
  solver.parameters.maxfev = 200;
  Eigen::VectorXd free = from.head(residual.free);
  solver.minimize(free);
  const Shape x = residual.shape(free);
  if (!plausible(x, from)) return std::nullopt;

  const Eigen::MatrixX4d share = shares(sections.seen, x);
  const ProfileShape shape = shape_of(x);
  Patch patch = start;
  const double sign = start.contrast >= 0 ? 1 : -1;
  if (!shows_two(shape, best_levels(share, residual.seen), sign, patch.contrast)) return std::nullopt;
  patch.type = graph::PatchType::double_ridge;
  patch.position = start.position + graph::Point{-std::sin(start.theta), std::cos(start.theta)} * x[0];
  patch.width = 2 * shape.half_width;
  patch.hollow = 2 * shape.half_hollow;
  patch.blur = std::sqrt(std::max(shape.blur * shape.blur - kInterpolationVariance, kLeastBlur * kLeastBlur));
  for (std::size_t c = 0; c < 3; ++c) {
    const bool grey = levels.channels() == 1;
    const Levels own = best_levels(share, grey ? residual.seen : values_of(sections.channel[c]));
    patch.left[c] = static_cast<float>(own[0]), patch.middle[c] = static_cast<float>(own[1]);
    patch.right[c] = static_cast<float>(own[2]), patch.between[c] = static_cast<float>(own[3]);
  }
  return patch;
}

}  // namespace emberfold::sketch
