// SPDX-License-Identifier: Apache-2.0
#include "pipeline/carried/carried_synthesis.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <memory>
#include <set>
#include <vector>

#include "core/error.hpp"
#include "core/parallel.hpp"
#include "graph/events/events.hpp"
#include "pipeline/carried/carried_play.hpp"
#include "tests/pipeline/carried/carried_scene.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/drawn_frames.hpp"
#include "tests/support/messages.hpp"

using namespace emberfold;
using namespace emberfold::test;
using graph::EventType;
using pipeline::CarriedSynthesis;
using pipeline::CarriedSynthesisOptions;

namespace {

mcmc::MotionEdit times(EventType type, double factor) {
  mcmc::MotionEdit edit;
  edit.rates[static_cast<std::size_t>(type)] = factor;
  return edit;
}

int events(const graph::MotionGraph& motion, EventType type) {
  return static_cast<int>(std::ranges::count(graph::stroke_events(motion), type, &graph::Event::type));
}

double level(const cv::Mat& frame, graph::Point at) {
  return double(
      frame.at<std::uint8_t>(static_cast<int>(std::lround(at.y)), static_cast<int>(std::lround(at.x))));
}

bool inside(graph::Point at) {
  return at.x >= 4 && at.y >= 4 && at.x < kSceneWidth - 4 && at.y < kSceneHeight - 4;
}

/// Lets one stroke lose a patch in its middle, half way through the clip.
void add_split(graph::MotionGraph& strokes) {
  auto& graphs = strokes.sketch.frames;
  std::size_t at = 0;
  for (std::size_t t = 12; t < graphs.size() && at == 0; ++t)
    if (t > 12 && graph::components(graphs[t]).count == graph::components(graphs[t - 1]).count) at = t;
  REQUIRE(at > 0);
  const auto stroke = graph::curves(graphs[at - 1]).front();
  std::set<std::uint32_t> cut;
  std::uint32_t one = graphs[at - 1].vertices()[stroke[stroke.size() / 2]].id.value;
  for (std::size_t t = at; t < graphs.size(); ++t)
    for (const auto& link : strokes.links[t])
      if (link.before.value == one || cut.contains(link.before.value)) cut.insert(link.after.value);
  for (std::size_t t = at; t < graphs.size(); ++t) {
    const auto gone = [&](graph::VertexId id) { return cut.contains(id.value); };
    std::vector<graph::Vertex> vertices;
    std::vector<graph::Edge> edges;
    for (const auto& vertex : graphs[t].vertices())
      if (!gone(vertex.id)) vertices.push_back(vertex);
    for (const auto& edge : graphs[t].edges())
      if (!gone(edge.a) && !gone(edge.b)) edges.push_back(edge);
    graphs[t] = {std::move(vertices), std::move(edges)};
    std::erase_if(strokes.links[t],
                  [&](const graph::Link& link) { return gone(link.after) || gone(link.before); });
  }
  strokes = graph::identify(strokes);
}

}  // namespace

TEST_CASE("carried strokes: without an edit every frame is one of the clip, with the strokes seen in it") {
  const auto scene = carried_scene(60, GENERATE(1, 3));
  CarriedSynthesis synthesis(scene.frames, scene.strokes, {});
  const auto frames = draw(synthesis, 30);
  const auto motion = synthesis.motion(30);
  REQUIRE(motion.sketch.frames.size() == 30);
  int copied = 0;
  for (std::size_t n = 0; n < frames.size(); ++n) {
    std::size_t best = 0;
    double least = 1e18;
    for (std::size_t t = 0; t < scene.frames.size(); ++t)
      if (const double apart = cv::norm(frames[n], scene.frames[t], cv::NORM_L1); apart < least)
        least = apart, best = t;
    if (least > 0) continue;  // on the way of a jump
    ++copied;
    const auto &shown = motion.sketch.frames[n], &seen = scene.strokes.sketch.frames[best];
    CHECK(shown.size() == seen.size());
    CHECK(shown.edges().size() == seen.edges().size());
  }
  CHECK(copied >= 15);
  CHECK(synthesis.statistics()->patches.size() == 30);
  CHECK(synthesis.statistics()->edited == std::size_t{0});
}

