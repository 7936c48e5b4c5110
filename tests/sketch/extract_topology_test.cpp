// SPDX-License-Identifier: Apache-2.0
// Number and connections of strokes; no strokes without structure.
#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <string>
#include <vector>

#include <opencv2/core.hpp>

#include "sketch/extract.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/sketch_scene.hpp"

using namespace emberfold;
using namespace emberfold::test;
using graph::AttributeGraph;

namespace {

const cv::Size kExtractTopologySize{130, 130};
constexpr Point kTopologyMiddle{64.7, 65.2};

/// A drawing of bars, by its segments about the origin.
struct Drawing {
  std::vector<std::pair<Point, Point>> bars;
  double width = 4;
};

Point turned(Point p, double angle) {
  return {std::cos(angle) * p.x - std::sin(angle) * p.y, std::sin(angle) * p.x + std::cos(angle) * p.y};
}

/// Turned, put into the middle of a frame, brighter than the ground (sign 1) or darker (−1).
AttributeGraph found_in(const Drawing& drawing, double angle, double sign, double noise) {
  std::vector<Cover> shapes;
  for (const auto& [a, b] : drawing.bars)
    shapes.push_back(
        segment(kTopologyMiddle + turned(a, angle), kTopologyMiddle + turned(b, angle), drawing.width, 1.2));
  auto frame = draw(kExtractTopologySize, shapes, sign > 0 ? 60 : 180, sign * 80);
  if (noise > 0) frame = with_noise(frame, noise, static_cast<std::uint64_t>(1 + 100 * angle));
  return sketch::extract(frame, {});
}

/// Vertices of degree 3 and more; neighbouring ones, 8 px or less apart, are one junction.
std::size_t junctions(const AttributeGraph& graph) {
  std::vector<Point> places;
  for (std::size_t i = 0; i < graph.size(); ++i) {
    if (graph.degree(i) < 3) continue;
    const Point p = graph.patch(i).position;
    if (std::none_of(places.begin(), places.end(), [&](Point q) { return graph::distance(p, q) <= 8; }))
      places.push_back(p);
  }
  return places.size();
}

struct Expected {
  std::size_t components, ends, junctions;
};

/// The share of drawings (angles, bright and dark, clean and in noise of SD 5) that come out as expected.
double share_right(const Drawing& drawing, Expected expected) {
  std::size_t right = 0, all = 0;
  for (const double angle : {0.0, 0.35, 0.8, 2.0})
    for (const double sign : {1.0, -1.0})
      for (const double noise : {0.0, 5.0}) {
        const AttributeGraph found = found_in(drawing, angle, sign, noise);
        const std::size_t parts = components(found).count, ends = count_degree(found, 1),
                          meetings = junctions(found);
        const bool fits =
            parts == expected.components && ends == expected.ends && meetings == expected.junctions;
        if (!fits)
          UNSCOPED_INFO("angle " << angle << ", sign " << sign << ", noise " << noise << ": " << parts
                                 << " components, " << ends << " ends, " << meetings << " junctions");
        right += fits ? 1U : 0U;
        ++all;
      }
  return static_cast<double>(right) / static_cast<double>(all);
}

Point polar(double radius, double angle) {
  return unit(angle) * radius;
}

}  // namespace

TEST_CASE("A plain stroke is one curve of patches 5 px apart, its flanks and lobes are none") {
  for (const double width : {3.0, 4.0, 6.0}) {
    CHECK(share_right({{{{-45, 0}, {45, 0}}}, width}, {1, 2, 0}) == 1);
    for (const double angle : {0.1, 1.0}) {
      const AttributeGraph found = found_in({{{{-45, 0}, {45, 0}}}, width}, angle, 1, 0);
      for (const graph::Edge& e : found.edges()) {
        const double step = graph::distance(found.patch(found.index_of(e.a)).position,
                                            found.patch(found.index_of(e.b)).position);
        INFO("width " << width << ", angle " << angle);
        CHECK(std::abs(step - 5) < 1);
      }
      // From end to end; half a width is lost or won at each.
      CHECK(std::abs(static_cast<double>(found.edges().size()) * 5 - 90) <= 10);
      for (std::size_t i = 0; i < found.size(); ++i) {
        const bool end = found.degree(i) == 1;
        CHECK((found.patch(i).type == graph::PatchType::terminator) == end);
      }
    }
  }
}

TEST_CASE("A T, a Y and an H have one, one and two junctions") {
  CHECK(share_right({{{{-45, 0}, {45, 0}}, {{0, 0}, {0, 45}}}}, {1, 3, 1}) >= 0.95);
  CHECK(share_right({{{{0, 0}, polar(45, 0.3)}, {{0, 0}, polar(45, 2.4)}, {{0, 0}, polar(45, 4.5)}}},
                    {1, 3, 1}) >= 0.95);
  CHECK(share_right({{{{-30, -45}, {-30, 45}}, {{30, -45}, {30, 45}}, {{-30, 0}, {30, 0}}}}, {1, 4, 2}) >=
        0.95);
}

