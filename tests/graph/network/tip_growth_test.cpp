// SPDX-License-Identifier: Apache-2.0
#include "graph/network/tip_growth.hpp"

#include <algorithm>
#include <cmath>
#include <set>
#include <sstream>
#include <utility>

#include "core/error.hpp"
#include "core/rng.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/graphs.hpp"

using namespace emberfold;
using graph::TipMotion;
using graph::TipPhase;

namespace {

/// How far the right end of a lying line has grown at frame t, px: still for 20 frames, then 2 px a frame for
/// 20, still again for 20, then back at 1 px a frame for 20.
double grown(int t) {
  return std::clamp(2.0 * (t - 20), 0.0, 40.0) - std::clamp(1.0 * (t - 60), 0.0, 20.0);
}

/// A line from (40, 100), turned by `angle`, whose end grows as `grown`; patches some 5 px apart that slip
/// along it, each linked with the nearest.
graph::MotionGraph growing_line(double angle, double noise, core::Rng& rng) {
  const graph::Point along{std::cos(angle), std::sin(angle)};
  std::vector<graph::AttributeGraph> frames;
  std::vector<std::vector<std::pair<std::uint32_t, std::uint32_t>>> links;
  int before = 0;
  for (int t = 0; t < 81; ++t) {
    const double length = 60 + grown(t) + noise * rng.normal();
    const int count = static_cast<int>(std::lround(length / 5)) + 1;
    test::Frame frame;
    const graph::Point begin = graph::Point{40, 100} + along * (noise * rng.normal());
    frame.line(test::segment(begin, begin + along * length, count));
    frames.push_back(frame.graph());
    if (t > 0) {
      links.emplace_back();
      for (int v = 0; v < std::min(before, count); ++v) links.back().emplace_back(v, v);
    }
    before = count;
  }
  return graph::identify(test::motion(frames, links));
}

}  // namespace

TEST_CASE("A tip's growth, pauses and retraction are found with their rates", "[graph][network]") {
  core::Rng rng(3);
  for (const double noise : {0.0, 0.4, 1.0}) {
    for (const double angle : {0.0, 0.7}) {
      const auto motions = graph::tip_motions(growing_line(angle, noise, rng));
      double growth = 0, retraction = 0;
      for (const TipMotion& one : motions) {
        if (one.phase == TipPhase::pause) continue;
        const int middle = (one.first + one.last) / 2;
        const bool is_long = one.last - one.first >= 5;  // a few frames tell a sense, hardly a rate
        CAPTURE(noise, angle, one.tip, one.first, one.last, one.rate);
        if (one.phase == TipPhase::growth) {
          growth += one.rate * (one.last - one.first);
          CHECK((middle >= 20 && middle <= 40));
          if (is_long) CHECK_THAT(one.rate, test::WithinAbs(2, 0.1 + 0.3 * noise));
        } else {
          retraction += one.rate * (one.last - one.first);
          CHECK((middle >= 60 && middle <= 80));
          if (is_long) CHECK_THAT(one.rate, test::WithinAbs(-1, 0.1 + 0.3 * noise));
        }
      }
      CHECK_THAT(growth, test::WithinAbs(40, 1 + 4 * noise));
      CHECK_THAT(retraction, test::WithinAbs(-20, 1 + 4 * noise));
    }
  }
}

