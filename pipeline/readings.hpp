// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "core/clip.hpp"
#include "core/context.hpp"
#include "core/option_field.hpp"
#include "graph/matching/match.hpp"
#include "graph/motion_graph.hpp"
#include "pipeline/sketch_clip.hpp"
#include "sketch/extract.hpp"

namespace emberfold::pipeline {

/// Holds how often a clip is read for the starts of a sampler's chains.
struct StartOptions {
  int chains = 3;  ///< with an odd number no share is exactly a half
  double perturb = 2;

  /// Returns what checks, help and docstrings say of the fields.
  static auto fields() {
    using core::between;
    return std::to_array<core::OptionField<StartOptions>>({
        {"chains", &StartOptions::chains, "N", between(1, 64),
         "Number of sampler chains, started from the clip forwards, backwards, with noise"},
        {"perturb", &StartOptions::perturb, "LEVELS", between(0, 64),
         "SD, in luma, of the noise that is added to the clip for some chains"},
    });
  }
  /// Throws core::InputError naming field, value and range.
  void validate() const;
};

/// Holds one reading of the clip.
struct StartReading {
  std::optional<std::size_t> copy;  ///< index of the noisy copy; none: the clip itself
  bool backwards = false;           ///< matched backwards in time, then reversed
};
/// Returns the reading of each chain.
/// The clip forwards, the clip backwards, a noisy copy forwards, another one backwards, and so on in turns of
/// four. At least half of all starts are of the clip itself.
std::vector<StartReading> readings(const StartOptions& options);

/// Holds the sketch of the clip and those of its noisy copies, as many as the readings need.
struct StartSketches {
  SketchedClip clip;
  std::vector<graph::SketchSequence> perturbed;
};

/// Reads the clip once and sketches each frame and its noisy copies.
/// The noise is white, Gaussian, independent in all channels and not clipped; luma has the SD `perturb`. It
/// depends on (seed, copy, frame) alone. Holds some frames and all graphs. Throws InputError,
/// core::Cancelled. Cost: 1 + copies sketches a frame.
StartSketches sketch_starts(core::FrameSource& source, const sketch::ExtractOptions& extract,
                            const StartOptions& options, std::uint64_t seed, const core::Context& context);

/// Matches every reading and returns a start for each chain, with strokes identified.
/// Chains with the same reading start alike. Forward and backward matching differ in ambiguous matches, since
/// velocities are carried on. Throws InputError where the number of copies does not fit the readings, and
/// core::Cancelled.
std::vector<graph::MotionGraph> match_starts(const StartSketches& sketches, const graph::MatchOptions& match,
                                             const StartOptions& options, const core::Context& context);

/// Sketches and matches dispersed starts for chains that cannot cross every barrier between readings.
std::vector<graph::MotionGraph> dispersed_starts(core::FrameSource& source,
                                                 const sketch::ExtractOptions& extract,
                                                 const graph::MatchOptions& match,
                                                 const StartOptions& options, std::uint64_t seed,
                                                 const core::Context& context);

}  // namespace emberfold::pipeline
