// SPDX-License-Identifier: Apache-2.0
// The switch of the deliberate faults, for the copy of the sources that scripts/test-mutants makes. Nothing
// else includes it.
#pragma once

#include <cstdlib>

// NOLINTNEXTLINE: read once, before main.
inline const long emberfold_chosen_fault =
    std::getenv("EMBERFOLD_FAULT") ? std::atol(std::getenv("EMBERFOLD_FAULT")) : 0;

/// Returns whether this fault is on.
inline bool emberfold_fault(long number) {
  return emberfold_chosen_fault == number;
}
