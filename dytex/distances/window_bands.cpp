// SPDX-License-Identifier: Apache-2.0
#include "dytex/distances/window_bands.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <numbers>
#include <utility>

namespace emberfold::dytex::detail {

namespace {

constexpr int kMostWindows = 1024;
constexpr int kHighest = kSegment / 2 - 1;  // cycles in a segment; half its length has no direction
constexpr double kLeastShare = 1e-5;        // −50 dB: below it compression and rounding dominate
constexpr double kMoving = 0.1, kStrong = 0.95;

double hann(int i, int length) {
  const double s = std::sin(std::numbers::pi * (i + 0.5) / length);
  return s * s;
}

// The band of squared cycles in a window: octaves' three quarters, 1 … 8 cycles.
int width_band(int squared) {
  constexpr std::array<int, 3> kEdges{3, 8, 23};
  return static_cast<int>(std::ranges::upper_bound(kEdges, squared) - kEdges.begin());
}

// Returns 0 for upright stripes … 3 for level ones. Mirrored waves are one.
int slant(int fx, int fy) {
  const double steep = std::tan(std::numbers::pi / 12), across = std::abs(fx), along = std::abs(fy);
  if (along < steep * across) return 0;
  if (along < across) return 1;
  return along * steep < across ? 2 : 3;
}

// Separates upward from downward motion, but for upright stripes.
int pattern_of(int fx, int fy, bool up) {
  const int s = slant(fx, fy), direction = s == 0 ? 0 : 2 * s - (up ? 1 : 0);
  return width_band(fx * fx + fy * fy) * 7 + direction;
}

// Removes the means, so that constants have no part.
Eigen::MatrixXf without_means(const Eigen::MatrixXd& rows) {
  return (rows.colwise() - rows.rowwise().mean()).cast<float>();
}

WindowTransforms make_transforms() {
  constexpr int kReach = kWindow / 2;
  std::vector<std::pair<int, int>> waves;
  for (int fy = 1 - kReach; fy < kReach; ++fy)
    for (int fx = 0; fx < kReach; ++fx)
      if ((fx > 0 || fy > 0) && fx * fx + fy * fy < kReach * kReach) waves.emplace_back(fx, fy);
  const auto count = static_cast<Eigen::Index>(waves.size());
  WindowTransforms result;
  Eigen::MatrixXd space(2 * count, kWindow * kWindow), cosine(kHighest, kSegment), sine(kHighest, kSegment);
  for (Eigen::Index k = 0; k < count; ++k) {
    const auto [fx, fy] = waves[static_cast<std::size_t>(k)];
    for (int y = 0; y < kWindow; ++y)
      for (int x = 0; x < kWindow; ++x) {
        const double w = hann(x, kWindow) * hann(y, kWindow);
        const double angle = 2 * std::numbers::pi * (fx * x + fy * y) / kWindow;
        space(k, y * kWindow + x) = w * std::cos(angle);
        space(count + k, y * kWindow + x) = -w * std::sin(angle);
      }
    // exp(i(f·x + ωt)) with fy ω > 0 runs up, to smaller y.
    result.pattern.push_back(pattern_of(fx, fy, fy > 0));
    result.turned.push_back(pattern_of(fx, fy, fy < 0));
  }
  for (int f = 1; f <= kHighest; ++f)
    for (int t = 0; t < kSegment; ++t) {
      const double angle = 2 * std::numbers::pi * f * t / kSegment;
      cosine(f - 1, t) = hann(t, kSegment) * std::cos(angle);
      sine(f - 1, t) = -hann(t, kSegment) * std::sin(angle);
    }
  result.space = space.cast<float>();
  result.time_cosine = without_means(cosine).transpose();
  result.time_sine = without_means(sine).transpose();
  return result;
}

}  // namespace

const WindowTransforms& window_transforms() {
  static const WindowTransforms kMade = make_transforms();
  return kMade;
}

int time_band(int cycles) {
  int band = 0;
  while (cycles >= 2 << band) ++band;
  return band;
}

std::vector<int> window_starts(int length, int step) {
  std::vector<int> starts;
  for (int at = length < kWindow ? length : (length - kWindow) % step / 2; at + kWindow <= length; at += step)
    starts.push_back(at);
  return starts;
}

int window_step(int width, int height) {
  int step = kWindow;
  const auto count = [&](int length) { return window_starts(length, step).size(); };
  while (count(width) * count(height) > kMostWindows) step += kWindow;
  return step;
}

double least_energy() {
  const auto& made = window_transforms();
  return 1e-4 * 2 * static_cast<double>(made.space.squaredNorm()) *
         static_cast<double>(made.time_cosine.squaredNorm() + made.time_sine.squaredNorm());
}

std::optional<Eigen::VectorXd> mean_shares(const Eigen::MatrixXd& energies, double least) {
  if (energies.cols() == 0) return std::nullopt;
  const Eigen::VectorXd totals = energies.colwise().sum().transpose();
  Eigen::VectorXd sorted = totals;
  std::ranges::sort(sorted);
  const auto strong = static_cast<Eigen::Index>(kStrong * static_cast<double>(sorted.size() - 1));
  const double moving = std::max(least, kMoving * sorted[strong]);
  Eigen::VectorXd sum = Eigen::VectorXd::Zero(energies.rows());
  int count = 0;
  for (Eigen::Index i = 0; i < totals.size(); ++i) {
    if (!(totals[i] >= moving)) continue;
    sum.array() += 10 * (energies.col(i).array() / totals[i] + kLeastShare).log10();
    ++count;
  }
  if (count == 0) return std::nullopt;
  return sum / count;
}

}  // namespace emberfold::dytex::detail
