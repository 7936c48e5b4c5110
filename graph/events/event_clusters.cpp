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
constexpr int kRounds = 5;

/// Time and place only, so that neither the order of samples nor the sense of time matters.
auto order(const Sighting& s) {
  return std::tie(s.time, s.place.x, s.place.y, s.bridge, s.sample, s.event);
}

/// Sightings in order, and those about a time and place.
class Field {
 public:
  Field(std::vector<Sighting> sightings, const PoolOptions& options)
      : all_(std::move(sightings)), options_(options) {
    std::sort(all_.begin(), all_.end(), [](const auto& a, const auto& b) { return order(a) < order(b); });
  }
  [[nodiscard]] const std::vector<Sighting>& all() const { return all_; }

  /// Calls take(index) for all within the tolerance, in order.
  template <class Take>
  void around(int time, Point place, Take take) const {
    for (int t = time - options_.frames; t <= time + options_.frames; ++t) {
      const auto from = std::pair(t, place.x - options_.radius);
      auto at = std::lower_bound(all_.begin(), all_.end(), from, [](const Sighting& s, const auto& key) {
        return std::pair(s.time, s.place.x) < key;
      });
      for (; at != all_.end() && at->time == t && at->place.x <= place.x + options_.radius; ++at) {
        if (distance(at->place, place) <= options_.radius) {
          take(static_cast<std::uint32_t>(at - all_.begin()));
        }
      }
    }
  }

  /// How near a sighting within the tolerance is, 4096 at most: whole numbers add up alike in
  /// any order.
  [[nodiscard]] std::int64_t closeness(const Sighting& s, int time, Point place) const {
    const double apart = distance(s.place, place) / options_.radius;
    const double late = std::abs(s.time - time) / (options_.frames + 1.0);
    return std::llround(4096 - 1024 * apart * apart - 1024 * late * late);
  }

 private:
  std::vector<Sighting> all_;
  const PoolOptions& options_;
};

