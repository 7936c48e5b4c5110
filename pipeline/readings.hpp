// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "core/clip.hpp"
#include "core/context.hpp"
#include "graph/matching/match.hpp"
#include "graph/motion_graph.hpp"
#include "pipeline/sketch_clip.hpp"
#include "sketch/extract.hpp"

namespace emberfold::pipeline {

struct StartOptions {
  int chains = 3;      ///< 1…64: how many readings of the clip; odd: no share is just a half
  double perturb = 2;  ///< grey levels, 0…64: SD, in luma, of the noise in the copies of the clip

  void validate() const;
};

/// How a start reads the clip.
struct StartReading {
  std::optional<std::size_t> copy;  ///< which copy in noise; none: the clip itself
  bool backwards = false;           ///< matched backwards in time and turned round
};
/// Of each chain: the clip forwards, the clip backwards, a new copy forwards, another one backwards, and so
/// on in turns of four. So half of all starts, or more, have seen the clip as it is.
std::vector<StartReading> readings(const StartOptions& options);
/// Returns which of the readings are matched backwards in time.
std::vector<bool> backward_readings(const StartOptions& options);

/// The clip's own sketch, and the sketches of its copies in noise, as many as the readings want.
struct StartSketches {
  SketchedClip clip;
  std::vector<graph::SketchSequence> perturbed;
};

/// Reads the clip once from its first frame and sketches each frame as it is and with white Gaussian noise
/// added, anew for each copy. The noise is independent in all channels, of a strength that gives luma the SD
/// `perturb`; it is not clipped, and depends on (seed, copy, frame) alone. Some frames on several threads at
/// once; holds some frames and all graphs. InputError, core::Cancelled. Costs a sketch a frame, and one more
/// for each copy.
StartSketches sketch_starts(core::FrameSource& source, const sketch::ExtractOptions& extract,
                            const StartOptions& options, std::uint64_t seed, const core::Context& context);

/// The readings, a start for each chain, strokes identified; chains that read alike start alike. The matching
/// carries velocities on, so its two directions differ where it is in doubt. Several readings at once on
/// several threads. InputError where the copies are not those that the readings want; core::Cancelled.
std::vector<graph::MotionGraph> match_starts(const StartSketches& sketches, const graph::MatchOptions& match,
                                             const StartOptions& options, const core::Context& context);

/// Both: starts for the chains of a sampler that cannot cross every barrier between readings of a clip.
/// Pooled (graph/events/event_pooling.hpp), their events already tell what is sure from what is not.
std::vector<graph::MotionGraph> dispersed_starts(core::FrameSource& source,
                                                 const sketch::ExtractOptions& extract,
                                                 const graph::MatchOptions& match,
                                                 const StartOptions& options, std::uint64_t seed,
                                                 const core::Context& context);

}  // namespace emberfold::pipeline
