// SPDX-License-Identifier: Apache-2.0
#include "dytex/learning/kernels.hpp"

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

/// sums[j · stride] += the sum of the j-th register's lanes.
EMBERFOLD_AVX2 inline void add_four(__m256i a, __m256i b, __m256i c, __m256i d, double* sums,
                                    std::size_t stride) {
  const __m256i four = _mm256_hadd_epi32(_mm256_hadd_epi32(a, b), _mm256_hadd_epi32(c, d));
  alignas(16) std::array<std::int32_t, 4> each{};
  _mm_store_si128(reinterpret_cast<__m128i*>(each.data()),
                  _mm_add_epi32(_mm256_castsi256_si128(four), _mm256_extracti128_si256(four, 1)));
  for (std::size_t j = 0; j < each.size(); ++j) sums[j * stride] += each[j];
}

// The sums have names, since the compiler keeps arrays of registers in memory.
EMBERFOLD_AVX2 void dot_avx2(const std::int16_t* left, const std::int16_t* right, double* sums,
                             std::size_t stride) {
  __m256i s00 = _mm256_setzero_si256(), s01 = s00, s02 = s00, s03 = s00, s10 = s00, s11 = s00, s12 = s00,
          s13 = s00, s20 = s00, s21 = s00, s22 = s00, s23 = s00;
  for (std::size_t p = 0; p < kDotLength; p += 16) {
    const __m256i a0 = load_256(left + p), a1 = load_256(left + kDotLength + p),
                  a2 = load_256(left + 2 * kDotLength + p);
    __m256i b = load_256(right + p);
    s00 = _mm256_add_epi32(s00, _mm256_madd_epi16(a0, b));
    s10 = _mm256_add_epi32(s10, _mm256_madd_epi16(a1, b));
    s20 = _mm256_add_epi32(s20, _mm256_madd_epi16(a2, b));
    b = load_256(right + kDotLength + p);
    s01 = _mm256_add_epi32(s01, _mm256_madd_epi16(a0, b));
    s11 = _mm256_add_epi32(s11, _mm256_madd_epi16(a1, b));
    s21 = _mm256_add_epi32(s21, _mm256_madd_epi16(a2, b));
    b = load_256(right + 2 * kDotLength + p);
    s02 = _mm256_add_epi32(s02, _mm256_madd_epi16(a0, b));
    s12 = _mm256_add_epi32(s12, _mm256_madd_epi16(a1, b));
    s22 = _mm256_add_epi32(s22, _mm256_madd_epi16(a2, b));
    b = load_256(right + 3 * kDotLength + p);
    s03 = _mm256_add_epi32(s03, _mm256_madd_epi16(a0, b));
    s13 = _mm256_add_epi32(s13, _mm256_madd_epi16(a1, b));
    s23 = _mm256_add_epi32(s23, _mm256_madd_epi16(a2, b));
  }
  add_four(s00, s01, s02, s03, sums, stride);
  add_four(s10, s11, s12, s13, sums + 1, stride);
  add_four(s20, s21, s22, s23, sums + 2, stride);
}

EMBERFOLD_AVX512 inline void add_one(__m512i register_sum, double* sum) {
  alignas(64) std::array<std::int32_t, 16> lanes{};
  _mm512_store_si512(lanes.data(), register_sum);
  *sum += std::accumulate(lanes.begin(), lanes.end(), 0);
}

EMBERFOLD_AVX512 void dot_avx512(const std::int16_t* left, const std::int16_t* right, double* sums,
                                 std::size_t stride) {
  __m512i s00 = _mm512_setzero_si512(), s01 = s00, s02 = s00, s03 = s00, s10 = s00, s11 = s00, s12 = s00,
          s13 = s00, s20 = s00, s21 = s00, s22 = s00, s23 = s00;
  for (std::size_t p = 0; p < kDotLength; p += 32) {
    const __m512i a0 = _mm512_loadu_si512(left + p), a1 = _mm512_loadu_si512(left + kDotLength + p),
                  a2 = _mm512_loadu_si512(left + 2 * kDotLength + p);
    __m512i b = _mm512_loadu_si512(right + p);
    s00 = _mm512_add_epi32(s00, _mm512_madd_epi16(a0, b));
    s10 = _mm512_add_epi32(s10, _mm512_madd_epi16(a1, b));
    s20 = _mm512_add_epi32(s20, _mm512_madd_epi16(a2, b));
    b = _mm512_loadu_si512(right + kDotLength + p);
    s01 = _mm512_add_epi32(s01, _mm512_madd_epi16(a0, b));
    s11 = _mm512_add_epi32(s11, _mm512_madd_epi16(a1, b));
    s21 = _mm512_add_epi32(s21, _mm512_madd_epi16(a2, b));
    b = _mm512_loadu_si512(right + 2 * kDotLength + p);
    s02 = _mm512_add_epi32(s02, _mm512_madd_epi16(a0, b));
    s12 = _mm512_add_epi32(s12, _mm512_madd_epi16(a1, b));
    s22 = _mm512_add_epi32(s22, _mm512_madd_epi16(a2, b));
    b = _mm512_loadu_si512(right + 3 * kDotLength + p);
    s03 = _mm512_add_epi32(s03, _mm512_madd_epi16(a0, b));
    s13 = _mm512_add_epi32(s13, _mm512_madd_epi16(a1, b));
    s23 = _mm512_add_epi32(s23, _mm512_madd_epi16(a2, b));
  }
  add_one(s00, sums), add_one(s10, sums + 1), add_one(s20, sums + 2);
  sums += stride;
  add_one(s01, sums), add_one(s11, sums + 1), add_one(s21, sums + 2);
  sums += stride;
  add_one(s02, sums), add_one(s12, sums + 1), add_one(s22, sums + 2);
  sums += stride;
  add_one(s03, sums), add_one(s13, sums + 1), add_one(s23, sums + 2);
}

