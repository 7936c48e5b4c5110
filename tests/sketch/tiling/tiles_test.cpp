// SPDX-License-Identifier: Apache-2.0
#include "sketch/tiling/tiles.hpp"

#include <algorithm>
#include <cmath>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "core/error.hpp"
#include "sketch/extract.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/sketch_scene.hpp"

using namespace emberfold;
using namespace emberfold::test;
using graph::AttributeGraph;

namespace {

/// Lines that cross the frame, a ring, an edge, and a faint line.
cv::Mat1f scene() {
  const cv::Size size(420, 330);
  const cv::Mat1f lines = draw(size,
                               {segment({20, 40}, {400, 90}, 3, 1), segment({60, 310}, {260, 20}, 4, 1.2),
                                ring({270, 190}, 70, 3, 1), segment({30, 180}, {160, 300}, 2, 1)},
                               90, 60);
  return with_noise(draw(size,
                         [&](Point p) {
                           return double{lines(static_cast<int>(p.y), static_cast<int>(p.x))} +
                                  50 * reached(p.y - 280 + 0.05 * p.x, 1);
                         }),
                    2, 8);
}

cv::Mat1b drawn(const AttributeGraph& graph, cv::Size size) {
  cv::Mat1b picture(size, std::uint8_t{0});
  const auto pixel = [](Point p) { return cv::Point(cvRound(p.x), cvRound(p.y)); };
  for (const graph::Edge& e : graph.edges())
    cv::line(picture, pixel(graph.patch(graph.index_of(e.a)).position),
             pixel(graph.patch(graph.index_of(e.b)).position), cv::Scalar(255));
  return picture;
}

/// The share of what `a` shows that lies within 1.5 px of what `b` shows: 1 px and the rounding of pixels.
double share_near(const cv::Mat1b& a, const cv::Mat1b& b) {
  cv::Mat1f distance;
  cv::distanceTransform(cv::Mat(255 - b), distance, cv::DIST_L2, cv::DIST_MASK_PRECISE);
  int near = 0, all = 0;
  for (int y = 0; y < a.rows; ++y)
    for (int x = 0; x < a.cols; ++x)
      if (a(y, x) != 0) ++all, near += distance(y, x) <= 1.5F ? 1 : 0;
  return static_cast<double>(near) / std::max(all, 1);
}

std::size_t free_ends(const AttributeGraph& graph) {
  std::size_t count = 0;
  for (std::size_t i = 0; i < graph.size(); ++i) count += graph.degree(i) == 1 ? 1 : 0;
  return count;
}

}  // namespace

TEST_CASE("The cores of tiles part the frame, and each is read with its margin", "[sketch]") {
  const cv::Size frame(1000, 701);
  cv::Mat1b count(frame, std::uint8_t{0});
  for (const sketch::Tile& tile : sketch::make_tiles(frame, 300, 40)) {
    CHECK(std::max(tile.core.width, tile.core.height) <= 300);
    CHECK((tile.core & tile.read) == tile.core);
    const auto apart = [](int core, int read, int border) { return read == border || core - read == 40; };
    CHECK(apart(tile.core.x, tile.read.x, 0));
    CHECK(apart(tile.core.y, tile.read.y, 0));
    CHECK((tile.read.br().x == frame.width || tile.read.br().x - tile.core.br().x == 40));
    count(tile.core) += 1;
  }
  CHECK(cv::countNonZero(count != 1) == 0);
}

TEST_CASE("A line that two tiles share is one stroke again", "[sketch]") {
  const auto tiles = sketch::make_tiles({200, 100}, 100, 20);
  const auto line = [](double from, double to) {
    std::vector<graph::Vertex> vertices;
    std::vector<graph::Edge> edges;
    for (double x = from; x <= to; x += 5) {
      const auto id = static_cast<std::uint32_t>(vertices.size());
      graph::Patch patch;
      patch.position = {x, 50};
      vertices.push_back({{id}, {}, patch});
      if (id > 0) edges.push_back({{id - 1}, {id}});
    }
    return AttributeGraph(std::move(vertices), std::move(edges));
  };
  // The second tile begins at 80: its patches lie 2 px beside the first one's.
  const AttributeGraph joined = sketch::join_tiles(tiles, {line(10, 115), line(4, 90)}, 5);
  CHECK(graph::components(joined).count == 1);
  CHECK(free_ends(joined) == 2);
  CHECK(joined.edges().size() + 1 == joined.size());
  const AttributeGraph apart = sketch::join_tiles(tiles, {line(10, 80), line(44, 90)}, 5);
  CHECK(graph::components(apart).count == 2);
}