/// Where a cluster of these members, in order, lies: at the time that most of them have (of several, where
/// most are near, then the first), at the medians of x and y there.
Cluster settled(std::vector<Sighting> members, const PoolOptions& options) {
  std::map<int, std::size_t> counts;
  for (const Sighting& s : members) ++counts[s.time];
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
  for (const Sighting& s : members) {
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

/// Clusters made one after the other of sightings that are in none, the greatest first: each is what most
/// samples have near one of the sightings, one of each sample.
class Greedy {
 public:
  Greedy(const Field& field, std::vector<bool>& used, const PoolOptions& options)
      : field_(field), used_(used), options_(options), weight_(field.all().size(), 0) {}

  void run(std::vector<Cluster>& result) {
    for (std::uint32_t i = 0; i < weight_.size(); ++i) weigh(i);
    while (!queue_.empty()) {
      const std::uint32_t centre = queue_.begin()->second;
      const auto members = nearest(centre);
      std::set<std::uint32_t> touched;
      std::vector<Sighting> taken;
      for (const std::uint32_t m : members) {
        used_[m] = true;
        taken.push_back(field_.all()[m]);
        about(m, [&](std::uint32_t i) { touched.insert(i); });
      }
      for (const std::uint32_t i : touched) weigh(i);
      std::sort(taken.begin(), taken.end(), [](const auto& a, const auto& b) { return order(a) < order(b); });
      result.push_back(settled(std::move(taken), options_));
    }
  }

 private:
  template <class Take>
  void about(std::uint32_t i, Take take) const {
    field_.around(field_.all()[i].time, field_.all()[i].place, take);
  }

  /// Of each sample the sighting nearest to this one.
  [[nodiscard]] std::vector<std::uint32_t> nearest(std::uint32_t centre) const {
    std::vector<std::tuple<std::uint32_t, std::int64_t, std::uint32_t>> near;  // sample, farness, index
    const Sighting& c = field_.all()[centre];
    about(centre, [&](std::uint32_t i) {
      const Sighting& s = field_.all()[i];
      if (!used_[i]) near.emplace_back(s.sample, -field_.closeness(s, c.time, c.place), i);
    });
    std::sort(near.begin(), near.end());
    std::vector<std::uint32_t> result;
    for (std::size_t k = 0; k < near.size(); ++k) {
      if (k == 0 || std::get<0>(near[k]) != std::get<0>(near[k - 1])) result.push_back(std::get<2>(near[k]));
    }
    return result;
  }

  /// Puts a sighting where it belongs in the queue: greatest weight first, then in order.
  void weigh(std::uint32_t i) {
    queue_.erase({-weight_[i], i});
    if (used_[i]) return;
    const Sighting& c = field_.all()[i];
    weight_[i] = 0;
    for (const std::uint32_t m : nearest(i)) weight_[i] += field_.closeness(field_.all()[m], c.time, c.place);
    queue_.insert({-weight_[i], i});
  }

  const Field& field_;
  std::vector<bool>& used_;
  const PoolOptions& options_;
  std::vector<std::int64_t> weight_;
  std::set<std::pair<std::int64_t, std::uint32_t>> queue_;
};

/// Gives each sample's sightings to the clusters, one to one, so that as many as can be have one and these
/// are likeliest: a mixture of Gaussians about the clusters' times and places, weighted by how many members
/// they have and of which class. Clusters without members are dropped; `used` tells who has one.
void give_out(const Field& field, std::size_t samples, const PoolOptions& options,
              std::vector<Cluster>& clusters, std::vector<bool>& used) {
  std::sort(clusters.begin(), clusters.end(), [](const Cluster& a, const Cluster& b) {
    return std::tie(a.time, a.place.x, a.place.y) < std::tie(b.time, b.place.x, b.place.y);
  });
  const double sigma = options.radius / 2.5, late = std::max(0.5, options.frames / 1.5);
  std::vector<std::vector<Candidate>> candidates(samples);
  for (std::uint32_t c = 0; c < clusters.size(); ++c) {
    const Cluster& cluster = clusters[c];
    const auto count = static_cast<double>(cluster.members.size());
    const double bridges = static_cast<double>(cluster.bridges());
    field.around(cluster.time, cluster.place, [&](std::uint32_t i) {
      const Sighting& s = field.all()[i];
      const double apart = distance(s.place, cluster.place) / sigma, off = (s.time - cluster.time) / late;
      const double alike = s.bridge ? bridges : count - bridges;
      // Far above what likelihoods differ by: one pair more is worth any of them.
      constexpr double kPair = 1000;
      candidates[s.sample].push_back({i, c,
                                      kPair + std::log(count + 0.5) + std::log((alike + 0.5) / (count + 1)) -
                                          0.5 * (apart * apart + off * off)});
    });
    clusters[c].members.clear();
  }
  std::fill(used.begin(), used.end(), false);
  std::vector<std::uint32_t> row(field.all().size(), kNone);
  for (auto& of_sample : candidates) {
    std::vector<std::uint32_t> rows;  // the assignment takes memory for the highest row
    for (const Candidate& candidate : of_sample) rows.push_back(candidate.row);
    std::sort(rows.begin(), rows.end());
    rows.erase(std::unique(rows.begin(), rows.end()), rows.end());
    for (std::uint32_t k = 0; k < rows.size(); ++k) row[rows[k]] = k;
    for (Candidate& candidate : of_sample) candidate.row = row[candidate.row];
    for (const auto& [k, c] : assign(of_sample)) {
      clusters[c].members.push_back(field.all()[rows[k]]);
      used[rows[k]] = true;
    }
  }
  std::erase_if(clusters, [](const Cluster& cluster) { return cluster.members.empty(); });
  for (Cluster& cluster : clusters) {
    std::sort(cluster.members.begin(), cluster.members.end(),
              [](const auto& a, const auto& b) { return order(a) < order(b); });
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

std::size_t Cluster::bridges() const {
  return static_cast<std::size_t>(
      std::count_if(members.begin(), members.end(), [](const Sighting& s) { return s.bridge; }));
}

std::vector<Cluster> clusters(std::vector<Sighting> sightings, std::size_t samples,
                              const PoolOptions& options) {
  const Field field(std::move(sightings), options);
  std::vector<bool> used(field.all().size(), false);
  std::vector<Cluster> result;
  for (int round = 0; round < kRounds; ++round) {
    Greedy(field, used, options).run(result);
    give_out(field, samples, options, result, used);
    for (Cluster& cluster : result) cluster = settled(std::move(cluster.members), options);
  }
  Greedy(field, used, options).run(result);
  give_out(field, samples, options, result, used);
  return result;
}

}  // namespace emberfold::graph::detail