/// One slice times one panel.
EMBERFOLD_AVX2 void panel_avx2(const float* slice, const float* panel, std::size_t depth, float* out,
                               std::size_t stride) {
  for (std::size_t half = 0; half < kSlice; half += 16, slice += 16, out += 16) {
    __m256 a0 = _mm256_loadu_ps(out), b0 = _mm256_loadu_ps(out + 8);
    __m256 a1 = _mm256_loadu_ps(out + stride), b1 = _mm256_loadu_ps(out + stride + 8);
    __m256 a2 = _mm256_loadu_ps(out + 2 * stride), b2 = _mm256_loadu_ps(out + 2 * stride + 8);
    __m256 a3 = _mm256_loadu_ps(out + 3 * stride), b3 = _mm256_loadu_ps(out + 3 * stride + 8);
    __m256 a4 = _mm256_loadu_ps(out + 4 * stride), b4 = _mm256_loadu_ps(out + 4 * stride + 8);
    __m256 a5 = _mm256_loadu_ps(out + 5 * stride), b5 = _mm256_loadu_ps(out + 5 * stride + 8);
    for (std::size_t t = 0; t < depth; ++t) {
      const __m256 a = _mm256_loadu_ps(slice + t * kSlice), b = _mm256_loadu_ps(slice + t * kSlice + 8);
      const float* weights = panel + t * kPanel;
      __m256 w = _mm256_broadcast_ss(weights + 0);
      a0 = _mm256_fmadd_ps(a, w, a0), b0 = _mm256_fmadd_ps(b, w, b0);
      w = _mm256_broadcast_ss(weights + 1);
      a1 = _mm256_fmadd_ps(a, w, a1), b1 = _mm256_fmadd_ps(b, w, b1);
      w = _mm256_broadcast_ss(weights + 2);
      a2 = _mm256_fmadd_ps(a, w, a2), b2 = _mm256_fmadd_ps(b, w, b2);
      w = _mm256_broadcast_ss(weights + 3);
      a3 = _mm256_fmadd_ps(a, w, a3), b3 = _mm256_fmadd_ps(b, w, b3);
      w = _mm256_broadcast_ss(weights + 4);
      a4 = _mm256_fmadd_ps(a, w, a4), b4 = _mm256_fmadd_ps(b, w, b4);
      w = _mm256_broadcast_ss(weights + 5);
      a5 = _mm256_fmadd_ps(a, w, a5), b5 = _mm256_fmadd_ps(b, w, b5);
    }
    _mm256_storeu_ps(out, a0), _mm256_storeu_ps(out + 8, b0);
    _mm256_storeu_ps(out + stride, a1), _mm256_storeu_ps(out + stride + 8, b1);
    _mm256_storeu_ps(out + 2 * stride, a2), _mm256_storeu_ps(out + 2 * stride + 8, b2);
    _mm256_storeu_ps(out + 3 * stride, a3), _mm256_storeu_ps(out + 3 * stride + 8, b3);
    _mm256_storeu_ps(out + 4 * stride, a4), _mm256_storeu_ps(out + 4 * stride + 8, b4);
    _mm256_storeu_ps(out + 5 * stride, a5), _mm256_storeu_ps(out + 5 * stride + 8, b5);
  }
}