TEST_CASE("Edges that leave two tiles are tied where they are in line and have not passed each other",
          "[sketch]") {
  const auto tiles =
      sketch::make_tiles({100, 60}, 50, 10);  // cores from 0 and from 50, read up to 60 and from 40
  REQUIRE(tiles.size() == 4);
  // An edge up to `left` goes on past the seam, one down from `right` comes from it.
  const auto edges = [&](Point left, Point left_to, Point right, Point right_from) {
    const auto edge = [](Point a, Point b, Point origin) {
      graph::Patch one, other;
      one.position = a - origin, other.position = b - origin;
      return AttributeGraph({{{0}, {}, one}, {{1}, {}, other}}, {{{0}, {1}}});
    };
    const Point origin{double(tiles[1].read.x), double(tiles[1].read.y)};
    const auto joined =
        sketch::join_tiles(tiles, {edge(left, left_to, {}), edge(right, right_from, origin), {}, {}}, 5);
    CHECK(joined.size() == 2);
    return joined.edges().size();
  };
  CHECK(edges({47, 15}, {52, 15}, {52, 15}, {47, 15}) == 1);
  CHECK(edges({49, 15}, {50, 20}, {51, 15}, {49, 10}) == 1);  // side by side at the seam
  CHECK(edges({48, 15}, {53, 15}, {51, 17.4}, {46, 17.4}) == 1);
  CHECK(edges({48, 15}, {53, 15}, {51, 17.6}, {46, 17.6}) == 0);  // too far aside
  CHECK(edges({48, 15}, {53, 15}, {62, 15}, {47, 15}) == 1);
  CHECK(edges({48, 15}, {53, 15}, {64, 15}, {47, 15}) == 0);  // too far away
  CHECK(edges({48, 15}, {53, 15}, {51, 15}, {49, 19}) == 0);  // in another direction
  // Along the seam: the second end lies 2, then 4 px behind the first one.
  CHECK(edges({49, 15}, {51, 35}, {50, 13}, {48, -7}) == 1);
  CHECK(edges({49, 15}, {51, 35}, {50, 11}, {48, -9}) == 0);
}

TEST_CASE("A frame in tiles has the curves of the whole frame", "[sketch]") {
  const cv::Mat1f frame = scene();
  const AttributeGraph whole = sketch::extract(frame, {}), tiled = sketch::extract(frame, {.tile = 90});
  const cv::Mat1b a = drawn(whole, frame.size()), b = drawn(tiled, frame.size());
  CHECK(share_near(a, b) > 0.99);
  CHECK(share_near(b, a) > 0.99);
  CHECK(free_ends(tiled) <= free_ends(whole) + 2);
  CHECK_FALSE(tiled == whole);
}

TEST_CASE("Given curves and boundaries are drawn in tiles, too", "[sketch][heavy]") {
  const cv::Mat1f frame = scene();
  cv::Mat1f given(frame.size(), 0.0F);
  cv::line(given, {20, 40}, {400, 90}, cv::Scalar(0.9), 3);
  const cv::Mat1b a = drawn(sketch::extract(frame, {}, given), frame.size()),
                  b = drawn(sketch::extract(frame, {.tile = 90}, given), frame.size());
  CHECK(share_near(a, b) > 0.99);
  CHECK(share_near(b, a) > 0.99);
  const cv::Mat1f halves =
      with_noise(draw(frame.size(), [](Point p) { return p.x + 0.3 * p.y < 230 ? 60.0 : 150.0; }), 3, 4);
  const cv::Mat1b c = drawn(sketch::extract(halves, {.boundaries = true}), frame.size()),
                  d = drawn(sketch::extract(halves, {.boundaries = true, .tile = 90}), frame.size());
  CHECK(cv::countNonZero(c) > 250);
  CHECK(share_near(c, d) > 0.97);
  CHECK(share_near(d, c) > 0.97);
}

TEST_CASE("A tile of a size that is not allowed is refused", "[sketch]") {
  CHECK_THROWS_AS(sketch::extract(scene(), {.tile = 10}), core::InputError);
}
