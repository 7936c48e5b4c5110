// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "dytex/quilting/quilt.hpp"

namespace emberfold::dytex {

/// Figures of a quilt: how much is copied and how visible seams are.
struct QuiltMeasures {
  double verbatim_blocks = 0;  ///< share of the blocks that only extend a neighbour, 0…1
  double largest_piece = 0;    ///< the largest connected piece copied unchanged, as a share of the output
  double source_share = 0;     ///< share of the source pixels that show somewhere
  double seam_share = 0;       ///< share of neighbouring output pixels that are not neighbours in the source
  double seam_step = 0;        ///< mean size of the step between these, levels of 255, over time and channels
  double other_step = 0;       ///< the same between all others
  double change_share = 0;     ///< share of pixels that copy another place in the next frame: seams that move
  double change_step = 0;      ///< mean size of their steps to the next frame, levels of 255
  double course_step = 0;      ///< the same of all others
  /// Returns seam_step / other_step, 1 where seams are as smooth as the rest; 1 where there are none, or
  /// nothing steps anywhere.
  [[nodiscard]] double seam_ratio() const;
  /// Returns change_step / course_step in the same way: 1 where seams that move flicker no more than the
  /// rest.
  [[nodiscard]] double change_ratio() const;
};

/// Returns the share of the source pixels that a map shows somewhere, at any time.
double shown_share(const QuiltMap& map, std::span<const Trajectories* const> sources);

/// Measures a quilt. Steps are taken over at most `frames` frames, spread evenly, and the frames after them;
/// the largest piece is that of the middle frame. `choices` may be empty: no verbatim_blocks.
QuiltMeasures measure_quilt(const QuiltMap& map, std::span<const QuiltChoice> choices,
                            std::span<const Trajectories* const> sources, int frames = 32);

}  // namespace emberfold::dytex
