// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace emberfold::apps {

/// Makes a number of many, in order, that tells what a checkpoint belongs to (FNV-1a, by whole numbers).
struct Fingerprint {
  std::uint64_t sum = 1469598103934665603ULL;
  void add(std::uint64_t value) { sum = (sum ^ value) * 1099511628211ULL; }
};

}  // namespace emberfold::apps
