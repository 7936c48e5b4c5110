// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "apps/gathering/gathered_runs.hpp"
#include "core/math/group_rates.hpp"

namespace emberfold::apps {

/// Names the unit of rates: the finest that all runs have.
enum class RateUnit { frame, second, second_and_mm2 };

/// Returns "frame", "second" or "second and mm2".
std::string name(RateUnit unit);

/// One rate: of a run or of a group of runs.
struct GatheredRate {
  std::string group, run;  ///< no run: for the whole group
  std::string type;        ///< class of events, or "all"
  double count = 0, exposure = 0;
  core::Interval rate;    ///< with its 90 % interval
  double dispersion = 1;  ///< of a group's clips
};

/// Compares the frequency of a type of event in two groups.
struct GatheredTest {
  std::string first, second, type;
  core::GroupComparison found;  ///< ratio: of second to first
};

struct GroupStatistics {
  RateUnit unit = RateUnit::frame;
  std::vector<std::string> groups;  ///< sorted
  std::vector<std::string> types;   ///< six classes, then "all"
  std::vector<GatheredRate> rates;  ///< by group, its runs first; by type in each
  std::vector<GatheredTest> tests;  ///< of every pair of groups, the first sorted before the second
};

/// Measures the rates of all runs and groups, and compares every pair of groups. At most 20 groups are
/// compared.
GroupStatistics measure_groups(const std::vector<GatheredRun>& runs, std::uint64_t seed);

}  // namespace emberfold::apps
