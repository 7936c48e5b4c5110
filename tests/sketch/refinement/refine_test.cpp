// SPDX-License-Identifier: Apache-2.0
#include "sketch/refinement/refine.hpp"

#include <algorithm>
#include <functional>

#include "sketch/extract.hpp"
#include "sketch/refinement/editable_graph.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/sketch_scene.hpp"

using namespace emberfold;
using namespace emberfold::sketch;
using namespace emberfold::test;

namespace {

const cv::Size kRefineSize(160, 120);

/// The sketch of a frame without the patches that `hidden` says.
graph::AttributeGraph without(const graph::AttributeGraph& graph, const std::function<bool(Point)>& hidden) {
  std::vector<graph::Vertex> vertices;
  std::vector<graph::Edge> edges;
  for (const graph::Vertex& v : graph.vertices())
    if (!hidden(v.patch.position)) vertices.push_back(v);
  for (const graph::Edge& e : graph.edges())
    if (!hidden(graph.patch(graph.index_of(e.a)).position) &&
        !hidden(graph.patch(graph.index_of(e.b)).position))
      edges.push_back(e);
  return {std::move(vertices), std::move(edges)};
}

graph::AttributeGraph refined(const graph::AttributeGraph& graph, const cv::Mat1f& frame) {
  const CodingContext prepared = prepare_coding(frame);
  return refine(graph, frame, {&prepared, 1}, {5});
}

double extent(const graph::AttributeGraph& graph) {
  double left = 1e9, right = -1e9;
  for (const graph::Vertex& v : graph.vertices()) {
    left = std::min(left, v.patch.position.x);
    right = std::max(right, v.patch.position.x);
  }
  return right - left;
}

}  // namespace

TEST_CASE("An end that was cut short grows to where the stroke ends and no further") {
  const cv::Mat1f frame = with_noise(draw(kRefineSize, {segment({20, 60}, {140, 70}, 4, 1)}, 60, 80), 4, 1);
  const graph::AttributeGraph whole = extract(frame, {});
  const graph::AttributeGraph half = without(whole, [](Point p) { return p.x > 70; });
  const graph::AttributeGraph grown = refined(half, frame);
  CHECK(extent(half) < 55);
  CHECK(extent(grown) > 110);
  CHECK(extent(grown) < 126);
  CHECK(graph::components(grown).count == 1);
  for (const graph::Vertex& v : grown.vertices()) {
    CHECK(v.patch.gain > 0);
    CHECK(v.patch.cost > 0);
  }
}

TEST_CASE("Two ends with the stroke between them are connected, over a gap they are not") {
  const auto parts = [](double gap) {
    return draw(kRefineSize,
                {segment({15, 60}, {80 - gap / 2, 60}, 4, 1), segment({80 + gap / 2, 60}, {145, 60}, 4, 1)},
                60, 80);
  };
  for (const double gap : {0.0, 9.0}) {
    const cv::Mat1f frame = with_noise(parts(gap), 4, 2);
    const graph::AttributeGraph open =
        without(extract(frame, {}), [](Point p) { return std::abs(p.x - 80) < 5.5; });
    REQUIRE(graph::components(open).count == 2);
    CHECK(graph::components(refined(open, frame)).count == (gap == 0 ? 1 : 2));
  }
}

TEST_CASE("A stroke that stops short of another goes on to it") {
  const cv::Mat1f frame = with_noise(
      draw(kRefineSize, {segment({20, 40}, {140, 40}, 4, 1), segment({80, 40}, {80, 105}, 4, 1)}, 60, 80), 4,
      3);
  const graph::AttributeGraph whole = extract(frame, {});
  REQUIRE(count_degree(whole, 3) == 1);
  const graph::AttributeGraph open = without(whole, [](Point p) { return p.y > 44 && p.y < 52; });
  REQUIRE(graph::components(open).count == 2);
  const graph::AttributeGraph closed = refined(open, frame);
  CHECK(graph::components(closed).count == 1);
  CHECK(count_degree(closed, 3) == 1);
  const auto joint = std::ranges::find_if(
      closed.vertices(), [&](const auto& v) { return closed.degree(closed.index_of(v.id)) == 3; });
  REQUIRE(joint != closed.vertices().end());
  CHECK(joint->patch.type == graph::PatchType::t_junction);
}

TEST_CASE("Ends whose ways cross meet in a corner") {
  const cv::Mat1f frame = with_noise(
      draw(kRefineSize, {segment({30, 40}, {102, 40}, 4, 1), segment({100, 38}, {100, 105}, 4, 1)}, 60, 80),
      4, 4);
  const graph::AttributeGraph open = without(extract(frame, {}), [](Point p) {
    return graph::distance(p, {100, 40}) < 9;
  });
  REQUIRE(graph::components(open).count == 2);
  const graph::AttributeGraph closed = refined(open, frame);
  CHECK(graph::components(closed).count == 1);
  CHECK(std::ranges::count_if(closed.vertices(),
                              [](const auto& v) { return v.patch.type == graph::PatchType::corner; }) == 1);
}

