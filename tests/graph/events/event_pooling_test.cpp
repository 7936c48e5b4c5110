// SPDX-License-Identifier: Apache-2.0
#include "graph/events/event_pooling.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <string>

#include "core/error.hpp"
#include "core/rng.hpp"
#include "graph/matching/time_reversal.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/graphs.hpp"
#include "tests/support/messages.hpp"

using namespace emberfold;
using namespace emberfold::test;
using graph::Event;
using graph::EventType;
using graph::Point;

namespace {

using Samples = std::vector<std::vector<Event>>;

constexpr std::array<EventType, 6> kTypes = {EventType::birth, EventType::death,   EventType::split,
                                             EventType::merge, EventType::connect, EventType::disconnect};

Event at(int frame, Point place, EventType type = EventType::birth) {
  return {frame, type, place, 1, {}, {}};
}

/// Events at true times and places, seen by each sample with some probability and up to a frame and a few
/// pixels off, unions and separations sometimes in their other class; many near each other. Places are
/// quarters of pixels, so that ties are common.
Samples world(std::uint64_t seed, std::size_t count, int events, double size) {
  core::Rng rng(seed);
  std::vector<Event> truth;
  for (int k = 0; k < events; ++k) {
    truth.push_back(at(5 + static_cast<int>(rng.below(20)), {rng.uniform(0, size), rng.uniform(0, size)},
                       kTypes[rng.below(6)]));
    truth.back().probability = rng.uniform();
  }
  const auto rounded = [](double x) { return std::round(4 * x) / 4; };
  Samples samples(count);
  std::uint32_t stroke = 0;
  for (auto& sample : samples) {
    for (Event event : truth) {
      if (rng.uniform() > event.probability) continue;
      event.probability = 1;
      event.frame += static_cast<int>(rng.below(3)) - 1;
      event.position = {rounded(event.position.x + 1.5 * rng.normal()),
                        rounded(event.position.y + 1.5 * rng.normal())};
      if (rng.uniform() < 0.3) {
        const std::map<EventType, EventType> other = {{EventType::merge, EventType::connect},
                                                      {EventType::connect, EventType::merge},
                                                      {EventType::split, EventType::disconnect},
                                                      {EventType::disconnect, EventType::split}};
        if (other.contains(event.type)) event.type = other.at(event.type);
      }
      event.before = {{++stroke}};
      event.after = {{++stroke}, {++stroke}};
      sample.push_back(std::move(event));
    }
    graph::sort_events(sample);
  }
  return samples;
}

/// Birth 0, death 1, union 2, separation 3.
int family(EventType type) {
  if (type == EventType::birth) return 0;
  if (type == EventType::death) return 1;
  return type == EventType::merge || type == EventType::connect ? 2 : 3;
}

}  // namespace

TEST_CASE("one sample is its own pool") {
  Samples samples = world(3, 1, 60, 400);
  CHECK(graph::pool_events(samples) == samples[0]);
  CHECK(graph::find_representative(samples) == 0);
}

TEST_CASE("samples that agree give their events with probability 1") {
  const Samples one = world(4, 1, 60, 400);
  const Samples samples(7, one[0]);
  CHECK(graph::pool_events(samples, 3) == one[0]);
}

TEST_CASE("an event of three samples in four has probability three quarters, where most have it") {
  Samples samples = {{at(10, {50, 60})}, {at(10, {52, 60})}, {at(11, {54, 67})}, {}};
  samples[1][0].after = {{7}};
  const auto pooled = graph::pool_events(samples, 1);
  REQUIRE(pooled.size() == 1);
  CHECK(pooled[0].frame == 10);
  CHECK(pooled[0].position == Point{51, 60});
  CHECK(pooled[0].probability == 0.75);
  CHECK(pooled[0].after == std::vector<graph::SubgraphId>{{7}});
  CHECK(pooled[0].before.empty());
  // A representative without the event cannot name its strokes.
  CHECK(graph::pool_events(samples, 3)[0].after.empty());
}

