// SPDX-License-Identifier: Apache-2.0
#include "apps/builtin/wind.hpp"

#include <cmath>
#include <numeric>

#include "apps/builtin/style.hpp"

namespace emberfold::apps {

namespace {

constexpr int settle = 150;          // frames simulated before the first that is used
constexpr double bump_spacing = 70;  // px between the centres of the gusts that neighbours share
constexpr double shared = 0.96;      // share of the displacement's variance due to these gusts

}  // namespace

Wind::Wind(const BuiltinOptions& options)
    : columns_(static_cast<int>(options.width / bump_spacing) + 2),
      rows_(static_cast<int>(options.height / bump_spacing) + 2) {
  const auto bumps = static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_);
  for (int t = 0; t < options.frames + settle; ++t) {
    core::Rng rng(options.seed,
                  {static_cast<std::uint32_t>(Purpose::wind), static_cast<std::uint32_t>(t), 0});
    for (std::size_t i = 0; i < bumps; ++i) {
      auto& gust = gusts_.emplace_back();
      for (double& push : gust) push = rng.normal();
    }
  }
}

std::vector<std::array<double, 3>> Wind::sway(const Body& body, int first, int last,
                                              const std::array<double, 3>& sd, core::Rng rng) const {
  const cv::Point2d at = body.curves[0].points[body.curves[0].points.size() / 2];
  std::vector<double> weights;
  for (int r = 0; r < rows_; ++r)
    for (int c = 0; c < columns_; ++c) {
      const double dx = at.x / bump_spacing - c, dy = at.y / bump_spacing - r;
      weights.push_back(std::exp(-(dx * dx + dy * dy)));
    }
  const double norm = std::sqrt(std::inner_product(weights.begin(), weights.end(), weights.begin(), 0.0));
  // Stationary variance of an AR(2) with unit noise.
  const double a = body.ar[0], b = body.ar[1];
  const double variance = (1 - b) / ((1 + b) * ((1 - b) * (1 - b) - a * a));
  std::array<double, 3> now{}, before{};
  std::vector<std::array<double, 3>> modes;
  for (int t = first - settle; t <= last; ++t) {
    std::array<double, 3> push{};
    const auto* const gust = &gusts_[static_cast<std::size_t>(t + settle) * weights.size()];
    for (std::size_t i = 0; i < weights.size(); ++i)
      for (std::size_t m = 0; m < 3 && weights[i] > 1e-6; ++m) push[m] += weights[i] / norm * gust[i][m];
    for (std::size_t m = 0; m < 3; ++m) {
      const double noise = std::sqrt(shared) * push[m] + std::sqrt(1 - shared) * rng.normal();
      const double next = a * now[m] + b * before[m] + sd[m] / std::sqrt(variance) * noise;
      before[m] = now[m];
      now[m] = next;
    }
    if (t >= first) modes.push_back(now);
  }
  return modes;
}

}  // namespace emberfold::apps
