// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace emberfold::sketch {

/// Computes out[x] = weight[0]·before[0][x] + Σ weight[i]·(before[i][x] + after[i][x]) for i from 1 to taps
/// − 1. A pair of equal weight is summed first, so that mirrored rows give the same bits.
void weigh_rows(const float* const* before, const float* const* after, const float* weight, int taps,
                int width, float* out);

}  // namespace emberfold::sketch
