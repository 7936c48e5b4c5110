// SPDX-License-Identifier: Apache-2.0
#include "pipeline/strokes/stroke_synthesis.hpp"

#include <vector>

#include <opencv2/core.hpp>

#include "core/error.hpp"
#include "core/parallel.hpp"
#include "pipeline/strokes/stroke_strips.hpp"
#include "tests/pipeline/carried/carried_scene.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/drawn_frames.hpp"
#include "tests/support/messages.hpp"

using namespace emberfold;
using namespace emberfold::test;
using pipeline::StrokeSynthesis;

namespace {}  // namespace

TEST_CASE("strokes that live again: lines are as bright as in the clip, on its ground") {
  const auto scene = carried_scene(60, GENERATE(1, 3));
  StrokeSynthesis synthesis(scene.frames, scene.strokes, {});
  const auto frames = draw(synthesis, 50);
  const auto motion = synthesis.motion(50);
  REQUIRE(motion.sketch.frames.size() == 50);
  double line = 0, ground = 0;
  int on_lines = 0, off = 0;
  for (std::size_t n = 0; n < frames.size(); ++n) {
    REQUIRE(frames[n].type() == scene.frames[0].type());
    const auto& graph = motion.sketch.frames[n];
    CHECK(graph.size() == synthesis.statistics()->patches[n]);
    for (int y = 0; y < kSceneHeight; y += 3)
      for (int x = 0; x < kSceneWidth; x += 3) {
        double nearest = 1e9;
        for (const auto& vertex : graph.vertices())
          nearest = std::min(nearest, graph::distance(vertex.patch.position, {double(x), double(y)}));
        const double over = frames[n].ptr<std::uint8_t>(y)[frames[n].channels() * x] - scene_ground(x, y);
        if (nearest < 0.8) line += over, ++on_lines;
        if (nearest > 20) ground += std::abs(over), ++off;
      }
  }
  REQUIRE(on_lines > 50);
  CHECK(line / on_lines > 60);
  CHECK(ground / off < 8);
}

TEST_CASE("strokes that live again: the same frames at any number of threads and calls") {
  const auto scene = carried_scene(40);
  StrokeSynthesis whole(scene.frames, scene.strokes, {3}), parts(scene.frames, scene.strokes, {3});
  const auto frames = draw(whole, 24);
  auto first = [&] {
    const core::ThreadLimit one(1);
    return draw(parts, 7);
  }();
  const auto rest = draw(parts, 17);
  first.insert(first.end(), rest.begin(), rest.end());
  CHECK(same_frames(frames, first));
  StrokeSynthesis other(scene.frames, scene.strokes, {4});
  CHECK(!same_frames(frames, draw(other, 24)));
}

TEST_CASE("strokes that live again: backwards, lives run from their end to their beginning") {
  const auto scene = carried_scene(60);
  mcmc::MotionEdit edit;
  edit.reverse = true;
  const auto motion = StrokeSynthesis(scene.frames, scene.strokes, {1, edit}).motion(40);
  int up = 0, down = 0;
  for (std::size_t t = 1; t < motion.sketch.frames.size(); ++t)
    for (const auto& link : motion.links[t]) {
      const auto &before = motion.sketch.frames[t - 1], &after = motion.sketch.frames[t];
      const double step = after.patch(after.index_of(link.after)).position.y -
                          before.patch(before.index_of(link.before)).position.y;
      (step < 0 ? up : down) += 1;
    }
  CHECK(up > 100);  // lines sink by a quarter of a pixel a frame in the clip
  CHECK(down == 0);
}

TEST_CASE("strokes that live again: what cannot be drawn is refused") {
  const auto scene = carried_scene(20);
  mcmc::MotionEdit edit;
  edit.contrast = 2;
  CHECK(contains(message_of<core::InputError>([&] {
                   StrokeSynthesis(scene.frames, scene.strokes, {1, edit});
                 }),
                 "contrast"));
  CHECK_THROWS_AS(StrokeSynthesis({scene.frames[0]}, scene.strokes, {}), core::InputError);
}
