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

/// Which strokes are left: half of the patches each, by how wide their strokes are on average (width and
/// twice the blur).
enum class StrokeChoice { all, coarse, fine };

/// How a motion model is to be changed, in this order; as it stands, not at all.
struct MotionEdit {
  double speed = 1;      ///< 0.1…10: everything happens so many times as fast
  bool reverse = false;  ///< time runs backwards
  double intensity = 1;  ///< 0…10: of the Brownian force that makes strokes displacement, SD
  double flicker = 1;    ///< 0…10: of what makes their contrast change, SD
  StrokeChoice strokes = StrokeChoice::all;
  /// Of births, as much as is painted in each cell of the model's grid; ≥ 0, not all 0.
  std::optional<CellMap> birth_map;
  /// 0…10: how many times as often births, deaths, splits, merges, connects and disconnects happen; births
  /// over deaths at most 4 (more would never come to rest, or crowd the frame).
  std::array<double, 6> rates = {1, 1, 1, 1, 1, 1};

  /// InputError, naming field, value and what is allowed.
  void validate() const;
};

struct EditedMotion {
  MotionModel model;
  std::vector<std::string> notes;  ///< a line for everything that could not be had as asked
};

/// The model, changed. What changes how many strokes there are (all but intensity and flicker) is settled by
/// simulating: events that are asked for happen as often as asked, for other events the rates at their places
/// stay, and the edited model begins in the state that it then keeps to. A neutral edit gives the same model.
/// InputError for an edit or a model that is not valid, a birth map of another grid, or where no stroke is
/// left. Some thousand simulated frames.
EditedMotion edit_motion(const MotionModel& model, const MotionEdit& edit, std::uint64_t seed = 1,
                         const core::Context& context = {});

/// The law sped up: its poles to the power `factor` (real negative ones keep their sign), at the same
/// stationary deviation.
Autoregression change_speed(const Autoregression& motion, double factor);

}  // namespace emberfold::mcmc
