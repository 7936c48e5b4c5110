// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "core/model_archive.hpp"
#include "graph/attribute_graph.hpp"
#include "mcmc/model/rate_maps.hpp"

namespace emberfold::mcmc {

/// Holds the law by which one attribute d of a patch, its deviation from rest, goes on from frame to frame:
///   d(t+1) = a1 d(t) + a2 d(t−1) + coupling (n̄(t) − d(t)) + e
/// n̄ is the mean over the patch's neighbours in the graph. e ~ N(0, noise²) is independent in time and smooth
/// along a stroke: at h px from each other two patches' e correlate by exp(−h²/2 range²). Source: Wang & Zhu
/// 2004, eq. 3, with a second frame of inertia.
struct Autoregression {
  double a1 = 0, a2 = 0, coupling = 0;
  double noise = 0;        ///< SD of e, ≥ 0
  double range = 0;        ///< px, ≥ 0
  double measurement = 0;  ///< SD, ≥ 0: what the sketch adds to d in each frame alone; never drawn

  bool operator==(const Autoregression&) const = default;
};

/// Returns the largest growth of a deviation in a frame over all couplings that a graph can make.
/// The motion is stable where it is below 1.
double spectral_radius(const Autoregression& motion);

/// Returns the SD of d in the stationary state along a long curve.
/// Throws core::InputError for a motion that is not stable.
double stationary_deviation(const Autoregression& motion);

/// Number of size classes of strokes: up to 4, 8, 16, 32, 64, 128 patches, and more. A class shares its
/// rates.
constexpr std::size_t kSizeClasses = 7;

/// Returns the size class of a stroke of so many patches.
std::size_t size_class(std::size_t patches);

/// Number of classes of the time since an event: below 4, 6, 9, 16, 32 frames, and longer or not known.
constexpr std::size_t kElapsedClasses = 6;
/// Number of classes of a gap's width: below 5, 7, 10, 14, 20 px, and wider.
constexpr std::size_t kGapClasses = 6;
/// Number of classes of the turn from a stroke's end to another stroke: below 30°, 60°, 90°, and more.
constexpr std::size_t kTurnClasses = 4;

/// Holds factors that multiply the rates of events by what happened nearby before and by the gap; about 1.
struct RateModifiers {
  std::array<double, kElapsedClasses> death = {1, 1, 1, 1, 1, 1};  ///< by the stroke's age
  /// Split and disconnect, by the time since a union nearby.
  std::array<double, kElapsedClasses> separation = {1, 1, 1, 1, 1, 1};
  /// Merge and connect, by the time since a separation nearby.
  std::array<double, kElapsedClasses> unification = {1, 1, 1, 1, 1, 1};
  std::array<double, kGapClasses> bridging = {1, 1, 1, 1, 1, 1};  ///< merge and connect, by the gap's width
  std::array<double, kTurnClasses> turning = {1, 1, 1, 1};  ///< connect, by the turn to the other stroke
  double pace = 1;  ///< frames of the clip it was learned from that pass in one drawn frame
  bool operator==(const RateModifiers&) const = default;
};

/// Holds θ_ext, how often strokes change.
/// A rate is the expected number of events in a frame at one site (mcmc/learning/operator_sites.hpp).
struct OperatorRates {
  CellMap birth;                                     ///< per px²
  std::array<double, kSizeClasses> birth_by_size{};  ///< shares of births, sum 1
  CellMap death;                                     ///< factor of `death_by_size`, about 1
  std::array<double, kSizeClasses> death_by_size{};  ///< per stroke
  CellMap separation;                                ///< factor of the rates of split and disconnect, about 1
  double split = 0;                                  ///< per inner patch of a curve
  double merge = 0;                                  ///< per pair of ends that continue each other
  double connect = 0;                                ///< per pair of strokes near each other, not in line
  double disconnect = 0;                             ///< per arm of a junction or corner
  double reach = 24;                                 ///< px: strokes farther apart neither merge nor connect
  double split_gap = 10, disconnect_gap = 10;        ///< px, from end to end after a separation
  double refractory_period = 0;                      ///< frames after an event in which its place has none
  RateModifiers modifiers;
  bool operator==(const OperatorRates&) const = default;
};

/// Holds a stroke of the clip that can be born again: its rest shape about (0, 0).
struct Exemplar {
  graph::AttributeGraph graph;
  graph::Point place;    ///< px, where it was observed
  double clearance = 0;  ///< px, distance to the nearest other stroke there
  bool operator==(const Exemplar&) const = default;
};

/// Holds the hard-core distances, px, below which patches of two strokes hardly ever lie; 0 where not known.
struct HardCoreDistances {
  double alike = 0;  ///< between lines of one sign, or between steps
  double lines = 0;  ///< between a ridge and a valley
  double mixed = 0;  ///< between a line and a step
  bool operator==(const HardCoreDistances&) const = default;
};

/// Holds how the velocities of all strokes vary together about the drift, a linear dynamic texture of their
/// field: v(t) = drift + modes · z(t), z(t+1) = step · z(t) + noise · e(t), e ~ N(0, I). The stationary
/// covariance of z is the identity. Matrices are row by row.
struct VelocityModes {
  std::size_t count = 0;            ///< of modes; 0: velocities do not vary
  std::vector<double> modes;        ///< px a frame, 2 · cells × count: x and y of each cell
  std::vector<double> step, noise;  ///< count × count
  bool operator==(const VelocityModes&) const = default;
};

/// Holds Θ of a clip: how its strokes move (θ_int), how often they change (θ_ext), and how they look.
struct MotionModel {
  int width = 0, height = 0;  ///< px
  double fps = 25;
  int frames = 0;  ///< of the clip it was learned from

  Autoregression displacement;  ///< from the rest shape, px, the same law for each coordinate
  CellMap displacement_scale;   ///< factor of the displacement's usual SD in each cell, about 1
  Autoregression contrast;      ///< of the logarithm of the contrast
  CellMap drift_x, drift_y;     ///< px a frame: velocity of the rest shapes
  VelocityModes velocity;       ///< of the rest shapes, about the drift
  OperatorRates rates;
  HardCoreDistances hard_core;
  CellMap density;                    ///< usual number of patches around each cell; guides births
  std::array<double, 8> appearing{};  ///< contrast 0, 1, … 7 frames after a birth, over the usual one
  std::array<double, 8> vanishing{};  ///< contrast with 0, 1, … 7 frames left to live, over the usual one
  std::vector<Exemplar> exemplars;    ///< strokes to be born
  graph::AttributeGraph first;        ///< strokes of the first frame, as they were seen

  bool operator==(const MotionModel&) const = default;
};

/// Checks a model. Throws core::InputError that names the part for a number out of its range, and for maps
/// and lists whose sizes disagree.
void validate(const MotionModel& model);

/// Packs a valid model in the format "emberfold.motion_model", version 1.
core::ModelArchive to_archive(const MotionModel& model);

/// Reads a model from an archive.
/// Throws core::IoError that names the part for another format, a newer version, or an invalid model.
MotionModel motion_model(const core::ModelArchive& archive);

}  // namespace emberfold::mcmc
