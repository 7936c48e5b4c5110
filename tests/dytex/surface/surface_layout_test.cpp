// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "core/error.hpp"
#include "dytex/surface/block_region.hpp"
#include "dytex/surface/edge_crossing.hpp"
#include "tests/dytex/surface/surface_make.hpp"
#include "tests/support/catch.hpp"

using namespace emberfold;
using namespace emberfold::test;
using Catch::Matchers::WithinAbs;

TEST_CASE("a flat surface is one chart whose texels are as large as they are") {
  const auto layout = dytex::lay_out_surface(mesh_of(flat_obj(3, 1)), {60, 40});
  CHECK(layout.covered == 2400);
  CHECK(layout.repeated == 0);
  CHECK(layout.chart_count == 1);
  CHECK(layout.glued.empty());
  CHECK_THAT(layout.pixel * layout.pixel, WithinAbs(3.0 / 2400, 1e-12));
  for (const auto& frame : layout.frames) {
    CHECK_THAT(frame.across * layout.pixel, WithinAbs(3.0 / 60, 1e-9));
    CHECK_THAT(frame.down * layout.pixel, WithinAbs(1.0 / 40, 1e-9));
    CHECK_THAT(frame.shear, WithinAbs(0, 1e-9));
  }
  const auto coarse = dytex::lay_out_surface(mesh_of(flat_obj(3, 1)), {60, 40}, 0.1);
  CHECK_THAT(coarse.frames[0].across, WithinAbs(0.5, 1e-9));
}

TEST_CASE("frames keep lengths and angles of sheared surfaces") {
  const auto mesh = mesh_of("v 0 0 0\nv 2 0 1\nv 1 3 0.5\nvt 0 0\nvt 1 0.1\nvt 0.2 1\nf 1/1 2/2 3/3\n");
  const auto layout = dytex::lay_out_surface(mesh, {50, 70}, 0.05);
  const auto& frame = layout.frames[0];
  for (const auto& [a, b] : {std::pair(0, 1), {1, 2}, {2, 0}}) {
    const auto place = [&](int i) {
      const auto& uv = mesh.uvs[static_cast<std::size_t>(i)];
      return cv::Point2d(uv.x * 50, (1 - uv.y) * 70);
    };
    const auto step = frame.to_surface(place(b) - place(a));
    const double length =
        cv::norm(mesh.points[static_cast<std::size_t>(b)] - mesh.points[static_cast<std::size_t>(a)]);
    CHECK_THAT(std::hypot(step.x, step.y) * 0.05, WithinAbs(length, 1e-9));
    const auto back = frame.to_texels(step);
    CHECK_THAT(back.x, WithinAbs((place(b) - place(a)).x, 1e-9));
    CHECK_THAT(back.y, WithinAbs((place(b) - place(a)).y, 1e-9));
  }
}

TEST_CASE("a cube has six charts and twelve glued edges and a ball one chart that meets itself") {
  const auto cube = dytex::lay_out_surface(mesh_of(cube_obj()), {120, 80});
  CHECK(cube.chart_count == 6);
  CHECK(cube.glued.size() == 12);
  CHECK(cube.hidden_charts == 0);
  CHECK(cube.covered == 6 * 36 * 36);
  const auto ball = dytex::lay_out_surface(mesh_of(ball_obj(24, 12)), {96, 48});
  CHECK(ball.chart_count == 1);
  CHECK(ball.covered == 96 * 48);
  CHECK(ball.glued.size() == 12);
  for (const auto& [a, b] : ball.glued) {
    CHECK_THAT(std::abs(a.from.x - b.from.x), WithinAbs(96, 1e-9));
    CHECK_THAT(a.from.y, WithinAbs(b.from.y, 1e-9));
  }
  // Texels at the equator are as wide on the surface as they are high, towards the poles narrower.
  const auto& middle = ball.frames[static_cast<std::size_t>(ball.triangles[ball.index({50, 23})])];
  CHECK_THAT(middle.across / middle.down, WithinAbs(1, 0.03));
  const auto& upper = ball.frames[static_cast<std::size_t>(ball.triangles[ball.index({50, 9})])];
  CHECK(upper.across < 0.7 * middle.across);
}

