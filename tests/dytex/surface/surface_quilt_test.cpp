// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <limits>

#include "core/error.hpp"
#include "dytex/quilting/quilt_measures.hpp"
#include "dytex/surface/block_cut.hpp"
#include "dytex/surface/surface_measures.hpp"
#include "tests/dytex/quilting/quilt_make.hpp"
#include "tests/dytex/surface/surface_make.hpp"
#include "tests/support/catch.hpp"

using namespace emberfold;
using namespace emberfold::test;
using dytex::detail::CellState;

namespace {

dytex::QuiltOptions options_of(const dytex::SurfaceLayout& layout) {
  dytex::QuiltOptions options;
  options.size = layout.size;
  options.block = {16, 16};
  options.overlap = 4;
  options.apart = 4;
  return options;
}

dytex::SurfaceQuilt laid(const dytex::SurfaceLayout& layout, const dytex::Trajectories& source) {
  const std::vector<dytex::QuiltSource> sources{{&source, {}, {}}};
  return dytex::quilt_surface(layout, sources, options_of(layout));
}

dytex::SurfaceMeasures measured(const dytex::SurfaceLayout& layout, const dytex::SurfaceQuilt& quilt,
                                const dytex::Trajectories& source) {
  const std::vector<const dytex::Trajectories*> sources{&source};
  return dytex::measure_surface(layout, quilt, sources);
}

bool same_block(const dytex::SurfaceQuilt& quilt, std::size_t a, std::size_t b) {
  return quilt.blocks[a] >= 0 && quilt.blocks[a] == quilt.blocks[b];
}

}  // namespace

TEST_CASE("a quilt on a flat surface copies blocks as they are and joins them where they fit") {
  const auto source = held(made_lapse({70, 60}, 6));
  const auto layout = dytex::lay_out_surface(mesh_of(flat_obj(1, 1)), {90, 90});
  const auto quilt = laid(layout, source);
  REQUIRE(quilt.map.pixels.size() == 8100);
  std::vector<bool> shows(quilt.choices.size());
  for (int y = 0; y < 90; ++y)
    for (int x = 0; x < 90; ++x) {
      const std::size_t at = layout.index({x, y});
      REQUIRE(quilt.blocks[at] >= 0);
      shows[static_cast<std::size_t>(quilt.blocks[at])] = true;
      if (x + 1 < 90 && same_block(quilt, at, at + 1))
        CHECK(dytex::continues(quilt.map.pixels[at], quilt.map.pixels[at + 1], {1, 0}));
      if (y + 1 < 90 && same_block(quilt, at, at + 90))
        CHECK(dytex::continues(quilt.map.pixels[at], quilt.map.pixels[at + 90], {0, 1}));
    }
  CHECK(std::ranges::count(shows, true) > 40);
  CHECK(quilt.choices.size() == 64);  // as in the plane: a block every 12 px
  const auto plane = quilted(source, options_of(layout));
  const std::vector<const dytex::Trajectories*> sources{&source};
  CHECK(measured(layout, quilt, source).seam_ratio() <
        1.1 * dytex::measure_quilt(plane.map, {}, sources).seam_ratio());
}

TEST_CASE("blocks have the same size on the surface however it is stretched") {
  const auto source = held(made_lapse({70, 60}, 4));
  // Texels are half as wide on the surface as they are high.
  const auto layout = dytex::lay_out_surface(mesh_of(flat_obj(1, 1)), {120, 60}, 1.0 / 60);
  const auto quilt = laid(layout, source);
  for (int y = 0; y < 60; ++y)
    for (int x = 0; x + 2 < 120; ++x) {
      const std::size_t at = layout.index({x, y});
      if (same_block(quilt, at, at + 2))
        CHECK(dytex::continues(quilt.map.pixels[at], quilt.map.pixels[at + 2], {1, 0}));
      if (y + 1 < 60 && same_block(quilt, at, at + 120))
        CHECK(dytex::continues(quilt.map.pixels[at], quilt.map.pixels[at + 120], {0, 1}));
    }
  CHECK(quilt.choices.size() <= 30);  // 25 where cells and texels end together
}

TEST_CASE("blocks on a ball are joined as well as in the plane") {
  const auto source = held(made_lapse({120, 100}, 4));
  const auto layout = dytex::lay_out_surface(mesh_of(ball_obj(48, 24)), {256, 128});
  const auto plane = quilted(source, options_of(layout));
  const std::vector<const dytex::Trajectories*> sources{&source};
  const double ratio = dytex::measure_quilt(plane.map, {}, sources).seam_ratio();
  const auto measures = measured(layout, laid(layout, source), source);
  INFO(measures.seam_ratio() << " " << measures.border_ratio() << " " << ratio);
  CHECK(measures.seam_ratio() < 1.25 * ratio);
  CHECK(measures.border_ratio() < 1.3 * ratio);
}

