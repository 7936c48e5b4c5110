// SPDX-License-Identifier: Apache-2.0
#include "pipeline/gain_totals.hpp"

#include <cmath>
#include <numbers>

#include "sketch/refinement/coding_length.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/sketch_scene.hpp"

using namespace emberfold;

TEST_CASE("gains are added up with the patches that they are of, and those above 0") {
  pipeline::GainTotals all{2.5, 4, 1};
  all.add({-1, 3, 2});
  CHECK(all.nats == 1.5);
  CHECK(all.patches == 7);
  CHECK(all.positive == 3);
}

TEST_CASE("the gain of a frame is that of its patches") {
  const cv::Mat levels = test::with_noise(
      test::draw({80, 60}, [](graph::Point p) { return std::abs(p.x - 40) < 2 ? 160.0 : 80.0; }), 2, 5);
  graph::Patch line;
  line.position = {40, 30}, line.theta = std::numbers::pi / 2, line.width = 3, line.blur = 1;
  line.left.fill(80), line.middle.fill(160), line.right.fill(80);
  line.contrast = 80;
  graph::Patch nothing = line;
  nothing.position.x = 15;
  const auto frame = sketch::prepare_coding(levels);
  const double gain = sketch::coding_gain(frame, line), loss = sketch::coding_gain(frame, nothing);
  REQUIRE((gain > 0 && loss < 0));
  const graph::AttributeGraph graph({{{0}, {}, line}, {{1}, {}, nothing}}, {});
  const auto totals = pipeline::total_gain(levels, graph);
  CHECK_THAT(totals.nats, test::WithinRel(gain + loss, 1e-12));
  CHECK(totals.patches == 2);
  CHECK(totals.positive == 1);
  CHECK(pipeline::total_gain(levels, {}).patches == 0);
}
