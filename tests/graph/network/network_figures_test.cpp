// SPDX-License-Identifier: Apache-2.0
#include "graph/network/network_figures.hpp"

#include <numeric>
#include <sstream>

#include "core/error.hpp"
#include "graph/io/network_table.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/graphs.hpp"

using namespace emberfold;
using graph::NetworkFigures;

namespace {

/// A square of 40 px with a wall across its middle and a tail, a ring of 10 px beside it, and a single patch.
graph::AttributeGraph rooms() {
  test::Frame frame;
  const auto square = frame.line({{0, 0}, {20, 0}, {40, 0}, {40, 40}, {20, 40}, {0, 40}});
  frame.edge(square, square + 5);
  frame.edge(square + 1, square + 4);
  const auto tail = frame.line({{50, 40}, {60, 40}});
  frame.edge(square + 3, tail);
  const auto ring = frame.line({{100, 0}, {110, 0}, {110, 10}, {100, 10}});
  frame.edge(ring, ring + 3);
  frame.line({{200, 200}});
  return frame.graph();
}

}  // namespace

TEST_CASE("Lengths, tips, junctions, loops and meshes of a network are counted", "[graph][network]") {
  const NetworkFigures f = graph::network_figures(rooms());
  CHECK(f.length == 160 + 40 + 20 + 40);
  CHECK(f.longest == 160 + 40 + 20);
  CHECK((f.components == 3 && f.points == 1 && f.tips == 1));
  CHECK((f.junctions_3 == 3 && f.junctions_4 == 0 && f.junctions_more == 0 && f.branches == 3));
  CHECK(f.loops == 3);
  CHECK(f.meshes == std::vector<double>{100, 800, 800});
  // between its junctions: 80 px round the left room, 20 and 60 round the right one, the wall and the tail
  CHECK_THAT(f.tortuosity,
             test::WithinAbs((80 + 40 + 60 + 20 + 20) / (40.0 + 40 + std::hypot(20, 40) + 20 + 20), 1e-9));
}

TEST_CASE("Euler's number holds for every network, and meshes are loops where nothing crosses",
          "[graph][network]") {
  core::Rng rng(2);
  for (int k = 0; k < 300; ++k) {
    const auto graph = test::random_graph(rng, rng.below(8), rng.below(8));
    const NetworkFigures f = graph::network_figures(graph);
    CHECK(static_cast<int>(f.tips + 2 * f.points) - static_cast<int>(f.branches) ==
          2 * (static_cast<int>(f.components) - static_cast<int>(f.loops)));
    const auto with = test::with_anchors(graph, rng, 5);
    CHECK(graph::network_figures(with).components == f.components);
  }
  // a grid of 5 × 4 rooms of 30 × 20 px
  test::Frame frame;
  for (int y = 0; y < 5; ++y) frame.line(test::segment({0, 20.0 * y}, {150, 20.0 * y}, 6));
  for (std::uint32_t v = 0; v + 6 < 30; ++v) frame.edge(v, v + 6);
  const auto f = graph::network_figures(frame.graph());
  CHECK(f.loops == 20);
  CHECK(f.meshes == std::vector<double>(20, 600));
  CHECK(graph::network_figures({}).tortuosity == 1);
}

TEST_CASE("In every frame the components change as the events say", "[graph][network]") {
  int changes = 0;
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    const auto motion = graph::identify(test::random_motion(seed, 6, 8));
    const auto events = graph::network_changes(motion);
    for (std::size_t t = 1; t < events.size(); ++t) {
      const auto before = graph::components(motion.sketch.frames[t - 1]).count;
      const auto after = graph::components(motion.sketch.frames[t]).count;
      CHECK(after + events[t].deaths + events[t].unions == before + events[t].births + events[t].separations);
      changes += static_cast<int>(events[t].unions + events[t].separations);
    }
  }
  CHECK(changes > 100);
}

TEST_CASE("The table of the network has a row for each frame, in px and in µm", "[graph][network]") {
  const auto motion = graph::identify(test::motion({rooms(), {}}, {{}}));
  const auto text_of = [&](const graph::Units& units) {
    std::ostringstream out;
    graph::write_network(out, motion, units);
    return out.str();
  };
  const std::string text = text_of({});
  CHECK(text.starts_with(
      "frame,length,components,longest,points,tips,junctions_3,junctions_4,junctions_more,branches,loops,"
      "meshes,mesh_mean,mesh_median,tortuosity,births,deaths,unions,separations\n"
      "0,260,3,220,1,1,3,0,0,3,3,3,566.6666666666666,800,"));
  CHECK(test::Contains("\n1,0,0,0,0,0,0,0,0,0,0,0,0,0,1,0,3,0,0\n").match(text));
  const std::string with = text_of({0.5, 0.1});
  CHECK(test::Contains(",time_s,length_um,longest_um,mesh_mean_um2,mesh_median_um2\n").match(with));
  CHECK(test::Contains(",0,0,0,0,0,26,22,5.6").match(with));
  std::ostringstream broken;
  broken.setstate(std::ios::failbit);
  CHECK_THROWS_AS(graph::write_network(broken, motion, {}), core::IoError);
}
