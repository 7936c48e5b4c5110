// SPDX-License-Identifier: Apache-2.0
#include "pipeline/review/review_calibration.hpp"

#include <algorithm>
#include <cmath>

#include "core/error.hpp"
#include "core/rng.hpp"
#include "tests/support/catch.hpp"

using namespace emberfold;
using graph::Answer;
using graph::Event;
using graph::EventType;
using graph::ReviewedEvent;

namespace {

struct Made {
  std::vector<Event> events;
  std::vector<bool> is_true;
};

/// Events whose probabilities are right, or whose true log odds are moved from what is told by `shift` and
/// `slope`.
Made make_events(core::Rng& rng, std::uint32_t count, double shift, double slope) {
  Made made;
  for (std::uint32_t k = 0; k < count; ++k) {
    const double odds = rng.uniform(-4, 4);
    made.events.push_back({static_cast<int>(k),
                           static_cast<EventType>(rng.below(6)),
                           {100, 100},
                           1 / (1 + std::exp(-odds)),
                           {},
                           {}});
    made.is_true.push_back(rng.uniform() < 1 / (1 + std::exp(-shift - slope * odds)));
  }
  return made;
}

std::vector<ReviewedEvent> answer(const Made& made, std::size_t first, std::size_t step) {
  std::vector<ReviewedEvent> review;
  for (std::size_t k = first; k < made.events.size(); k += step)
    review.push_back({made.events[k], made.is_true[k] ? Answer::yes : Answer::no, made.events[k].type});
  return review;
}

}  // namespace

TEST_CASE("Without an answer a review changes nothing", "[pipeline][review]") {
  core::Rng rng(1);
  const auto made = make_events(rng, 100, 0, 1);
  std::vector<ReviewedEvent> open;
  for (const Event& event : made.events) open.push_back({event, Answer::none, event.type});
  for (const auto& review : {open, {}}) {
    const auto result = pipeline::apply_review(made.events, review, 99, 1);
    CHECK(result.events == made.events);
    CHECK((result.shift == std::array<double, 2>{0, 0} && result.slope == std::array<double, 2>{1, 1}));
    double expected = 0;
    for (const Event& event : made.events) expected += event.probability;
    CHECK_THAT(result.counts.back().mean, test::WithinAbs(expected, 1));
  }
}

TEST_CASE("Answers are facts: of probability 1 or 0, of the class given, and added events",
          "[pipeline][review]") {
  const std::vector<Event> events{{5, EventType::merge, {10, 10}, 0.5, {{1}, {2}}, {{3}}},
                                  {6, EventType::merge, {90, 10}, 0.9, {}, {}},
                                  {7, EventType::split, {90, 90}, 0.2, {}, {}}};
  const std::vector<ReviewedEvent> review{
      {events[0], Answer::yes, EventType::merge},
      {events[1], Answer::no, EventType::merge},
      {events[2], Answer::other, EventType::disconnect},
      {{8, EventType::birth, {40, 40}, 1, {}, {}}, Answer::added, EventType::birth},
      {{30, EventType::birth, {40, 40}, 1, {}, {}}, Answer::no, EventType::birth}};
  const auto result = pipeline::apply_review(events, review, 10, 1);
  REQUIRE(result.events.size() == 4);
  CHECK((result.events[0].probability == 1 && result.events[0].before == events[0].before));
  CHECK(result.events[1].probability == 0);
  CHECK((result.events[2].probability == 1 && result.events[2].type == EventType::disconnect));
  CHECK((result.events[3].probability == 1 && result.events[3].type == EventType::birth));
  CHECK(
      (result.yes == 1 && result.no == 1 && result.other == 1 && result.added == 1 && result.unmatched == 1));
  // all is known but for chance
  CHECK((result.counts.back().low == 3 && result.counts.back().high == 3));
  CHECK(result.rates.back().mean == 0.3);
  CHECK((result.rates.back().low < 0.2 && result.rates.back().high > 0.5));
  CHECK_THROWS_AS(pipeline::apply_review(events, review, 0, 1), core::InputError);
}

TEST_CASE("Where all is answered a count is known, and its rate has a Gamma law", "[pipeline][review]") {
  std::vector<Event> events;
  std::vector<ReviewedEvent> review;
  for (int k = 0; k < 100; ++k) {
    events.push_back({k, EventType::birth, {100, 100}, 0.5, {}, {}});
    review.push_back({events.back(), Answer::yes, EventType::birth});
  }
  double low = 0, high = 0;
  constexpr std::uint64_t seeds = 20;
  for (std::uint64_t seed = 0; seed < seeds; ++seed) {
    const auto result = pipeline::apply_review(events, review, 200, seed);
    CHECK((result.counts[0].low == 100 && result.counts[0].high == 100));
    low += result.rates[0].low * 200 / seeds, high += result.rates[0].high * 200 / seeds;
  }
  // Quantiles .05 and .95 of Gamma(100.5): half of those of chi squared with 201 degrees of freedom.
  CHECK_THAT(low, test::WithinAbs(84.6, 0.8));
  CHECK_THAT(high, test::WithinAbs(117.6, 0.9));
}

TEST_CASE("Answers to a part of the events set the others right", "[pipeline][review]") {
  core::Rng rng(7);
  for (const auto& [shift, slope] : {std::pair{-2.5, 1.0}, {1.5, 1.0}, {0.0, 0.4}, {-1.0, 0.6}}) {
    const auto made = make_events(rng, 1200, shift, slope);
    const auto result = pipeline::apply_review(made.events, answer(made, 0, 4), 1199, 1);
    double before = 0, after = 0;
    for (std::size_t k = 0; k < made.events.size(); ++k) {
      if (k % 4 == 0) continue;
      const double truth = made.is_true[k] ? 1 : 0;
      before += std::pow(made.events[k].probability - truth, 2);
      after += std::pow(result.events[k].probability - truth, 2);
    }
    CAPTURE(shift, slope, before, after);
    CHECK(after < before);
    for (std::size_t group = 0; group < 2; ++group) {
      CHECK_THAT(result.shift[group], test::WithinAbs(shift, 0.7));
      CHECK_THAT(std::log(result.slope[group]), test::WithinAbs(std::log(slope), 0.45));
    }
  }
}

TEST_CASE("Nine of ten intervals of the counts hold the truth, also where doubtful events were asked first",
          "[pipeline][review]") {
  int inside = 0;
  constexpr int kClips = 60;
  for (std::uint64_t seed = 1; seed <= kClips; ++seed) {
    core::Rng rng(seed);
    auto made = make_events(rng, 200, rng.normal(), std::exp(0.3 * rng.normal()));
    std::vector<ReviewedEvent> review;
    double total = 0;
    for (std::size_t k = 0; k < made.events.size(); ++k) {
      total += made.is_true[k] ? 1 : 0;
      const double p = made.events[k].probability;
      if (p < 0.15 || p > 0.85) continue;
      review.push_back({made.events[k], made.is_true[k] ? Answer::yes : Answer::no, made.events[k].type});
    }
    const auto count = pipeline::apply_review(made.events, review, 199, seed).counts.back();
    inside += count.low <= total && total <= count.high ? 1 : 0;
  }
  // of 54 expected, SD 2.3
  CHECK(inside >= 47);
}
