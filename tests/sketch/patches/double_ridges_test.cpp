// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <numbers>
#include <numeric>

#include <opencv2/core.hpp>

#include "core/error.hpp"
#include "sketch/extract.hpp"
#include "sketch/patches/double_profile.hpp"
#include "sketch/refinement/coding_length.hpp"
#include "sketch/rendering/render.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/sketch_scene.hpp"

using namespace emberfold;
using namespace emberfold::sketch;
using namespace emberfold::test;
using graph::Patch;
using graph::PatchType;

namespace {

const cv::Size kSize(180, 130);

ExtractOptions with_doubles() {
  ExtractOptions options;
  options.double_ridges = true;
  return options;
}

/// Two lines of this width, `apart` px from middle to middle, about the way from a to b.
std::vector<Cover> rails(Point a, Point b, double apart, double width = 2, double blur = 1) {
  const Point along = (b - a) * (1 / graph::distance(a, b)), aside = Point{-along.y, along.x} * (apart / 2);
  return {segment(a - aside, b - aside, width, blur), segment(a + aside, b + aside, width, blur)};
}

std::size_t count(const graph::AttributeGraph& graph, PatchType type) {
  return static_cast<std::size_t>(
      std::ranges::count_if(graph.vertices(), [&](const graph::Vertex& v) { return v.patch.type == type; }));
}

Patch double_patch(Point at, double theta) {
  Patch patch;
  patch.type = PatchType::double_ridge;
  patch.position = at, patch.theta = theta;
  patch.width = 9, patch.hollow = 5, patch.blur = 1;
  patch.left = {40, 50, 60}, patch.right = {90, 80, 70};
  patch.middle = {180, 190, 200}, patch.between = {60, 90, 100};
  patch.contrast = 100;
  return patch;
}

double blurred_double(double d, double left, double middle, double right, double between) {
  return bar_level(d, 9, 1, left, middle, right) + (between - middle) * seen(d, 5, 1);
}

std::vector<Rib> ribs_at(Point position, double theta) {
  std::vector<Rib> ribs;
  for (int r = -2; r <= 2; ++r)
    ribs.push_back({position + unit(theta) * r, unit(theta + std::numbers::pi / 2)});
  return ribs;
}

/// A row of nine patches.
graph::AttributeGraph row_of(const Patch& middle) {
  std::vector<graph::Vertex> vertices;
  std::vector<graph::Edge> edges;
  for (std::uint32_t i = 0; i < 9; ++i) {
    vertices.push_back({{i}, {}, middle});
    vertices.back().patch.position = middle.position + unit(middle.theta) * (5.0 * (i - 4.0));
    if (i > 0) edges.push_back({{i - 1}, {i}});
  }
  return {vertices, edges};
}

}  // namespace

TEST_CASE("A drawn double ridge shows its profile: two blurred lines and what is between them") {
  const Patch patch = double_patch({45, 30}, 0);
  const Sketchable drawn = draw_fitted(row_of(patch), {90, 60}, 3);
  for (int y = 24; y <= 36; ++y) {
    const auto level = drawn.levels.at<cv::Vec3f>(y, 45);
    for (std::size_t c = 0; c < 3; ++c) {
      const double expected = blurred_double(y - 30.0, double{patch.left[c]}, double{patch.middle[c]},
                                             double{patch.right[c]}, double{patch.between[c]});
      CHECK_THAT(double{level[static_cast<int>(c)]}, WithinAbs(expected, 1e-3));
    }
  }
}

TEST_CASE("A double ridge that was drawn is found again with its attributes") {
  const double theta = 0.4;
  const Patch truth = double_patch({60, 60}, theta);
  cv::Mat drawn;
  std::vector<cv::Mat> channels;
  for (std::size_t c = 0; c < 3; ++c)
    channels.push_back(draw({120, 120}, [&](Point p) {
      return blurred_double(graph::dot(p - truth.position, unit(theta + std::numbers::pi / 2)),
                            double{truth.left[c]}, double{truth.middle[c]}, double{truth.right[c]},
                            double{truth.between[c]});
    }));
  cv::merge(channels, drawn);
  Patch start = truth;
  start.position = truth.position + unit(theta + std::numbers::pi / 2) * 0.7;
  start.width = 10.5, start.hollow = 4.2, start.blur = 1.2;
  const auto found = fit_double_ridge(drawn, start, ribs_at(start.position, theta), 0.3);
  REQUIRE(found);
  CHECK(found->type == PatchType::double_ridge);
  CHECK(graph::distance(found->position, truth.position) < 0.1);
  CHECK_THAT(found->width, WithinAbs(9, 0.3));
  CHECK_THAT(found->hollow, WithinAbs(5, 0.3));
  CHECK_THAT(found->blur, WithinAbs(1, 0.15));
  for (std::size_t c = 0; c < 3; ++c) {
    CHECK_THAT(double{found->left[c]}, WithinAbs(double{truth.left[c]}, 2));
    CHECK_THAT(double{found->middle[c]}, WithinAbs(double{truth.middle[c]}, 9));
    CHECK_THAT(double{found->right[c]}, WithinAbs(double{truth.right[c]}, 2));
    CHECK_THAT(double{found->between[c]}, WithinAbs(double{truth.between[c]}, 5));
  }
}

