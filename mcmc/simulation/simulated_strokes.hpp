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
struct Particle {
  graph::Patch rest;                   ///< as it is at rest; its position too
  graph::Point offset, offset_before;  ///< px from rest where the sway is usual, now and a frame ago
  double share = 1;                    ///< of the usual sway that it shows
  double gain = 0, gain_before = 0;    ///< logarithm of its contrast over that at rest
  int age = 0;                         ///< frames since it appeared
  int leaving = -1;                    ///< frames until it goes; −1: it stays
  int held = 0;                        ///< frames until something may happen to it again

  [[nodiscard]] graph::Point position() const { return rest.position + offset * share; }
};

/// The strokes of a moment: particles, with ids that ascend and are never used again, and edges by index.
struct Particles {
  std::vector<std::uint32_t> ids;
  std::vector<Particle> list;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> edges;
  std::uint32_t next_id = 0;
  std::vector<Happening> unions, partings;  ///< of late; a parting when what fades there is gone

  /// Returns its index.
  std::uint32_t add(const Particle& particle);
};

/// For each particle the indices of those it shares an edge with.
std::vector<std::vector<std::uint32_t>> neighbours(const Particles& particles);

/// Removes the marked ones, and their edges.
void remove(Particles& particles, const std::vector<bool>& marked);

/// What the particles show, without regard to how they come and go: positions, types by degree; for sites and
/// components.
graph::AttributeGraph shape(const Particles& particles);
/// The same as it is drawn: contrasts by gain, and by age and leaving.
graph::AttributeGraph appearance(const Particles& particles, const MotionModel& model);

/// The patch with `factor` times its contrast: a line's core comes nearer to its sides, a step's sides to
/// each other.
void scale_contrast(graph::Patch& patch, double factor);

/// What random numbers are drawn for.
enum class Purpose : std::uint32_t { start = 1, motion, operators };  // below 8

/// One step of the auto-regressions.
void sway(Particles& particles, const MotionModel& model, std::uint64_t seed, Purpose purpose,
          std::uint32_t step);

/// Brings particles into the stationary state of their motion.
void settle(Particles& particles, const MotionModel& model, std::uint64_t seed);

/// Adds a graph's patches at rest about `place`, settled and of this age.
void add_settled(Particles& particles, const graph::AttributeGraph& graph, graph::Point place, int age,
                 const MotionModel& model, std::uint64_t seed);

}  // namespace emberfold::mcmc::detail
