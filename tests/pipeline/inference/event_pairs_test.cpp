// SPDX-License-Identifier: Apache-2.0
#include "pipeline/inference/event_pairs.hpp"

#include <algorithm>
#include <utility>
#include <vector>

#include "pipeline/inference/event_posterior.hpp"
#include "tests/support/catch.hpp"

using namespace emberfold;
using namespace emberfold::test;
using graph::EventType;
using Pairs = std::vector<std::pair<std::size_t, std::size_t>>;

namespace {

graph::Event event(EventType type, int frame, double x = 50) {
  graph::Event made;
  made.type = type, made.frame = frame, made.position = {x, 60};
  return made;
}

/// The pairs, the lower number first, in order.
Pairs in_order(const std::vector<mcmc::ChangePair>& pairs) {
  Pairs result;
  for (const auto& pair : pairs) result.push_back(std::minmax(pair.a, pair.b));
  std::ranges::sort(result);
  return result;
}

Pairs brief(const std::vector<graph::Event>& events) {
  return in_order(pipeline::brief_pairs(events));
}
Pairs rivals(const std::vector<graph::Event>& events) {
  return in_order(pipeline::rival_pairs(events));
}

/// An event that the images show as well as can be, long after and before any opposite one.
pipeline::WeighedEvent shown(const graph::Event& event, double log_factor, double since, double until) {
  pipeline::WeighedEvent made;
  made.event = event;
  auto& evidence = made.evidence;
  evidence.of_stroke = event.type == EventType::birth || event.type == EventType::death;
  evidence.log_factor = log_factor, evidence.since = since, evidence.until = until;
  return made;
}

}  // namespace

TEST_CASE("A stroke that is born and dies at once is one thing") {
  using enum EventType;
  CHECK(brief({event(birth, 10), event(death, 11, 55)}) == Pairs{{0, 1}});
  CHECK(brief({event(death, 12), event(birth, 10)}) == Pairs{{0, 1}});
  CHECK(brief({event(birth, 10), event(death, 13)}).empty());
  CHECK(brief({event(birth, 10), event(death, 11, 57)}).empty());
  CHECK(brief({event(death, 10), event(birth, 11)}).empty());  // another stroke may begin where one ended
}

TEST_CASE("Strokes that meet and part at once are one thing") {
  using enum EventType;
  for (const auto& [first, then] : {std::pair{connect, split}, {merge, disconnect}, {split, merge}}) {
    CHECK(brief({event(first, 10), event(then, 11)}) == Pairs{{0, 1}});
    CHECK(brief({event(first, 10), event(then, 10)}) == Pairs{{0, 1}});
    CHECK(brief({event(first, 10), event(then, 12)}).empty());
  }
  CHECK(brief({event(connect, 10), event(merge, 11)}).empty());
}

TEST_CASE("Of several brief things the nearest in time are paired, each once") {
  using enum EventType;
  CHECK(brief({event(birth, 10), event(death, 12), event(birth, 11)}) == Pairs{{1, 2}});
  CHECK(brief({event(birth, 10), event(death, 11, 54), event(death, 11, 51)}) == Pairs{{0, 2}});
}

TEST_CASE("A stroke dies or is taken up, is new or has come off") {
  using enum EventType;
  CHECK(rivals({event(death, 10), event(connect, 12, 69)}) == Pairs{{0, 1}});
  CHECK(rivals({event(merge, 10), event(death, 8)}) == Pairs{{0, 1}});
  CHECK(rivals({event(birth, 10), event(split, 10), event(disconnect, 11)}) == Pairs{{0, 1}, {0, 2}});
  CHECK(rivals({event(death, 10), event(connect, 13)}).empty());
  CHECK(rivals({event(death, 10), event(connect, 10, 71)}).empty());
  CHECK(rivals({event(death, 10), event(split, 10), event(birth, 10)}) == Pairs{{1, 2}});
}

TEST_CASE("A death is believed no more than the birth just before it") {
  using enum EventType;
  const auto sure = shown(event(death, 40), 13, 1, 60);
  const auto alone = pipeline::event_probabilities(std::vector{sure}).of_event;
  CHECK(alone[0] > 0.5);
  const std::vector both{sure, shown(event(birth, 39), -13, 39, 1)};
  const auto paired = pipeline::event_probabilities(both).of_event;
  CHECK(paired[0] < 0.1);
  CHECK(paired[1] == paired[0]);
}

TEST_CASE("Of two readings of one change the likelier one stays") {
  using enum EventType;
  const std::vector two{shown(event(connect, 40), 13, 40, 60), shown(event(death, 41), 2, 41, 59)};
  const auto alone = pipeline::event_probabilities(std::vector{two[1]}).of_event;
  const auto together = pipeline::event_probabilities(two).of_event;
  CHECK(together[0] > 0.85);
  CHECK(together[1] < 0.5 * alone[0]);
}