TEST_CASE("carried strokes: twice the births show lives of other times with their pixels") {
  const auto scene = carried_scene(60);
  CarriedSynthesis usual(scene.frames, scene.strokes, {}),
      more(scene.frames, scene.strokes, {1, times(EventType::birth, 2), {10, 10}});
  const auto frames = draw(more, 60);
  const auto motion = more.motion(60);
  const auto before = events(usual.motion(60), EventType::birth), after = events(motion, EventType::birth);
  CHECK(after > 1.4 * before);
  CHECK(more.statistics()->operators[0] >= static_cast<std::size_t>(after));
  CHECK(more.statistics()->edited.value_or(0) > 10);
  // The middle of every stroke is as bright as in the clip: 90 levels above the ground.
  double sum = 0;
  int count = 0;
  for (std::size_t n = 8; n < frames.size(); ++n)
    for (const auto& vertex : motion.sketch.frames[n].vertices())
      if (const auto at = vertex.patch.position;
          inside(at) && motion.sketch.frames[n].degree(motion.sketch.frames[n].index_of(vertex.id)) == 2) {
        sum += level(frames[n], at) - scene_ground(int(at.x), int(at.y));
        ++count;
      }
  REQUIRE(count > 500);
  CHECK(sum / count > 60);
}

TEST_CASE("carried strokes: births that do not happen leave the ground") {
  const auto scene = carried_scene(60);
  CarriedSynthesis none(scene.frames, scene.strokes, {1, times(EventType::birth, 0), {10, 10}});
  const auto frames = draw(none, 40);
  const auto motion = none.motion(40);
  CHECK(events(motion, EventType::birth) == 0);
  CHECK(motion.sketch.frames[30].size() < motion.sketch.frames[0].size());
  CarriedSynthesis usual(scene.frames, scene.strokes, {});
  const auto whole = draw(usual, 40);
  double brightest = 0;
  int empty = 0;
  for (std::size_t n = 0; n < 40; ++n) {
    // On the way of a jump strokes of both runs are seen.
    const bool copied = std::ranges::any_of(
        scene.frames, [&](const cv::Mat& frame) { return cv::norm(frame, whole[n], cv::NORM_L1) == 0; });
    if (!copied || !motion.sketch.frames[n].empty()) continue;
    ++empty;
    for (int y = 4; y < kSceneHeight - 4; ++y)
      for (int x = 4; x < kSceneWidth - 4; ++x)
        brightest = std::max(brightest, double(frames[n].at<std::uint8_t>(y, x)) - scene_ground(x, y));
  }
  CHECK(empty > 2);
  CHECK(brightest < 45);
}

TEST_CASE("carried strokes: what parts two things is hidden last") {
  auto scene = carried_scene(120);
  const auto is_border = [](graph::Point at) { return at.y < 48 || at.y > 92; };  // rows 0, 1, 4 of five
  for (auto& graph : scene.strokes.sketch.frames) {
    std::vector<graph::Vertex> vertices(graph.vertices().begin(), graph.vertices().end());
    for (auto& vertex : vertices)
      if (is_border(vertex.patch.position))
        for (float& level : vertex.patch.right) level += 100;
    graph = {std::move(vertices), {graph.edges().begin(), graph.edges().end()}};
  }
  const auto births = [&](double factor) {
    std::array<int, 2> counted{};
    const auto motion =
        CarriedSynthesis(scene.frames, scene.strokes, {1, times(EventType::birth, factor), {10, 10}})
            .motion(110);
    for (const auto& event : graph::stroke_events(motion))
      if (event.type == EventType::birth) ++counted.at(is_border(event.position) ? 1 : 0);
    return counted;
  };
  const auto all = births(1), fewer = births(0.7);
  REQUIRE(all[0] >= 5);
  REQUIRE(all[1] >= 8);
  CHECK(fewer[1] >= all[1] - 3);  // the first ones have nothing to be compared with
  CHECK(fewer[0] <= all[0] / 2);
  CHECK(std::abs(fewer[0] + fewer[1] - 0.7 * (all[0] + all[1])) < 5);
}