TEST_CASE("what is farther than one frame or ten pixels or of another kind is another event") {
  const Event event = at(10, {50, 60});
  for (const Event& other : {at(12, {50, 60}), at(8, {50, 60}), at(10, {60.5, 60}), at(10, {50, 49.5}),
                             at(10, {50, 60}, EventType::death), at(10, {50, 60}, EventType::merge)}) {
    const auto pooled = graph::pool_events(Samples{{event}, {other}});
    REQUIRE(pooled.size() == 2);
    CHECK(pooled[0].probability == 0.5);
    CHECK(pooled[1].probability == 0.5);
  }
  for (const Event& other : {at(11, {50, 60}), at(9, {50, 60}), at(11, {60, 60}), at(10, {44, 52})}) {
    const auto pooled = graph::pool_events(Samples{{event}, {other}});
    REQUIRE(pooled.size() == 1);
    CHECK(pooled[0].probability == 1);
  }
}

TEST_CASE("two true births eight pixels apart stay two with their own probabilities") {
  // All but the first two samples see the left one, all but the last one the right one.
  const std::array<Point, 4> off = {{{0, 0}, {1, 0}, {-1, 0.5}, {0.5, -1}}};
  Samples samples(8);
  for (std::size_t k = 0; k < samples.size(); ++k) {
    if (k >= 2) samples[k].push_back(at(10, Point{100, 100} + off[k % 4]));
    if (k != 7) samples[k].push_back(at(10, Point{108, 100} + off[(k + 1) % 4]));
  }
  const auto pooled = graph::pool_events(samples);
  REQUIRE(pooled.size() == 2);
  CHECK_THAT(pooled[0].position.x, WithinAbs(100, 1));
  CHECK(pooled[0].probability == 0.75);
  CHECK_THAT(pooled[1].position.x, WithinAbs(108, 1));
  CHECK(pooled[1].probability == 0.875);
}

TEST_CASE("a chain of near events does not melt into one") {
  Samples samples(6);
  for (std::size_t k = 0; k < samples.size(); ++k) {
    for (int n = 0; n < 12; ++n)
      samples[k].push_back(at(10, {20 + 8.0 * n + 0.25 * double(k % 3), 50 + 0.5 * double(k % 2)}));
  }
  const auto pooled = graph::pool_events(samples);
  REQUIRE(pooled.size() == 12);
  for (std::size_t n = 0; n < pooled.size(); ++n) {
    CHECK(pooled[n].probability == 1);
    CHECK_THAT(pooled[n].position.x, WithinAbs(20 + 8.0 * double(n), 0.5));
  }
}

TEST_CASE("two events of one sample never support one") {
  const Samples samples = {{at(10, {50, 60}), at(10, {53, 60})}, {at(10, {51, 60})}};
  const auto pooled = graph::pool_events(samples);
  REQUIRE(pooled.size() == 2);
  CHECK(pooled[0].probability + pooled[1].probability == 1.5);
}

TEST_CASE("a union whose class is unsure") {
  const auto unions = [](int merges, int connects, int none) {
    Samples samples(static_cast<std::size_t>(none));
    for (int k = 0; k < merges; ++k) samples.push_back({at(10, {50, 60}, EventType::merge)});
    for (int k = 0; k < connects; ++k) samples.push_back({at(10, {52, 60}, EventType::connect)});
    const auto pooled = graph::pool_events(samples);
    REQUIRE(pooled.size() == 1);
    return std::pair(pooled[0].type, pooled[0].probability);
  };
  CHECK(unions(4, 6, 0) == std::pair(EventType::connect, 0.6));
  CHECK(unions(7, 2, 1) == std::pair(EventType::merge, 0.7));
  CHECK(unions(3, 4, 3) == std::pair(EventType::connect, 0.7));  // neither class has a half, either has
  CHECK(unions(3, 3, 4) == std::pair(EventType::merge, 0.6));
  CHECK(unions(1, 2, 7) == std::pair(EventType::connect, 0.2));  // not even either
}

