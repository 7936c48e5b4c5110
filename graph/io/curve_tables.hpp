// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <iosfwd>
#include <vector>

#include "graph/curves/curve_identity.hpp"
#include "graph/io/unit_tables.hpp"

namespace emberfold::graph {

/// A curve in one frame, as a row of curves.csv.
struct CurveRow {
  StrokeRow whole;            ///< its number is the curve's
  std::uint32_t touches = 0;  ///< edges that lead to other curves
};

/// Returns a row for every curve and frame, curve after curve. The curves must be identified.
std::vector<CurveRow> curve_rows(const MotionGraph& motion);

/// Writes curves.csv, a row for each curve and frame, curve after curve.
/// Columns: curve, frame, x, y (the middle of its longest piece, px), length (px), patches, width (px) and
/// contrast (means over the patches), pieces (1, or more where other curves lie over it), touches (edges that
/// lead to other curves), and where the units are known time_s, x_um, y_um, length_um. Throws IoError if the
/// stream fails, InputError as validate() does. O(n log n).
void write_curves(std::ostream& out, const MotionGraph& motion, const Units& units);

/// Writes joints.csv: frame, x, y (px), curve_a, curve_b (equal: one curve goes on), junction (1 or 0),
/// probability (that one goes on), and where the units are known time_s, x_um, y_um. Throws IoError if the
/// stream fails.
void write_joints(std::ostream& out, const std::vector<CurveJoint>& joints, const Units& units);

}  // namespace emberfold::graph