TEST_CASE("The fit of a double ridge says no where there is one line, a step, or nothing") {
  const Patch start = double_patch({60, 60}, 0);
  const std::vector<Cover> line = {segment({0, 60}, {119, 60}, 9, 1)};
  CHECK_FALSE(fit_double_ridge(draw({120, 120}, line, 40, 120), start, ribs_at({60, 60}, 0), 0.3));
  const cv::Mat1f step = draw({120, 120}, [](Point p) { return 40 + 120 * reached(p.y - 60, 1); });
  CHECK_FALSE(fit_double_ridge(step, start, ribs_at({60, 60}, 0), 0.3));
  CHECK_FALSE(fit_double_ridge(cv::Mat1f(120, 120, 77.0F), start, ribs_at({60, 60}, 0), 0.3));
  // Two dark lines are no double ridge of bright ones, and are one of their own.
  const cv::Mat1f dark = draw({120, 120}, rails({0, 60}, {119, 60}, 7), 160, -100);
  CHECK_FALSE(fit_double_ridge(dark, start, ribs_at({60, 60}, 0), 0.3));
  Patch valley = start;
  valley.contrast = -100;
  const auto found = fit_double_ridge(dark, valley, ribs_at({60, 60}, 0), 0.3);
  REQUIRE(found);
  CHECK(found->contrast < -60);
}

TEST_CASE("Two lines side by side become one double ridge, if that is asked for") {
  const Point from{30, 50}, to{150, 80};
  const double apart = GENERATE(6.0, 8.0, 10.0), sign = GENERATE(1.0, -1.0);
  CAPTURE(apart, sign);
  const cv::Mat1f frame = with_noise(draw(kSize, rails(from, to, apart), 120, sign * 90), 2, 7);
  const graph::AttributeGraph two = extract(frame, {}), one = extract(frame, with_doubles());
  CHECK(count(two, PatchType::double_ridge) == 0);
  CHECK(graph::components(two).count >= 2);
  CHECK(graph::components(one).count == 1);
  CHECK(count(one, PatchType::terminator) == 2);
  CHECK(count(one, PatchType::double_ridge) == one.size() - 2);
  const Point along = (to - from) * (1 / graph::distance(from, to));
  for (const graph::Vertex& v : one.vertices()) {
    if (v.patch.hollow <= 0) continue;  // the rest of a line's end
    const Point off = v.patch.position - from;
    CHECK(std::abs(off.y * along.x - off.x * along.y) < 0.3);
    CHECK(v.patch.contrast * sign > 0);
    CHECK_THAT((v.patch.width + v.patch.hollow) / 2, WithinAbs(apart, 0.5));
    CHECK(v.patch.gain > 0);
    CHECK(v.patch.cost > 0);
  }
  const double cost_of_two = std::accumulate(two.vertices().begin(), two.vertices().end(), 0.0,
                                             [](double sum, auto& v) { return sum + v.patch.cost; });
  const double cost_of_one = std::accumulate(one.vertices().begin(), one.vertices().end(), 0.0,
                                             [](double sum, auto& v) { return sum + v.patch.cost; });
  CHECK(cost_of_one < 0.85 * cost_of_two);
}

