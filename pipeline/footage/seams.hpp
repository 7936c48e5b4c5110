// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include <opencv2/core/mat.hpp>

namespace emberfold::pipeline {

/// Positions of the seams between neighbouring plays of a footage in a frame: by seam and by cell along it,
/// in cells from the left (from the top where frames are higher than wide).
using SeamLines = std::vector<std::vector<float>>;

/// Finds where plays of one footage meet in a frame, so that each fills a part of it.
/// Seams run where neighbours look most similar, and move over time only across what looks similar (Kwatra et
/// al. 2003, "Graphcut textures", here frame by frame by dynamic programming).
class Seams {
 public:
  /// `footage`: CV_8U, of one size; `moves`: its moving_pixels. Each of `plays` plays fills about an equal
  /// share of what moves.
  Seams(const std::vector<cv::Mat>& footage, const cv::Mat1b& moves, int plays);

  [[nodiscard]] int plays() const { return static_cast<int>(bands_.size()) + 1; }
  /// Returns the visibility of a seam between two plays that show these frames: mean difference under the
  /// best path of seam `seam`, relative to the usual one of this footage.
  [[nodiscard]] double visibility(int seam, int frame, int other) const;

  /// Finds the seams of the next moment. `shown[d][i]`: the frame that play i shows d moments later, at least
  /// for d = 0; `before`: the previous moment's seams, or none. O(cells · moments).
  [[nodiscard]] SeamLines next(const std::vector<std::vector<int>>& shown, const SeamLines& before) const;

  /// Returns the play that fills each cell, at most 80 a side.
  [[nodiscard]] cv::Mat1b plays_by_cell(const SeamLines& lines) const;

  /// Joins the plays' frames of a moment, CV_8U, blended over some pixels along the seams.
  [[nodiscard]] cv::Mat join(const std::vector<cv::Mat>& frames, const SeamLines& lines) const;

 private:
  struct Band {
    int first = 0, last = 0;  // cells that a seam may be in
  };
  struct Line {
    std::vector<float> cells;
    double sum = 0;  // of the differences under it, and of pixels that change sides
  };
  [[nodiscard]] static Line find_line(const cv::Mat1f& apart, const Band& band,
                                      const std::vector<float>& before);
  [[nodiscard]] cv::Mat1f difference(int frame, int other) const;

  std::vector<cv::Mat> pictures_;  // small; transposed where seams run across the height
  std::vector<Band> bands_;
  bool turned_;       // frames are higher than wide
  double cell_;       // px
  double usual_ = 1;  // sum along a seam
};

}  // namespace emberfold::pipeline
