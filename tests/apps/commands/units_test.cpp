// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <map>
#include <sstream>

#include "tests/apps/commands/command_check.hpp"
#include "tests/support/stored_video.hpp"

using namespace emberfold;
using namespace emberfold::test;

namespace {

std::string first_line(const fs::path& file) {
  std::istringstream lines(bytes_of(file));
  std::string line;
  std::getline(lines, line);
  return line;
}

/// The first row of a table whose `column` is `value`, by columns.
std::map<std::string, std::string> row_where(const fs::path& file, const std::string& column,
                                             const std::string& value) {
  std::istringstream lines(bytes_of(file));
  const auto cells = [&] {
    std::string line, cell;
    std::getline(lines, line);
    std::vector<std::string> found;
    for (std::istringstream rest(line); std::getline(rest, cell, ',');) found.push_back(cell);
    return found;
  };
  const auto names = cells();
  for (auto row = cells(); !row.empty(); row = cells()) {
    std::map<std::string, std::string> found;
    for (std::size_t i = 0; i < std::min(names.size(), row.size()); ++i) found[names[i]] = row[i];
    if (found[column] == value) return found;
  }
  return {};
}

double number_in(const std::map<std::string, std::string>& row, const char* column) {
  INFO(column);
  REQUIRE(row.contains(column));
  return std::stod(row.at(column));
}

/// A line stays, another one is born at x = 66 in frame 8; eight frames at 33 ms, then 100 ms.
void write_uneven_birth(const fs::path& path) {
  StoredVideo video{.width = 96, .height = 72, .times = {}};
  for (int t = 0; t < 16; ++t) video.times.push_back(t < 8 ? 33 * t : 231 + 100 * (t - 7));
  write_stored_video(path, video, [](AVFrame& frame, int t) {
    for (int y = 0; y < 72; ++y)
      for (int x = 0; x < 96; ++x) {
        const auto line = [&](int at) {
          return y < 12 || y >= 60 ? 0 : 150 * std::exp(-(x - at) * (x - at) / 8.0);
        };
        set_value(frame, 0, x, y, static_cast<int>(std::lround(40 + line(30) + (t < 8 ? 0 : line(66)))));
      }
  });
}

}  // namespace

TEST_CASE(
    "times are those of the frames, and a part of a clip counts from the source unless an option says "
    "otherwise") {
  const TempFolder temp;
  const auto clip = temp / "clip.mkv";
  write_uneven_birth(clip);
  const auto birth = [&](const char* out, const std::vector<std::string>& more) {
    const auto result = run_command(joined(
        {"analyze", clip.string(), "-o", (temp / out).string(), "-q", "--bottom-up", "--pixel-size", "2um"},
        more));
    INFO(result.err);
    REQUIRE(result.exit == 0);
    auto row = row_where(temp / out / "events.csv", "type", "birth");
    // The same as in events.json, and in what export makes of that.
    REQUIRE(
        run_command({"export", (temp / out).string(), "--csv", "-o", (temp / out / "again").string()}).exit ==
        0);
    for (const char* table :
         {"events.csv", "strokes.csv", "curves.csv", "lives.csv", "network.csv", "trajectories.csv"})
      CHECK(bytes_of(temp / out / table) == bytes_of(temp / out / "again" / table));
    const Json events = json_of(temp / out / "events.json");
    CHECK(events["events"][0]["x"].get<double>() == Approx(number_in(row, "x")));
    CHECK(events.value("counted_from", "") == (row.contains("counted_from") ? row["counted_from"] : ""));
    return row;
  };
  const auto whole = birth("whole", {});
  CHECK(number_in(whole, "frame") == 8);
  CHECK(number_in(whole, "time_s") == Approx(0.331));
  CHECK(number_in(whole, "x") == Approx(66).margin(1));
  CHECK_FALSE(whole.contains("counted_from"));
  CHECK(number_in(row_where(temp / "whole/network.csv", "frame", "15"), "time_s") == Approx(1.031));
  const Json summary = summary_of(temp / "whole");
  CHECK(summary["rates"]["counted_in"]["s"].get<double>() == Approx(1.031));
  CHECK(summary["clip"]["times_s"][8].get<double>() == Approx(0.331));

  const std::vector<std::string> part{"--range", "4:", "--roi", "40,4,56,64"};
  const auto source = birth("source", part), own = birth("own", joined(part, {"--origin", "part"}));
  CHECK(number_in(source, "frame") == 4);
  CHECK(number_in(source, "time_s") == Approx(0.331));
  CHECK(number_in(source, "x") == Approx(number_in(whole, "x")).margin(0.5));
  CHECK(number_in(source, "y") == Approx(number_in(whole, "y")).margin(0.5));
  CHECK(number_in(source, "x_um") == Approx(2 * number_in(source, "x")));
  CHECK(source.at("counted_from") == "source");
  CHECK(number_in(own, "time_s") == Approx(0.199));
  CHECK(number_in(own, "x") == Approx(number_in(source, "x") - 40));
  CHECK(own.at("counted_from") == "part");
  CHECK(summary_of(temp / "source")["clip"]["counted_from"]["time_s"].get<double>() == Approx(0.132));
  for (const char* table : {"strokes", "trajectories", "curves", "joints", "named_events", "contacts",
                            "topology", "tips", "network", "lives"})
    CHECK(first_line(temp / "source" / (std::string(table) + ".csv")).ends_with(",counted_from"));
  check_one_line({"analyze", clip.string(), "-o", (temp / "wrong").string(), "--origin", "here"}, 2,
                 {"--origin is here", "source or part"});
}

TEST_CASE("rates and lives are told in seconds and lengths where these are known, and only there") {
  const TempFolder temp;
  const auto clip = write_strokes(temp / "clip", {120, 90}, 16, 8);
  const auto run = [&](const std::string& out, const std::vector<std::string>& more) {
    REQUIRE(
        run_command(joined({"analyze", clip, "-o", (temp / out).string(), "-q", "--bottom-up"}, more)).exit ==
        0);
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
