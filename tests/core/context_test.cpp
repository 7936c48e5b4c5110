// SPDX-License-Identifier: Apache-2.0
#include "core/context.hpp"

#include <string>
#include <utility>
#include <vector>

#include "tests/support/catch.hpp"

using namespace emberfold;

TEST_CASE("The default context never stops and tells nobody", "[core][context]") {
  const core::Context context;
  CHECK_FALSE(context.cancelled());
  CHECK_NOTHROW(context.report("sketch", 0.5));
}

TEST_CASE("A context and its copies are cancelled by the source of their token", "[core][context]") {
  std::stop_source stop, other;
  const core::Context context(stop.get_token());
  const core::Context copy = context;
  const core::Context apart(other.get_token());
  CHECK_FALSE(context.cancelled());
  stop.request_stop();
  CHECK(context.cancelled());
  CHECK(copy.cancelled());
  CHECK_FALSE(apart.cancelled());
}

TEST_CASE("Progress passes on the stage and a share between 0 and 1", "[core][context]") {
  std::vector<std::pair<std::string, double>> told;
  const core::Context context({},
                              [&](std::string_view stage, double share) { told.emplace_back(stage, share); });
  context.report("sketch", 0.25);
  context.report("match", -1);
  context.report("match", 1.0000001);
  CHECK(told == std::vector<std::pair<std::string, double>>{{"sketch", 0.25}, {"match", 0}, {"match", 1}});
  CHECK_FALSE(context.cancelled());
}

TEST_CASE("A context that tells somebody else stops with the first", "[core][context]") {
  std::stop_source stop;
  int first = 0, other = 0;
  const core::Context context(stop.get_token(), [&](std::string_view, double) { ++first; });
  const core::Context part = context.with_progress([&](std::string_view, double) { ++other; });
  part.report("julesz", 0.5);
  CHECK(first == 0);
  CHECK(other == 1);
  stop.request_stop();
  CHECK(part.cancelled());
}
