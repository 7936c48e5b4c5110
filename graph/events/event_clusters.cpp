// SPDX-License-Identifier: Apache-2.0
#include "graph/events/event_clusters.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <tuple>
#include <utility>

#include "graph/matching/assignment.hpp"

namespace emberfold::graph::detail {

namespace {

constexpr std::uint32_t kNone = ~std::uint32_t{0};
constexpr int kRounds = 5;       // of assignment and re-centring
constexpr double kUnits = 4096;  // closeness of two equal observations, in whole units: their sums are exact
constexpr double kFalloff = 1024;  // units lost at the tolerance, in place and in time each
// SDs of the mixture by which observations are assigned.
constexpr double kRadiusInSds = 2.5, kFramesInSds = 1.5;
constexpr double kLeastLateness = 0.5;  // frames: least SD in time
// Gain of a pair, nats: above any difference of log-likelihoods, so that as many as possible are paired.
constexpr double kPairGain = 1000;

/// Orders by time and place first, so that neither the order of samples nor the direction of time matters.
auto sort_key(const Observation& s) {
  return std::tie(s.time, s.place.x, s.place.y, s.bridge, s.sample, s.event);
}

/// Sorted observations with look-up by time and place.
class ObservationIndex {
 public:
  ObservationIndex(std::vector<Observation> observations, const PoolOptions& options)
      : all_(std::move(observations)), options_(options) {
    std::sort(all_.begin(), all_.end(),
              [](const auto& a, const auto& b) { return sort_key(a) < sort_key(b); });
  }
  [[nodiscard]] const std::vector<Observation>& all() const { return all_; }

  /// Calls take(index) for all observations within the tolerance, in order.
  template <class Take>
  void for_each_near(int time, Point place, Take take) const {
    for (int t = time - options_.frames; t <= time + options_.frames; ++t) {
      const auto from = std::pair(t, place.x - options_.radius);
      auto at = std::lower_bound(all_.begin(), all_.end(), from, [](const Observation& s, const auto& key) {
        return std::pair(s.time, s.place.x) < key;
      });
      for (; at != all_.end() && at->time == t && at->place.x <= place.x + options_.radius; ++at) {
        if (distance(at->place, place) <= options_.radius) {
          take(static_cast<std::uint32_t>(at - all_.begin()));
        }
      }
    }
  }

  /// Returns the closeness of an observation within the tolerance, at most kUnits.
  [[nodiscard]] std::int64_t closeness(const Observation& s, int time, Point place) const {
    const double apart = distance(s.place, place) / options_.radius;
    const double late = std::abs(s.time - time) / (options_.frames + 1.0);
    return std::llround(kUnits - kFalloff * apart * apart - kFalloff * late * late);
  }

 private:
  std::vector<Observation> all_;
  const PoolOptions& options_;
};

/// Makes a cluster of members, which are in order, and places it.
/// Its time is that of most members (of several, the one with most members near, then the first); its place
/// is given by the medians of x and y at that time.
Cluster make_cluster(std::vector<Observation> members, const PoolOptions& options) {
  std::map<int, std::size_t> counts;
  for (const Observation& s : members) ++counts[s.time];
  const auto near = [&](int time) {
    std::size_t sum = 0;
    for (auto at = counts.lower_bound(time - options.frames);
         at != counts.end() && at->first <= time + options.frames; ++at) {
      sum += at->second;
    }
    return sum;
  };
  Cluster result;
  std::pair<std::size_t, std::size_t> most;
  for (const auto& [time, count] : counts) {
    const std::pair here(count, near(time));
    if (here > most) most = here, result.time = time;
  }
  std::vector<double> x, y;
  for (const Observation& s : members) {
    if (s.time == result.time) x.push_back(s.place.x), y.push_back(s.place.y);
  }
  const auto median = [](std::vector<double>& values) {
    std::sort(values.begin(), values.end());
    return 0.5 * (values[(values.size() - 1) / 2] + values[values.size() / 2]);
  };
  result.place = {median(x), median(y)};
  result.members = std::move(members);
  return result;
}

/// Forms clusters of unused observations, the heaviest first.
/// A cluster has a centre observation and the nearest observation of each sample within the tolerance.
class GreedyClustering {
 public:
  GreedyClustering(const ObservationIndex& index, std::vector<bool>& used, const PoolOptions& options)
      : index_(index), used_(used), options_(options), weight_(index.all().size(), 0) {}

  void run(std::vector<Cluster>& result) {
    for (std::uint32_t i = 0; i < weight_.size(); ++i) update_weight(i);
    while (!queue_.empty()) {
      const std::uint32_t centre = queue_.begin()->second;
      const auto members = nearest_of_each_sample(centre);
      std::set<std::uint32_t> touched;
      std::vector<Observation> taken;
      for (const std::uint32_t m : members) {
        used_[m] = true;
        taken.push_back(index_.all()[m]);
        for_each_near(m, [&](std::uint32_t i) { touched.insert(i); });
      }
      for (const std::uint32_t i : touched) update_weight(i);
      std::sort(taken.begin(), taken.end(),
                [](const auto& a, const auto& b) { return sort_key(a) < sort_key(b); });
      result.push_back(make_cluster(std::move(taken), options_));
    }
  }

 private:
  template <class Take>
  void for_each_near(std::uint32_t i, Take take) const {
    index_.for_each_near(index_.all()[i].time, index_.all()[i].place, take);
  }