EMBERFOLD_AVX512 void panel_avx512(const float* slice, const float* panel, std::size_t depth, float* out,
                                   std::size_t stride) {
  __m512 a0 = _mm512_loadu_ps(out), b0 = _mm512_loadu_ps(out + 16);
  __m512 a1 = _mm512_loadu_ps(out + stride), b1 = _mm512_loadu_ps(out + stride + 16);
  __m512 a2 = _mm512_loadu_ps(out + 2 * stride), b2 = _mm512_loadu_ps(out + 2 * stride + 16);
  __m512 a3 = _mm512_loadu_ps(out + 3 * stride), b3 = _mm512_loadu_ps(out + 3 * stride + 16);
  __m512 a4 = _mm512_loadu_ps(out + 4 * stride), b4 = _mm512_loadu_ps(out + 4 * stride + 16);
  __m512 a5 = _mm512_loadu_ps(out + 5 * stride), b5 = _mm512_loadu_ps(out + 5 * stride + 16);
  for (std::size_t t = 0; t < depth; ++t) {
    const __m512 a = _mm512_loadu_ps(slice + t * kSlice), b = _mm512_loadu_ps(slice + t * kSlice + 16);
    const float* weights = panel + t * kPanel;
    __m512 w = _mm512_set1_ps(weights[0]);
    a0 = _mm512_fmadd_ps(a, w, a0), b0 = _mm512_fmadd_ps(b, w, b0);
    w = _mm512_set1_ps(weights[1]);
    a1 = _mm512_fmadd_ps(a, w, a1), b1 = _mm512_fmadd_ps(b, w, b1);
    w = _mm512_set1_ps(weights[2]);
    a2 = _mm512_fmadd_ps(a, w, a2), b2 = _mm512_fmadd_ps(b, w, b2);
    w = _mm512_set1_ps(weights[3]);
    a3 = _mm512_fmadd_ps(a, w, a3), b3 = _mm512_fmadd_ps(b, w, b3);
    w = _mm512_set1_ps(weights[4]);
    a4 = _mm512_fmadd_ps(a, w, a4), b4 = _mm512_fmadd_ps(b, w, b4);
    w = _mm512_set1_ps(weights[5]);
    a5 = _mm512_fmadd_ps(a, w, a5), b5 = _mm512_fmadd_ps(b, w, b5);
  }
  _mm512_storeu_ps(out, a0), _mm512_storeu_ps(out + 16, b0);
  _mm512_storeu_ps(out + stride, a1), _mm512_storeu_ps(out + stride + 16, b1);
  _mm512_storeu_ps(out + 2 * stride, a2), _mm512_storeu_ps(out + 2 * stride + 16, b2);
  _mm512_storeu_ps(out + 3 * stride, a3), _mm512_storeu_ps(out + 3 * stride + 16, b3);
  _mm512_storeu_ps(out + 4 * stride, a4), _mm512_storeu_ps(out + 4 * stride + 16, b4);
  _mm512_storeu_ps(out + 5 * stride, a5), _mm512_storeu_ps(out + 5 * stride + 16, b5);
}

/// The lanes of twelve sums: that of left a and right b at 4 a + b.
struct TwelveSums {
  alignas(32) std::array<std::array<float, kLanes>, 12> lanes;
};

/// Twelve inner products at once.
EMBERFOLD_AVX2 void twelve_products(const std::array<const float*, 3>& left,
                                    const std::array<const float*, 4>& right, std::size_t count,
                                    std::size_t step, TwelveSums& sums) {
  __m256 s00 = _mm256_setzero_ps(), s01 = s00, s02 = s00, s03 = s00, s10 = s00, s11 = s00, s12 = s00,
         s13 = s00, s20 = s00, s21 = s00, s22 = s00, s23 = s00;
  for (std::size_t slice = 0; slice < count; ++slice)
    for (std::size_t p = slice * step; p < slice * step + kSlice; p += kLanes) {
      const __m256 a0 = _mm256_loadu_ps(left[0] + p), a1 = _mm256_loadu_ps(left[1] + p),
                   a2 = _mm256_loadu_ps(left[2] + p);
      __m256 b = _mm256_loadu_ps(right[0] + p);
      s00 = _mm256_fmadd_ps(a0, b, s00), s10 = _mm256_fmadd_ps(a1, b, s10), s20 = _mm256_fmadd_ps(a2, b, s20);
      b = _mm256_loadu_ps(right[1] + p);
      s01 = _mm256_fmadd_ps(a0, b, s01), s11 = _mm256_fmadd_ps(a1, b, s11), s21 = _mm256_fmadd_ps(a2, b, s21);
      b = _mm256_loadu_ps(right[2] + p);
      s02 = _mm256_fmadd_ps(a0, b, s02), s12 = _mm256_fmadd_ps(a1, b, s12), s22 = _mm256_fmadd_ps(a2, b, s22);
      b = _mm256_loadu_ps(right[3] + p);
      s03 = _mm256_fmadd_ps(a0, b, s03), s13 = _mm256_fmadd_ps(a1, b, s13), s23 = _mm256_fmadd_ps(a2, b, s23);
    }
  float* to = sums.lanes.front().data();
  for (const __m256& sum : {s00, s01, s02, s03, s10, s11, s12, s13, s20, s21, s22, s23}) {
    _mm256_store_ps(to, sum);
    to += kLanes;
  }
}

EMBERFOLD_AVX2 void inner_avx2(const Slices& block, double* products) {
  constexpr std::size_t kLeft = 3, kRight = 4;
  const std::size_t n = block.columns;
  TwelveSums sums{};
  for (std::size_t i = 0; i < n; i += kLeft)
    for (std::size_t j = 0; j < std::min(i + kLeft, n); j += kRight) {
      twelve_products(columns_from<kLeft>(block, i), columns_from<kRight>(block, j), block.count, n * kSlice,
                      sums);
      for (std::size_t a = 0; a < kLeft && i + a < n; ++a)
        for (std::size_t b = 0; b < kRight && j + b <= i + a; ++b) {
          for (const float x : sums.lanes[a * kRight + b])
            products[(j + b) * n + i + a] += static_cast<double>(x);
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
                      out + j * stride + s * kSlice, stride);
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