TEST_CASE("carried strokes: births go where the map says") {
  const auto scene = carried_scene(60);
  mcmc::MotionEdit edit;
  edit.birth_map = mcmc::make_cell_grid(kSceneWidth, kSceneHeight);
  for (std::size_t c = 0; c < edit.birth_map->values.size(); ++c)
    edit.birth_map->values[c] = c % static_cast<std::size_t>(edit.birth_map->columns) == 4 ? 1 : 0;
  const CarriedSynthesis moved(scene.frames, scene.strokes, {1, edit, {10, 10}});
  const auto motion = moved.motion(60);
  int born = 0;
  for (const auto& event : graph::stroke_events(motion))
    if (event.type == EventType::birth) {
      ++born;
      CHECK(event.position.x > 50);
      CHECK(event.position.x < 94);
    }
  CHECK(born > 4);
}

TEST_CASE("carried strokes: gaps open where none was, in the graph and in the frame") {
  auto scene = carried_scene(60);
  add_split(scene.strokes);
  REQUIRE(events(scene.strokes, EventType::split) == 1);
  CarriedSynthesis usual(scene.frames, scene.strokes, {}),
      more(scene.frames, scene.strokes, {1, times(EventType::split, 5), {10, 10}});
  const int count = 120;
  const auto whole = draw(usual, count), frames = draw(more, count);
  const auto before = usual.motion(count), after = more.motion(count);
  CHECK(events(after, EventType::split) > events(before, EventType::split));
  double darker = 0;
  for (std::size_t n = 0; n < frames.size(); ++n) {
    const auto &seen = before.sketch.frames[n], &shown = after.sketch.frames[n];
    for (const auto& vertex : seen.vertices()) {
      const auto there = [&](const graph::Vertex& other) {
        return graph::distance(other.patch.position, vertex.patch.position) < 0.5;
      };
      if (std::ranges::none_of(shown.vertices(), there) && inside(vertex.patch.position))
        darker = std::max(darker,
                          level(whole[n], vertex.patch.position) - level(frames[n], vertex.patch.position));
    }
  }
  CHECK(darker > 50);
}

TEST_CASE("carried strokes: a gap stays as wide as it was opened when patches beside it are new ones") {
  auto scene = carried_scene(60);
  add_split(scene.strokes);
  // In every frame a third of the patches continue none.
  for (std::size_t t = 1; t < scene.strokes.links.size(); ++t) {
    std::size_t n = t;
    std::erase_if(scene.strokes.links[t], [&](const graph::Link&) { return n++ % 3 == 0; });
  }
  scene.strokes = graph::identify(scene.strokes);
  REQUIRE(events(scene.strokes, EventType::split) == 1);
  const int count = 120, most = 5;  // patches 4 px apart within a gap of 20 px
  const auto clip = std::make_shared<const pipeline::SeenClip>(scene.frames, scene.strokes);
  pipeline::CarriedPlay play(clip, times(EventType::split, 6), {20, 20}, 1);
  std::size_t opened = 0, widest = 0;
  for (int n = 0; n < count; ++n)
    for (const auto& stroke : play.next(n % 60).strokes)
      if (stroke.hides) ++opened, widest = std::max(widest, stroke.patches.size());
  CHECK(opened > 5);
  CHECK(widest >= 3);
  CHECK(widest <= most);
}

TEST_CASE("carried strokes: what moves across its curve does not stand still, what slides along it does") {
  mcmc::detail::LinkedFrames linked;
  std::vector<cv::Mat> frames;
  for (int t = 0; t < 40; ++t) {
    const auto at = [&](std::uint32_t id, double x, double y, double turn) {
      auto made = vertex(id, x, y);
      made.patch.theta = turn;
      return made;
    };
    std::vector<graph::Vertex> vertices{at(1, 20, 20 + 0.02 * t, 0), at(2, 20 + 1.5 * t, 60, 0),
                                        at(3, 20 + 1.5 * t, 90, 1.57), at(4, 120, 20 + 0.3 * t, 0)};
    if (t < 15) vertices.push_back(vertex(5, 140, 100));
    linked.append({std::move(vertices), {}});
    frames.emplace_back(kSceneHeight, kSceneWidth, CV_8U, cv::Scalar(90));
  }
  linked.motion.sketch.width = kSceneWidth, linked.motion.sketch.height = kSceneHeight;
  const pipeline::SeenClip clip(frames, graph::identify(std::move(linked.motion)));
  const std::vector<bool> expected{true, true, false, false, false};
  for (std::uint32_t v = 0; v < 5; ++v) CHECK(clip.stands_still(10, v) == expected[v]);
  CHECK(clip.stands_still(39, 0));
}

