// SPDX-License-Identifier: Apache-2.0
#include "apps/review/review_page.hpp"

#include <algorithm>
#include <cmath>
#include <set>

#include "core/rng.hpp"
#include "tests/support/catch.hpp"

using namespace emberfold;
using namespace emberfold::apps;

namespace {

std::vector<graph::Event> random_events(std::size_t count) {
  core::Rng rng(2);
  std::vector<graph::Event> events;
  for (std::size_t k = 0; k < count; ++k)
    events.push_back({static_cast<int>(rng.below(90)),
                      graph::EventType::birth,
                      {rng.uniform(0, 300), rng.uniform(0, 200)},
                      rng.uniform(),
                      {},
                      {}});
  return events;
}

}  // namespace

TEST_CASE("a review asks about the most doubtful events, and of many also about sure ones") {
  for (const std::size_t count : {0UL, 1UL, 50UL, 400UL, 3000UL}) {
    const auto events = random_events(count);
    const auto chosen = choose_for_review(events);
    CHECK(chosen.size() == std::min(count, kReviewStrips));
    CHECK(std::set(chosen.begin(), chosen.end()).size() == chosen.size());
    std::vector<double> doubts;
    for (const std::size_t k : chosen) doubts.push_back(std::abs(events[k].probability - 0.5));
    CHECK(std::ranges::is_sorted(doubts));
    if (count <= kReviewStrips) continue;
    CHECK(doubts[kReviewStrips / 4 * 3 - 1] < 0.06);
    CHECK(doubts.back() > 0.49);
  }
}
