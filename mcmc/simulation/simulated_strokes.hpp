// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <utility>
#include <vector>

#include "core/rng.hpp"
#include "mcmc/learning/rate_modifiers.hpp"

namespace emberfold::mcmc::detail {

/// Holds a patch of a synthesized clip.
struct SimulatedPatch {
  graph::Patch rest;                   ///< patch at rest, with its position at rest
  graph::Point offset, offset_before;  ///< px from rest at the usual displacement, now and a frame ago
  graph::Point carried;                ///< px: how far the velocity modes have moved the rest
  double share = 1;                    ///< factor of the usual displacement
  double gain = 0, gain_before = 0;    ///< logarithm of its contrast over that at rest
  int age = 0;                         ///< frames since it appeared
  int frames_left = -1;                ///< frames until it is removed; −1: it stays
  int refractory_left = 0;             ///< frames until the next operator may change it

  [[nodiscard]] graph::Point position() const { return rest.position + offset * share; }
};

/// Holds the amplitudes of the velocity modes about now.
struct ModeAmplitudes {
  std::vector<double> before, after;  ///< one frame of the clip apart
  double between = 0;                 ///< time since `before`, 0…1 frames of the clip
};

/// Holds the strokes of one frame: patches and edges by index. Ids ascend and are never used again.
struct SimulatedStrokes {
  std::vector<std::uint32_t> ids;
  std::vector<SimulatedPatch> list;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> edges;
  std::uint32_t next_id = 0;
  ModeAmplitudes amplitudes;
  std::vector<PastEvent> unions, separations;  ///< recent; a separation counts from the end of its fade-out

  /// Adds a patch with a new id and returns its index.
  std::uint32_t add(const SimulatedPatch& simulated);
};

/// Lists for each patch the indices of its neighbours.
std::vector<std::vector<std::uint32_t>> neighbour_lists(const SimulatedStrokes& strokes);

/// Removes the marked patches and their edges.
void remove_patches(SimulatedStrokes& strokes, const std::vector<bool>& marked);

/// Returns the patches as a graph without fading, for sites and components.
/// Positions are the displaced ones, types follow from the degrees.
graph::AttributeGraph stroke_graph(const SimulatedStrokes& strokes);
/// Returns the graph as it is drawn: with contrasts by gain, age and fade-out.
graph::AttributeGraph drawn_graph(const SimulatedStrokes& strokes, const MotionModel& model);

/// Multiplies a patch's contrast by `factor`.
/// A line's core moves towards its sides, the sides of a step towards each other.
void scale_contrast(graph::Patch& patch, double factor);

/// Purpose of random numbers, part of their key.
enum class Purpose : std::uint32_t { start = 1, motion, operators, velocity };  // below 8

/// Advances displacement and contrast by one step of the auto-regressions.
void step_motion(SimulatedStrokes& strokes, const MotionModel& model, std::uint64_t seed, Purpose purpose,
                 std::uint32_t step);

/// Draws the patches' motion from its stationary state.
void draw_stationary_motion(SimulatedStrokes& strokes, const MotionModel& model, std::uint64_t seed);

/// Adds a graph's strokes of the given age about `place`. Their motion is stationary, and begins at the shape
/// that the graph shows; one amplitude for a whole stroke keeps it smooth.
void add_stationary(SimulatedStrokes& strokes, const graph::AttributeGraph& graph, graph::Point place,
                    int age, const MotionModel& model, std::uint64_t seed);

}  // namespace emberfold::mcmc::detail