TEST_CASE("pools of random samples") {
  const auto seed = GENERATE(range(0, 8));
  const double size = GENERATE(60.0, 300.0);  // crowded, and sparse
  const Samples samples = world(100 + static_cast<std::uint64_t>(seed), 7, 80, size);
  const auto pooled = graph::pool_events(samples, 2);

  SECTION("reversed samples give the reversed events") {
    Samples backwards;
    for (const auto& sample : samples) backwards.push_back(graph::reverse_time(sample, 31));
    CHECK(graph::reverse_time(graph::pool_events(backwards, 2), 31) == pooled);
    CHECK(graph::find_representative(backwards) == graph::find_representative(samples));
  }
  SECTION("the order of samples does not matter") {
    std::vector<std::size_t> order(samples.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    core::Rng rng(7);
    for (std::size_t k = order.size(); k > 1; --k)
      std::swap(order[k - 1], order[rng.below(static_cast<std::uint32_t>(k))]);
    Samples shuffled;
    std::size_t now = 0;
    for (std::size_t k = 0; k < order.size(); ++k) {
      shuffled.push_back(samples[order[k]]);
      std::reverse(shuffled.back().begin(), shuffled.back().end());
      if (order[k] == 2) now = k;
    }
    CHECK(graph::pool_events(shuffled, now) == pooled);
  }
  SECTION("every event of a sample supports at most one, and most support one") {
    double support = 0, events = 0;
    for (const auto& sample : samples) events += double(sample.size());
    for (const Event& event : pooled) {
      CHECK(event.probability > 0);
      CHECK(event.probability <= 1);
      support += event.probability * double(samples.size());
    }
    CHECK(support <= events + 1e-9);
    // Supports of a union's other class are left out: at most a half of each.
    CHECK(support >= 0.7 * events);
  }
  SECTION("a probability is no more than the share of samples with a fitting event near") {
    for (const Event& event : pooled) {
      std::size_t with_class = 0, with_family = 0;
      for (const auto& sample : samples) {
        const auto near = [&](const Event& e) {
          return std::abs(e.frame - event.frame) <= 1 && graph::distance(e.position, event.position) <= 10;
        };
        with_class +=
            std::ranges::any_of(sample, [&](const Event& e) { return near(e) && e.type == event.type; });
        with_family += std::ranges::any_of(
            sample, [&](const Event& e) { return near(e) && family(e.type) == family(event.type); });
      }
      const double least = double(with_class) / double(samples.size());
      const double either = double(with_family) / double(samples.size());
      if (event.probability >= 0.5 && family(event.type) >= 2) {
        CHECK(event.probability <= either + 1e-12);
      } else {
        CHECK(event.probability <= least + 1e-12);
      }
    }
  }
}

TEST_CASE("probabilities of well separated events are the shares of samples that saw them") {
  core::Rng rng(11);
  Samples samples(40);
  std::vector<int> seen(50);
  for (std::size_t k = 0; k < samples.size(); ++k) {
    for (std::size_t n = 0; n < seen.size(); ++n) {
      if (rng.uniform() * 50 > double(n + 1)) continue;
      ++seen[n];
      // Most in one frame, none farther than the tolerance from the rest.
      const int frame = 10 + (rng.uniform() < 0.2 ? 1 : 0);
      samples[k].push_back(
          at(frame, {30.0 * double(n) + rng.uniform(-2, 2), 50 + rng.uniform(-2, 2)}, kTypes[n % 6]));
    }
  }
  auto pooled = graph::pool_events(samples);
  std::ranges::sort(pooled, {}, [](const Event& e) { return e.position.x; });
  std::erase(seen, 0);
  REQUIRE(pooled.size() == seen.size());
  for (std::size_t n = 0; n < seen.size(); ++n) CHECK(pooled[n].probability == seen[n] / 40.0);
}

TEST_CASE("with readings a probability tells how often a further one has the event") {
  // Events far apart, each with a probability of its own that is uniform: Beta(1, 1).
  constexpr std::size_t kReadings = 3, kEach = 4;
  core::Rng rng(21);
  Samples samples(kReadings * kEach), further(1);
  for (int n = 0; n < 3000; ++n) {
    const double own = rng.uniform();
    const Event event = at(5 + n / 50, {30.0 * (n % 50), 40}, kTypes[static_cast<std::size_t>(n / 50 % 2)]);
    for (std::size_t r = 0; r < kReadings; ++r)
      if (rng.uniform() < own)
        for (std::size_t k = 0; k < kEach; ++k) samples[r * kEach + k].push_back(event);
    if (rng.uniform() < own) further[0].push_back(event);
  }
  graph::PoolOptions options;
  options.readings = kReadings;
  std::map<double, std::pair<double, double>> found;  // by probability: events, and those seen again
  for (const Event& event : graph::pool_events(samples, 0, options)) {
    auto& [events, again] = found[std::round(100 * event.probability)];
    events += 1;
    again += std::ranges::any_of(
        further[0], [&](const Event& e) { return e.frame == event.frame && e.position == event.position; });
  }
  REQUIRE(found.size() == kReadings);  // of one, two and three readings
  double readings = 0;
  for (const auto& [percent, counted] : found) {
    ++readings;
    const auto& [events, again] = counted;
    const double p = percent / 100;
    CHECK_THAT(p, WithinAbs((1 + readings) / (2 + kReadings), 0.02));  // Laplace's rule of succession
    INFO(p << " of " << events << " events, " << again << " again");
    CHECK(std::abs(again - p * events) < 3 * std::sqrt(events * p * (1 - p)));
  }
}

TEST_CASE("readings that agree are believed, and no reading turns the majority") {
  const Samples same(12, world(5, 1, 200, 600)[0]);
  graph::PoolOptions options;
  options.readings = 3;
  for (const Event& event : graph::pool_events(same, 0, options)) {
    CHECK(event.probability > 0.97);
    CHECK(event.probability < 1);
  }
  const Samples samples = world(9, 12, 120, 400);
  const auto shares = graph::pool_events(samples), doubted = graph::pool_events(samples, 0, options);
  REQUIRE(shares.size() == doubted.size());
  for (std::size_t n = 0; n < shares.size(); ++n) {
    const double share = shares[n].probability, p = doubted[n].probability;
    CHECK((p >= 0.5) == (share >= 0.5));
    CHECK(std::abs(p - 0.5) <= std::abs(share - 0.5));
  }
  Samples backwards;  // and the readings in another order
  for (std::size_t k = 0; k < samples.size(); ++k)
    backwards.push_back(graph::reverse_time(samples[(k + 4) % samples.size()], 31));
  auto again = graph::reverse_time(graph::pool_events(backwards, 8, options), 31);
  CHECK(again == doubted);
  options.readings = 1;
  CHECK(graph::pool_events(samples, 0, options) == shares);
}

TEST_CASE("the representative is the sample that agrees most") {
  const Event a = at(3, {10, 10}), b = at(5, {80, 10}), c = at(7, {150, 10}), odd = at(9, {300, 10});
  // c and `odd` are in one sample in four, a and b in most.
  CHECK(graph::find_representative(Samples{{a}, {a, b, odd}, {a, b}, {b, c}}) == 2);
  CHECK(graph::find_representative(Samples{{a, b}, {a, b}}) == 0);
  CHECK(graph::find_representative(Samples{{odd}, {}, {}}) == 1);
  // Which class a union has does not make it disagree.
  const Event merge = at(3, {10, 10}, EventType::merge), connect = at(3, {10, 10}, EventType::connect);
  CHECK(graph::find_representative(Samples{{}, {merge}, {connect}}) == 1);
}

TEST_CASE("what cannot be pooled is refused") {
  const auto complaint = [](const Samples& samples, std::size_t representative, graph::PoolOptions options) {
    return test::message_of<core::InputError>([&] { graph::pool_events(samples, representative, options); });
  };
  CHECK(test::contains(complaint({}, 0, {}), "no samples"));
  CHECK(test::contains(complaint({{}, {}}, 2, {}), "sample 2 of 2"));
  CHECK(test::contains(complaint({{}, {}, {}}, 0, {1, 10, 2}), "3 samples of 2 readings"));
  CHECK(test::contains(complaint({{}}, 0, {-1, 10, 0}), "frames is -1"));
  CHECK(test::contains(complaint({{}}, 0, {1, 0, 0}), "radius is 0"));
  const double nan = std::numeric_limits<double>::quiet_NaN();
  CHECK(test::contains(complaint({{at(4, {nan, 0})}}, 0, {}), "sample 0 in frame 4"));
  CHECK(graph::pool_events(Samples(1)).empty());
}