TEST_CASE("faces over each other and faces between texels are counted") {
  const std::string flat = flat_obj(1, 1);
  const auto twice =
      dytex::lay_out_surface(mesh_of(flat + "v 0 0 5\nv 1 0 5\nv 1 1 5\nf 5/1 6/2 7/3\n"), {20, 20});
  CHECK(twice.chart_count == 2);
  CHECK(twice.hidden_charts == 1);
  CHECK_THAT(static_cast<double>(twice.repeated), WithinAbs(190, 20));
  CHECK_THROWS_AS(dytex::lay_out_surface(mesh_of(flat), {0, 20}), core::InputError);
  CHECK_THROWS_AS(dytex::lay_out_surface(mesh_of(flat), {20, 20}, -1), core::InputError);
  CHECK_THROWS_AS(dytex::lay_out_surface(mesh_of("v 0 0 0\nvt 0 0\nvt 1 0\nvt 1 1\nf 1/1 1/2 1/3\n"), {9, 9}),
                  core::InputError);
  CHECK_THROWS_AS(
      dytex::lay_out_surface(
          mesh_of("v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0.5 0.5\nvt 0.51 0.5\nvt 0.5 0.51\nf 1/1 2/2 3/3\n"),
          {8, 8}),
      core::InputError);
}

TEST_CASE("the surface goes on beyond a glued edge however its charts are turned") {
  const auto mesh = mesh_of(two_charts_obj());
  const auto layout = dytex::lay_out_surface(mesh, {200, 200});
  REQUIRE(layout.chart_count == 2);
  REQUIRE(layout.glued.size() == 1);
  dytex::detail::RegionFinder finder(layout);
  const dytex::detail::GluedNeighbours neighbours(layout);
  // A block around a texel near the middle of the glued edge, on the left chart's side.
  const cv::Point seed(74, 110);
  REQUIRE(layout.chart_at(seed) == 0);
  const auto region = finder.find(static_cast<std::int32_t>(layout.index(seed)), {16, 16}, {32, 32});
  const auto beyond = neighbours.texels_beyond(region, 8);
  const cv::Point3d here = point_at(mesh, layout, seed);
  int across = 0;
  for (std::int32_t i = 0; i < 32 * 32; ++i) {
    const auto at = static_cast<std::size_t>(i);
    CHECK((region.nearest[at] < 0 || beyond[at] < 0));
    if (beyond[at] < 0) continue;
    ++across;
    const cv::Point3d step =
        (point_at(mesh, layout, layout.texel(static_cast<std::size_t>(beyond[at]))) - here) / layout.pixel;
    const cv::Point cell = region.cell(i) - cv::Point(16, 16);
    CHECK_THAT(step.x, WithinAbs(cell.x, 1.01));
    CHECK_THAT(step.y, WithinAbs(-cell.y, 1.01));
  }
  CHECK_THAT(static_cast<double>(across), WithinAbs(8 * 32, 32));
}

TEST_CASE("blocks cover the same part of a ball everywhere but at its poles") {
  const auto mesh = mesh_of(ball_obj(96, 48));
  const auto layout = dytex::lay_out_surface(mesh, {1024, 512});
  dytex::detail::RegionFinder finder(layout);
  for (const int y : {256, 180, 120, 80}) {
    const auto region = finder.find(static_cast<std::int32_t>(layout.index({512, y})), {32, 32}, {64, 64});
    double area = 0;
    for (const auto& one : region.texels) {
      const auto& f =
          layout.frames[static_cast<std::size_t>(layout.triangles[static_cast<std::size_t>(one.texel)])];
      area += f.across * f.down;
    }
    INFO(y);
    CHECK_THAT(area / 4096, WithinAbs(1, 0.06));
  }
}
