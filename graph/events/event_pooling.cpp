// SPDX-License-Identifier: Apache-2.0
#include "graph/events/event_pooling.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string>
#include <utility>

#include "core/error.hpp"
#include "core/text/check_range.hpp"
#include "graph/events/event_clusters.hpp"

namespace emberfold::graph {

namespace {

using detail::Cluster;
using detail::Family;

// Prior of the recurrence R of an event in another reading of its clip: kRecurred of kSeen observations, in
// units of one event that every sample has.
constexpr double kSeen = 5, kRecurred = 4;
// Least R: matching in time and place is strict, and clips of lower agreement still find two thirds of the
// events that all readings share again in other noise (docs/method/events.md).
constexpr double kLeastRecurrence = 0.6;

constexpr std::array<Family, 4> kFamilies = {Family::birth, Family::death, Family::unite, Family::separate};

bool counts_backwards(Family family) {
  return family == Family::death || family == Family::separate;
}

EventType type_of(Family family, bool bridge) {
  switch (family) {
    case Family::birth:
      return EventType::birth;
    case Family::death:
      return EventType::death;
    case Family::unite:
      return bridge ? EventType::connect : EventType::merge;
    case Family::separate:
      break;
  }
  return bridge ? EventType::disconnect : EventType::split;
}

void check(std::span<const std::vector<Event>> samples, const PoolOptions& options) {
  if (samples.empty()) throw core::InputError("pooled events: no samples, allowed is one at least");
  if (samples.size() > std::numeric_limits<std::uint32_t>::max()) {
    throw core::InputError("pooled events: " + std::to_string(samples.size()) +
                           " samples, allowed are fewer than 2^32");
  }
  if (options.readings > 0 && samples.size() % options.readings != 0) {
    throw core::InputError("pooled events: " + std::to_string(samples.size()) + " samples of " +
                           std::to_string(options.readings) + " readings, allowed are as many of each");
  }
  for (std::size_t k = 0; k < samples.size(); ++k) {
    for (const Event& event : samples[k]) {
      if (!std::isfinite(event.position.x) || !std::isfinite(event.position.y)) {
        throw core::InputError("pooled events: an event of sample " + std::to_string(k) + " in frame " +
                               std::to_string(event.frame) + " lies at no finite place");
      }
    }
  }
}

std::vector<Cluster> find_clusters(std::span<const std::vector<Event>> samples, Family family,
                                   const PoolOptions& options) {
  std::vector<detail::Observation> observations;
  for (std::uint32_t k = 0; k < samples.size(); ++k) {
    for (std::uint32_t e = 0; e < samples[k].size(); ++e) {
      const Event& event = samples[k][e];
      if (detail::family(event.type) != family) continue;
      const bool bridge = event.type == EventType::connect || event.type == EventType::disconnect;
      observations.push_back(
          {counts_backwards(family) ? -event.frame : event.frame, event.position, bridge, k, e});
    }
  }
  return detail::cluster_observations(std::move(observations), samples.size(), options);
}

/// Estimates a of the prior Beta(a, a) of event probabilities from how often readings agree.
/// Under it, an event of one reading recurs in another with probability R = (a + 1) / (2a + 1).
class ReadingAgreement {
 public:
  ReadingAgreement(std::size_t samples, std::size_t readings)
      : samples_(samples), readings_(readings), found_(std::max<std::size_t>(1, readings)) {}

