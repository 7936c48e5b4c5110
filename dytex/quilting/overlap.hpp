// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "dytex/quilting/blocks.hpp"
#include "dytex/quilting/quilt_map.hpp"
#include "dytex/quilting/trajectories.hpp"

/// Exact differences over all of time. Inner header of quilting.
namespace emberfold::dytex::detail {

/// Returns Σ (a − b)² over n values; exact for whole numbers.
double squared_difference(const std::byte* a, const std::byte* b, std::size_t n, int depth);

/// The pixels under a block's strips, which source blocks are compared with:
/// E = Σ_{x, y, t} (p₁ − p₂)² (Enrique et al. 2005, section 2), exact for 8 and 16 bits.
class Overlap {
 public:
  /// `pixels`: the source pixels placed there, for every pixel of `runs` in their order.
  Overlap(std::span<const Trajectories* const> sources, std::vector<Run> runs,
          std::vector<SourcePixel> pixels);

  /// Returns E of the block that begins at each place. Values above `limit` may be too small, but not below
  /// it.
  [[nodiscard]] std::vector<double> errors(std::span<const SourcePixel> places, double limit) const;
  /// Returns Σ_t (p₁ − p₂)² of every pixel: CV_64F of the block's size, 0 outside of the strips.
  [[nodiscard]] cv::Mat picture(const SourcePixel& place, cv::Size block) const;
  [[nodiscard]] std::size_t pixels() const { return pixels_.size(); }

 private:
  [[nodiscard]] std::vector<std::byte> gather(int chunk) const;
  [[nodiscard]] const std::byte* at(const SourcePixel& pixel, int chunk) const;

  std::span<const Trajectories* const> sources_;
  std::vector<Run> runs_;
  std::vector<SourcePixel> pixels_;
  std::size_t bytes_;  // of a pixel in a chunk
};

}  // namespace emberfold::dytex::detail
