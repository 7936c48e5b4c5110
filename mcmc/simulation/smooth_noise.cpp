// SPDX-License-Identifier: Apache-2.0
#include "mcmc/simulation/smooth_noise.hpp"

#include <array>
#include <cmath>
#include <numbers>
#include <unordered_map>

#include "core/rng.hpp"
#include "mcmc/simulation/rounding.hpp"

namespace emberfold::mcmc::detail {

namespace {

using graph::Point;

// Field of one step, standard normal at every place with the correlation exp(−h²/2 range²): white noise on a
// lattice, weighted by Gaussians.
class NoiseField {
 public:
  NoiseField(double range, std::uint64_t seed, std::uint32_t field, std::uint32_t purpose_and_step,
             int components)
      : reach_(range / std::numbers::sqrt2),
        seed_(seed),
        field_(field),
        key_(purpose_and_step),
        components_(components) {}

  std::array<double, 2> at(Point p) {
    const double u = p.x / reach_, v = p.y / reach_;
    const auto x0 = static_cast<int>(std::floor(u / spacing)) - 1,
               y0 = static_cast<int>(std::floor(v / spacing)) - 1;
    std::array<double, 4> across{}, down{};
    double power_x = 0, power_y = 0;
    for (std::size_t i = 0; i < 4; ++i) {
      const double dx = u - spacing * (x0 + static_cast<int>(i)),
                   dy = v - spacing * (y0 + static_cast<int>(i));
      across[i] = std::exp(-0.5 * dx * dx), down[i] = std::exp(-0.5 * dy * dy);
      power_x += across[i] * across[i], power_y += down[i] * down[i];
    }
    std::array<double, 2> sum{};
    for (int y = 0; y < 4; ++y)
      for (int x = 0; x < 4; ++x) {
        const double weight = across[static_cast<std::size_t>(x)] * down[static_cast<std::size_t>(y)];
        const auto& white = node(x0 + x, y0 + y);
        for (std::size_t c = 0; c < 2; ++c) sum[c] += weight * white[c];
      }
    for (double& value : sum) value /= std::sqrt(power_x * power_y);
    return sum;
  }

 private:
  static constexpr double spacing = 1.25;  // of the lattice, in reaches

  const std::array<double, 2>& node(int x, int y) {
    const auto key = (static_cast<std::uint32_t>(x) << 16U) ^ (static_cast<std::uint32_t>(y) & 0xffffU);
    const auto [found, is_new] = nodes_.try_emplace(key);
    if (is_new) {
      core::Rng rng(seed_, {field_, key, key_});
      for (int c = 0; c < components_; ++c) found->second[static_cast<std::size_t>(c)] = rng.normal();
    }
    return found->second;
  }
  double reach_;
  std::uint64_t seed_;
  std::uint32_t field_, key_;
  int components_;
  std::unordered_map<std::uint32_t, std::array<double, 2>> nodes_;  // looked up, never walked through
};

constexpr double finest_range = 3;  // px: below it neighbours have nothing in common

}  // namespace

std::vector<PatchNoise> draw_noise(const SimulatedStrokes& p, const MotionModel& model, std::uint64_t seed,
                                   Purpose purpose, std::uint32_t step, std::uint32_t field) {
  const auto key = [&](std::uint32_t which) {
    return (step << 4U) | (static_cast<std::uint32_t>(purpose) << 1U) | which;
  };
  NoiseField displacement(model.displacement.range, seed, field, key(0), 2),
      gain(model.contrast.range, seed, field, key(1), 1);
  std::vector<PatchNoise> result;
  for (std::size_t i = 0; i < p.list.size(); ++i) {
    const Point place = p.list[i].rest.position;
    core::Rng alone(seed, {p.ids[i], 0, key(8)});
    PatchNoise noise;
    if (model.displacement.range >= finest_range) {
      const auto [x, y] = displacement.at(place);
      noise.x = x, noise.y = y;
    } else {
      noise.x = alone.normal(), noise.y = alone.normal();
    }
    noise.gain = model.contrast.range >= finest_range ? gain.at(place)[0] : alone.normal();
    result.push_back({rounded(noise.x), rounded(noise.y), rounded(noise.gain)});
  }
  return result;
}

}  // namespace emberfold::mcmc::detail
