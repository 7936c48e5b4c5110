// SPDX-License-Identifier: Apache-2.0
#include <map>
#include <sstream>

#include "core/error.hpp"
#include "graph/io/motion_io.hpp"
#include "graph/network/network_figures.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/graphs.hpp"

using namespace emberfold;

namespace {

std::string table_of(const graph::MotionGraph& motion) {
  std::ostringstream out;
  graph::write_strokes(out, motion);
  return out.str();
}

std::vector<std::vector<double>> rows_of(const std::string& table) {
  std::vector<std::vector<double>> rows;
  std::istringstream lines(table);
  std::string line, cell;
  std::getline(lines, line);
  while (std::getline(lines, line)) {
    std::istringstream cells(line);
    rows.emplace_back();
    while (std::getline(cells, cell, ',')) rows.back().push_back(std::stod(cell));
  }
  return rows;
}

}  // namespace

TEST_CASE("The table of strokes has a row for each stroke and frame", "[graph][io]") {
  test::Frame first, second;
  first.line({{10, 20}, {14, 20}, {18, 20}}, 40);
  first.line({{60, 80}}, -30);
  // the line goes on with an arm: a T; the single patch goes, another line comes
  second.line({{10, 21}, {14, 21}, {18, 21}}, 50);
  second.edge(1, second.line({{14, 23}}, 30));
  second.line({{100, 100}, {100, 112}}, 20);
  second.vertices[0].patch.width = 6;
  const auto motion =
      graph::identify(test::motion({first.graph(), second.graph()}, {{{0, 0}, {1, 1}, {2, 2}}}));
  CHECK(table_of(motion) ==
        "stroke,frame,x,y,length,patches,width,contrast,ends,junctions\n"
        "1,0,14,20,8,3,2,40,2,0\n"
        "1,1,14,21,10,4,3,45,3,1\n"
        "2,0,60,80,0,1,2,-30,0,0\n"
        "3,1,100,106,12,2,2,20,2,0\n");
}

TEST_CASE("A ring has no end, a stroke's length is that of all its edges", "[graph][io]") {
  test::Frame frame;
  frame.line({{0, 0}, {3, 4}, {6, 0}});
  frame.edge(0, 2);
  const auto rows = rows_of(table_of(graph::identify(test::motion({frame.graph()}, {}))));
  REQUIRE(rows.size() == 1);
  CHECK(rows[0][4] == 16);
  CHECK(rows[0][8] == 0);
  CHECK(rows[0][9] == 0);
}

TEST_CASE("A stroke's length is what is seen of it: no border, no way to another piece", "[graph][io]") {
  const graph::Point corners[] = {{0, 0}, {10, 0}, {20, 0}, {20, 60}, {30, 60}};
  std::vector<graph::Vertex> vertices;
  for (std::uint32_t id = 0; id < 5; ++id) {
    vertices.push_back(test::vertex(id, corners[id].x, corners[id].y, 0, id < 2 ? 0 : 40));
    vertices.back().patch.width = 0;
  }
  const graph::AttributeGraph outline(vertices, {{{0}, {1}}, {{1}, {2}}, {{2}, {3}}, {{3}, {4}}});
  const auto motion = graph::identify(graph::MotionGraph{{40, 80, 25, {outline}}, {{}}});
  const auto rows = rows_of(table_of(motion));
  REQUIRE(rows.size() == 1);
  CHECK(rows[0][4] == 20);
  CHECK(graph::seen_length(outline) == 20);
  CHECK(graph::network_figures(outline).length == 20);
}

TEST_CASE("The table of strokes tells of every patch once, in order", "[graph][io]") {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const auto motion = graph::identify(test::random_motion(seed, 5, 8));
    const auto rows = rows_of(table_of(motion));
    std::map<std::pair<double, double>, double> patches;  // by stroke and frame
    for (std::size_t t = 0; t < motion.sketch.frames.size(); ++t)
      for (const auto& v : motion.sketch.frames[t].vertices())
        ++patches[{static_cast<double>(v.subgraph.value), static_cast<double>(t)}];
    REQUIRE(rows.size() == patches.size());
    auto expected = patches.begin();
    for (const auto& row : rows) {
      CHECK(expected->first == std::pair(row[0], row[1]));
      CHECK(expected->second == row[5]);
      ++expected;
    }
  }
}

TEST_CASE("Strokes that were not identified are told apart all the same", "[graph][io]") {
  test::Frame frame;
  frame.line({{0, 0}, {4, 0}});
  frame.line({{50, 0}, {58, 0}});
  const auto rows = rows_of(table_of(test::motion({frame.graph()}, {})));
  REQUIRE(rows.size() == 2);
  CHECK(rows[0][0] == 0);
  CHECK(rows[0][4] == 4);
  CHECK(rows[1][4] == 8);
  std::ostringstream broken;
  broken.setstate(std::ios::badbit);
  CHECK_THROWS_AS(graph::write_strokes(broken, test::motion({frame.graph()}, {})), core::IoError);
}
