// SPDX-License-Identifier: Apache-2.0
#include "pipeline/inference/cuts.hpp"

#include <array>
#include <cmath>
#include <functional>
#include <vector>

#include "tests/support/catch.hpp"
#include "tests/support/sketch_scene.hpp"

using namespace emberfold;
using namespace emberfold::test;

namespace {

using Scene = std::function<double(Point, int)>;

std::vector<int> cuts_of(const Scene& level) {
  core::Clip clip;
  clip.info.width = 96, clip.info.height = 72, clip.info.channels = 1, clip.info.frames = 30;
  for (int t = 0; t < 30; ++t) {
    cv::Mat bytes;
    with_noise(draw({96, 72}, [&](Point p) { return level(p, t); }), 2, static_cast<std::uint64_t>(t) + 1)
        .convertTo(bytes, CV_8U);
    clip.frames.push_back(bytes);
  }
  core::ClipSource source(clip);
  return pipeline::find_cuts(source, {});
}

double waves(Point p, double phase) {
  return 120 + 60 * std::sin(p.x / 9 + phase) * std::cos(p.y / 7);
}
double spot(Point p, Point at) {
  return 60 + 120 * reached(12 - distance(p, at), 2);
}

}  // namespace

TEST_CASE("cuts: another scene, black frames and a flash begin and end with one") {
  CHECK(cuts_of([](Point p, int t) {
          return t < 12 ? waves(p, 0.1 * t) : spot(p, {40, 30});
        }) == std::vector{12});
  CHECK(cuts_of([](Point p, int t) {
          return t >= 10 && t < 15 ? 0 : spot(p, {30. + t, 30});
        }) == std::vector{10, 15});
  CHECK(cuts_of([](Point p, int t) { return t == 20 ? 255 : waves(p, 0.1 * t); }) == std::vector{20, 21});
}

TEST_CASE("cuts: things that appear, flickering light, fast motion and noise are none") {
  CHECK(cuts_of([](Point p, int t) { return t < 15 ? 60 : spot(p, {48, 36}); }).empty());
  CHECK(cuts_of([](Point p, int t) { return waves(p, 0.1 * t) * (t % 5 == 2 ? 0.6 : 1); }).empty());
  CHECK(cuts_of([](Point p, int t) { return waves(p, 1.3 * t); }).empty());
  CHECK(cuts_of([](Point, int) { return 100; }).empty());
}

TEST_CASE("cuts: events within one frame of a cut have probability 0") {
  std::vector<graph::Event> events(4);
  const std::array frames{8, 9, 11, 12};
  for (std::size_t k = 0; k < 4; ++k) events[k].frame = frames[k], events[k].probability = 0.9;
  pipeline::disbelieve_cuts(events, {10});
  CHECK(events[0].probability == 0.9);
  CHECK(events[1].probability == 0);
  CHECK(events[2].probability == 0);
  CHECK(events[3].probability == 0.9);
}
