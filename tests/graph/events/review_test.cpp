// SPDX-License-Identifier: Apache-2.0
#include "graph/events/review.hpp"

#include <algorithm>
#include <sstream>

#include "core/error.hpp"
#include "core/rng.hpp"
#include "graph/events/event_score.hpp"
#include "graph/io/motion_io.hpp"
#include "graph/io/review_io.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/messages.hpp"

using namespace emberfold;
using graph::Answer;
using graph::Event;
using graph::EventType;
using graph::ReviewedEvent;

namespace {

Event event(int frame, EventType type, double x, double y, double probability = 0.5) {
  return {frame, type, {x, y}, probability, {}, {}};
}

std::vector<ReviewedEvent> random_review(std::uint64_t seed) {
  core::Rng rng(seed);
  std::vector<ReviewedEvent> review;
  for (std::uint32_t k = 0; k < 40; ++k) {
    const auto type = static_cast<EventType>(rng.below(6));
    ReviewedEvent one{
        event(static_cast<int>(rng.below(50)), type, rng.uniform(0, 300), rng.uniform(0, 200), rng.uniform()),
        static_cast<Answer>(rng.below(5)), type};
    if (one.answer == Answer::other) one.type = static_cast<EventType>((static_cast<int>(type) + 1) % 6);
    review.push_back(one);
  }
  return review;
}

std::vector<ReviewedEvent> read(const std::string& text) {
  std::istringstream in(text);
  return graph::read_review(in, "review.json");
}

std::string error_of(const std::string& text) {
  try {
    read(text);
  } catch (const core::IoError& error) {
    return error.what();
  }
  return "";
}

}  // namespace

TEST_CASE("A review is read as it was written", "[graph][io]") {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const auto review = random_review(seed);
    std::stringstream file;
    graph::write_review(file, review);
    CHECK(graph::read_review(file, "file") == review);
  }
}

TEST_CASE("A bad review is refused with its event and the cause", "[graph][io]") {
  const std::string head = R"({"format":"emberfold.review","version":1,"events":[)";
  const std::string event = R"({"frame":3,"type":"birth","x":1,"y":2,"answer":)";
  CHECK(read(head + event + "null}]}").at(0).answer == Answer::none);
  CHECK(read(head + event + "\"birth\"}]}").at(0).answer == Answer::yes);
  CHECK(test::Contains("review.json: event 1: the answer \"maybe\" is none of yes")
            .match(error_of(head + event + "\"no\"}," + event + "\"maybe\"}]}")));
  CHECK(test::Contains("the answer \"7\"").match(error_of(head + event + "7}]}")));
  CHECK(test::Contains("expected \"emberfold.review\"")
            .match(error_of(R"({"format":"emberfold.events","version":1,"events":[]})")));
  CHECK(test::Contains("newer").match(error_of(R"({"format":"emberfold.review","version":2,"events":[]})")));
}

TEST_CASE("Any file of true events is taken as truth", "[graph][io]") {
  const std::vector<Event> events{event(3, EventType::merge, 5, 6, 0.25)};
  std::stringstream plain, reviewed;
  graph::write_events(plain, events);
  const auto truth = graph::read_truth(plain, "truth.json");
  REQUIRE(truth.size() == 1);
  CHECK(truth[0].answer == Answer::yes);
  graph::write_review(reviewed, std::vector<ReviewedEvent>{{events[0], Answer::no, EventType::merge}});
  CHECK(graph::told_events(graph::read_truth(reviewed, "review.json")).empty());
}

TEST_CASE("What was told is what was answered with yes, with another class, or added", "[graph][events]") {
  const std::vector<ReviewedEvent> review{{event(9, EventType::merge, 1, 1), Answer::yes, EventType::merge},
                                          {event(2, EventType::merge, 1, 1), Answer::no, EventType::merge},
                                          {event(3, EventType::merge, 1, 1), Answer::other, EventType::birth},
                                          {event(4, EventType::death, 1, 1), Answer::added, EventType::death},
                                          {event(5, EventType::death, 1, 1), Answer::none, EventType::death}};
  const auto told = graph::told_events(review);
  REQUIRE(told.size() == 3);
  CHECK((told[0].frame == 3 && told[0].type == EventType::birth));
  CHECK((told[1].frame == 4 && told[2].frame == 9));
  CHECK(std::ranges::all_of(told, [](const Event& e) { return e.probability == 1; }));
}

TEST_CASE("Answers find their events, whatever the order, and also a little beside them", "[graph][events]") {
  core::Rng rng(5);
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    auto review = random_review(seed);
    std::vector<Event> events;
    for (ReviewedEvent& one : review) {
      if (one.answer == Answer::added) one.answer = Answer::yes;
      events.push_back(one.event);
    }
    std::vector<std::size_t> order(events.size());
    for (std::size_t k = 0; k < order.size(); ++k) order[k] = k;
    for (std::size_t k = order.size(); k > 1; --k)
      std::swap(order[k - 1], order[rng.below(static_cast<std::uint32_t>(k))]);
    std::vector<Event> mixed;
    for (const std::size_t k : order) mixed.push_back(events[k]);
    CHECK(graph::find_answers(mixed, review) == order);
  }
  const std::vector<ReviewedEvent> one{{event(10, EventType::split, 50, 50), Answer::no, EventType::split}};
  const auto finds = [&](const Event& e) { return graph::find_answers(std::vector{e}, one)[0] == 0; };
  CHECK(finds(event(12, EventType::disconnect, 56, 50)));
  CHECK_FALSE(finds(event(13, EventType::split, 50, 50)));
  CHECK_FALSE(finds(event(10, EventType::split, 61, 50)));
  CHECK_FALSE(finds(event(10, EventType::merge, 50, 50)));
  const std::vector<ReviewedEvent> other{
      {event(9, EventType::birth, 50, 50), Answer::other, EventType::merge}};
  CHECK(graph::find_answers(std::vector{event(9, EventType::merge, 50, 50)}, other)[0] == 0);
  CHECK(graph::find_answers(std::vector{event(9, EventType::birth, 50, 50)}, other)[0] == 0);
}

TEST_CASE("Of answers beside an event that of its own class is taken", "[graph][events]") {
  const std::vector<ReviewedEvent> review{
      {event(10, EventType::disconnect, 50, 50), Answer::no, EventType::disconnect},
      {event(10, EventType::split, 54, 50), Answer::yes, EventType::split}};
  CHECK(graph::find_answers(std::vector{event(10, EventType::split, 50, 50)}, review)[0] == 1);
  CHECK(graph::find_answers(std::vector{event(10, EventType::disconnect, 54, 50)}, review)[0] == 0);
}

TEST_CASE("A reviewed file scores what was answered and leaves the rest out", "[graph][events]") {
  const std::vector<ReviewedEvent> review{
      {event(10, EventType::split, 50, 50), Answer::yes, EventType::split},
      {event(20, EventType::split, 50, 50), Answer::no, EventType::split},
      {event(30, EventType::split, 50, 50), Answer::none, EventType::split},
      {event(40, EventType::birth, 9, 9), Answer::added, EventType::birth}};
  std::vector<Event> found;
  for (const ReviewedEvent& one : review) found.push_back(one.event);
  const auto left = graph::drop_open_events(found, review);
  CHECK(left.size() == 3);
  const auto score = graph::score_events(graph::told_events(review), left);
  CHECK((score.six.back().in_truth == 2 && score.six.back().found == 3 && score.six.back().hit == 2));
}
