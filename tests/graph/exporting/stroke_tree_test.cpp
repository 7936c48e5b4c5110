// SPDX-License-Identifier: Apache-2.0
#include "graph/exporting/stroke_tree.hpp"

#include <cmath>
#include <sstream>
#include <string>
#include <vector>

#include "graph/events/events.hpp"
#include "graph/exporting/tracking_files.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/merging_strokes.hpp"

using namespace emberfold;
using test::merge_with;
using test::two_become_one;

TEST_CASE("A merge leads from the last frames of two strokes to the first of the whole",
          "[graph][exporting]") {
  const auto tree = graph::make_stroke_tree(two_become_one(), {merge_with(0.75)});
  REQUIRE(tree.rows.size() == 6);  // two frames of each of three strokes
  for (std::uint32_t i = 0; i < 6; ++i) {
    CHECK(tree.rows[i].stroke == i / 2 + 1);
    CHECK(tree.rows[i].frame == (i < 4 ? i % 2 : i - 2));
    CHECK(tree.rows[i].length == Approx(i < 4 ? 10 : 30));
  }
  REQUIRE(tree.links.size() == 5);
  for (std::size_t k = 0; k < 3; ++k) {  // strokes that go on
    CHECK(tree.links[k].from == 2 * k);
    CHECK(tree.links[k].to == 2 * k + 1);
    CHECK(tree.links[k].probability == 1);
    CHECK(tree.links[k].event.empty());
  }
  for (std::size_t k = 3; k < 5; ++k) {
    CHECK(tree.links[k].from == (k == 3 ? 1 : 3));
    CHECK(tree.links[k].to == 4);
    CHECK(tree.links[k].probability == 0.75);
    CHECK(tree.links[k].event == "merge");
  }
}

TEST_CASE("An event between strokes that do not follow each other is no link", "[graph][exporting]") {
  auto event = merge_with(0.75);
  event.before = {{3}}, event.after = {{1}};
  const auto tree = graph::make_stroke_tree(two_become_one(), {event, merge_with(0.5), merge_with(0.25)});
  REQUIRE(tree.links.size() == 5);
  CHECK(tree.links.back().probability == 0.5);  // of two events between two strokes the first counts
}

TEST_CASE("Strokes of a TrackMate file lie in micrometres and seconds", "[graph][exporting]") {
  const auto tree = graph::make_stroke_tree(two_become_one(), {merge_with(0.75)});
  graph::TrackedClip clip{"clip", 320, 240, 4, 25, {}};
  clip.units.um = 0.5, clip.units.seconds = 0.2;
  std::ostringstream out;
  graph::write_trackmate(out, tree, clip);
  // The whole in the last frame: its middle at (25, 50) px, 30 px long.
  CHECK_THAT(out.str(), test::Contains("POSITION_X=\"12.5\" POSITION_Y=\"25\"") &&
                            test::Contains("POSITION_T=\"0.6") && test::Contains("RADIUS=\"7.5\"") &&
                            test::Contains("LENGTH=\"15\""));
  clip.units.times = {0, 0.1, 0.3, 0.7}, clip.units.origin = {10, 0, 0, "source"};
  std::ostringstream uneven;
  graph::write_trackmate(uneven, tree, clip);
  CHECK_THAT(uneven.str(), test::Contains("POSITION_X=\"17.5\"") && test::Contains("POSITION_T=\"0.7\""));
  CHECK_THAT(out.str(), test::Contains("SPOT_SOURCE_ID=\"3\" SPOT_TARGET_ID=\"4\" LINK_COST=\"0.28768207"));
}

TEST_CASE("The surest link of a TrackMate file is the cheapest", "[graph][exporting]") {
  const auto costs = [](double probability) {
    const auto tree = graph::make_stroke_tree(two_become_one(), {merge_with(probability)});
    std::ostringstream out;
    graph::write_trackmate(out, tree, {"clip", 320, 240, 4, 25, {}});
    std::vector<double> found;
    const std::string text = out.str(), key = "LINK_COST=\"";
    for (auto at = text.find(key); at != std::string::npos; at = text.find(key, at + 1))
      found.push_back(std::stod(text.substr(at + key.size())));
    return found;
  };
  // Three links of strokes that go on, which are sure, and two of the event.
  CHECK(costs(1) == std::vector<double>{0, 0, 0, 0, 0});
  const auto even = costs(0.5), faint = costs(0);
  REQUIRE(even.size() == 5);
  CHECK(even[2] == 0);
  CHECK(even[4] == Approx(0.693147));
  REQUIRE(faint.size() == 5);
  CHECK((std::isfinite(faint[4]) && faint[4] > even[4]));
}

TEST_CASE("A stroke of a GraphML file has its frames and its mean length", "[graph][exporting]") {
  const auto tree = graph::make_stroke_tree(two_become_one(), {merge_with(0.75)});
  std::ostringstream out;
  graph::write_graphml(out, tree, {"clip", 320, 240, 4, 25, {}});
  CHECK_THAT(out.str(),
             test::Contains("<node id=\"s3\"><data key=\"first\">2</data><data key=\"last\">3</data>"
                            "<data key=\"length\">30</data></node>"));
  CHECK_THAT(out.str(), test::Contains("<edge source=\"s2\" target=\"s3\"><data key=\"type\">merge</data>"
                                       "<data key=\"probability\">0.75</data><data key=\"frame\">2</data>"));
}