TEST_CASE("Lines that cross at a right angle are one component with one junction") {
  for (const double width : {3.0, 4.0, 6.0}) {
    INFO("width " << width);
    CHECK(share_right({{{{-45, 0}, {45, 0}}, {{0, -45}, {0, 45}}}, width}, {1, 4, 1}) >= 0.85);
  }
}

TEST_CASE("A soft line on a steep slope of the ground is one stroke") {
  // The scales of such a line lie beside each other, by up to 4 px.
  for (int k = 0; k < 12; ++k) {
    const double theta = 0.13 + std::numbers::pi * k / 12;
    const Point along = unit(theta), across = unit(theta + std::numbers::pi / 2);
    const auto frame = with_noise(draw({160, 160},
                                       [&](Point p) {
                                         const Point off = p - Point{80.2, 79.6};
                                         const double d = graph::dot(off, across), s = graph::dot(off, along);
                                         const double line = std::exp(-d * d / (2 * 3.7 * 3.7));
                                         return 155 - 60 * reached(d - 8, 5) +
                                                45 * line * reached(s + 55, 2) * reached(55 - s, 2);
                                       }),
                                  2, static_cast<std::uint64_t>(k) + 1);
    const AttributeGraph found = sketch::extract(frame, {});
    std::vector<graph::VertexId> lines;
    double least = 1e9, most = -1e9;
    for (std::size_t i = 0; i < found.size(); ++i) {
      const graph::Patch& p = found.patch(i);
      const Point off = p.position - Point{80.2, 79.6};
      if (graph::on_step(p) || p.contrast < 0 || std::abs(graph::dot(off, across)) > 8) continue;
      lines.push_back(found.vertices()[i].id);
      least = std::min(least, graph::dot(off, along)), most = std::max(most, graph::dot(off, along));
    }
    std::size_t ends = 0;
    for (const auto id : lines) ends += found.degree(found.index_of(id)) == 1 ? 1U : 0U;
    INFO("angle " << theta << ": " << lines.size() << " patches, " << ends << " ends, from " << least
                  << " to " << most);
    CHECK(ends == 2);
    CHECK(most - least > 85);
  }
}

TEST_CASE("A gap of 8 px parts a stroke, one of 1 px does not") {
  for (const double width : {3.0, 4.0, 6.0}) {
    INFO("width " << width);
    CHECK(share_right({{{{-45, 0}, {-4, 0}}, {{4, 0}, {45, 0}}}, width}, {2, 4, 0}) == 1);
    CHECK(share_right({{{{-45, 0}, {-0.5, 0}}, {{0.5, 0}, {45, 0}}}, width}, {1, 2, 0}) == 1);
  }
}

TEST_CASE("Two arms whose soft tips leave a gap of 4.5 px stay apart, at one place they meet",
          "[sketch][gaps]") {
  int apart = 0, met = 0, all = 0;
  for (const double rise : {15.0, 25.0, 35.0})
    for (const double angle : {0.0, 0.3, 1.1, 2.0})
      for (const std::uint64_t seed : {1U, 2U, 3U}) {
        const auto count = [&](double gap) {
          const auto arm = [&](double side) {
            return segment(kTopologyMiddle + turned({side * gap / 2, 0}, angle),
                           kTopologyMiddle + turned({side * 45, rise}, angle), 4, 1.5);
          };
          const Cover left = arm(-1), right = arm(1);
          const auto frame =
              draw(kExtractTopologySize, [&](Point p) { return 70 + std::max(70 * left(p), 95 * right(p)); });
          return graph::components(sketch::extract(with_noise(frame, 4, seed), {})).count;
        };
        apart += count(4.5) == 2 ? 1 : 0, met += count(0) == 1 ? 1 : 0, ++all;
      }
  CAPTURE(apart, met, all);
  CHECK(apart >= 0.95 * all);
  CHECK(met >= 0.95 * all);
}

TEST_CASE("A ring is one closed curve") {
  for (const double noise : {0.0, 5.0, 15.0})
    for (const double sign : {1.0, -1.0})
      for (const double radius : {18.0, 30.0, 45.0}) {
        auto frame =
            draw(kExtractTopologySize, {ring(kTopologyMiddle, radius, 4, 1)}, sign > 0 ? 60 : 180, sign * 80);
        if (noise > 0) frame = with_noise(frame, noise, 3);
        const AttributeGraph found = sketch::extract(frame, {});
        INFO("noise " << noise << ", sign " << sign << ", radius " << radius);
        CHECK(components(found).count == 1);
        CHECK(count_degree(found, 2) == found.size());
        CHECK(std::abs(static_cast<double>(found.size()) * 5 / (2 * std::numbers::pi * radius) - 1) < 0.1);
      }
}

