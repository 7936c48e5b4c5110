// SPDX-License-Identifier: Apache-2.0
#pragma once

// Marks a function whose loops are compiled for wider vectors too, where the compiler and the system can
// choose between versions when the program starts. All versions give the same bits: sums are of whole numbers
// or element by element, and nothing is contracted.
#if defined(__x86_64__) && defined(__GLIBC__) && defined(__GNUC__) && !defined(__clang__) && \
    !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define EMBERFOLD_VECTOR_PASS __attribute__((target_clones("avx2", "default")))
#else
#define EMBERFOLD_VECTOR_PASS
#endif
