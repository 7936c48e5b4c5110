// SPDX-License-Identifier: Apache-2.0
#include "apps/gathering/group_statistics.hpp"

#include <algorithm>
#include <map>
#include <set>

#include "graph/events/events.hpp"

namespace emberfold::apps {

namespace {

constexpr double kLevel = 0.9;
constexpr std::size_t kMostGroups = 20;

RateUnit finest_unit(const std::vector<GatheredRun>& runs) {
  const auto all_know = [&](auto field) {
    return std::ranges::all_of(runs, [&](const auto& r) { return (r.*field).has_value(); });
  };
  if (all_know(&GatheredRun::area_seconds)) return RateUnit::second_and_mm2;
  return all_know(&GatheredRun::seconds) ? RateUnit::second : RateUnit::frame;
}

double exposure_of(const GatheredRun& run, RateUnit unit) {
  if (unit == RateUnit::second_and_mm2) return *run.area_seconds;
  return unit == RateUnit::second ? *run.seconds : run.counted_frames;
}

core::CountedClip counted(const GatheredRun& run, const std::string& type, RateUnit unit) {
  const auto found = run.counts.find(type);
  return {found == run.counts.end() ? 0 : found->second, exposure_of(run, unit)};
}

std::vector<core::CountedClip> counted(const std::vector<const GatheredRun*>& runs, const std::string& type,
                                       RateUnit unit) {
  std::vector<core::CountedClip> clips;
  for (const auto* run : runs) clips.push_back(counted(*run, type, unit));
  return clips;
}

}  // namespace

std::string name(RateUnit unit) {
  if (unit == RateUnit::second_and_mm2) return "second and mm2";
  return unit == RateUnit::second ? "second" : "frame";
}

GroupStatistics measure_groups(const std::vector<GatheredRun>& runs, std::uint64_t seed) {
  GroupStatistics found;
  found.unit = finest_unit(runs);
  for (const auto type : graph::all_event_types()) found.types.emplace_back(graph::name(type));
  found.types.emplace_back("all");
  std::map<std::string, std::vector<const GatheredRun*>> groups;
  for (const auto& run : runs) groups[run.group].push_back(&run);
  for (const auto& [group, members] : groups) {
    found.groups.push_back(group);
    for (const auto* run : members)
      for (const auto& type : found.types) {
        const auto one = counted(*run, type, found.unit);
        found.rates.push_back({group, run->run, type, one.count, one.exposure,
                               core::event_rate(one.count, one.exposure, kLevel), 1});
      }
    for (const auto& type : found.types) {
      const auto clips = counted(members, type, found.unit);
      const auto all = core::group_rate(clips, kLevel);
      core::CountedClip sum;
      for (const auto& clip : clips) sum.count += clip.count, sum.exposure += clip.exposure;
      found.rates.push_back({group, {}, type, sum.count, sum.exposure, all.rate, all.dispersion});
    }
  }
  if (groups.size() > kMostGroups) return found;
  for (auto first = groups.begin(); first != groups.end(); ++first)
    for (auto second = std::next(first); second != groups.end(); ++second)
      for (const auto& type : found.types)
        found.tests.push_back(
            {first->first, second->first, type,
             core::compare_groups(counted(first->second, type, found.unit),
                                  counted(second->second, type, found.unit), kLevel, seed)});
  return found;
}

}  // namespace emberfold::apps