  void add(const Cluster& cluster) {
    if (readings_ < 2) return;
    std::ranges::fill(found_, std::size_t{0});
    const std::size_t each = samples_ / readings_;
    for (const detail::Observation& seen : cluster.members) ++found_[seen.sample / each];
    // Sums of whole numbers do not depend on the order.
    for (const std::size_t n : found_) {
      again_ += n * (cluster.members.size() - n);
      seen_ += n * each * (readings_ - 1);
    }
  }
  /// Returns the probability that a further reading has an event which this share of the samples has.
  [[nodiscard]] double probability(double share) const {
    if (readings_ < 2) return share;
    const auto each = static_cast<double>(samples_ / readings_);
    const double weight = each * each * static_cast<double>(readings_ - 1);
    const double again = std::max(kLeastRecurrence, (static_cast<double>(again_) + kRecurred * weight) /
                                                        (static_cast<double>(seen_) + kSeen * weight));
    const double a = (1 - again) / (2 * again - 1);
    const auto n = static_cast<double>(readings_);
    return 0.5 + (share - 0.5) * n / (n + 2 * a);
  }

 private:
  std::size_t samples_, readings_;
  std::vector<std::size_t> found_;  // members of a cluster by reading
  std::uint64_t again_ = 0, seen_ = 0;
};

Event event_of(const Cluster& cluster, Family family, std::size_t samples,
               const ReadingAgreement& agreement) {
  const std::size_t all = cluster.members.size(), bridges = cluster.bridge_count();
  const bool bridge = 2 * bridges > all;
  const auto share = [&](std::size_t count) {
    return static_cast<double>(count) / static_cast<double>(samples);
  };
  Event event;
  event.frame = counts_backwards(family) ? -cluster.time : cluster.time;
  event.type = type_of(family, bridge);
  event.position = cluster.place;
  double seen = share(bridge ? bridges : all - bridges);
  if (seen < 0.5 && share(all) >= 0.5) seen = share(all);
  event.probability = agreement.probability(seen);
  return event;
}

}  // namespace

void PoolOptions::validate() const {
  core::check_range("PoolOptions.frames", frames, 0, 100);
  core::check_positive("PoolOptions.radius", radius);
}

std::vector<Event> pool_events(std::span<const std::vector<Event>> samples, std::size_t representative,
                               const PoolOptions& options) {
  options.validate();
  check(samples, options);
  if (representative >= samples.size()) {
    throw core::InputError("pooled events: the representative is sample " + std::to_string(representative) +
                           " of " + std::to_string(samples.size()) + ", counted from 0");
  }
  std::array<std::vector<Cluster>, kFamilies.size()> found;
  ReadingAgreement agreement(samples.size(), options.readings);
  for (std::size_t f = 0; f < found.size(); ++f) {
    found[f] = find_clusters(samples, kFamilies[f], options);
    for (const Cluster& cluster : found[f]) agreement.add(cluster);
  }
  std::vector<Event> result;
  for (std::size_t f = 0; f < found.size(); ++f) {
    for (const Cluster& cluster : found[f]) {
      Event event = event_of(cluster, kFamilies[f], samples.size(), agreement);
      for (const detail::Observation& seen : cluster.members) {
        if (seen.sample != representative) continue;
        event.before = samples[seen.sample][seen.event].before;
        event.after = samples[seen.sample][seen.event].after;
      }
      result.push_back(std::move(event));
    }
  }
  sort_events(result);
  return result;
}

std::size_t find_representative(std::span<const std::vector<Event>> samples, const PoolOptions& options) {
  options.validate();
  check(samples, options);
  // 2 · samples · Σ (probability − ½), a whole number; an event outside all clusters has probability 0.
  std::vector<std::int64_t> agreement(samples.size());
  const auto count = static_cast<std::int64_t>(samples.size());
  for (std::size_t k = 0; k < samples.size(); ++k) {
    agreement[k] = -count * static_cast<std::int64_t>(samples[k].size());
  }
  for (const Family family : kFamilies) {
    for (const Cluster& cluster : find_clusters(samples, family, options)) {
      for (const detail::Observation& seen : cluster.members) {
        agreement[seen.sample] += 2 * static_cast<std::int64_t>(cluster.members.size());
      }
    }
  }
  std::size_t best = 0;
  for (std::size_t k = 1; k < samples.size(); ++k) {
    if (agreement[k] > agreement[best]) best = k;
  }
  return best;
}

}  // namespace emberfold::graph
