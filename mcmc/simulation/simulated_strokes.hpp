// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <utility>
#include <vector>

#include "core/rng.hpp"
#include "mcmc/learning/rate_modifiers.hpp"

namespace emberfold::mcmc::detail {

/// A patch of a synthesized clip.
struct SimulatedPatch {
  graph::Patch rest;                   ///< as it is at rest; its position too
  graph::Point offset, offset_before;  ///< px from rest where the displacement is usual, now and a frame ago
  double share = 1;                    ///< of the usual displacement that it shows
  double gain = 0, gain_before = 0;    ///< logarithm of its contrast over that at rest
  int age = 0;                         ///< frames since it appeared
  int frames_left = -1;                    ///< frames until it goes; −1: it stays
  int refractory_left = 0;                        ///< frames until something may happen to it again

  [[nodiscard]] graph::Point position() const { return rest.position + offset * share; }
};

/// The strokes of a moment: patches, with ids that ascend and are never used again, and edges by index.
struct SimulatedStrokes {
  std::vector<std::uint32_t> ids;
  std::vector<SimulatedPatch> list;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> edges;
  std::uint32_t next_id = 0;
  std::vector<PastEvent> unions, separations;  ///< of late; a separation when what fades there is gone

  /// Returns its index.
  std::uint32_t add(const SimulatedPatch& simulated);
};

/// For each patch the indices of those it shares an edge with.
std::vector<std::vector<std::uint32_t>> neighbour_lists(const SimulatedStrokes& strokes);

/// Removes the marked ones, and their edges.
void remove_patches(SimulatedStrokes& strokes, const std::vector<bool>& marked);

/// What the patches show, without regard to how they come and go: positions, types by degree; for sites and
/// components.
graph::AttributeGraph stroke_graph(const SimulatedStrokes& strokes);
/// The same as it is drawn: contrasts by gain, and by age and leaving.
graph::AttributeGraph drawn_graph(const SimulatedStrokes& strokes, const MotionModel& model);

/// The patch with `factor` times its contrast: a line's core comes nearer to its sides, a step's sides to
/// each other.
void scale_contrast(graph::Patch& patch, double factor);

/// What random numbers are drawn for.
enum class Purpose : std::uint32_t { start = 1, motion, operators };  // below 8

/// One step of the auto-regressions.
void step_motion(SimulatedStrokes& strokes, const MotionModel& model, std::uint64_t seed, Purpose purpose,
          std::uint32_t step);

/// Brings patches into the stationary state of their motion.
void draw_stationary_motion(SimulatedStrokes& strokes, const MotionModel& model, std::uint64_t seed);

/// Adds a graph's patches at rest about `place`, settled and of this age.
void add_stationary(SimulatedStrokes& strokes, const graph::AttributeGraph& graph, graph::Point place, int age,
                 const MotionModel& model, std::uint64_t seed);

}  // namespace emberfold::mcmc::detail
