// SPDX-License-Identifier: Apache-2.0
#include "pipeline/strokes/stroke_play.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <set>
#include <vector>

#include <opencv2/core.hpp>

#include "core/error.hpp"
#include "tests/pipeline/carried/carried_scene.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/merging_strokes.hpp"
#include "tests/support/messages.hpp"

using namespace emberfold;
using namespace emberfold::test;
using graph::EventType;
using pipeline::StrokePlay;

namespace {

std::size_t number(EventType type) {
  return static_cast<std::size_t>(type);
}

StrokePlay play(const std::vector<cv::Mat>& frames, const graph::MotionGraph& strokes,
                const mcmc::MotionEdit& edit = {}, std::uint64_t seed = 1) {
  return {std::make_shared<const pipeline::SeenClip>(frames, strokes), pipeline::compare_moments(frames, {}),
          edit, seed};
}

struct Totals {
  double patches = 0, births = 0, deaths = 0, splits = 0;
};
Totals run(StrokePlay& play, int moments) {
  Totals totals;
  for (int n = 0; n < moments; ++n) {
    const auto moment = play.next();
    totals.patches += static_cast<double>(moment.graph.size()) / moments;
    totals.births += moment.operators[number(EventType::birth)];
    totals.deaths += moment.operators[number(EventType::death)];
    totals.splits += moment.operators[number(EventType::split)];
  }
  return totals;
}

mcmc::MotionEdit edited(EventType type, double factor) {
  mcmc::MotionEdit edit;
  edit.rates[number(type)] = factor;
  return edit;
}

}  // namespace

TEST_CASE("stroke play: as many strokes are born, die and are there as in the clip") {
  const auto scene = carried_scene(100);
  double seen = 0;
  for (const auto& graph : scene.strokes.sketch.frames) seen += static_cast<double>(graph.size()) / 100;
  auto again = play(scene.frames, scene.strokes);
  const double lives = static_cast<double>(again.families().lives.size());
  const auto totals = run(again, 1000);
  CHECK_THAT(totals.patches, WithinRel(seen, 0.15));
  CHECK_THAT(totals.births, WithinRel(10 * lives, 0.2));
  CHECK_THAT(totals.deaths, WithinRel(totals.births, 0.05));
}

TEST_CASE("stroke play: edits change how often strokes are born and die") {
  const auto scene = carried_scene(100);
  auto usual = play(scene.frames, scene.strokes);
  auto more = play(scene.frames, scene.strokes, edited(EventType::birth, 2));
  auto dying = play(scene.frames, scene.strokes, edited(EventType::death, 2));
  mcmc::MotionEdit fast;
  fast.speed = 2;
  auto twice = play(scene.frames, scene.strokes, fast);
  const auto before = run(usual, 500);
  CHECK_THAT(run(more, 500).births, WithinRel(2 * before.births, 0.2));
  CHECK(run(dying, 500).patches < 0.95 * before.patches);
  CHECK_THAT(run(twice, 500).births, WithinRel(2 * before.births, 0.2));
}

TEST_CASE("stroke play: patches are where they were in the clip, moved by a stroke's own offset") {
  const auto scene = carried_scene(60);
  auto again = play(scene.frames, scene.strokes);
  const auto& lives = again.families().lives;
  std::set<std::pair<int, int>> offsets;
  for (int n = 0; n < 60; ++n) {
    const auto moment = again.next();
    std::size_t at = 0;
    std::vector<graph::Point> places;
    for (const auto& stroke : moment.strokes) {
      const auto& life = lives[stroke.family];
      const auto& patches = life.patches[static_cast<std::size_t>(stroke.frame - life.first)];
      at += patches.size();
      for (const auto v : patches)
        places.push_back(
            scene.strokes.sketch.frames[static_cast<std::size_t>(stroke.frame)].patch(v).position +
            stroke.offset);
      CHECK(stroke.offset.x == std::round(stroke.offset.x));
      offsets.insert({static_cast<int>(stroke.offset.x), static_cast<int>(stroke.offset.y)});
      CHECK(std::abs(stroke.offset.x) < 16);
    }
    REQUIRE(at == moment.graph.size());
    for (const auto& vertex : moment.graph.vertices())
      CHECK(std::ranges::any_of(
          places, [&](graph::Point p) { return graph::distance(p, vertex.patch.position) < 1e-9; }));
  }
  CHECK(offsets.size() > 5);
}

TEST_CASE("stroke play: a patch keeps its id through its stroke's life, and equal seeds play alike") {
  const auto scene = carried_scene(60);
  auto one = play(scene.frames, scene.strokes), same = play(scene.frames, scene.strokes),
       other = play(scene.frames, scene.strokes, {}, 2);
  std::size_t kept = 0, all = 0, unlike = 0;
  graph::AttributeGraph before;
  for (int n = 0; n < 40; ++n) {
    const auto moment = one.next();
    CHECK(moment.graph == same.next().graph);
    if (moment.graph != other.next().graph) ++unlike;
    for (const auto& vertex : before.vertices()) {
      ++all;
      if (moment.graph.index_of(vertex.id) < moment.graph.size()) ++kept;
    }
    before = moment.graph;
  }
  CHECK(double(kept) > 0.9 * double(all));  // lives of 17 frames: 16 of 17 patches go on
  CHECK(double(kept) < 0.99 * double(all));
  CHECK(unlike > 20);
}

TEST_CASE("stroke play: a family that is there for most of the clip always is, with its events") {
  const auto strokes = two_become_one();
  std::vector<cv::Mat> frames;
  for (int t = 0; t < 4; ++t) frames.emplace_back(cv::Mat1b(80, 60, static_cast<std::uint8_t>(40 * t)));
  auto again = play(frames, strokes);
  std::size_t merges = 0;
  for (int n = 0; n < 40; ++n) {
    const auto moment = again.next();
    REQUIRE(moment.strokes.size() == 1);
    const int shown = pipeline::shown_frame(moment.shown);
    CHECK(moment.strokes[0].frame == shown);
    CHECK(moment.graph.size() == (shown < 2 ? 6 : 7));
    merges += static_cast<std::size_t>(moment.operators[number(EventType::merge)]);
  }
  CHECK(merges > 2);
}

TEST_CASE("stroke play: births keep to a map, and what cannot be shown is refused") {
  const auto scene = carried_scene(60);
  mcmc::MotionEdit edit;
  edit.birth_map = mcmc::make_cell_grid(kSceneWidth, kSceneHeight);
  edit.birth_map->values[edit.birth_map->index({40, 100})] = 1;
  auto again = play(scene.frames, scene.strokes, edit);
  for (int n = 0; n < 30; ++n) (void)again.next();  // those of the beginning have died
  std::size_t seen = 0;
  for (int n = 0; n < 30; ++n) {
    const auto moment = again.next();
    seen += moment.graph.size();
    for (const auto& vertex : moment.graph.vertices()) {
      CHECK(std::abs(vertex.patch.position.x - 40) < 40);
      CHECK(std::abs(vertex.patch.position.y - 100) < 16);
    }
  }
  CHECK(seen > 100);
  mcmc::MotionEdit flicker;
  flicker.flicker = 2;
  CHECK(
      contains(message_of<core::InputError>([&] { play(scene.frames, scene.strokes, flicker); }), "flicker"));
  CHECK(pipeline::edit_not_repeated(edited(EventType::split, 3)) == "rate of splits");
  CHECK(pipeline::edit_not_repeated(edited(EventType::death, 0.5)) == "deaths below 1");
  CHECK(pipeline::edit_not_repeated(edited(EventType::death, 2)).empty());
}