TEST_CASE("carried strokes: the wind takes them along") {
  const auto scene = carried_scene(60);
  mcmc::MotionEdit edit;
  edit.wind = {2, 0};
  const auto still = CarriedSynthesis(scene.frames, scene.strokes, {}).motion(40);
  const auto blown = CarriedSynthesis(scene.frames, scene.strokes, {1, edit, {10, 10}}).motion(40);
  const auto speed = [](const graph::MotionGraph& motion) {
    std::vector<double> steps;
    for (std::size_t t = 20; t < motion.links.size(); ++t)  // then no stroke is left of the first ones
      for (const auto& [a, b] : motion.links[t]) {
        const auto &before = motion.sketch.frames[t - 1], &now = motion.sketch.frames[t];
        steps.push_back(now.patch(now.index_of(b)).position.x - before.patch(before.index_of(a)).position.x);
      }
    std::ranges::nth_element(steps, steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2));
    return steps[steps.size() / 2];
  };
  CHECK_THAT(speed(still), Catch::Matchers::WithinAbs(0, 0.01));
  CHECK_THAT(speed(blown), Catch::Matchers::WithinAbs(2, 0.01));
  edit.speed = 0.5;  // what the clip shows moves by 0.125 px a frame, the wind as ever
  const auto slowed = CarriedSynthesis(scene.frames, scene.strokes, {1, edit, {10, 10}}).motion(60);
  CHECK_THAT(speed(slowed), Catch::Matchers::WithinAbs(2, 0.01));
}

TEST_CASE("carried strokes: at another speed the same moments are shown, and what lies between them") {
  const auto scene = carried_scene(60, GENERATE(1, 3));
  const auto at_speed = [&](double speed) {
    CarriedSynthesisOptions options{1, times(EventType::birth, 2), {10, 10}};
    options.edit.speed = speed;
    return CarriedSynthesis(scene.frames, scene.strokes, options);
  };
  auto usual = at_speed(1), slow = at_speed(0.5), fast = at_speed(2);
  const auto frames = draw(usual, 41), halves = draw(slow, 41), every_other = draw(fast, 20);
  for (std::size_t n = 0; n < 20; ++n) {
    CHECK(cv::norm(halves[2 * n], frames[n], cv::NORM_L1) == 0);
    CHECK(cv::norm(every_other[n], frames[2 * n], cv::NORM_L1) == 0);
    // Lines move by a quarter of a pixel a frame.
    const double apart = cv::norm(frames[n], frames[n + 1], cv::NORM_L1);
    CHECK(cv::norm(halves[2 * n + 1], frames[n], cv::NORM_L1) <= 1.05 * apart);
    CHECK(cv::norm(halves[2 * n + 1], frames[n + 1], cv::NORM_L1) <= 1.05 * apart);
  }
  const auto seen = usual.motion(41), slowed = slow.motion(41), hurried = fast.motion(20);
  for (std::size_t n = 0; n < 20; ++n) {
    const auto& graph = seen.sketch.frames[n];
    REQUIRE(slowed.sketch.frames[2 * n].size() == graph.size());
    REQUIRE(hurried.sketch.frames[n].size() == seen.sketch.frames[2 * n].size());
    for (std::size_t v = 0; v < graph.size(); ++v)
      CHECK(distance(slowed.sketch.frames[2 * n].patch(v).position, graph.patch(v).position) == 0);
    // Half way the later graph stands, half a step back where its patches were there before.
    const auto &between = slowed.sketch.frames[2 * n + 1], &after = seen.sketch.frames[n + 1];
    REQUIRE(between.size() == after.size());
    std::vector<graph::Point> expected;
    for (const graph::Vertex& vertex : after.vertices()) expected.push_back(vertex.patch.position);
    for (const auto& [a, b] : seen.links[n + 1])
      expected[after.index_of(b)] =
          (expected[after.index_of(b)] + graph.patch(graph.index_of(a)).position) * 0.5;
    for (std::size_t v = 0; v < after.size(); ++v)
      CHECK(distance(between.patch(v).position, expected[v]) < 1e-9);
  }
  CHECK(slow.statistics()->patches.size() == 21);
  CHECK(events(slow.motion(41), EventType::birth) == events(usual.motion(21), EventType::birth));
}

