// SPDX-License-Identifier: Apache-2.0
#pragma once

// EMBERFOLD_SIMD_CLONES marks a function that is compiled twice on x86-64 with GCC and glibc: for the
// baseline and for AVX2. The program chooses when it starts. Both versions give the same bits: floating-point
// operations are neither contracted (-ffp-contract=off) nor reordered, and integer sums are exact in any
// order.
#if defined(__x86_64__) && defined(__GLIBC__) && defined(__GNUC__) && !defined(__clang__) && \
    !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define EMBERFOLD_SIMD_CLONES __attribute__((target_clones("avx2", "default")))
#else
#define EMBERFOLD_SIMD_CLONES
#endif
