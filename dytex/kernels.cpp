// SPDX-License-Identifier: Apache-2.0
#include "dytex/kernels.hpp"

#include <algorithm>
#include <array>
#include <numeric>

#include <opencv2/core/hal/intrin.hpp>

#if defined(__x86_64__) && defined(__GNUC__)
#define EMBERFOLD_X86 1
#include <immintrin.h>
#define EMBERFOLD_AVX2 __attribute__((target("avx2,fma")))
#define EMBERFOLD_AVX512 __attribute__((target("avx512f,avx512bw")))
#endif

namespace emberfold::dytex::detail {

namespace {

constexpr std::size_t kLanes = 8;  // in which sums of add_inner_products() run

/// Three or four columns of a block, the last one again where there are no more.
template <std::size_t kCount>
std::array<const float*, kCount> columns_from(const Slices& block, std::size_t first) {
  std::array<const float*, kCount> result{};
  for (std::size_t k = 0; k < kCount; ++k)
    result[k] = block.data + std::min(first + k, block.columns - 1) * kSlice;
  return result;
}

void dot_baseline(const std::int16_t* left, const std::int16_t* right, double* sums, std::size_t stride) {
  cv::v_int32x4 s[kDotLeft][kDotRight];
  for (auto& row : s)
    for (auto& sum : row) sum = cv::v_setzero_s32();
  for (std::size_t p = 0; p < kDotLength; p += 8) {
    const cv::v_int16x8 a0 = cv::v_load(left + p), a1 = cv::v_load(left + kDotLength + p),
                        a2 = cv::v_load(left + 2 * kDotLength + p);
#pragma GCC unroll 4
    for (std::size_t j = 0; j < kDotRight; ++j) {
      const cv::v_int16x8 b = cv::v_load(right + j * kDotLength + p);
      s[0][j] = cv::v_dotprod(a0, b, s[0][j]);
      s[1][j] = cv::v_dotprod(a1, b, s[1][j]);
      s[2][j] = cv::v_dotprod(a2, b, s[2][j]);
    }
  }
  for (std::size_t i = 0; i < kDotLeft; ++i)
    for (std::size_t j = 0; j < kDotRight; ++j) sums[j * stride + i] += cv::v_reduce_sum(s[i][j]);
}

void product_baseline(const Slices& left, const float* panels, std::size_t columns, float* out,
                      std::size_t stride) {
  for (std::size_t s = 0; s < left.count; ++s) {
    const float* slice = left.data + s * left.columns * kSlice;
    for (std::size_t j = 0; j < columns; ++j) {
      float* to = out + j * stride + s * kSlice;
      const float* weight = panels + j / kPanel * left.columns * kPanel + j % kPanel;
      std::array<float, kSlice> sum{};
      std::copy_n(to, kSlice, sum.begin());
      for (std::size_t t = 0; t < left.columns; ++t)
        for (std::size_t i = 0; i < kSlice; ++i) sum[i] += slice[t * kSlice + i] * weight[t * kPanel];
      std::copy_n(sum.begin(), kSlice, to);
    }
  }
}

void inner_baseline(const Slices& block, double* products) {
  const std::size_t step = block.columns * kSlice;
  for (std::size_t j = 0; j < block.columns; ++j)
    for (std::size_t i = j; i < block.columns; ++i) {
      std::array<float, kLanes> sum{};
      for (std::size_t s = 0; s < block.count; ++s) {
        const float* a = block.data + s * step + i * kSlice;
        const float* b = block.data + s * step + j * kSlice;
        for (std::size_t p = 0; p < kSlice; p += kLanes)
          for (std::size_t k = 0; k < kLanes; ++k) sum[k] += a[p + k] * b[p + k];
      }
      for (const float x : sum) products[j * block.columns + i] += static_cast<double>(x);
    }
}

#ifdef EMBERFOLD_X86

EMBERFOLD_AVX2 inline __m256i load_256(const std::int16_t* from) {
  return _mm256_loadu_si256(reinterpret_cast<const __m256i*>(from));
}

EMBERFOLD_AVX2 void dot_avx2(const std::int16_t* left, const std::int16_t* right, double* sums,
                             std::size_t stride) {
  __m256i s[kDotLeft][kDotRight];
  for (auto& row : s)
    for (auto& sum : row) sum = _mm256_setzero_si256();
  for (std::size_t p = 0; p < kDotLength; p += 16) {
    const __m256i a0 = load_256(left + p), a1 = load_256(left + kDotLength + p),
                  a2 = load_256(left + 2 * kDotLength + p);
#pragma GCC unroll 4
    for (std::size_t j = 0; j < kDotRight; ++j) {
      const __m256i b = load_256(right + j * kDotLength + p);
      s[0][j] = _mm256_add_epi32(s[0][j], _mm256_madd_epi16(a0, b));
      s[1][j] = _mm256_add_epi32(s[1][j], _mm256_madd_epi16(a1, b));
      s[2][j] = _mm256_add_epi32(s[2][j], _mm256_madd_epi16(a2, b));
    }
  }
  for (std::size_t i = 0; i < kDotLeft; ++i) {
    const __m256i four =
        _mm256_hadd_epi32(_mm256_hadd_epi32(s[i][0], s[i][1]), _mm256_hadd_epi32(s[i][2], s[i][3]));
    alignas(16) std::array<std::int32_t, kDotRight> each{};
    _mm_store_si128(reinterpret_cast<__m128i*>(each.data()),
                    _mm_add_epi32(_mm256_castsi256_si128(four), _mm256_extracti128_si256(four, 1)));
    for (std::size_t j = 0; j < kDotRight; ++j) sums[j * stride + i] += each[j];
  }
}

EMBERFOLD_AVX512 void dot_avx512(const std::int16_t* left, const std::int16_t* right, double* sums,
                                 std::size_t stride) {
  __m512i s[kDotLeft][kDotRight];
  for (auto& row : s)
    for (auto& sum : row) sum = _mm512_setzero_si512();
  for (std::size_t p = 0; p < kDotLength; p += 32) {
    const __m512i a0 = _mm512_loadu_si512(left + p), a1 = _mm512_loadu_si512(left + kDotLength + p),
                  a2 = _mm512_loadu_si512(left + 2 * kDotLength + p);
#pragma GCC unroll 4
    for (std::size_t j = 0; j < kDotRight; ++j) {
      const __m512i b = _mm512_loadu_si512(right + j * kDotLength + p);
      s[0][j] = _mm512_add_epi32(s[0][j], _mm512_madd_epi16(a0, b));
      s[1][j] = _mm512_add_epi32(s[1][j], _mm512_madd_epi16(a1, b));
      s[2][j] = _mm512_add_epi32(s[2][j], _mm512_madd_epi16(a2, b));
    }
  }
  for (std::size_t i = 0; i < kDotLeft; ++i)
    for (std::size_t j = 0; j < kDotRight; ++j) {
      alignas(64) std::array<std::int32_t, 16> lanes{};
      _mm512_store_si512(lanes.data(), s[i][j]);
      sums[j * stride + i] += std::accumulate(lanes.begin(), lanes.end(), 0);
    }
}

/// One slice times one panel. Columns of the panel behind the last one are summed for nothing.
EMBERFOLD_AVX2 void panel_avx2(const float* slice, const float* panel, std::size_t depth, float* out,
                               std::size_t stride, std::size_t columns) {
  for (std::size_t half = 0; half < kSlice; half += 16) {
    __m256 s[kPanel][2];
#pragma GCC unroll 6
    for (std::size_t j = 0; j < kPanel; ++j) {
      const float* from = out + std::min(j, columns - 1) * stride + half;
      s[j][0] = _mm256_loadu_ps(from), s[j][1] = _mm256_loadu_ps(from + 8);
    }
    for (std::size_t t = 0; t < depth; ++t) {
      const __m256 a = _mm256_loadu_ps(slice + t * kSlice + half),
                   b = _mm256_loadu_ps(slice + t * kSlice + half + 8);
#pragma GCC unroll 6
      for (std::size_t j = 0; j < kPanel; ++j) {
        const __m256 w = _mm256_broadcast_ss(panel + t * kPanel + j);
        s[j][0] = _mm256_fmadd_ps(a, w, s[j][0]), s[j][1] = _mm256_fmadd_ps(b, w, s[j][1]);
      }
    }
#pragma GCC unroll 6
    for (std::size_t j = 0; j < kPanel; ++j) {
      if (j >= columns) break;
      _mm256_storeu_ps(out + j * stride + half, s[j][0]);
      _mm256_storeu_ps(out + j * stride + half + 8, s[j][1]);
    }
  }
}

EMBERFOLD_AVX512 void panel_avx512(const float* slice, const float* panel, std::size_t depth, float* out,
                                   std::size_t stride, std::size_t columns) {
  __m512 s[kPanel][2];
#pragma GCC unroll 6
  for (std::size_t j = 0; j < kPanel; ++j) {
    const float* from = out + std::min(j, columns - 1) * stride;
    s[j][0] = _mm512_loadu_ps(from), s[j][1] = _mm512_loadu_ps(from + 16);
  }
  for (std::size_t t = 0; t < depth; ++t) {
    const __m512 a = _mm512_loadu_ps(slice + t * kSlice), b = _mm512_loadu_ps(slice + t * kSlice + 16);
#pragma GCC unroll 6
    for (std::size_t j = 0; j < kPanel; ++j) {
      const __m512 w = _mm512_set1_ps(panel[t * kPanel + j]);
      s[j][0] = _mm512_fmadd_ps(a, w, s[j][0]), s[j][1] = _mm512_fmadd_ps(b, w, s[j][1]);
    }
  }
#pragma GCC unroll 6
  for (std::size_t j = 0; j < kPanel; ++j) {
    if (j >= columns) break;
    _mm512_storeu_ps(out + j * stride, s[j][0]);
    _mm512_storeu_ps(out + j * stride + 16, s[j][1]);
  }
}

EMBERFOLD_AVX2 void inner_avx2(const Slices& block, double* products) {
  constexpr std::size_t kLeft = 3, kRight = 4;
  const std::size_t n = block.columns, step = n * kSlice;
  for (std::size_t i = 0; i < n; i += kLeft)
    for (std::size_t j = 0; j < std::min(i + kLeft, n); j += kRight) {
      const auto left = columns_from<kLeft>(block, i);
      const auto right = columns_from<kRight>(block, j);
      __m256 s[kLeft][kRight];
      for (auto& row : s)
        for (auto& sum : row) sum = _mm256_setzero_ps();
      for (std::size_t slice = 0; slice < block.count; ++slice)
        for (std::size_t p = slice * step; p < slice * step + kSlice; p += kLanes) {
          const __m256 a0 = _mm256_loadu_ps(left[0] + p), a1 = _mm256_loadu_ps(left[1] + p),
                       a2 = _mm256_loadu_ps(left[2] + p);
#pragma GCC unroll 4
          for (std::size_t k = 0; k < kRight; ++k) {
            const __m256 b = _mm256_loadu_ps(right[k] + p);
            s[0][k] = _mm256_fmadd_ps(a0, b, s[0][k]);
            s[1][k] = _mm256_fmadd_ps(a1, b, s[1][k]);
            s[2][k] = _mm256_fmadd_ps(a2, b, s[2][k]);
          }
        }
      for (std::size_t a = 0; a < kLeft && i + a < n; ++a)
        for (std::size_t b = 0; b < kRight && j + b <= i + a; ++b) {
          alignas(32) std::array<float, kLanes> lanes{};
          _mm256_store_ps(lanes.data(), s[a][b]);
          for (const float x : lanes) products[(j + b) * n + i + a] += static_cast<double>(x);
        }
    }
}

#endif

}  // namespace

Isa best_isa() {
#ifdef EMBERFOLD_X86
  static const Isa best = [] {
    if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512bw")) return Isa::avx512;
    if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma")) return Isa::avx2;
    return Isa::baseline;
  }();
  return best;
#else
  return Isa::baseline;
#endif
}

void add_dot_products([[maybe_unused]] Isa isa, const std::int16_t* left, const std::int16_t* right,
                      double* sums, std::size_t stride) {
#ifdef EMBERFOLD_X86
  if (isa == Isa::avx512) return dot_avx512(left, right, sums, stride);
  if (isa == Isa::avx2) return dot_avx2(left, right, sums, stride);
#endif
  dot_baseline(left, right, sums, stride);
}

void add_product([[maybe_unused]] Isa isa, const Slices& left, const float* panels, std::size_t columns,
                 float* out, std::size_t stride) {
#ifdef EMBERFOLD_X86
  if (isa != Isa::baseline) {
    const auto panel_product = isa == Isa::avx512 ? panel_avx512 : panel_avx2;
    for (std::size_t s = 0; s < left.count; ++s)
      for (std::size_t j = 0; j < columns; j += kPanel)
        panel_product(left.data + s * left.columns * kSlice, panels + j * left.columns, left.columns,
                      out + j * stride + s * kSlice, stride, std::min(kPanel, columns - j));
    return;
  }
#endif
  product_baseline(left, panels, columns, out, stride);
}

void add_inner_products([[maybe_unused]] Isa isa, const Slices& block, double* products) {
#ifdef EMBERFOLD_X86
  if (isa != Isa::baseline) return inner_avx2(block, products);
#endif
  inner_baseline(block, products);
}

}  // namespace emberfold::dytex::detail
