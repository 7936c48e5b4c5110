// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <string>
#include <vector>

#include "core/option_field.hpp"
#include "graph/events/events.hpp"

namespace emberfold::graph {

/// Tolerances within which a found event counts as a true one.
struct ScoreOptions {
  double frames = 2;
  double radius = 20;

  /// Returns what checks, help and docstrings say of the fields.
  static auto fields() {
    using core::at_least;
    return std::to_array<core::OptionField<ScoreOptions>>({
        {"frames", &ScoreOptions::frames, "N", at_least(0),
         "Count a true event at most this many frames away as a hit"},
        {"radius", &ScoreOptions::radius, "PX", at_least(0),
         "Count a true event at most this far away as a hit"},
    });
  }
  /// Throws InputError naming field, value and range.
  void validate() const;
};

/// Counts and ratios of one event class.
struct ClassScore {
  std::string name;
  std::size_t in_truth = 0, found = 0, hit = 0;
  [[nodiscard]] double precision() const;  ///< 0…1; 1 if nothing was found and nothing is in the truth
  [[nodiscard]] double recall() const;
  [[nodiscard]] double f1() const;
};

/// Scores of the classes that occur, in alphabetical order, then of "all".
/// `four` counts split and disconnect as "separate", merge and connect as "unite".
struct Score {
  std::vector<ClassScore> four, six;
};

/// Scores found events against the true ones.
/// Events of a class are paired one to one within the tolerances, by optimal assignment in time and place.
/// Throws InputError for invalid options. O(n³) in the events of a class.
Score score_events(const std::vector<Event>& truth, const std::vector<Event>& found,
                   const ScoreOptions& options = {});

}  // namespace emberfold::graph
