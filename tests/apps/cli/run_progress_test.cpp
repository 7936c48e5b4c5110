// SPDX-License-Identifier: Apache-2.0
#include "apps/cli/run_progress.hpp"

#include "tests/support/catch.hpp"

using emberfold::apps::RunProgress;

TEST_CASE("a run's progress counts all stages, and its time left follows the pace") {
  RunProgress run({{"sketch", {}, 60}, {"events", {"match", "chance"}, 20}, {"pictures", {}, 20}});
  CHECK(run.report("unknown", 0.5, 0).of == 3);
  const auto begin = run.report("sketch", 0, 0);
  CHECK(begin.number == 1);
  CHECK(begin.whole == 0);
  CHECK_FALSE(begin.seconds_left);
  // Twice as slow as planned.
  const auto half = run.report("sketch", 0.5, 60);
  CHECK(half.whole == Approx(0.3));
  REQUIRE(half.seconds_left);
  CHECK(*half.seconds_left == Approx(140));
  const auto match = run.report("match", 1, 140);
  CHECK(match.stage == "events");
  CHECK(match.number == 2);
  CHECK(match.share == Approx(0.5));
  CHECK(*match.seconds_left == Approx(60));
  CHECK(run.report("chance", 0.5, 150).share == Approx(0.75));
  CHECK(run.report("sketch", 0.1, 151).stage == "events");  // it does not go back
  CHECK(run.report("pictures", 1, 200).whole == Approx(1));
  CHECK(*run.report("pictures", 1, 200).seconds_left == Approx(0));
}

TEST_CASE("stages that are skipped say nothing of the pace") {
  RunProgress run({{"sketch", {}, 60}, {"events", {}, 20}, {"pictures", {}, 20}});
  run.report("pictures", 0, 1);
  const auto half = run.report("pictures", 0.5, 11);
  CHECK(half.number == 3);
  CHECK(half.whole == Approx(0.9));
  CHECK(*half.seconds_left == Approx(10));
}
