// SPDX-License-Identifier: Apache-2.0
#include "graph/matching/curve_alignment.hpp"

#include <cstdint>
#include <numeric>
#include <vector>

#include "tests/support/catch.hpp"

using namespace emberfold;
using graph::Candidate;
using graph::detail::Aligner;
using graph::detail::IndexLinks;

namespace {

/// Curves of so many vertices each, numbered on.
std::vector<graph::Curve> rows_of_pairs(const std::vector<std::uint32_t>& sizes) {
  std::vector<graph::Curve> result;
  std::uint32_t next = 0;
  for (const std::uint32_t size : sizes) {
    result.emplace_back(size);
    std::iota(result.back().begin(), result.back().end(), next);
    next += size;
  }
  return result;
}

IndexLinks aligned(const std::vector<graph::Curve>& before, const std::vector<graph::Curve>& after,
                   const std::vector<Candidate>& candidates) {
  Aligner aligner(before, after, 20, 20);
  return aligner.align(candidates, [](std::uint32_t, std::uint32_t) { return 1.0; });
}

}  // namespace

TEST_CASE("Curves are aligned in order, either way round", "[graph][alignment]") {
  const auto a = rows_of_pairs({4}), b = rows_of_pairs({4});
  CHECK(aligned(a, b, {{0, 0, 1}, {1, 1, 1}, {2, 2, 1}, {3, 3, 1}}) ==
        IndexLinks{{0, 0}, {1, 1}, {2, 2}, {3, 3}});
  CHECK(aligned(a, b, {{0, 3, 1}, {1, 2, 1}, {2, 1, 1}, {3, 0, 1}}) ==
        IndexLinks{{0, 3}, {1, 2}, {2, 1}, {3, 0}});
}

TEST_CASE("A skipped point costs half a nat, on either curve", "[graph][alignment]") {
  const auto a = rows_of_pairs({5}), b = rows_of_pairs({5});
  const auto found = [&](std::vector<Candidate> candidates) {
    // Only columns between candidates of a row are looked at: some of no gain let all be.
    for (std::uint32_t i = 0; i < 5; ++i) candidates.insert(candidates.end(), {{i, 0, 0}, {i, 4, 0}});
    return aligned(a, b, candidates);
  };
  // From (0, 0) and (1, 1) on, a link two points later pays where it gains more than both skips cost.
  CHECK(found({{0, 0, 2}, {1, 1, 2}, {4, 2, 1.2}}) == IndexLinks{{0, 0}, {1, 1}, {4, 2}});
  CHECK(found({{0, 0, 2}, {1, 1, 2}, {4, 2, 0.8}}) == IndexLinks{{0, 0}, {1, 1}});
  CHECK(found({{0, 0, 2}, {1, 1, 2}, {2, 4, 1.2}}) == IndexLinks{{0, 0}, {1, 1}, {2, 4}});
  CHECK(found({{0, 0, 2}, {1, 1, 2}, {2, 4, 0.8}}) == IndexLinks{{0, 0}, {1, 1}});
  // 1 lies before 2 on one curve and behind it on the other: only one order can be had.
  CHECK(found({{0, 0, 3}, {1, 2, 1}, {2, 1, 2}, {3, 3, 3}}) == IndexLinks{{0, 0}, {2, 1}, {3, 3}});
}

TEST_CASE("A single link joins two curves only where one of them is a single point", "[graph][alignment]") {
  CHECK(aligned(rows_of_pairs({3}), rows_of_pairs({3}), {{1, 1, 4}}).empty());
  CHECK(aligned(rows_of_pairs({1}), rows_of_pairs({3}), {{0, 1, 4}}) == IndexLinks{{0, 1}});
  CHECK(aligned(rows_of_pairs({3}), rows_of_pairs({1}), {{2, 0, 4}}) == IndexLinks{{2, 0}});
}

TEST_CASE("The pair of curves of the greatest gain comes first, what is left goes to others",
          "[graph][alignment]") {
  const auto a = rows_of_pairs({4}), b = rows_of_pairs({3, 2});
  const std::vector<Candidate> candidates{{0, 0, 1}, {1, 1, 1}, {2, 2, 1}, {2, 3, 1.2}, {3, 4, 1.2}};
  CHECK(aligned(a, b, candidates) == IndexLinks{{0, 0}, {1, 1}, {2, 2}});
  auto stronger = candidates;
  stronger[3].gain = stronger[4].gain = 2;
  CHECK(aligned(a, b, stronger) == IndexLinks{{0, 0}, {1, 1}, {2, 3}, {3, 4}});
}
