// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace emberfold::core {

/// Computes one block of Philox4x32-10 (Salmon et al. 2011, "Parallel random numbers: as easy as 1, 2, 3").
std::array<std::uint32_t, 4> philox4x32(std::array<std::uint32_t, 4> counter,
                                        std::array<std::uint32_t, 2> key);

/// Selects one of the 2^96 independent streams of a seed, for example by (sweep, frame, purpose).
struct Stream {
  std::uint32_t a = 0, b = 0, c = 0;
};

/// Generates random numbers that depend only on (seed, stream) and the number of draws.
/// A copy continues from the same position. A stream holds 2^34 draws of 32 bits.
class Rng {
 public:
  explicit Rng(std::uint64_t seed, Stream stream = {});

  /// Draws 32 uniform bits.
  std::uint32_t bits() {
    if (used_ == block_.size()) refill();
    return block_[used_++];
  }
  /// Draws uniformly from [0, 1), a multiple of 2^-53.
  double uniform() {
    const std::uint64_t high = bits() >> 5, low = bits() >> 6;
    return static_cast<double>((high << 26) | low) * 0x1p-53;
  }
  /// Draws uniformly from [low, high).
  double uniform(double low, double high) { return low + (high - low) * uniform(); }
  /// Draws uniformly from {0, …, count − 1}, without bias. Throws InputError for count 0.
  std::uint32_t below(std::uint32_t count);
  /// Draws one of the two whole numbers next to `mean` ≥ 0, which is the mean of many.
  int count(double mean);
  /// Draws from the standard normal distribution (Box & Muller 1958).
  double normal();
  /// Draws i with probability weights[i] / Σ weights.
  /// Throws InputError unless weights are ≥ 0 with a positive finite sum.
  std::size_t categorical(std::span<const double> weights);

 private:
  void refill();

  std::array<std::uint32_t, 2> key_;
  std::array<std::uint32_t, 4> counter_;
  std::array<std::uint32_t, 4> block_{};
  std::size_t used_ = 4;
  double spare_normal_ = 0;
  bool has_spare_ = false;
};

}  // namespace emberfold::core
