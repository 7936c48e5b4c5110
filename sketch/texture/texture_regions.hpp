// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "sketch/texture/filter_bank.hpp"

namespace emberfold::sketch {

/// Holds the settings of segment_texture().
struct TextureOptions {
  int regions = 0;         ///< 0…16: number of textures; 0: chosen from fewest…most
  int fewest = 3;          ///< 1…most
  int most = 7;            ///< fewest…16
  int window = 11;         ///< px, odd, 3…31: side of the square in which histograms are taken
  std::uint64_t seed = 1;  ///< of the first cluster centres
  void validate() const;
};

/// Holds the non-sketchable part of a frame, segmented by texture. Every region has two parts with their own
/// histograms: its pixels away from strokes, and those whose filters (3 px) reach into a stroke, where
/// responses are of another kind.
struct TextureRegions {
  cv::Mat label;  ///< CV_8U: 0 sketchable, else 1…count
  cv::Mat part;   ///< CV_8U: 0 sketchable, label away from strokes, label + count beside them
  int count = 0;  ///< of regions; none is empty
  std::vector<FilterHistograms> histograms;  ///< 2 · count, by part − 1; 0 of an empty part
  std::vector<std::array<BinEdges, kTextureFilters>> edges;  ///< of their bins
};

/// Segments the pixels where `sketchable` (CV_8U) is 0 by texture: the histograms of filter responses around
/// them. Only non-sketchable pixels count. `levels`: CV_32F, 1 or 3 channels, finite; the rounded luma
/// counts. Throws core::InputError otherwise. Guo, Zhu & Wu 2007, "Primal sketch: integrating structure and
/// texture".
///
/// Each filter gives the shares of responses below six limits (cumulative histograms, so that near bins are
/// alike), in units of how much they differ between windows side by side. k-means with k-means++ seeds
/// (Arthur & Vassilvitskii 2007) runs on every third pixel both ways; in the end all pixels are assigned. The
/// number of regions is at the greatest jump of distortion^(−Y/2), Y being the effective dimension (Sugar &
/// James 2003, "Finding the number of clusters in a dataset: an information-theoretic approach"). Labels are
/// in the order of the mean level. O(pixels · regions); the same bytes at any number of threads.
TextureRegions segment_texture(const cv::Mat& levels, const cv::Mat& sketchable,
                               const TextureOptions& options = {});

/// Measures the histograms of other levels (CV_8U) over the same parts and bins.
std::vector<FilterHistograms> measure_region_histograms(const cv::Mat& bytes, const TextureRegions& regions);

}  // namespace emberfold::sketch