namespace {

/// The evidence is that of the frame in which a graph was found.
graph::AttributeGraph without_evidence(const graph::AttributeGraph& graph) {
  std::vector<graph::Vertex> vertices(graph.vertices().begin(), graph.vertices().end());
  for (graph::Vertex& v : vertices) v.patch.evidence = 0;
  return {std::move(vertices), {graph.edges().begin(), graph.edges().end()}};
}

}  // namespace

TEST_CASE("A stroke that nothing shows is deleted") {
  const cv::Mat1f bare = with_noise(cv::Mat1f(kRefineSize, 80.0F), 4, 5);
  const graph::AttributeGraph drawn =
      extract(draw(kRefineSize, {segment({30, 60}, {110, 60}, 4, 1)}, 80, 60), {});
  REQUIRE(drawn.size() > 10);
  CHECK(refined(without_evidence(drawn), bare).empty());
}

TEST_CASE("Two steps that bound a bar become that bar") {
  const cv::Mat1f frame = with_noise(draw(kRefineSize, {segment({30, 60}, {130, 60}, 16, 1)}, 60, 80), 4, 6);
  ExtractOptions fine;
  fine.scales = 1;  // sees the sides only
  const graph::AttributeGraph bar =
      refined(without(extract(frame, fine), [](Point p) { return p.x < 38 || p.x > 122; }), frame);
  CHECK(graph::components(bar).count == 1);
  REQUIRE(bar.size() > 10);
  for (const graph::Vertex& v : bar.vertices()) {
    CHECK(std::abs(v.patch.position.y - 60) < 0.5);
    CHECK(std::abs(v.patch.width - 16) < 1);
    if (bar.degree(bar.index_of(v.id)) == 2) CHECK(std::abs(v.patch.contrast - 80) < 5);
  }
}

TEST_CASE("What refining leaves it leaves when it looks again") {
  const cv::Mat1f frame = with_noise(draw(kRefineSize,
                                          {segment({15, 20}, {120, 34}, 3, 1), ring({80, 70}, 25, 4, 1),
                                           segment({20, 60}, {50, 110}, 5, 1.5)},
                                          60, 80),
                                     8, 8);
  const graph::AttributeGraph once = extract(frame, {});
  CHECK(refined(once, frame) == once);
}

TEST_CASE("Corners back to back, where two lines cross at a small angle, are joined, others are not") {
  const Point middle{80.3, 60.2};
  const auto frame_with = [&](bool crossing) {
    std::vector<Cover> shapes;
    for (const double lean : {0.4, -0.4}) {
      if (crossing) {
        shapes.push_back(segment(middle - unit(lean) * 45, middle + unit(lean) * 45, 3, 1));
        continue;
      }
      // Two angles whose points are 14 px apart.
      shapes.push_back(segment(middle + Point{7, 0}, middle + Point{7, 0} + unit(lean) * 40, 3, 1));
      shapes.push_back(segment(middle - Point{7, 0}, middle - Point{7, 0} - unit(lean) * 40, 3, 1));
    }
    return with_noise(draw(kRefineSize, shapes, 60, 60), 2, 5);
  };
  const auto bent = [&](const cv::Mat1f& frame) {
    const graph::AttributeGraph arms =
        without(extract(frame, {}), [&](Point p) { return std::abs(p.x - middle.x) < 11; });
    REQUIRE(graph::components(arms).count == 4);
    std::vector<graph::Vertex> vertices(arms.vertices().begin(), arms.vertices().end());
    std::vector<graph::Edge> edges(arms.edges().begin(), arms.edges().end());
    for (const double side : {-1.0, 1.0}) {
      graph::Vertex corner = vertices.front();
      corner.id = {vertices.back().id.value + 1};
      corner.patch.position = middle + Point{side * 7, 0};
      for (std::size_t i = 0; i < arms.size(); ++i)
        if (arms.degree(i) == 1 && graph::distance(arms.patch(i).position, corner.patch.position) < 12)
          edges.push_back({arms.vertices()[i].id, corner.id});
      vertices.push_back(corner);
    }
    return graph::AttributeGraph(std::move(vertices), std::move(edges));
  };
  const cv::Mat1f crossing = frame_with(true), apart = frame_with(false);
  REQUIRE(graph::components(bent(crossing)).count == 2);
  CHECK(graph::components(refined(bent(crossing), crossing)).count == 1);
  CHECK(graph::components(refined(bent(apart), apart)).count == 2);
}
