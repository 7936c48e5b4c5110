// SPDX-License-Identifier: Apache-2.0
#include "tests/apps/commands/command_check.hpp"

using namespace emberfold;
using namespace emberfold::test;

TEST_CASE("bench-events makes scenes, and scores a program that knows the truth with 1") {
  const TempFolder temp;
  const std::string out = (temp / "bench").string();
  const std::vector<std::string> make{
      "runs",     "bench-events", "-o",       out, "--only",      "networks,filaments",
      "--frames", "60",           "--scenes", "2", "--make-only", "-q"};
  REQUIRE(run_command(make).exit == 0);
  fs::create_directories(temp / "oracle");
  for (const char* scene : {"networks_1", "networks_2", "filaments_1", "filaments_2"}) {
    CHECK(fs::exists(temp / "bench/scenes" / scene / "clip.avi"));
    fs::copy_file(temp / "bench/scenes" / scene / "truth.json",
                  temp / "oracle" / (std::string(scene) + ".json"));
  }
  CHECK_FALSE(fs::exists(temp / "bench/bench.csv"));  // there was nothing to score
  const auto scored =
      run_command(joined(make, {"--json", "--entry", "oracle=" + (temp / "oracle").string()}));
  REQUIRE(scored.exit == 0);
  const Json rows = Json::parse(scored.out)["rows"];
  REQUIRE(rows.size() == 2);
  CHECK((rows[0]["kind"] == "networks" && rows[0]["entry"] == "oracle" && rows[0]["frames"] == 120));
  CHECK((rows[0]["six"]["all"]["f1"] == 1 && rows[0]["six"]["all"]["true"] >= 8));
  CHECK((rows[1]["six"]["all"]["true"] == 0 && rows[1]["false_per_frame"] == 0));
  CHECK(bytes_of(temp / "bench/bench.csv").starts_with("kind,entry,frames,true,found,hit,precision"));
}

TEST_CASE("what bench-events does not take is told") {
  const TempFolder temp;
  const std::string out = (temp / "bench").string();
  const auto error_of = [&](const std::vector<std::string>& more) {
    const auto result =
        run_command(joined({"runs", "bench-events", "-o", out, "-q", "--only", "folds"}, more));
    CHECK(result.exit != 0);
    return result.err;
  };
  CHECK(contains(error_of({"--frames", "10"}), "frames is 10; allowed is 60 to 1000"));
  CHECK(contains(error_of({"--entry", "folder"}), "it is to be NAME=FOLDER"));
  CHECK(contains(error_of({"--entry", "emberfold=x", "--make-only"}), "a name of its own"));
  CHECK(contains(error_of({"--entry", "x=" + (temp / "none").string(), "--make-only", "--frames", "60"}),
                 "folds_1.json"));
  CHECK(contains(error_of({"--picture", (temp / "none.png").string()}), "none.png"));
  CHECK_FALSE(fs::exists(temp / "bench"));
}
