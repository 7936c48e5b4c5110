// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/context.hpp"
#include "core/option_field.hpp"
#include "graph/matching/match.hpp"
#include "mcmc/learning/fit.hpp"
#include "mcmc/simulation/event_statistics.hpp"
#include "sketch/extract.hpp"
#include "sketch/rendering/frame_renderer.hpp"

namespace emberfold::pipeline {

/// Most frames that are drawn in a round of a calibration, and looked at in the clip.
inline constexpr int kCalibrationFrames = 150;

/// Holds the settings of calibrate().
struct CalibrateOptions {
  int calibrate = 2;  ///< made when strokes are first drawn from the model

  /// Returns what checks, help and docstrings say of the fields.
  static auto fields() {
    using core::between;
    return std::to_array<core::OptionField<CalibrateOptions>>({
        {"calibrate", &CalibrateOptions::calibrate, "ROUNDS", between(0, 20),
         "Draw from the model, analyse the clip and correct the rates; 0: never"},
    });
  }
  /// Throws core::InputError naming field, value and range.
  void validate() const;
};

/// Holds how the clip was analysed, and how clips are drawn from its model.
struct ReadingAndDrawing {
  sketch::ExtractOptions sketch;
  graph::MatchOptions match;
  sketch::RenderOptions look;
};

/// Draws a clip from the model, analyses it bottom-up and returns its event statistics.
/// `frames` ≥ 2 frames from the stationary state are drawn, sketched and matched. Throws core::Cancelled.
mcmc::EventStatistics seen_when_drawn(const mcmc::MotionModel& model, const ReadingAndDrawing& how,
                                      int frames, std::uint64_t seed, const core::Context& context);

/// Corrects the rates of a learned model so that drawn and analysed clips show the statistics `source`.
/// `source` is of the clip itself, from the same bottom-up analysis. A detector misses some events and finds
/// others that did not happen, which only an analysis of drawn clips can measure (indirect inference:
/// Gourieroux, Monfort & Renault 1993). In each round as many frames as the clip has, at most 150, are drawn
/// and analysed; the frequency of each kind of event that the model is balanced to is multiplied by (source /
/// seen)^(1 / round). Number and sizes of strokes are not corrected: the undetected ones lie under others,
/// and more strokes would hide more. Returns the statistics of each round before its correction. Throws
/// core::Cancelled.
std::vector<mcmc::EventStatistics> calibrate(mcmc::FitResult& fitted, const mcmc::EventStatistics& source,
                                             const ReadingAndDrawing& how, const CalibrateOptions& options,
                                             std::uint64_t seed, const core::Context& context);

}  // namespace emberfold::pipeline
