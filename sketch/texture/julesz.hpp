// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include <opencv2/core/mat.hpp>

#include "core/context.hpp"
#include "sketch/texture/texture_regions.hpp"

namespace emberfold::sketch {

/// Holds the settings of julesz().
struct JuleszOptions {
  int sweeps = 30;        ///< 1…10000, over all free pixels
  double hottest = 2;     ///< > 0: temperature of the first sweep; 1 is that of plain sampling
  double coldest = 0.02;  ///< > 0, ≤ hottest: temperature of the last sweep
  std::uint64_t seed = 1;
  void validate() const;
};

/// Holds a sample and its distance from the histograms asked for.
struct JuleszResult {
  cv::Mat levels;     ///< CV_32F, channels as given
  double before = 0;  ///< histogram_distance of the start from the histograms asked for, 0…1
  double after = 0;   ///< of the result; both weighted by the parts' responses
};

/// Samples the free pixels (those of a part) from the Julesz ensemble of their part's filter histograms. In
/// every part of a region the responses of the texture filters come to have the histograms that `regions`
/// holds, with the other pixels held as the boundary. Single-pixel Metropolis updates, annealed geometrically
/// in temperature, of
///     E = Σ over parts, filters, bins of (n − n₀)² / (n₀ + ½ + N/1000),
/// n and n₀ being the counts in the sample and asked for, N the part's pixels. Zhu, Wu & Mumford 1998
/// (FRAME); Zhu, Liu & Wu 2000, "Exploring texture ensembles by efficient Markov chain Monte Carlo".
///
/// Grain, ripples and foam come out like the observed. Regular patterns of high contrast (a fence, brick)
/// freeze half-way, as they do with single-pixel updates: efros_leung() is for those. Contrast that is wider
/// than the filters and was not sketched comes out as grain of that contrast.
///
/// `start`: CV_32F, 1 or 3 channels, finite, of the labels' size; held pixels and first levels elsewhere,
/// best those of the diffusion, since structure wider than the filters is kept. Throws core::InputError
/// otherwise. Free pixels get whole luma levels 0…255; in colour they keep the start's differences between
/// channels as far as 0…255 allows. Held pixels come back bit for bit. Responses are updated, never computed
/// again: about 280 additions a proposal. Random numbers depend on (seed, sweep, pixel). One thread; progress
/// as "julesz". Throws core::Cancelled between sweeps.
JuleszResult julesz(const cv::Mat& start, const TextureRegions& regions, const JuleszOptions& options = {},
                    const core::Context& context = {});

}  // namespace emberfold::sketch
