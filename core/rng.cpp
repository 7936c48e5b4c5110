// SPDX-License-Identifier: Apache-2.0
#include "core/rng.hpp"

#include <cmath>
#include <numbers>
#include <string>

#include "core/error.hpp"

namespace emberfold::core {

std::array<std::uint32_t, 4> philox4x32(std::array<std::uint32_t, 4> counter,
                                        std::array<std::uint32_t, 2> key) {
  constexpr std::uint64_t kMultiplier0 = 0xD2511F53, kMultiplier1 = 0xCD9E8D57;
  constexpr std::uint32_t kWeyl0 = 0x9E3779B9, kWeyl1 = 0xBB67AE85;
  for (int round = 0; round < 10; ++round) {
    const std::uint64_t p0 = kMultiplier0 * counter[0], p1 = kMultiplier1 * counter[2];
    counter = {static_cast<std::uint32_t>(p1 >> 32) ^ counter[1] ^ key[0], static_cast<std::uint32_t>(p1),
               static_cast<std::uint32_t>(p0 >> 32) ^ counter[3] ^ key[1], static_cast<std::uint32_t>(p0)};
    key[0] += kWeyl0;
    key[1] += kWeyl1;
  }
  return counter;
}

Rng::Rng(std::uint64_t seed, Stream stream)
    : key_{static_cast<std::uint32_t>(seed), static_cast<std::uint32_t>(seed >> 32)},
      counter_{0, stream.a, stream.b, stream.c} {}

void Rng::refill() {
  block_ = philox4x32(counter_, key_);
  ++counter_[0];
  used_ = 0;
}

std::uint32_t Rng::below(std::uint32_t count) {
  if (count == 0) throw InputError("Rng::below: count is 0; allowed is at least 1");
  // Lemire 2019, multiply and reject: a low half below 2^32 mod count would make some results likelier.
  std::uint64_t product = static_cast<std::uint64_t>(bits()) * count;
  if (static_cast<std::uint32_t>(product) < count) {
    const std::uint32_t remainder = static_cast<std::uint32_t>(-count) % count;
    while (static_cast<std::uint32_t>(product) < remainder)
      product = static_cast<std::uint64_t>(bits()) * count;
  }
  return static_cast<std::uint32_t>(product >> 32);
}

int Rng::count(double mean) {
  const double whole = std::floor(mean);
  return static_cast<int>(whole) + (uniform() < mean - whole ? 1 : 0);
}

double Rng::normal() {
  if (has_spare_) {
    has_spare_ = false;
    return spare_normal_;
  }
  const double radius = std::sqrt(-2.0 * std::log(1.0 - uniform()));  // 1 − u is never 0
  const double angle = 2.0 * std::numbers::pi * uniform();
  spare_normal_ = radius * std::sin(angle);
  has_spare_ = true;
  return radius * std::cos(angle);
}

std::size_t Rng::categorical(std::span<const double> weights) {
  double total = 0;
  for (const double w : weights) {
    if (!(w >= 0))
      throw InputError("Rng::categorical: a weight is " + std::to_string(w) + ", must be at least 0");
    total += w;
  }
  if (!(total > 0) || !std::isfinite(total))
    throw InputError("Rng::categorical: the weights sum to " + std::to_string(total) +
                     ", must be positive and finite");
  double left = uniform() * total;
  std::size_t last = 0;
  for (std::size_t i = 0; i < weights.size(); ++i) {
    if (weights[i] <= 0) continue;
    if (left < weights[i]) return i;
    left -= weights[i];
    last = i;
  }
  return last;  // rounding moved the draw past the end
}

}  // namespace emberfold::core
