// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace emberfold::apps {

/// One stage of a command, as shown to the user.
struct PlannedStage {
  std::string name;
  std::vector<std::string> reports;  ///< names under which its parts report, in order; none: its own
  double seconds = 1;                ///< expected, > 0; only the ratios count
};

/// Follows a command through its planned stages. The remaining time is the planned time, scaled by the pace
/// of the stages so far; skipped stages do not affect the pace.
class RunProgress {
 public:
  explicit RunProgress(std::vector<PlannedStage> stages) : stages_(std::move(stages)) {}

  struct State {
    std::string stage;
    int number = 0, of = 0;  ///< stage i of n; 0 of 0 before the first
    double share = 0;        ///< done of the stage, 0…1
    double whole = 0;        ///< done of all, 0…1
    std::optional<double> seconds_left;
  };
  /// Records a report at `now` seconds. Reports that belong to no planned stage count for the current one.
  State report(std::string_view name, double share, double now);

 private:
  void enter(std::size_t stage, double now);
  [[nodiscard]] double planned(std::size_t from, std::size_t to) const;

  std::vector<PlannedStage> stages_;
  std::optional<std::size_t> at_;
  double share_ = 0, began_ = 0;
  double spent_ = 0, planned_spent_ = 0;  ///< of finished stages
};

}  // namespace emberfold::apps