TEST_CASE("carried strokes: a loop repeats itself to the byte, with strokes that live on across its end") {
  const auto scene = carried_scene(60);
  mcmc::MotionEdit edit;
  edit.rates[0] = GENERATE(0.5, 3.0);
  edit.rates[1] = 2;
  edit.speed = GENERATE(1.0, 0.4);
  const int loop = GENERATE(30, 47);
  INFO(edit.rates[0] << " " << edit.speed << " " << loop);
  CarriedSynthesis synthesis(scene.frames, scene.strokes, {1, edit, {10, 10}, loop});
  const auto frames = draw(synthesis, 2 * loop + 5);
  for (std::size_t n = 0; n + static_cast<std::size_t>(loop) < frames.size(); ++n)
    CHECK(cv::norm(frames[n], frames[n + static_cast<std::size_t>(loop)], cv::NORM_L1) == 0);
  // The step over its end shows no more than others do.
  double most = 0;
  for (std::size_t n = 1; n < static_cast<std::size_t>(loop); ++n)
    most = std::max(most, cv::norm(frames[n - 1], frames[n], cv::NORM_L1));
  CHECK(cv::norm(frames[static_cast<std::size_t>(loop) - 1], frames[0], cv::NORM_L1) <= 1.1 * most);
  // Patches keep their ids across it.
  const auto motion = synthesis.motion(loop + 1);
  const auto& last = motion.sketch.frames.back();
  REQUIRE(last.size() == motion.sketch.frames.front().size());
  for (std::size_t v = 0; v < last.size(); ++v)
    CHECK(distance(last.patch(v).position, motion.sketch.frames.front().patch(v).position) < 1e-9);
}

TEST_CASE("carried strokes: the same bytes at any number of threads, and others for another seed") {
  const auto scene = carried_scene(50, 3);
  const auto drawn = [&](std::size_t threads, std::uint64_t seed) {
    const core::ThreadLimit limit(threads);
    CarriedSynthesis synthesis(scene.frames, scene.strokes, {seed, times(EventType::birth, 3), {10, 10}});
    auto frames = draw(synthesis, 7);
    std::ranges::move(draw(synthesis, 33), std::back_inserter(frames));
    return frames;
  };
  const auto one = drawn(1, 1);
  CHECK(same_frames(one, drawn(2, 1)));
  CHECK(same_frames(one, drawn(8, 1)));
  CHECK_FALSE(same_frames(one, drawn(2, 2)));
}

TEST_CASE("carried strokes: clips without strokes, backwards, and what cannot be carried") {
  auto scene = carried_scene(12);
  mcmc::MotionEdit back = times(EventType::birth, 2);
  back.reverse = true;
  CarriedSynthesis reversed(scene.frames, scene.strokes, {1, back, {10, 10}});
  CHECK(draw(reversed, 20).size() == 20);
  auto empty = scene.strokes;
  for (auto& graph : empty.sketch.frames) graph = {};
  for (auto& links : empty.links) links.clear();
  CarriedSynthesis none(scene.frames, empty, {1, times(EventType::birth, 2), {10, 10}});
  CHECK(draw(none, 5).size() == 5);
  CHECK(none.motion(5).sketch.frames[4].empty());
  mcmc::MotionEdit edit;
  edit.intensity = 2;
  CHECK(contains(message_of<core::InputError>([&] {
                   CarriedSynthesis(scene.frames, scene.strokes, {1, edit, {10, 10}});
                 }),
                 "intensity"));
  CHECK(
      contains(message_of<core::InputError>([&] { CarriedSynthesis({scene.frames[0]}, scene.strokes, {}); }),
               "one frame"));
  scene.frames.pop_back();
  CHECK(contains(message_of<core::InputError>([&] { CarriedSynthesis(scene.frames, scene.strokes, {}); }),
                 "12 frames"));
}
