// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/context.hpp"
#include "mcmc/model/motion_model.hpp"

namespace emberfold::mcmc {

/// Choice of strokes: all, or the half of the patches in the wider or finer strokes, by mean width + 2 ·
/// blur.
enum class StrokeChoice { all, coarse, fine };

/// Holds changes to a motion model, applied in this order; by default none.
struct MotionEdit {
  double speed = 1;      ///< 0.1…10: factor of the speed of all motion and events
  bool reverse = false;  ///< time runs backwards
  double intensity = 1;  ///< 0…10: factor of the SD of the displacement's noise
  double flicker = 1;    ///< 0…10: factor of the SD of the contrast's noise
  double contrast = 1;   ///< 0.1…10: factor of the strokes' contrast
  graph::Point wind;     ///< px a frame, −8…8 each: added to the drift of all strokes
  StrokeChoice strokes = StrokeChoice::all;
  /// Shares of births in each cell of the model's grid; ≥ 0, not all 0.
  std::optional<CellMap> birth_map;
  /// 0…10: factors of the numbers of births, deaths, splits, merges, connects and disconnects; births over
  /// deaths at most 4 (more would crowd the frame without end).
  std::array<double, 6> rates = {1, 1, 1, 1, 1, 1};

  /// Throws core::InputError, naming field, value and range.
  void validate() const;
  bool operator==(const MotionEdit&) const = default;
};

/// Holds an edited model.
struct EditedMotion {
  MotionModel model;
  std::vector<std::string> notes;  ///< one line for each change that could not be made in full
};

/// Returns an edited copy of a model.
/// Edits that change the number of strokes (all but intensity, flicker and contrast) are settled by
/// simulation: events
/// that are asked for happen as often as asked, other events keep their rates per site, and the edited model
/// starts in its own stationary state. What the wind carries out of the frame is born at its other side.
/// A neutral edit returns the same model. Throws core::InputError for an
/// invalid edit or model, a birth map of another grid, and where no stroke is left. Some thousand simulated
/// frames.
EditedMotion edit_motion(const MotionModel& model, const MotionEdit& edit, std::uint64_t seed = 1,
                         const core::Context& context = {});

/// Returns a law sped up: its poles to the power `factor`, at the same stationary SD.
/// Real negative poles keep their sign.
Autoregression change_speed(const Autoregression& motion, double factor);

}  // namespace emberfold::mcmc
