// SPDX-License-Identifier: Apache-2.0
#pragma once

// Marks a function whose loops over rows are compiled for wider vectors too, where the compiler and the
// system can choose between versions when the program starts. All versions give the same bits: no operation
// is contracted or reordered.
#if defined(__x86_64__) && defined(__GLIBC__) && defined(__GNUC__) && !defined(__clang__) && \
    !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define EMBERFOLD_SIMD_CLONES __attribute__((target_clones("avx2", "default")))
#else
#define EMBERFOLD_SIMD_CLONES
#endif