  /// Finds the nearest unused observation of each sample.
  [[nodiscard]] std::vector<std::uint32_t> nearest_of_each_sample(std::uint32_t centre) const {
    std::vector<std::tuple<std::uint32_t, std::int64_t, std::uint32_t>> near;  // sample, farness, index
    const Observation& c = index_.all()[centre];
    for_each_near(centre, [&](std::uint32_t i) {
      const Observation& s = index_.all()[i];
      if (!used_[i]) near.emplace_back(s.sample, -index_.closeness(s, c.time, c.place), i);
    });
    std::sort(near.begin(), near.end());
    std::vector<std::uint32_t> result;
    for (std::size_t k = 0; k < near.size(); ++k) {
      if (k == 0 || std::get<0>(near[k]) != std::get<0>(near[k - 1])) result.push_back(std::get<2>(near[k]));
    }
    return result;
  }

  /// Updates the place of an observation in the queue: greatest weight first, then in order.
  void update_weight(std::uint32_t i) {
    queue_.erase({-weight_[i], i});
    if (used_[i]) return;
    const Observation& c = index_.all()[i];
    weight_[i] = 0;
    for (const std::uint32_t m : nearest_of_each_sample(i))
      weight_[i] += index_.closeness(index_.all()[m], c.time, c.place);
    queue_.insert({-weight_[i], i});
  }

  const ObservationIndex& index_;
  std::vector<bool>& used_;
  const PoolOptions& options_;
  std::vector<std::int64_t> weight_;
  std::set<std::pair<std::int64_t, std::uint32_t>> queue_;
};

/// Assigns each sample's observations to the clusters, one to one: as many as possible, then the likeliest.
/// The likelihood is a mixture of Gaussians about the clusters, weighted by their members and their classes.
/// Clusters without members are dropped; `used` marks the observations that have a cluster.
void assign_observations(const ObservationIndex& index, std::size_t samples, const PoolOptions& options,
                         std::vector<Cluster>& clusters, std::vector<bool>& used) {
  std::sort(clusters.begin(), clusters.end(), [](const Cluster& a, const Cluster& b) {
    return std::tie(a.time, a.place.x, a.place.y) < std::tie(b.time, b.place.x, b.place.y);
  });
  const double sigma = options.radius / kRadiusInSds,
               late = std::max(kLeastLateness, options.frames / kFramesInSds);
  std::vector<std::vector<Candidate>> candidates(samples);
  for (std::uint32_t c = 0; c < clusters.size(); ++c) {
    const Cluster& cluster = clusters[c];
    const auto count = static_cast<double>(cluster.members.size());
    const double bridges = static_cast<double>(cluster.bridge_count());
    index.for_each_near(cluster.time, cluster.place, [&](std::uint32_t i) {
      const Observation& s = index.all()[i];
      const double apart = distance(s.place, cluster.place) / sigma, off = (s.time - cluster.time) / late;
      const double alike = s.bridge ? bridges : count - bridges;
      candidates[s.sample].push_back({i, c,
                                      kPairGain + std::log(count + 0.5) +
                                          std::log((alike + 0.5) / (count + 1)) -
                                          0.5 * (apart * apart + off * off)});
    });
    clusters[c].members.clear();
  }
  std::fill(used.begin(), used.end(), false);
  std::vector<std::uint32_t> row(index.all().size(), kNone);
  for (auto& of_sample : candidates) {
    std::vector<std::uint32_t> rows;  // renumbered: the assignment takes memory for the highest row
    for (const Candidate& candidate : of_sample) rows.push_back(candidate.row);
    std::sort(rows.begin(), rows.end());
    rows.erase(std::unique(rows.begin(), rows.end()), rows.end());
    for (std::uint32_t k = 0; k < rows.size(); ++k) row[rows[k]] = k;
    for (Candidate& candidate : of_sample) candidate.row = row[candidate.row];
    for (const auto& [k, c] : assign(of_sample)) {
      clusters[c].members.push_back(index.all()[rows[k]]);
      used[rows[k]] = true;
    }
  }
  std::erase_if(clusters, [](const Cluster& cluster) { return cluster.members.empty(); });
  for (Cluster& cluster : clusters) {
    std::sort(cluster.members.begin(), cluster.members.end(),
              [](const auto& a, const auto& b) { return sort_key(a) < sort_key(b); });
  }
}

}  // namespace

Family family(EventType type) {
  switch (type) {
    case EventType::birth:
      return Family::birth;
    case EventType::death:
      return Family::death;
    case EventType::merge:
    case EventType::connect:
      return Family::unite;
    case EventType::split:
    case EventType::disconnect:
      break;
  }
  return Family::separate;
}

std::size_t Cluster::bridge_count() const {
  return static_cast<std::size_t>(
      std::count_if(members.begin(), members.end(), [](const Observation& s) { return s.bridge; }));
}

std::vector<Cluster> cluster_observations(std::vector<Observation> observations, std::size_t samples,
                                          const PoolOptions& options) {
  const ObservationIndex index(std::move(observations), options);
  std::vector<bool> used(index.all().size(), false);
  std::vector<Cluster> result;
  for (int round = 0; round < kRounds; ++round) {
    GreedyClustering(index, used, options).run(result);
    assign_observations(index, samples, options, result, used);
    for (Cluster& cluster : result) cluster = make_cluster(std::move(cluster.members), options);
  }
  GreedyClustering(index, used, options).run(result);
  assign_observations(index, samples, options, result, used);
  return result;
}

}  // namespace emberfold::graph::detail
