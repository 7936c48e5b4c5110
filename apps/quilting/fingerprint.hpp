// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace emberfold::apps {

/// Hashes a sequence of whole numbers (FNV-1a) to identify what a checkpoint belongs to.
struct Fingerprint {
  std::uint64_t sum = 1469598103934665603ULL;
  void add(std::uint64_t value) { sum = (sum ^ value) * 1099511628211ULL; }
};

}  // namespace emberfold::apps
