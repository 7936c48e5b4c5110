// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <vector>

#include "core/model_archive.hpp"
#include "graph/attribute_graph.hpp"

namespace emberfold::mcmc {

/// How one attribute d of a patch, its deviation from rest, goes on from frame to frame:
///   d(t+1) = a1 d(t) + a2 d(t−1) + coupling (n̄(t) − d(t)) + e
/// where n̄ is the mean over the patch's neighbours in the graph and e ~ N(0, noise²), independent in time and
/// smooth along a stroke: at h px from each other two patches' e correlate by exp(−h²/2 range²) (Wang & Zhu
/// 2004, eq. 3, with the inertia of two frames).
struct Autoregression {
  double a1 = 0, a2 = 0, coupling = 0;
  double noise = 0;        ///< SD of e, ≥ 0
  double range = 0;        ///< px, ≥ 0
  double measurement = 0;  ///< SD of what the sketch adds to d in each frame alone, ≥ 0; not drawn

  bool operator==(const Autoregression&) const = default;
};
/// The largest growth of a deviation in a frame, over all couplings that a graph can make; below 1: stable.
double spectral_radius(const Autoregression& motion);
/// SD of d in the stationary state along a long curve. InputError where there is none.
double stationary_deviation(const Autoregression& motion);

/// A number for each cell of a grid over the frame, row by row; it holds for all of the cell.
struct CellMap {
  double cell = 16;  ///< px, side of a cell
  int columns = 0, rows = 0;
  std::vector<double> values;

  /// The cell of a place; outside the frame the nearest one.
  [[nodiscard]] std::size_t index(graph::Point p) const;
  [[nodiscard]] double at(graph::Point p) const { return values[index(p)]; }
  bool operator==(const CellMap&) const = default;
};

/// Strokes of how many patches share a rate: up to 4, 8, 16, 32, 64, 128, and longer.
constexpr std::size_t kSizes = 7;
std::size_t size_class(std::size_t patches);

/// Classes of how long ago something was (mcmc/learning/rate_modifiers.hpp): below 4, 6, 9, 16, 32 frames,
/// and longer or not known; of how wide a gap is: below 5, 7, 10, 14, 20 px, and wider; and of how far a
/// stroke has to turn to reach another: below 30°, 60°, 90°, and farther.
constexpr std::size_t kSince = 6, kGaps = 6, kTurns = 4;

/// How much more often than usual something happens where, and so long after, something else was; about 1.
struct Circumstances {
  std::array<double, kSince> death = {1, 1, 1, 1, 1, 1};    ///< by the stroke's age
  std::array<double, kSince> parting = {1, 1, 1, 1, 1, 1};  ///< split, disconnect: after a union near there
  std::array<double, kSince> uniting = {1, 1, 1, 1, 1, 1};  ///< merge, connect: after a parting near there
  std::array<double, kGaps> bridging = {1, 1, 1,
                                        1, 1, 1};     ///< merge, connect: by the gap between the strokes
  std::array<double, kTurns> turning = {1, 1, 1, 1};  ///< connect: by where the other stroke lies
  double pace = 1;  ///< frames of the clip it was learned from that pass in one
  bool operator==(const Circumstances&) const = default;
};

/// θ_ext: how often strokes change. A rate is an expected number in a frame at one place where the change can
/// happen (mcmc/learning/operator_sites.hpp).
struct OperatorRates {
  CellMap birth;                               ///< per px²
  std::array<double, kSizes> birth_by_size{};  ///< shares of births, sum 1
  CellMap death;                               ///< relative to `death_by_size`, about 1
  std::array<double, kSizes> death_by_size{};  ///< per stroke
  CellMap parting;        ///< of splits and disconnects, relative to their rates, about 1
  double split = 0;       ///< per inner patch of a curve
  double merge = 0;       ///< per pair of ends that continue each other
  double connect = 0;     ///< per pair of strokes near each other, in no line
  double disconnect = 0;  ///< per arm of a junction, or corner
  double reach = 24;      ///< px: strokes farther apart neither merge nor connect
  double split_gap = 10, disconnect_gap = 10;  ///< px: from end to end where a stroke came apart
  double hold = 0;  ///< frames: so long nothing happens again where something has just happened
  Circumstances circumstances;
  bool operator==(const OperatorRates&) const = default;
};

/// A stroke as it was seen, to be born again: its rest shape about (0, 0).
struct Exemplar {
  graph::AttributeGraph graph;
  graph::Point place;    ///< where it was seen, px
  double clearance = 0;  ///< px: how far the nearest other stroke was
  bool operator==(const Exemplar&) const = default;
};

/// px: nearer than this patches of two strokes hardly ever come to each other; 0: nothing is known.
struct Exclusion {
  double alike = 0;  ///< lines of one sign, or steps
  double lines = 0;  ///< a ridge and a valley
  double mixed = 0;  ///< a line and a step
  bool operator==(const Exclusion&) const = default;
};

/// How a patch of the first frame moved as it was seen: what an auto-regression of two frames goes on from.
struct Swing {
  graph::Point offset, offset_before;  ///< px from rest where the sway is usual (sway_share), and a frame ago
  double gain = 0, gain_before = 0;    ///< logarithm of its contrast over that at rest, likewise
  bool operator==(const Swing&) const = default;
};

/// Θ of a clip: how its strokes move (θ_int), how often they change (θ_ext), and what they look like.
struct MotionModel {
  int width = 0, height = 0;  ///< px
  double fps = 25;
  int frames = 0;  ///< of the clip it was learned from

  Autoregression sway;       ///< of the displacement from the rest shape, px, each coordinate alike
  CellMap sway_share;        ///< of the sway's SD that is usual in each cell; about 1
  Autoregression contrast;   ///< of the logarithm of the contrast
  CellMap drift_x, drift_y;  ///< px a frame: how the rest shapes travel
  OperatorRates rates;
  Exclusion exclusion;
  CellMap density;  ///< patches usually around each cell; births keep to it
  std::array<double, 8> appearing{},
      vanishing{};                  ///< share of the contrast, so many frames after birth or before death
  std::vector<Exemplar> exemplars;  ///< strokes to be born
  graph::AttributeGraph first;      ///< rest shapes of one frame's strokes, to begin with
  std::vector<Swing> first_swing;   ///< of each of its patches; empty: not known

  bool operator==(const MotionModel&) const = default;
};

/// Throws InputError, naming the part, where a number is out of its range or maps and sizes disagree.
void validate(const MotionModel& model);

/// The format "emberfold.motion_model", version 1.
core::ModelArchive to_archive(const MotionModel& model);
/// core::IoError, naming the part, for another format, a newer version, or anything that validate() refuses.
MotionModel motion_model(const core::ModelArchive& archive);

}  // namespace emberfold::mcmc
