// SPDX-License-Identifier: Apache-2.0
#pragma once

// EMBERFOLD_SIMD_CLONES marks a function that is compiled twice on x86-64 with glibc (g++, clang from 14):
// for the baseline and for AVX2. The program chooses when it starts. Both versions give the same bits:
// floating-point operations are neither contracted (-ffp-contract=off) nor reordered, and integer sums are
// exact in any order. Sanitizers do not support the choice.
#if defined(__has_feature)
#define EMBERFOLD_SANITIZER_FEATURE (__has_feature(address_sanitizer) || __has_feature(thread_sanitizer))
#else
#define EMBERFOLD_SANITIZER_FEATURE 0
#endif
#if defined(__x86_64__) && defined(__GLIBC__) && __has_attribute(target_clones) && \
    !EMBERFOLD_SANITIZER_FEATURE && !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define EMBERFOLD_SIMD_CLONES __attribute__((target_clones("avx2", "default")))
#else
#define EMBERFOLD_SIMD_CLONES
#endif
#undef EMBERFOLD_SANITIZER_FEATURE
