// SPDX-License-Identifier: Apache-2.0
#include "sketch/detection/weighted_rows.hpp"

#include "core/math/simd_clones.hpp"

namespace emberfold::sketch {

namespace {

// Two pairs at a time: the sums stay in the nearest cache.
EMBERFOLD_SIMD_CLONES void weigh(const float* const* before, const float* const* after, const float* weight,
                                 int taps, int width, float* __restrict out) {
  const float* middle = before[0];
  for (int x = 0; x < width; ++x) out[x] = weight[0] * middle[x];
  int i = 1;
  for (; i + 1 < taps; i += 2) {
    const float *a = before[i], *b = after[i], *c = before[i + 1], *d = after[i + 1];
    const float w = weight[i], v = weight[i + 1];
    for (int x = 0; x < width; ++x) out[x] = (out[x] + w * (a[x] + b[x])) + v * (c[x] + d[x]);
  }
  for (; i < taps; ++i) {
    const float *a = before[i], *b = after[i];
    const float w = weight[i];
    for (int x = 0; x < width; ++x) out[x] += w * (a[x] + b[x]);
  }
}

}  // namespace

void weigh_rows(const float* const* before, const float* const* after, const float* weight, int taps,
                int width, float* out) {
  weigh(before, after, weight, taps, width, out);
}

}  // namespace emberfold::sketch
