// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <string_view>
#include <vector>

#include <opencv2/core/mat.hpp>

namespace emberfold::sketch {

inline constexpr int kTextureFilters = 11;
inline constexpr int kTextureBins = 13;
inline constexpr int kTextureLevel = 128;  ///< Σ |weight| of a filter: response of the first to level 1

/// Holds a linear filter of whole numbers, Σ |weight| about kTextureLevel. All but the first sum to 0. Whole
/// numbers make responses exact, however often they are updated; responses to 0…255 fit into 16 bits.
struct TextureFilter {
  struct Tap {
    int dx, dy, weight;  ///< response(x, y) = Σ weight · level(x + dx, y + dy)
  };
  std::string_view name;
  int radius = 0;  ///< px, at most 3: |dx|, |dy| of the farthest tap
  std::vector<Tap> taps;
};

/// Returns the filters of the texture model.
/// They are: the level itself; the Laplacian of a Gaussian of SD 0.7 px; Gaussian first derivatives along x
/// and y, SD 1; second ones at 0°, 45°, 90°, 135°, SD 1.2; the Laplacian of a Gaussian of SD 1.2; the
/// differences from a pixel to the next along x and y.
std::array<TextureFilter, kTextureFilters> make_texture_filters();

/// Filters CV_8U levels. Returns CV_32S; the border is repeated outwards.
cv::Mat filter_responses(const cv::Mat& bytes, const TextureFilter& filter);

/// Ascending limits between the bins of one filter: bin b holds edge[b − 1] ≤ response < edge[b].
using BinEdges = std::array<int, kTextureBins - 1>;
/// Chooses the edges by quantiles of the responses. The first and the last bin lie beyond all of them; the
/// limits between leave 0.5, 3, 12, 28, 43 % of them below, and likewise above. All are at least 32 apart (a
/// quarter of a grey level), so that bins stay narrow where all responses are alike.
BinEdges make_bin_edges(std::vector<int> responses);
/// Returns the number of the bin that holds a response.
int find_bin(const BinEdges& edges, int response);

/// For each filter the share of the pixels in each bin: sums to 1, or is 0 where no pixel counts.
using FilterHistograms = std::array<std::array<double, kTextureBins>, kTextureFilters>;

/// Returns the mean over the filters of ½ Σ |a − b|: 0 for equal histograms, 1 for disjoint ones.
double histogram_distance(const FilterHistograms& a, const FilterHistograms& b);

}  // namespace emberfold::sketch
