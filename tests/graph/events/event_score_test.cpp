// SPDX-License-Identifier: Apache-2.0
#include "graph/events/event_score.hpp"

#include <numeric>

#include "core/error.hpp"
#include "core/rng.hpp"
#include "graph/matching/assignment.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/graphs.hpp"
#include "tests/support/messages.hpp"

using namespace emberfold;
using namespace emberfold::test;
using graph::Event;
using graph::EventType;

namespace {

/// The least cost over all ways to pair min(rows, columns), by trying them all.
double least(std::size_t rows, std::size_t columns, const std::vector<double>& cost) {
  std::vector<std::size_t> order(std::max(rows, columns));
  std::iota(order.begin(), order.end(), 0);
  double best = 1e300;
  do {
    double sum = 0;
    for (std::size_t k = 0; k < std::min(rows, columns); ++k) {
      sum += rows <= columns ? cost[k * columns + order[k]] : cost[order[k] * columns + k];
    }
    best = std::min(best, sum);
  } while (std::next_permutation(order.begin(), order.end()));
  return best;
}

std::vector<Event> random_events(core::Rng& rng, std::uint32_t count) {
  std::vector<Event> events;
  for (std::uint32_t k = 0; k < count; ++k) {
    events.push_back({static_cast<int>(rng.below(6)),
                      static_cast<EventType>(rng.below(6)),
                      {rng.uniform(0, 60), rng.uniform(0, 60)},
                      1,
                      {},
                      {}});
  }
  return events;
}

/// The most pairs within reach, by trying every pairing in turn.
std::size_t most_pairs(const std::vector<Event>& truth, const std::vector<Event>& found, std::size_t i,
                       std::vector<bool>& taken, const graph::ScoreOptions& options) {
  if (i == truth.size()) return 0;
  std::size_t best = most_pairs(truth, found, i + 1, taken, options);
  for (std::size_t j = 0; j < found.size(); ++j) {
    if (taken[j] || found[j].type != truth[i].type) continue;
    if (std::abs(truth[i].frame - found[j].frame) > options.frames) continue;
    if (graph::distance(truth[i].position, found[j].position) > options.radius) continue;
    taken[j] = true;
    best = std::max(best, 1 + most_pairs(truth, found, i + 1, taken, options));
    taken[j] = false;
  }
  return best;
}

}  // namespace

TEST_CASE("An assignment is as cheap as the cheapest permutation", "[graph][assignment]") {
  core::Rng rng(5);
  for (std::size_t rows = 1; rows <= 6; ++rows) {
    for (std::size_t columns = 1; columns <= 6; ++columns) {
      for (int k = 0; k < 12; ++k) {
        std::vector<double> cost(rows * columns);
        for (double& c : cost) c = k % 2 == 0 ? rng.uniform(-5, 20) : static_cast<double>(rng.below(4));
        const auto column_of = graph::assign(rows, columns, cost);
        double sum = 0;
        std::vector<int> uses(columns, 0);
        std::size_t pairs = 0;
        for (std::size_t i = 0; i < rows; ++i) {
          if (column_of[i] == graph::kUnassigned) continue;
          ++pairs;
          CHECK(++uses.at(column_of[i]) == 1);
          sum += cost[i * columns + column_of[i]];
        }
        CHECK(pairs == std::min(rows, columns));
        CHECK_THAT(sum, WithinAbs(least(rows, columns, cost), 1e-9));
      }
    }
  }
}

TEST_CASE("An assignment refuses sizes and costs that are none", "[graph][assignment]") {
  CHECK_THROWS_AS(graph::assign(2, 2, std::vector<double>{1, 2, 3}), core::InputError);
  CHECK_THROWS_AS(graph::assign(1, 1, std::vector<double>{std::nan("")}), core::InputError);
  CHECK(graph::assign(0, 3, {}).empty());
  CHECK(graph::assign(2, 0, {}) == std::vector<std::size_t>(2, graph::kUnassigned));
}

