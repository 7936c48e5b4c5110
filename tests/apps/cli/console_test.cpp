// SPDX-License-Identifier: Apache-2.0
#include "apps/cli/console.hpp"

#include <string>
#include <vector>

#include "apps/cli/did_you_mean.hpp"
#include "tests/support/catch.hpp"

using namespace emberfold::apps;

TEST_CASE("slips of the keyboard find the word that was meant") {
  const std::vector<std::string> known{"analyze", "sketch", "score", "demo"};
  CHECK(nearest_word("analyse", known) == "analyze");
  CHECK(nearest_word("anaylze", known) == "analyze");
  CHECK(nearest_word("sketc", known) == "sketch");
  CHECK(nearest_word("scroe", known) == "score");
  CHECK(nearest_word("xyzzy", known).empty());
  CHECK(nearest_word("", known).empty());
}

TEST_CASE("what is said stays on one line and tells times as people do") {
  CHECK(one_line("a\nb\x1b[2J\tc\r\n") == "a b [2J c");
  CHECK(duration_text(7.4) == "7 s");
  CHECK(duration_text(59.6) == "1 min 0 s");
  CHECK(duration_text(185) == "3 min 5 s");
  CHECK(duration_text(7805) == "2 h 10 min");
}
