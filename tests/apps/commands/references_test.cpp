// SPDX-License-Identifier: Apache-2.0
// Every identity that a table of a run names is in the table of strokes or curves, in that frame.
#include <algorithm>
#include <fstream>
#include <iterator>
#include <map>
#include <set>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "graph/events/events.hpp"
#include "graph/io/motion_io.hpp"
#include "tests/apps/commands/command_check.hpp"

using namespace emberfold;
using namespace emberfold::test;

namespace {

using Seen = std::set<std::pair<int, int>>;  // identity, frame

/// A table of numbers and names, by column.
class Table {
 public:
  explicit Table(const fs::path& path) {
    std::ifstream in(path);
    std::string line, cell;
    std::vector<std::string> names;
    REQUIRE(std::getline(in, line));
    for (std::istringstream cells(line); std::getline(cells, cell, ',');) names.push_back(cell);
    for (; std::getline(in, line); ++rows) {
      std::istringstream cells(line);
      for (const auto& name : names) {
        cell.clear();
        std::getline(cells, cell, ',');
        columns_[name].push_back(cell);
      }
    }
  }
  [[nodiscard]] int number(const std::string& column, std::size_t row) const {
    return std::stoi(columns_.at(column)[row]);
  }
  [[nodiscard]] Seen pairs(const std::string& identity, const std::string& frame) const {
    Seen result;
    for (std::size_t k = 0; k < rows; ++k) result.emplace(number(identity, k), number(frame, k));
    return result;
  }
  std::size_t rows = 0;

 private:
  std::map<std::string, std::vector<std::string>> columns_;
};

/// Returns which of the pairs are not in a table.
Seen missing(const Seen& named, const Seen& there) {
  Seen result;
  std::ranges::set_difference(named, there, std::inserter(result, result.end()));
  return result;
}

std::vector<graph::Event> events_of(const fs::path& path) {
  std::ifstream in(path);
  return graph::read_events(in, path.string());
}

void check_events(const std::vector<graph::Event>& events, const Seen& strokes) {
  for (const auto& event : events) {
    CAPTURE(event.frame, graph::name(event.type), event.probability);
    for (const auto& [list, frame] :
         {std::pair(&event.before, event.frame - 1), std::pair(&event.after, event.frame)}) {
      std::set<std::uint32_t> once;
      for (const auto stroke : *list) {
        CHECK(strokes.contains({static_cast<int>(stroke.value), frame}));
        CHECK(once.insert(stroke.value).second);
      }
    }
  }
}

}  // namespace

TEST_CASE("no table of a run names a stroke or curve that is not there") {
  const TempFolder temp;
  const fs::path run = temp / "run";
  REQUIRE(
      run_command({"analyze", "builtin:fire", "-o", run.string(), "-q", "--range", "0:30", "--scale", "0.4"})
          .exit == 0);
  const Seen strokes = Table(run / "strokes.csv").pairs("stroke", "frame"),
             curves = Table(run / "curves.csv").pairs("curve", "frame");
  const Table joints(run / "joints.csv"), contacts(run / "contacts.csv"), tips(run / "tips.csv"),
      lives(run / "lives.csv"), trajectories(run / "trajectories.csv");
  REQUIRE((joints.rows > 20 && contacts.rows > 5 && tips.rows > 100 && lives.rows > 20));
  for (const char* curve : {"curve_a", "curve_b"}) {
    CHECK(missing(joints.pairs(curve, "frame"), curves).empty());
    for (const char* frame : {"first", "last"}) CHECK(missing(contacts.pairs(curve, frame), curves).empty());
  }
  for (const char* frame : {"first", "last"}) {
    CHECK(missing(tips.pairs("curve", frame), curves).empty());
    CHECK(missing(lives.pairs("stroke", frame), strokes).empty());
  }
  CHECK(trajectories.pairs("stroke", "frame") == strokes);

  const auto events = events_of(run / "events.json");
  CHECK(Table(run / "named_events.csv").rows == events.size());
  CHECK(Table(run / "events.csv").rows == events.size());
  check_events(events, strokes);
  check_events(events_of(run / "events_all.json"), strokes);
  REQUIRE(events.size() > 5);
  for (const auto& event : events) {
    CAPTURE(event.frame, graph::name(event.type), event.probability);
    CHECK_FALSE((event.before.empty() && event.after.empty()));
  }
}