TEST_CASE("Sparse pairs gain the most that any choice of pairs can", "[graph][assignment]") {
  core::Rng rng(8);
  for (int k = 0; k < 100; ++k) {
    std::vector<graph::Candidate> candidates;
    for (std::uint32_t i = 0; i < 6; ++i) {
      for (std::uint32_t j = 0; j < 6; ++j) {
        if (rng.uniform() < 0.3) candidates.push_back({10 * i, 7 * j, rng.uniform(0.1, 5)});
      }
    }
    const auto total = [&](auto take) {
      double sum = 0;
      for (std::size_t c = 0; c < candidates.size(); ++c) sum += take(c) ? candidates[c].gain : 0;
      return sum;
    };
    double best = 0;
    const auto search = [&](auto&& self, std::size_t c, std::uint64_t rows, std::uint64_t columns,
                            double sum) -> void {
      best = std::max(best, sum);
      for (; c < candidates.size(); ++c) {
        const auto row = std::uint64_t{1} << candidates[c].row,
                   column = std::uint64_t{1} << candidates[c].column;
        if ((rows & row) || (columns & column)) continue;
        self(self, c + 1, rows | row, columns | column, sum + candidates[c].gain);
      }
    };
    search(search, 0, 0, 0, 0);
    const auto pairs = graph::assign(candidates);
    std::vector<std::uint32_t> rows, columns;
    for (const auto& [row, column] : pairs) rows.push_back(row), columns.push_back(column);
    std::sort(columns.begin(), columns.end());
    CHECK(std::adjacent_find(rows.begin(), rows.end()) == rows.end());
    CHECK(std::adjacent_find(columns.begin(), columns.end()) == columns.end());
    CHECK_THAT(total([&](std::size_t c) {
                 return std::count(pairs.begin(), pairs.end(),
                                   std::pair(candidates[c].row, candidates[c].column)) > 0;
               }),
               WithinAbs(best, 1e-9));
  }
  const std::vector<graph::Candidate> bad{{0, 0, -1}};
  CHECK_THROWS_AS(graph::assign(bad), core::InputError);
}

TEST_CASE("Hits are the most one-to-one pairs within reach", "[graph][score]") {
  core::Rng rng(6);
  const graph::ScoreOptions options{1, 20};
  for (int k = 0; k < 60; ++k) {
    const auto truth = random_events(rng, rng.below(12)), found = random_events(rng, rng.below(12));
    const graph::Score score = graph::score_events(truth, found, options);
    std::vector<bool> taken(found.size(), false);
    CHECK(score.six.back().hit == most_pairs(truth, found, 0, taken, options));
    CHECK(score.six.back().in_truth == truth.size());
    CHECK(score.four.back().found == found.size());
    CHECK(score.four.back().hit >= score.six.back().hit);
    // Truth and finding change places: precision and recall do too.
    const graph::Score swapped = graph::score_events(found, truth, options);
    for (std::size_t c = 0; c < score.six.size(); ++c) {
      CHECK(score.six[c].name == swapped.six[c].name);
      CHECK(score.six[c].hit == swapped.six[c].hit);
      CHECK(score.six[c].f1() == swapped.six[c].f1());
    }
  }
}

TEST_CASE("Four classes see no difference between split and disconnect, merge and connect",
          "[graph][score]") {
  const std::vector<Event> truth{{4, EventType::split, {10, 10}, 1, {}, {}},
                                 {9, EventType::merge, {50, 50}, 1, {}, {}}};
  std::vector<Event> found{{5, EventType::disconnect, {20, 10}, 1, {}, {}},
                           {7, EventType::connect, {50, 69}, 1, {}, {}}};
  graph::Score score = graph::score_events(truth, found);
  REQUIRE(score.four.size() == 3);
  CHECK(score.four[0].name == "separate");
  CHECK(score.four[1].name == "unite");
  CHECK(score.four[2].name == "all");
  CHECK(score.four[2].hit == 2);
  CHECK(score.six.back().hit == 0);
  CHECK(score.six.back().precision() == 0);
  found[0].frame = 7;
  found[1].position.y = 70.5;
  score = graph::score_events(truth, found);
  CHECK(score.four.back().hit == 0);
  CHECK(graph::score_events({}, {}).four.back().f1() == 1);
  CHECK(graph::score_events({}, found).four.back().recall() == 1);
  CHECK(graph::score_events(truth, {}).four.back().precision() == 0);
}

TEST_CASE("Precision is of what was found, recall of the truth, and F1 their harmonic mean",
          "[graph][score]") {
  const graph::ClassScore score{"birth", 8, 5, 3};
  CHECK(score.precision() == 0.6);
  CHECK(score.recall() == 0.375);
  CHECK_THAT(score.f1(), WithinAbs(2 * 0.6 * 0.375 / (0.6 + 0.375), 1e-12));
}

TEST_CASE("Options of the score are held to their ranges", "[graph][score]") {
  const auto refusal = [](graph::ScoreOptions options) {
    return test::message_of<core::InputError>([&] { options.validate(); });
  };
  CHECK(test::contains(refusal({-1, 20}), "frames"));
  CHECK(test::contains(refusal({2, std::nan("")}), "radius"));
  CHECK(refusal({0, 0}).empty());
}
