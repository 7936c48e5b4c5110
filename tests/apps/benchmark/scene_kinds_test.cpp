// SPDX-License-Identifier: Apache-2.0
#include "apps/benchmark/scene_kinds.hpp"

#include <algorithm>
#include <cmath>

#include <opencv2/imgproc.hpp>

#include "core/error.hpp"
#include "core/parallel.hpp"
#include "tests/support/catch.hpp"

using namespace emberfold;
using namespace emberfold::apps;
using graph::EventType;

namespace {

/// Counts the strokes of a frame by drawing what shows into a mask.
int count_strokes(const LineScene& scene, int frame) {
  int count = 0;
  for (const int sign : {1, -1}) {
    cv::Mat mask = cv::Mat::zeros(scene.height, scene.width, CV_8UC1), labels;
    for (const SceneLine& line : scene.lines) {
      if (line.contrast * sign < 0 || !line.presence.shows(frame)) continue;
      std::vector<cv::Point> points;
      constexpr int kShift = 4;
      for (const cv::Point2d& p : line_at(scene, line, frame))
        points.emplace_back(static_cast<int>(std::lround(p.x * (1 << kShift))),
                            static_cast<int>(std::lround(p.y * (1 << kShift))));
      cv::polylines(mask, points, false, 255, 4, cv::LINE_8, kShift);
    }
    count += cv::connectedComponents(mask, labels, 8) - 1;
  }
  return count;
}

int said_change(const std::vector<graph::Event>& events, int frame) {
  int change = 0;
  for (const graph::Event& event : events) {
    if (event.frame != frame) continue;
    using enum EventType;
    const bool more = event.type == birth || event.type == split || event.type == disconnect;
    change += more ? 1 : -1;
  }
  return change;
}

}  // namespace

TEST_CASE("the strokes of a made scene change in number as its truth says, frame by frame") {
  for (const SceneKind kind :
       {SceneKind::flames, SceneKind::folds, SceneKind::networks, SceneKind::ripples}) {
    for (std::uint64_t seed = 1; seed <= 4; ++seed) {
      const LineScene scene = plan_line_scene(kind, {seed, 100, {}});
      CHECK(scene.events.size() >= 12);
      int said = count_strokes(scene, 0), wrong = 0;
      const int first = said;
      for (int t = 1; t < scene.frames; ++t) {
        said += said_change(scene.events, t);
        wrong += said != count_strokes(scene, t) ? 1 : 0;
      }
      CAPTURE(name(kind), seed, first, said);
      // rings meet within a frame or two of where a mask of whole pixels joins them
      CHECK(wrong <= (kind == SceneKind::ripples ? 30 : 0));
      CHECK(said == count_strokes(scene, scene.frames - 1));
    }
  }
}

TEST_CASE("true events lie where lines change, inside the picture") {
  for (const SceneKind kind :
       {SceneKind::flames, SceneKind::folds, SceneKind::networks, SceneKind::ripples}) {
    const LineScene scene = plan_line_scene(kind, {7, 100, {}});
    for (const graph::Event& event : scene.events) {
      CHECK((event.frame >= 1 && event.frame < scene.frames));
      CHECK((event.position.x > 0 && event.position.x < scene.width));
      CHECK((event.position.y > 0 && event.position.y < scene.height));
    }
    CHECK(std::ranges::is_sorted(scene.events, {}, &graph::Event::frame));
  }
}

TEST_CASE(
    "equal seeds give equal scenes at any number of threads, nothing happens to filaments and pictures") {
  for (const SceneKind kind : all_scene_kinds()) {
    const SceneOptions options{3, 60, {}};
    const MadeScene a = make_scene(kind, options);
    const core::ThreadLimit one(1);
    const MadeScene b = make_scene(kind, options);
    REQUIRE(a.clip.frames.size() == 60);
    CHECK(a.truth == b.truth);
    for (std::size_t t = 0; t < 60; t += 13) {
      CHECK(cv::norm(a.clip.frames[t], b.clip.frames[t], cv::NORM_INF) == 0);
      CHECK((t == 0 || cv::norm(a.clip.frames[t], a.clip.frames[0], cv::NORM_INF) > 0));
    }
    CHECK(a.truth.empty() == (kind == SceneKind::filaments || kind == SceneKind::sway));
    CHECK(scene_kind(name(kind)) == kind);
  }
  CHECK_FALSE(scene_kind("waves"));
  CHECK_THROWS_AS(make_scene(SceneKind::folds, {1, 59, {}}), core::InputError);
  CHECK_THROWS_AS(plan_line_scene(SceneKind::sway, {}), core::InputError);
}
