// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include <opencv2/core/mat.hpp>

#include "core/context.hpp"
#include "sketch/texture/texture_regions.hpp"

namespace emberfold::sketch {

struct JuleszOptions {
  int sweeps = 30;        ///< 1…10000, over all free pixels
  double hottest = 2;     ///< > 0: temperature of the first sweep; 1 is what sampling alone would leave
  double coldest = 0.02;  ///< > 0, ≤ hottest: of the last
  std::uint64_t seed = 1;
  void validate() const;
};

struct JuleszResult {
  cv::Mat levels;     ///< CV_32F, channels as given
  double before = 0;  ///< histogram distance of the start from what is asked, 0…1: see histogram_distance
  double after = 0;   ///< of the result; both weighted with the parts' responses
};

/// Draws the free pixels (those of a part) anew such that in every part of a region the responses of the
/// texture filters have the histograms that `regions` holds, the other pixels being held as the boundary: a
/// sample of the Julesz ensemble by single-pixel Metropolis updates, annealed geometrically in temperature,
///     E = Σ over parts, filters, bins of (n − n₀)² / (n₀ + ½ + N/1000),
/// n and n₀ being the counts in the sample and asked for, N the part's pixels. Grain, ripples, foam come
/// out like the observed; regular patterns of high contrast (a fence, brick) freeze half-way, as they do with
/// single-pixel updates: efros_leung() is for those. Contrast that is wider than the filters and was not
/// sketched comes out as grain and specks of that contrast. `start`: CV_32F, 1 or 3 channels, finite, of the
/// labels' size, with the held pixels and something to begin with elsewhere, the diffusion's result best:
/// what is wider than the filters stays as it begins. InputError otherwise. Free pixels get whole luma levels
/// 0…255; in colour they keep the start's differences between channels as far as 0…255 allows. Held ones come
/// back bit for bit.
///
/// Responses are whole numbers and are updated, never computed again: about 280 additions a proposal. Random
/// numbers depend on (seed, sweep, pixel). One thread; progress as "julesz". Throws
/// core::Cancelled between sweeps. Zhu, Wu & Mumford 1998 (FRAME); Zhu, Liu & Wu 2000, "Exploring texture ensembles
/// by efficient Markov chain Monte Carlo".
JuleszResult julesz(const cv::Mat& start, const TextureRegions& regions, const JuleszOptions& options = {},
                    const core::Context& context = {});

}  // namespace emberfold::sketch