TEST_CASE("Tips that only tremble, and a curve that moves across itself, do not grow", "[graph][network]") {
  core::Rng rng(9);
  std::vector<graph::AttributeGraph> frames;
  std::vector<std::vector<std::pair<std::uint32_t, std::uint32_t>>> links;
  for (int t = 0; t < 60; ++t) {
    test::Frame frame;
    for (int k = 0; k < 6; ++k) {
      const double y = 20 + 30.0 * k + 0.5 * t, left = 50 + rng.normal(), right = 120 + rng.normal();
      frame.line(test::segment({left, y}, {right, y}, 15));
    }
    frames.push_back(frame.graph());
    if (t == 0) continue;
    links.emplace_back();
    for (std::uint32_t v = 0; v < 90; ++v) links.back().emplace_back(v, v);
  }
  const auto motions = graph::tip_motions(graph::identify(test::motion(frames, links)));
  CHECK(motions.size() >= 12);
  CHECK(std::ranges::count(motions, TipPhase::pause, &TipMotion::phase) + 1 >=
        static_cast<std::ptrdiff_t>(motions.size()));
  for (const TipMotion& one :
       motions) {  // places err by 1 px, the slope by that over the root of Σ (t − mean)²
    const double count = one.last - one.first + 1;
    CHECK_THAT(one.error * std::sqrt(count * (count * count - 1) / 12), test::WithinAbs(1, 0.15));
  }
}

TEST_CASE("A tip that is missed in single frames does not grow", "[graph][network]") {
  std::vector<graph::AttributeGraph> frames;
  std::vector<std::vector<std::pair<std::uint32_t, std::uint32_t>>> links;
  for (int t = 0; t < 40; ++t) {
    test::Frame frame;
    frame.line(test::segment({50, 100}, {t % 9 == 5 ? 109.0 : 120.0, 100}, 15));
    frames.push_back(frame.graph());
    if (t == 0) continue;
    links.emplace_back();
    for (std::uint32_t v = 0; v < 15; ++v) links.back().emplace_back(v, v);
  }
  for (const TipMotion& one : graph::tip_motions(graph::identify(test::motion(frames, links))))
    CHECK(one.phase == TipPhase::pause);
}

TEST_CASE("A tip is the end of one curve: where that becomes another one, a new tip begins",
          "[graph][network]") {
  // Curve 7 is called 9 from frame 20 on.
  std::vector<graph::AttributeGraph> frames;
  std::vector<std::vector<std::pair<std::uint32_t, std::uint32_t>>> links;
  for (int t = 0; t < 40; ++t) {
    test::Frame frame;
    frame.line(test::segment({50, 100}, {120.0 + t, 100}, 15));
    for (auto& vertex : frame.vertices) vertex.curve = {t < 20 ? 7U : 9U};
    frames.push_back(frame.graph());
    if (t == 0) continue;
    links.emplace_back();
    for (std::uint32_t v = 0; v < 15; ++v) links.back().emplace_back(v, v);
  }
  std::set<std::pair<std::uint32_t, std::uint32_t>> tips;  // and their curves
  double growth = 0;
  for (const TipMotion& one : graph::tip_motions(graph::identify(test::motion(frames, links)))) {
    tips.emplace(one.tip, one.curve.value);
    CHECK((one.curve.value == 7 ? one.last < 20 : one.first >= 20));
    if (one.phase == TipPhase::growth) growth += one.rate * (one.last - one.first);
  }
  CHECK(tips.size() == 4);  // two ends of two curves
  CHECK_THAT(growth, test::WithinAbs(38, 0.5));
}

TEST_CASE("The table of tips, in px and in units", "[graph][io]") {
  const std::vector<TipMotion> motions{{3, {7}, TipPhase::growth, 4, 8, {1, 2}, {9, 2}, 2, 0.25}};
  std::ostringstream plain, with, broken;
  graph::write_tips(plain, motions, {});
  CHECK(plain.str() ==
        "tip,curve,phase,first,last,x,y,x_end,y_end,length,rate,error\n3,7,growth,4,8,1,2,9,2,8,2,0.25\n");
  graph::write_tips(with, motions, {0.5, 0.5});
  CHECK(test::Contains(",first_s,last_s,rate_px_s,length_um,rate_um_s\n").match(with.str()));
  CHECK(test::Contains(",8,2,0.25,2,4,4,4,2\n").match(with.str()));
  broken.setstate(std::ios::failbit);
  CHECK_THROWS_AS(graph::write_tips(broken, motions, {}), core::IoError);
}
