// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <opencv2/core/mat.hpp>

/// Sums of products of a block with every place of a picture. Inner header of quilting.
namespace emberfold::dytex::detail {

/// Sums of squared differences between a small query and a picture, both of several planes, at every place of
/// the picture, by Fourier transforms: E(u) = Σ S² − 2 Σ S q + Σ q². The picture is cut into overlapping
/// tiles whose transforms are kept, so that a query is transformed once, at the size of a tile.
class Correlator {
 public:
  /// `planes`: CV_32F, of one size. Sizes of queries are between `least` and `most`.
  Correlator(const std::vector<cv::Mat>& planes, cv::Size least, cv::Size most);

  /// Returns E at every place u where the query fits, CV_32F of (height − query height + 1) × (width − query
  /// width + 1). `query`: a plane each, 0 outside of `boxes`, over which the sums run. E is off by less than
  /// margin(). O(planes · tile · log tile) + O(planes · tiles · tile).
  [[nodiscard]] cv::Mat squared_differences(const std::vector<cv::Mat>& query,
                                            const std::vector<cv::Rect>& boxes) const;
  /// Bounds the rounding error of E of a query: some 10⁻⁵ of ‖S‖ ‖q‖, the norms taken over a tile.
  [[nodiscard]] double margin(const std::vector<cv::Mat>& query) const;

 private:
  struct Tile {
    cv::Point origin;
    std::vector<float> rows;   // row by row, in it plane by plane: real parts, then imaginary parts
    std::vector<float> edges;  // plane by plane: first column, last column, each as packed by cv::dft
  };
  void split(const cv::Mat& packed, std::size_t plane, Tile& tile) const;
  [[nodiscard]] cv::Mat correlate(const Tile& tile, const Tile& query) const;
  void choose_tile(cv::Size most);

  std::size_t planes_ = 0;
  cv::Size size_, tile_, step_;
  std::vector<Tile> tiles_;
  cv::Mat energy_;   // integral of Σ S², CV_64F
  double norm_ = 0;  // the largest of a tile
};

/// Returns the sum over boxes moved by u, for every u where a block of this size fits. `integral` as of
/// cv::integral.
cv::Mat box_sums(const cv::Mat& integral, const std::vector<cv::Rect>& boxes, cv::Size block);

}  // namespace emberfold::dytex::detail
