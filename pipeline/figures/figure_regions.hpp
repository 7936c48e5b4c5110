// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "core/clip.hpp"
#include "core/context.hpp"
#include "graph/motion_graph.hpp"
#include "pipeline/figures/figure_ground.hpp"

namespace emberfold::pipeline {

/// A connected region of a frame in which the amplitude exceeds a threshold.
struct FigureRegion {
  std::size_t frame = 0;
  int area = 0;  ///< px of the view, as all lengths here
  cv::Point2d centre;
  cv::Rect box;
  double border = 0;  ///< px, its length along the border of frame and mask
  int rim = 0;        ///< pixels of the outline further than 2 px from that
  double turning = 0;  ///< full turns of its outline inside the frame: 1 for each outer one, −1 for each hole
  /// Sums of squares, (grey levels)², that a plane and that two levels leave within 8 px of the region, with
  /// a sharp edge between those and with a soft one.
  double plane = 0, sharp = 0, soft = 0;
  double thickness = 0;  ///< diameter of the largest disc inside
  int wide = 0;          ///< pixels that discs of kWideDisc inside cover
  bool is_figure = false;
  bool is_removed = false;
  std::vector<std::size_t> next, before;  ///< regions of the next frame and the one before that continue it

  /// Returns the width of a strip of this area and outline; half of the diameter of a disc.
  [[nodiscard]] double width() const { return 2. * area / std::max(1, rim); }
  /// Returns the nats a pixel of outline by which two levels explain more than a plane does.
  [[nodiscard]] double gain() const { return 0.5 * std::log(plane / std::min(sharp, soft)); }
  [[nodiscard]] double sharp_gain() const { return 0.5 * std::log(plane / sharp); }
};

/// The regions of one polarity, of all frames.
struct PolarityRegions {
  std::vector<FigureRegion> regions;
  /// By frame, the region of each connected component of its labels, less 1; kNoRegion for small ones.
  std::vector<std::vector<std::size_t>> of_component;
};
inline constexpr std::size_t kNoRegion = ~std::size_t{0};

inline constexpr double kWideDisc = 6;  ///< px, a diameter: what no such disc fits into is a line

/// Thresholds of the amplitude. Regions are those of the first; the others tell how sure a change is.
inline constexpr std::array<double, 3> kFigureThresholds = {0, -0.2, 0.2};
/// Returns the bit of FigureRegions::labels of a polarity and a threshold, given as indices.
constexpr int label_bit(std::size_t polarity, std::size_t threshold) {
  return 1 << (polarity * kFigureThresholds.size() + threshold);
}

/// Holds a clip's regions.
struct FigureRegions {
  std::vector<cv::Mat1b> labels;  ///< by frame: the thresholds that the amplitudes exceed, as label_bit
  std::array<PolarityRegions, kFigurePolarities.size()> of;  ///< by polarity
  ImageBlocks blocks;                                        ///< that labels lie in
};

/// Returns the pixels of a frame further than 2 px from the border of frame and mask: 0 or 1.
cv::Mat1b inner_part(const FigureGround& ground, std::size_t frame);

/// Finds the regions of a clip, which is read once. Throws core::Cancelled. O(pixels).
FigureRegions find_figure_regions(core::FrameSource& source, const FigureGround& ground,
                                  const core::Context& context);

/// Returns the region of each pixel of a frame, plus 1; 0: none, or a removed one.
cv::Mat1i region_numbers(const FigureRegions& all, std::size_t polarity, std::size_t frame);

/// Links the regions of neighbouring frames that overlap where motion takes them, removes those that do not
/// explain the frames, and says which are figures (find_families). `lines`: the clip's sketch.
void link_figure_regions(FigureRegions& all, const FigureGround& ground, const graph::SketchSequence& lines,
                         const core::Context& context);

}  // namespace emberfold::pipeline
