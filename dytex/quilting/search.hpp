// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "dytex/quilting/basis.hpp"
#include "dytex/quilting/blocks.hpp"
#include "dytex/quilting/correlation.hpp"
#include "dytex/quilting/overlap.hpp"
#include "dytex/quilting/quilt.hpp"

/// Search for source blocks that fit. Inner header of quilting.
namespace emberfold::dytex::detail {

/// The surroundings that a block has to fit.
struct BlockQuery {
  QuiltBlock block;                  ///< its column and row, and its size
  std::vector<Run> runs{};           ///< the overlap, row by row
  std::vector<SourcePixel> there{};  ///< for each pixel of the overlap, by runs
  cv::Mat guide{};                   ///< CV_32F of the block's size, or empty
  std::vector<SourcePixel> near{};   ///< places of blocks nearby, not to be shown again
};

class BlockSearch {
 public:
  /// `least`, `most`: bounds of the sizes of blocks in queries. Keeps references to all but these.
  BlockSearch(std::span<const QuiltSource> sources, const QuiltOptions& options, cv::Size least,
              cv::Size most, const core::Context& context);

  /// Chooses a block, drawn with a stream of its column and row. Throws core::Cancelled.
  [[nodiscard]] QuiltChoice choose(const BlockQuery& query) const;
  [[nodiscard]] Overlap overlap(const BlockQuery& query) const;
  [[nodiscard]] int components() const { return components_; }

 private:
  struct Prepared {
    std::vector<cv::Mat> planes;
    std::optional<Correlator> features, guide;
    cv::Mat forbidden;  // integral
  };
  struct Candidate {
    double lower = 0;
    SourcePixel at;
  };
  struct Scale {  // total error = overlap + weight · guide
    double guide = 0, floor = 0;
  };
  [[nodiscard]] Scale scale_of(const BlockQuery& query) const;
  [[nodiscard]] cv::Mat allowed(std::size_t source, cv::Size block) const;
  [[nodiscard]] cv::Mat lower_bounds(std::size_t source, const BlockQuery& query, const Scale& scale) const;
  [[nodiscard]] std::vector<cv::Mat> feature_query(const BlockQuery& query) const;
  [[nodiscard]] double guide_error(const BlockQuery& query, const SourcePixel& at) const;
  [[nodiscard]] QuiltChoice pick(const BlockQuery& query, std::vector<cv::Mat>& bounds,
                                 const Scale& scale) const;

  std::span<const QuiltSource> sources_;
  std::vector<const Trajectories*> courses_;
  const QuiltOptions& options_;
  const core::Context& context_;
  std::vector<Prepared> prepared_;
  int components_ = 0;
};

}  // namespace emberfold::dytex::detail