TEST_CASE("blocks fit what lies beyond glued edges") {
  const auto source = held(made_lapse({120, 100}, 4));
  for (const auto& [text, size] :
       {std::pair(cube_obj(), cv::Size(192, 128)), {ball_obj(48, 24), {192, 96}}}) {
    const auto layout = dytex::lay_out_surface(mesh_of(text), size);
    auto open = layout;
    open.glued.clear();
    const auto glued = measured(layout, laid(layout, source), source);
    const auto apart = measured(layout, laid(open, source), source);
    INFO(glued.border_ratio() << " " << apart.border_ratio());
    CHECK(glued.border_places > 80);
    CHECK(glued.border_ratio() < 0.75 * apart.border_ratio());
    CHECK(glued.border_gap < 0.75 * apart.border_gap);
  }
}

TEST_CASE("texels beyond a chart show what follows on the surface and then the nearest") {
  const auto source = held(made_lapse({70, 60}, 3));
  const auto mesh = mesh_of(two_charts_obj());
  const auto layout = dytex::lay_out_surface(mesh, {200, 200});
  const auto quilt = laid(layout, source);
  // The left chart ends at x = 80; the right one, turned, goes down where the surface goes right.
  for (int i = 3; i < 57; ++i) {
    CHECK(quilt.map.at(80 + 2, 139 - i) == quilt.map.at(120 + i, 80 + 2));
    CHECK(quilt.map.at(120 + i, 79 - 2) == quilt.map.at(79 - 2, 139 - i));
    CHECK(quilt.map.at(10, 139 - i) == quilt.map.at(20, 139 - i));
  }
  for (std::size_t i = 0; i < quilt.blocks.size(); ++i) {
    CHECK((quilt.blocks[i] >= 0) == (layout.triangles[i] >= 0));
    CHECK(quilt.map.pixels[i].source == 0);
  }
}

TEST_CASE("a quilt on a surface leaves masked places out and refuses what it cannot do") {
  const auto source = held(made_lapse({70, 60}, 4));
  const auto layout = dytex::lay_out_surface(mesh_of(cube_obj()), {96, 64});
  std::vector<dytex::QuiltSource> sources{{&source, cv::Mat::zeros(60, 70, CV_8U), {}}};
  sources[0].forbidden.colRange(40, 70).setTo(1);
  const auto masked = dytex::quilt_surface(layout, sources, options_of(layout));
  for (const auto& from : masked.map.pixels) CHECK(from.x < 40);
  auto options = options_of(layout);
  options.tileable = true;
  CHECK_THROWS_AS(dytex::quilt_surface(layout, sources, options), core::InputError);
  options = options_of(layout);
  options.seams = dytex::Seams::moving;
  CHECK_THROWS_AS(dytex::quilt_surface(layout, sources, options), core::InputError);
  options = options_of(layout);
  options.size = {64, 64};
  CHECK_THROWS_AS(dytex::quilt_surface(layout, sources, options), core::InputError);
}

TEST_CASE("the cut of a block is the cheapest of all") {
  core::Rng rng(5);
  const cv::Size block(4, 3);
  for (int round = 0; round < 30; ++round) {
    std::vector<CellState> states;
    std::vector<double> errors;
    for (int i = 0; i < 12; ++i) {
      states.push_back(static_cast<CellState>(std::min(3U, rng.below(6))));
      if (rng.below(3) > 0) states.back() = CellState::there;
      errors.push_back(static_cast<double>(rng.below(1000)));
    }
    const auto known = [&](std::size_t i) {
      return states[i] == CellState::there || states[i] == CellState::held;
    };
    // The cost of a choice of cells, a bit each; infinite where it is not allowed.
    const auto cost = [&](unsigned own) {
      double sum = 0;
      for (std::size_t i = 0; i < 12; ++i) {
        const bool mine = (own >> i & 1U) != 0;
        if ((states[i] == CellState::held || states[i] == CellState::outside) && mine)
          return std::numeric_limits<double>::infinity();
        if (states[i] == CellState::empty && !mine) return std::numeric_limits<double>::infinity();
        for (const std::size_t j : {i + 1, i + 4}) {
          if (j > 11 || (j == i + 1 && j % 4 == 0) || mine == ((own >> j & 1U) != 0)) continue;
          if (states[i] == CellState::outside || states[j] == CellState::outside) continue;
          sum += errors[known(i) ? i : j] + errors[known(j) ? j : i];
        }
      }
      return sum;
    };
    double least = std::numeric_limits<double>::infinity();
    for (unsigned own = 0; own < 4096; ++own) least = std::min(least, cost(own));
    const auto cut = dytex::detail::cut_cells(block, states, errors);
    unsigned own = 0;
    for (std::size_t i = 0; i < 12; ++i) own |= cut[i] ? 1U << i : 0U;
    CHECK(cost(own) <= least + 20);  // the cut also prefers short seams, by 1/1000 of the largest error each
  }
}
