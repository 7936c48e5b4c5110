// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "core/context.hpp"
#include "dytex/quilting/quilt_map.hpp"
#include "dytex/quilting/trajectories.hpp"

namespace emberfold::dytex {

/// Kind of cut between blocks: paths that are the same in every frame, or surfaces in x, y and t.
enum class Seams { still, moving };

struct QuiltOptions {
  cv::Size size{512, 512};  ///< px, of the output, 1 … 16384 each way
  cv::Size block{64, 64};   ///< px, 2 … 4096 each way; elongated ones suit textures that are
  int overlap = 16;         ///< px, 1 … half the block's shorter side
  int components = 16;      ///< k, of the basis in which blocks are compared, 1 … 256
  double tolerance = 0.1;  ///< blocks with an error up to (1 + tolerance) times the least are equals, 0 … 10
  double floor = 1;        ///< and so are those below this RMS error, levels of 255, 0 … 255
  int apart = 0;  ///< px: places nearer than this to those that blocks nearby show are excluded, 0 … 4096
  double guide_weight = 0.5;  ///< of the guide against the overlap, 0 … 0.99
  bool tileable = false;      ///< the output tiles seamlessly
  Seams seams = Seams::still;
  bool exact = false;  ///< compare every place over all of time, without the basis: slow
  std::uint64_t seed = 1;

  /// Throws InputError naming field, value and range.
  void validate() const;
};

/// A source of blocks.
struct QuiltSource {
  const Trajectories* trajectories = nullptr;
  cv::Mat forbidden;  ///< CV_8U of its size, or empty: pixels that are not 0 must not be copied
  cv::Mat guide;      ///< CV_32F of its size: compared with the output's guide; needed with one
};

/// One block as it was placed.
struct QuiltChoice {
  int column = 0, row = 0;
  SourcePixel at;             ///< the block's upper left corner in the source
  double error = 0;           ///< Σ of squared differences over the overlap and all of time
  std::int64_t equals = 0;    ///< number of places within the tolerance
  std::int64_t compared = 0;  ///< number of places compared over all of time
  bool continues = false;     ///< it only extends its left or upper neighbour
};

struct QuiltResult {
  QuiltMap map;                      ///< covers the output
  std::vector<QuiltChoice> choices;  ///< in the order in which they were placed
  int columns = 0, rows = 0;         ///< of blocks
  int components = 0;                ///< of the basis; 0 where whole trajectories are compared
};

/// Image quilting (Efros & Freeman 2001) with blocks that span all of time (Enrique et al. 2005): blocks of
/// the sources are laid one after the other, each overlapping those before; a block is drawn evenly among the
/// places whose squared difference over the overlap, summed over time and channels, is within the tolerance
/// of the least one; it is cut along seams of least error, the same in every frame. Seams::moving then lets
/// the seams move in space and time (as minimum cuts, Kwatra et al. 2003), wherever blocks have been placed.
/// The search works in a basis of rank k whose bounds select the places to compare exactly: it chooses as an
/// exhaustive search would. With one frame this is quilting of still images.
///
/// `guide`: CV_32F of the output's size, whose levels the sources' guides follow; or empty.
///
/// Sources agree in frames, channels and depth, and chunk_frames. Throws InputError where they do not, where
/// none of them holds a block, or where the mask forbids every place. The same result at any thread count.
/// O(blocks · (k · pixels + compared · overlap · frames)).
QuiltResult quilt(std::span<const QuiltSource> sources, const QuiltOptions& options,
                  const core::Context& context = {}, const cv::Mat& guide = {});

}  // namespace emberfold::dytex