TEST_CASE("Strokes side by side are two, and what lies between them is none") {
  for (const double width : {3.0, 4.0})
    for (const double apart : {12.0, 16.0, 22.0}) {
      INFO("width " << width << ", " << apart << " px apart");
      const double y = apart / 2;
      CHECK(share_right({{{{-45, -y}, {45, -y}}, {{-45, y}, {45, y}}}, width}, {2, 4, 0}) >= 0.95);
    }
}

TEST_CASE("Where two lines run close together the ground between is none", "[sketch]") {
  const Cover one_ring = ring(kTopologyMiddle - Point{19, 0}, 24, 4, 1),
              other_ring = ring(kTopologyMiddle + Point{19, 0}, 24, 4, 1);
  for (const double noise : {0.0, 3.0})
    for (const double sign : {1.0, -1.0}) {
      INFO("noise " << noise << ", sign " << sign);
      const auto frame = draw(kExtractTopologySize, [&](Point p) {
        return 120 + sign * 70 * std::max(one_ring(p), other_ring(p));
      });
      const auto of_other_sign = [&](const AttributeGraph& graph) {
        return std::ranges::count_if(graph.vertices(),
                                     [&](const auto& v) { return v.patch.contrast * sign < 0; });
      };
      const AttributeGraph rings = sketch::extract(with_noise(frame, noise, 5), {});
      CHECK(of_other_sign(rings) == 0);
      CHECK(graph::components(rings).count == 1);
    }
}

TEST_CASE("Even frames, ramps and slow waves have no strokes") {
  for (const float level : {0.0F, 128.0F, 255.0F})
    CHECK(sketch::extract(cv::Mat1f(200, 300, level), {}).empty());
  for (const double slope : {0.1, 0.5, 1.0, 2.0})
    for (const double angle : {0.0, 0.5, 2.2})
      CHECK(sketch::extract(
                draw(kExtractTopologySize, [&](Point p) { return 20 + slope * graph::dot(p, unit(angle)); }),
                {})
                .empty());
  for (const double length : {40.0, 80.0, 160.0})
    for (const double noise : {0.0, 3.0}) {
      const auto waves = draw({256, 256}, [&](Point p) {
        return 128 + 30 * std::sin(2 * std::numbers::pi * p.x / length) *
                         std::sin(1 + 1.6 * std::numbers::pi * p.y / length);
      });
      INFO("wavelength " << length << ", noise " << noise);
      CHECK(sketch::extract(noise > 0 ? with_noise(waves, noise, 1) : waves, {}).empty());
    }
}

TEST_CASE("Pure noise has no strokes") {
  for (const double sd : {2.0, 10.0, 25.0}) {
    std::size_t strokes = 0;
    for (std::uint64_t seed = 1; seed <= 2; ++seed)
      strokes += components(sketch::extract(with_noise(cv::Mat1f(512, 512, 128.0F), sd, seed), {})).count;
    INFO("SD " << sd);
    CHECK(strokes == 0);
  }
}

namespace {

/// A bar along the x axis of the frame's middle; `shows`: how much of it, by place along it.
AttributeGraph found_along(const std::function<double(double)>& shows, double spread, std::uint64_t seed) {
  const Cover whole =
      segment(kTopologyMiddle - Point{50, 0}, kTopologyMiddle + Point{50, 0}, 2 * spread, spread / 2);
  const Cover seen_of = [&](Point p) { return whole(p) * shows(p.x - kTopologyMiddle.x); };
  return sketch::extract(with_noise(draw(kExtractTopologySize, {seen_of}, 60, 60), 4, seed), {});
}

}  // namespace

TEST_CASE("A narrow gap cuts a line, also where the line is wide", "[sketch][gaps]") {
  for (const double gap : {5.0, 6.0, 8.0})
    for (const double spread : {1.5, 2.0, 3.0})
      for (const std::uint64_t seed : {1U, 3U, 4U}) {
        INFO("gap " << gap << ", spread " << spread << ", seed " << seed);
        const auto graph = found_along([&](double x) { return 1 - seen(x - 3, gap, 1); }, spread, seed);
        CHECK(graph::components(graph).count == 2);
        for (const auto& vertex : graph.vertices())
          CHECK(std::abs(vertex.patch.position.x - kTopologyMiddle.x - 3) > gap / 2 - 2);
      }
}

TEST_CASE(
    "A line whose contrast varies by 30 percent is not cut, nor one that fades to two thirds in a place",
    "[sketch][gaps]") {
  for (const double spread : {1.5, 2.0, 3.0})
    for (const std::uint64_t seed : {1U, 2U, 3U}) {
      INFO("spread " << spread << ", seed " << seed);
      const auto waves = found_along([](double x) { return 1 + 0.3 * std::sin(x / 4); }, spread, seed);
      CHECK(graph::components(waves).count == 1);
      const auto dip = found_along([](double x) { return 1 - seen(x, 6, 1) / 3; }, spread, seed);
      CHECK(graph::components(dip).count == 1);
      const auto step = found_along([](double x) { return x < 0 ? 1 : 0.55; }, spread, seed);
      CHECK(graph::components(step).count == 1);
    }
}
