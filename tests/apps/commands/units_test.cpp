// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <sstream>

#include "tests/apps/commands/command_check.hpp"

using namespace emberfold;
using namespace emberfold::test;

namespace {

std::string first_line(const fs::path& file) {
  std::istringstream lines(bytes_of(file));
  std::string line;
  std::getline(lines, line);
  return line;
}

}  // namespace

TEST_CASE("rates and lives are told in seconds and lengths where these are known, and only there") {
  const TempFolder temp;
  const auto clip = write_strokes(temp / "clip", {120, 90}, 16, 8);
  const auto run = [&](const std::string& out, const std::vector<std::string>& more) {
    REQUIRE(run_command(joined({"analyze", clip, "-o", (temp / out).string(), "-q", "--bottom-up", "--set",
                                "calibrate.calibrate=0"},
                               more))
                .exit == 0);
    return summary_of(temp / out);
  };
  const Json plain = run("plain", {}), known = run("known", {"--fps", "4", "--pixel-size", "10um"});
  const Json &rate = plain["rates"]["classes"]["all"], &all = known["rates"]["classes"]["all"];
  CHECK(rate["a_second"].is_null());
  CHECK(rate["a_second_and_mm2"].is_null());
  CHECK(rate["a_frame"] == all["a_frame"]);
  CHECK(rate["count"] == plain["events"]["total"]);
  const double events = all["count"].get<double>();
  REQUIRE(events > 0);
  for (const char* end : {"mean", "low", "high"}) {
    CHECK(all["a_second"][end].get<double>() == Approx(4 * all["a_frame"][end].get<double>()).epsilon(1e-4));
    // 1.2 mm × 0.9 mm
    CHECK(all["a_second_and_mm2"][end].get<double>() ==
          Approx(all["a_second"][end].get<double>() / 1.08).epsilon(1e-4));
  }
  CHECK(all["a_frame"]["mean"].get<double>() == Approx(events / 15).epsilon(1e-4));
  CHECK(all["a_frame"]["low"] < all["a_frame"]["mean"]);
  CHECK(all["a_frame"]["mean"] < all["a_frame"]["high"]);
  const Json& length = known["strokes"]["length"];
  CHECK(length["median_um"].get<double>() == Approx(10 * length["median"].get<double>()).epsilon(1e-4));
  CHECK_FALSE(plain["strokes"]["length"].contains("median_um"));
  CHECK(first_line(temp / "known/events.csv").ends_with(",time_s,x_um,y_um"));
  CHECK(first_line(temp / "plain/events.csv") == "frame,type,x,y,probability,before,after");
  CHECK(first_line(temp / "known/lives.csv").ends_with("speed_um_s"));
}

TEST_CASE("compare tests whether events are as frequent in both clips") {
  const TempFolder temp;
  const auto a = write_strokes(temp / "a", {96, 72}, 16, 8), b = write_strokes(temp / "b", {96, 72}, 12, 3);
  const auto result = run_command({"compare", a, b, "-o", (temp / "out").string(), "-q"});
  INFO(result.err);
  REQUIRE(result.exit == 0);
  CHECK(contains(result.out, "events a frame, other to first"));
  const Json tests = json_of(temp / "out/measures.json")["rate_tests"];
  CHECK(tests["per"] == "frame");
  const Json &all = tests["classes"]["all"], measures = json_of(temp / "out/measures.json");
  double sum = 0;
  for (const auto& [name, one] : measures["distances"]["source"]["strokes"]["events"].items())
    sum += one["count"].get<double>();
  CHECK(all["counts"][0] == sum);
  CHECK(all["p"] >= 0);
  CHECK(all["p"] <= 1);
  if (all["ratio"].is_number() && all["low"].is_number()) CHECK(all["low"] <= all["ratio"]);
  const auto timed = run_command({"compare", a, a, "-o", (temp / "same").string(), "-q", "--fps", "10"});
  REQUIRE(timed.exit == 0);
  const Json same = json_of(temp / "same/measures.json")["rate_tests"];
  CHECK(same["per"] == "second");
  CHECK(same["classes"]["all"]["p"] == 1);
}
