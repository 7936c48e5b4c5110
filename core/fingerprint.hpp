// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <cstdio>
#include <string>
#include <string_view>

namespace emberfold::core {

/// Hashes texts to 128 bits, by two sums of FNV-1a (Fowler, Noll & Vo 1991) with different initial values:
/// equal texts in equal order give equal hashes. Detects accidental changes, not deliberate collisions.
class Fingerprint {
 public:
  /// Adds one text. Two texts hash differently from their concatenation.
  Fingerprint& add(std::string_view text) {
    for (const char c : text) mix(static_cast<unsigned char>(c));
    for (std::uint64_t length = text.size(), i = 0; i < 8; ++i, length >>= 8) mix(length & 0xff);
    return *this;
  }
  /// Returns 32 hexadecimal digits.
  [[nodiscard]] std::string text() const {
    std::array<char, 33> digits{};
    std::snprintf(digits.data(), digits.size(), "%016llx%016llx", static_cast<unsigned long long>(sums_[0]),
                  static_cast<unsigned long long>(sums_[1]));
    return digits.data();
  }

 private:
  void mix(std::uint64_t byte) {
    for (auto& sum : sums_) sum = (sum ^ byte) * 0x100000001b3ULL;
  }
  std::array<std::uint64_t, 2> sums_{0xcbf29ce484222325ULL, 0x9ae16a3b2f90404fULL};
};

}  // namespace emberfold::core
