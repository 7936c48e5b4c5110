// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "graph/events/events.hpp"

namespace emberfold::graph {

struct ScoreOptions {
  double frames = 2;   ///< a true event at most so many frames away is a hit, ≥ 0
  double radius = 20;  ///< px, ≥ 0
  void validate() const;
};

struct ClassScore {
  std::string name;
  std::size_t in_truth = 0, found = 0, hit = 0;
  [[nodiscard]] double precision() const;  ///< 1 where nothing was found and nothing was there
  [[nodiscard]] double recall() const;
  [[nodiscard]] double f1() const;
};

/// The classes that are in the truth or were found, in alphabetical order, then "all". Four classes count
/// split and disconnect as `separate`, merge and connect as `unite`.
struct Score {
  std::vector<ClassScore> four, six;
};

/// Found and true events of a class are paired one to one within the tolerance, at the least total distance
/// in time and place (optimal assignment). O(n³) in the events of a class.
Score score_events(const std::vector<Event>& truth, const std::vector<Event>& found,
                   const ScoreOptions& options = {});

}  // namespace emberfold::graph
