// SPDX-License-Identifier: Apache-2.0
// The switch of the deliberate faults, for the copy of the sources that scripts/test-mutants makes. Nothing
// else includes it.
#pragma once

#include <cstdlib>

// NOLINTNEXTLINE(concurrency-mt-unsafe): read once, before main.
inline const char* const emberfold_fault_number = std::getenv("EMBERFOLD_FAULT");
inline const long emberfold_chosen_fault =
    emberfold_fault_number != nullptr ? std::atol(emberfold_fault_number) : 0;

/// Returns whether this fault is on.
inline bool emberfold_fault(long number) {
  return emberfold_chosen_fault == number;
}