TEST_CASE("A double ridge forks where its lines part") {
  // Side by side for 70 px, then each by itself.
  const auto height = [](double x) { return 3.5 + (x > 90 ? (x - 90) * (x - 90) / 110 : 0); };
  const cv::Mat1f frame = with_noise(
      draw({200, 150},
           [&](Point p) {
             const double h = height(p.x), slope = p.x > 90 ? (p.x - 90) / 55 : 0,
                          lean = std::hypot(1, slope);
             const double inside = reached(p.x - 20, 1) * reached(180 - p.x, 1);
             return 60 +
                    100 * inside * (seen((p.y - 75 - h) / lean, 2, 1) + seen((p.y - 75 + h) / lean, 2, 1));
           }),
      1, 3);
  const graph::AttributeGraph found = extract(frame, with_doubles());
  CHECK(count(found, PatchType::double_ridge) >= 8);
  CHECK(count_degree(found, 3) == 1);
  CHECK(count_degree(found, 1) == 3);
  CHECK(graph::components(found).count == 1);
  for (std::size_t i = 0; i < found.size(); ++i)
    if (found.degree(i) == 3) CHECK(found.patch(i).hollow > 0);
}

TEST_CASE("What does not run side by side, or costs more as one, stays two lines") {
  SECTION("far apart") {
    const auto found = extract(draw(kSize, rails({30, 60}, {150, 60}, 24), 60, 90), with_doubles());
    CHECK(count(found, PatchType::double_ridge) == 0);
  }
  SECTION("a bright line beside a dark one") {
    const cv::Mat1f frame = draw(kSize, [](Point p) {
      const double inside = reached(p.x - 30, 1) * reached(150 - p.x, 1);
      return 120 + 80 * inside * (seen(p.y - 56, 2, 1) - seen(p.y - 64, 2, 1));
    });
    CHECK(count(extract(frame, with_doubles()), PatchType::double_ridge) == 0);
  }
  SECTION("lines of different brightness") {
    const cv::Mat1f frame =
        with_noise(draw(kSize,
                        [](Point p) {
                          const double inside = reached(p.x - 30, 1) * reached(150 - p.x, 1);
                          return 60 + inside * (120 * seen(p.y - 56, 2, 1) + 50 * seen(p.y - 64, 2, 1));
                        }),
                   1, 5);
    const auto found = extract(frame, with_doubles());
    CHECK(count(found, PatchType::double_ridge) == 0);
    CHECK(graph::components(found).count >= 2);
  }
  SECTION("lines that cross") {
    const cv::Mat1f frame =
        draw(kSize, {segment({20, 40}, {160, 90}, 2, 1), segment({20, 90}, {160, 40}, 2, 1)}, 60, 90);
    CHECK(extract(frame, with_doubles()) == extract(frame, {}));
  }
}

TEST_CASE("Double ridges are the same in a frame that is mirrored or turned") {
  // One line is a little longer: else nothing but the order of strokes would tell along which to go.
  const cv::Mat1f frame =
      draw({140, 140}, {segment({22, 53}, {112, 83}, 2, 1), segment({25, 46}, {120, 77.5}, 2, 1)}, 100, 80);
  const auto found = extract(frame, with_doubles());
  REQUIRE(count(found, PatchType::double_ridge) > 10);
  const int flip = GENERATE(-1, 0, 1, 2);
  cv::Mat1f other;
  if (flip == 2)
    cv::transpose(frame, other);
  else
    cv::flip(frame, other, flip);
  const auto mapped = [&](Point p) {
    if (flip == 2) return Point{p.y, p.x};
    return Point{flip != 0 ? 139 - p.x : p.x, flip != 1 ? 139 - p.y : p.y};
  };
  const auto again = extract(other, with_doubles());
  REQUIRE(count(again, PatchType::double_ridge) == count(found, PatchType::double_ridge));
  for (const graph::Vertex& v : found.vertices()) {
    if (v.patch.hollow <= 0) continue;  // a line's last patch may be too faint on one side
    const Point place = mapped(v.patch.position);
    CHECK(std::ranges::any_of(again.vertices(), [&](const graph::Vertex& w) {
      return graph::distance(w.patch.position, place) < 0.1 && w.patch.type == v.patch.type &&
             std::abs(w.patch.hollow - v.patch.hollow) < 0.1;
    }));
  }
}

TEST_CASE("A double ridge costs nine numbers, and gains what one line of its width cannot show") {
  const Patch patch = double_patch({45, 30}, 0);
  CHECK_THAT(coding_cost(patch, 99), WithinAbs(4.5 * std::log(100.0), 1e-9));
  const cv::Mat drawn = draw_fitted(row_of(patch), {90, 60}, 1).levels;
  const CodingContext frame = prepare_coding(drawn);
  Patch solid = patch;
  solid.hollow = 0;
  CHECK(coding_gain(frame, patch) > coding_gain(frame, solid) + 100);
}
