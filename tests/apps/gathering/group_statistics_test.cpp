// SPDX-License-Identifier: Apache-2.0
#include "apps/gathering/group_statistics.hpp"

#include <sstream>

#include <nlohmann/json.hpp>

#include "apps/gathering/gathered_table.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/messages.hpp"

using namespace emberfold;
using namespace emberfold::test;

namespace {

apps::GatheredRun run(const std::string& name, const std::string& group, double splits, double frames,
                      std::optional<double> seconds) {
  apps::GatheredRun made;
  made.run = name, made.group = group, made.clip = name + ".avi", made.frames = static_cast<int>(frames) + 1;
  made.counted_frames = frames, made.seconds = seconds;
  made.counts = {{"split", splits}, {"all", splits + 3}};
  return made;
}

}  // namespace

TEST_CASE("rates are told in the finest unit that all runs know") {
  const std::vector<apps::GatheredRun> timed{run("a", "x", 4, 10, 2.), run("b", "x", 6, 10, 2.)},
      some{run("a", "x", 4, 10, 2.), run("b", "x", 6, 10, std::nullopt)};
  const auto by_second = apps::measure_groups(timed, 1), by_frame = apps::measure_groups(some, 1);
  CHECK(apps::name(by_second.unit) == "second");
  CHECK(apps::name(by_frame.unit) == "frame");
  const auto rate = [](const apps::GroupStatistics& found, const std::string& of) {
    for (const auto& one : found.rates)
      if (one.run == of && one.type == "split") return one.rate.mean;
    return -1.;
  };
  CHECK(rate(by_second, "a") == Approx(2));
  CHECK(rate(by_second, "") == Approx(2.5));
  CHECK(rate(by_frame, "b") == Approx(0.6));
}

TEST_CASE("groups that differ are told with their ratio, those that do not with that") {
  std::vector<apps::GatheredRun> runs;
  for (int i = 0; i < 4; ++i) {
    runs.push_back(run("x/" + std::to_string(i), "x", 10 + i, 10, std::nullopt));
    runs.push_back(run("y/" + std::to_string(i), "y", 40 + i, 10, std::nullopt));
  }
  auto found = apps::measure_groups(runs, 1);
  const auto words = apps::gathered_words({runs, {}}, found);
  CHECK(contains(words.at(0), "8 clips of 2 groups"));
  const auto all = [&](const std::vector<std::string>& sentences, const std::string& part) {
    return std::any_of(sentences.begin(), sentences.end(), [&](const auto& s) { return contains(s, part); });
  };
  CHECK(all(words, "kind split are 3.6 times as frequent in y as in x"));
  CHECK(all(words, "p = 0.029"));  // 2 of 70 ways to deal eight clips out
  for (auto& one : runs) one.counts["split"] = 20, one.counts["all"] = 23;
  CHECK(all(apps::gathered_words({runs, {}}, apps::measure_groups(runs, 1)), "No two groups differ"));
}

TEST_CASE("cells of the table that hold commas, quotes or line breaks are quoted") {
  auto odd = run("a, \"b\"", "x", 1, 10, std::nullopt);
  odd.warnings = {"one, two", "three"};
  std::ostringstream out;
  apps::write_gathered_table(out, {{odd}, {}}, apps::measure_groups({odd}, 1));
  CHECK(contains(out.str(), "\"a, \"\"b\"\"\""));
  CHECK(contains(out.str(), "\"one, two; three\""));
}
