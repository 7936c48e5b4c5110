// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <iosfwd>
#include <string_view>
#include <vector>

#include "graph/io/unit_tables.hpp"
#include "graph/motion_graph.hpp"

namespace emberfold::graph {

/// Motion of a tip over some frames.
enum class TipPhase : std::uint8_t { pause, growth, retraction };
/// Returns the name of a phase as files write it.
std::string_view name(TipPhase phase);

/// One phase of one tip.
struct TipMotion {
  std::uint32_t tip = 0;  ///< counts from 1
  CurveId curve;          ///< ends there, from first to last frame; 0 where curves are not identified
  TipPhase phase = TipPhase::pause;
  int first = 0, last = 0;  ///< frames
  Point begin, end;         ///< px
  double rate = 0;          ///< px a frame, out of the curve; negative of a retraction
  double error = 0;         ///< px a frame, standard error of it
};

/// Follows the tips of all curves and finds when they grow, retract and pause.
/// A tip is the end of one curve: where a track goes on as the end of another one, a new tip begins. Its
/// way is the sum of its steps along the direction in which its curve ends, in the frame of the
/// picture: a curve that slides along itself grows at one end and retracts at the other. The way, its running
/// median of three frames, is cut into straight parts of three frames or more by least squares, at 3
/// ln(frames) of twice the log likelihood for a part (optimal partitioning, Jackson et al. 2005), its noise
/// taken from the second differences of all ways. A part is a growth or retraction where it leads 3 px or
/// farther and its rate exceeds three standard errors. Tips seen in fewer than 3 frames are left out. Sorted
/// by tip, then frame. O(200 · tips · frames).
std::vector<TipMotion> tip_motions(const MotionGraph& motion);

/// Writes tips.csv: tip, curve, phase, first, last (frames), x, y, x_end, y_end (px), length (px), rate,
/// error (px a frame), and where the units are known first_s, last_s, rate_px_s, length_um, rate_um_s. Throws
/// IoError if the stream fails.
void write_tips(std::ostream& out, const std::vector<TipMotion>& motions, const Units& units);

}  // namespace emberfold::graph
