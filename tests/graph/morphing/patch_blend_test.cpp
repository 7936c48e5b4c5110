// SPDX-License-Identifier: Apache-2.0
#include "graph/morphing/patch_blend.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <vector>

#include "graph/morphing/curve_pairs.hpp"
#include "graph/morphing/morph.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/graphs.hpp"

using namespace emberfold;
using graph::Patch;

namespace {

Patch patch_of_numbers(double from) {
  Patch patch;
  patch.position = {from, from + 1}, patch.theta = from / 100;
  patch.width = from + 2, patch.blur = from + 3, patch.contrast = from + 4;
  patch.cost = from + 5, patch.gain = from + 6, patch.evidence = from + 7;
  for (std::size_t c = 0; c < 3; ++c) {
    const auto level = static_cast<float>(from) + static_cast<float>(c);
    patch.left[c] = level + 8, patch.middle[c] = level + 11, patch.right[c] = level + 14;
  }
  return patch;
}

std::vector<double> numbers_of(const Patch& patch) {
  std::vector<double> all{patch.position.x, patch.position.y, patch.width, patch.blur,
                          patch.contrast,   patch.cost,       patch.gain,  patch.evidence};
  for (const auto* level : {&patch.left, &patch.middle, &patch.right})
    for (const float value : *level) all.push_back(double{value});
  return all;
}

}  // namespace

TEST_CASE("A patch that is turned round shows the same: a step's sign changes, a line's does not",
          "[morph]") {
  for (const double width : {2.0, 0.0}) {
    auto patch = patch_of_numbers(10);
    patch.width = width;
    const auto turned = graph::detail::turn_round(patch);
    CHECK_THAT(turned.theta, test::WithinAbs(0.1 - std::numbers::pi, 1e-12));
    CHECK(turned.left == patch.right);
    CHECK(turned.right == patch.left);
    CHECK(turned.middle == patch.middle);
    CHECK(turned.contrast == (width > 0 ? patch.contrast : -patch.contrast));
    CHECK(turned.position == patch.position);
    const auto back = graph::detail::turn_round(turned);
    CHECK_THAT(back.theta, test::WithinAbs(patch.theta, 1e-12));
    CHECK(back.contrast == patch.contrast);
  }
}

TEST_CASE("Between two patches every number is so much of the way on, and the type the nearer one's",
          "[morph]") {
  auto a = patch_of_numbers(10), b = patch_of_numbers(50);
  a.type = graph::PatchType::bar, b.type = graph::PatchType::corner;
  for (const double share : {0.0, 0.25, 0.6, 1.0}) {
    const auto between = graph::detail::blend_patches(a, b, share, 2);
    const auto from = numbers_of(a), to = numbers_of(b), found = numbers_of(between);
    for (std::size_t k = 0; k < found.size(); ++k)
      CHECK_THAT(found[k], test::WithinAbs((1 - share) * from[k] + share * to[k], 1e-5));
    CHECK_THAT(between.theta, test::WithinAbs(graph::detail::wrap_angle(0.1 + 2 * share), 1e-12));
    CHECK(between.type == (share < 0.5 ? a.type : b.type));
  }
}

TEST_CASE("Resampled patches are those of the nearer vertices, a curve's middle is that of its length",
          "[morph]") {
  test::Frame frame;
  frame.line({{10, 50}, {20, 50}, {50, 50}, {50, 90}});
  const auto graph = frame.graph();
  const auto curve = graph::detail::sample_curve(graph, {0, 1, 2, 3});
  CHECK_THAT(curve.length, test::WithinAbs(80, 1e-9));
  CHECK_THAT(curve.centre.x, test::WithinAbs((40 * 30 + 40 * 50) / 80.0, 1e-9));
  CHECK_THAT(curve.centre.y, test::WithinAbs((40 * 50 + 40 * 70) / 80.0, 1e-9));
  const std::vector<double> at{0, 5 / 80.0, 0.2, 0.4, 0.7, 0.8, 1};
  const auto found = graph::detail::resample(curve, at);
  CHECK(found.vertices == std::vector<std::uint32_t>{0, 1, 1, 2, 2, 3, 3});
  const std::vector<graph::Point> places{{10, 50}, {15, 50}, {26, 50}, {42, 50},
                                         {50, 66}, {50, 74}, {50, 90}};
  for (std::size_t k = 0; k < at.size(); ++k)
    CHECK_THAT(graph::distance(found.patches[k].position, places[k]), test::WithinAbs(0, 1e-9));
}

TEST_CASE("A line that changes its levels alone goes as far as they change on average", "[morph]") {
  test::Frame dark, bright;
  for (auto* frame : {&dark, &bright}) frame->line(test::segment({40, 50}, {100, 50}, 11));
  for (auto& v : bright.vertices)
    for (std::size_t c = 0; c < 3; ++c)
      v.patch.left[c] += 30, v.patch.middle[c] += 30, v.patch.right[c] += 30;
  const auto length = [&] {
    graph::MorphOptions options;
    options.frames = 5;
    return graph::morph(dark.graph(), bright.graph(), 320, 240, 25, options).length;
  };
  CHECK_THAT(length(), test::WithinAbs(3, 1e-6));  // 0.1 px a level
  // One side alone, of three levels: a third of the squares.
  for (auto& v : bright.vertices) v.patch.middle = dark.vertices[0].patch.middle;
  for (auto& v : bright.vertices) v.patch.right = dark.vertices[0].patch.right;
  CHECK_THAT(length(), test::WithinAbs(3 / std::sqrt(3), 1e-6));
}

TEST_CASE("Arms that stay joined bend at the junction, their free ends go their own way", "[morph]") {
  // Three arms about a junction; in the second graph one is longer and two are turned.
  const auto arms = [](double reach, double turned) {
    test::Frame frame;
    const auto middle = frame.line({{100, 100}});
    const double lengths[] = {40, 30, reach};
    for (int k = 0; k < 3; ++k) {
      const double angle = 2 * std::numbers::pi * k / 3 + (k > 0 ? turned * k : 0);
      const graph::Point way{std::cos(angle), std::sin(angle)};
      const graph::Point from{100, 100};
      const auto first = frame.line(test::segment(from + way * 5, from + way * lengths[k], 7));
      frame.edge(middle, first);
    }
    return frame.graph();
  };
  const auto first = arms(35, 0), last = arms(60, 0.3);
  graph::MorphOptions options;
  options.frames = 5;
  const auto pairs = graph::detail::pair_curves(first, last, {});
  REQUIRE(pairs.paths.size() == 3);
  const auto morph = graph::morph(first, last, 320, 240, 25, options);
  for (const int t : {1, 2, 3}) {
    const auto& graph = morph.motion.sketch.frames[static_cast<std::size_t>(t)];
    graph::Point joint;
    std::vector<graph::Point> tips;
    for (const auto& path : pairs.paths) {
      const auto patches = path.patches(t / 4.0);
      const bool joined_front = path.from.vertices.front() == 0;
      joint = joint + (joined_front ? patches.front() : patches.back()).position * (1 / 3.0);
      tips.push_back((joined_front ? patches.back() : patches.front()).position);
    }
    std::size_t found = 0;
    for (std::uint32_t v = 0; v < graph.size(); ++v) {
      const auto at = graph.patch(v).position;
      if (graph.degree(v) == 3) CHECK_THAT(graph::distance(at, joint), test::WithinAbs(0, 1e-9));
      if (graph.degree(v) != 1) continue;
      ++found;
      CHECK(std::ranges::any_of(tips, [&](graph::Point tip) { return graph::distance(tip, at) < 1e-9; }));
    }
    CHECK(found == 3);
  }
}
