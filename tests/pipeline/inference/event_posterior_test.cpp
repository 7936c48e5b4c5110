// SPDX-License-Identifier: Apache-2.0
#include "pipeline/inference/event_posterior.hpp"

#include <algorithm>
#include <cmath>
#include <functional>

#include <opencv2/core.hpp>

#include "core/error.hpp"
#include "graph/matching/match.hpp"
#include "graph/matching/time_reversal.hpp"
#include "mcmc/inference/change_posterior.hpp"
#include "pipeline/inference/event_evidence.hpp"
#include "pipeline/sketch_clip.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/sketch_scene.hpp"

using namespace emberfold;
using namespace emberfold::test;
using graph::EventType;

namespace {

constexpr int kPosteriorFrames = 30;
using Level = std::function<double(Point, int)>;

core::Clip film(const Level& level, double noise) {
  core::Clip clip;
  clip.info.width = 160, clip.info.height = 120, clip.info.channels = 1, clip.info.frames = kPosteriorFrames;
  for (int t = 0; t < kPosteriorFrames; ++t) {
    const cv::Mat1f levels = with_noise(draw({160, 120}, [&](Point p) { return level(p, t); }), noise,
                                        static_cast<std::uint64_t>(t) + 7);
    cv::Mat bytes;
    levels.convertTo(bytes, CV_8U);
    clip.frames.push_back(bytes);
  }
  return clip;
}

graph::MotionGraph matched(const core::Clip& clip) {
  core::ClipSource source(clip);
  return graph::match(pipeline::sketch_clip(source, pipeline::kFollowedSketch, {}).sketch, {});
}

std::vector<graph::Event> posterior(const core::Clip& clip, const graph::MotionGraph& motion) {
  core::ClipSource source(clip);
  auto events = pipeline::weighed_events(source, motion);
  pipeline::sample_events(motion, events, events.size(), {}, 1);
  return events;
}

/// Leaves out the patches of a frame for which is_out(frame, patch) holds, and matches what is left.
template <class IsOut>
graph::MotionGraph matched_without(const graph::MotionGraph& motion, const IsOut& is_out,
                                   int flicker = graph::MatchOptions{}.flicker) {
  graph::SketchSequence left = motion.sketch;
  left.frames.clear();
  for (int t = 0; t < kPosteriorFrames; ++t) {
    const graph::AttributeGraph& g = motion.sketch.frames[static_cast<std::size_t>(t)];
    const auto is_gone = [&](const graph::Vertex& v) { return is_out(t, v.patch); };
    std::vector<graph::Vertex> vertices;
    std::ranges::remove_copy_if(g.vertices(), std::back_inserter(vertices), is_gone);
    std::vector<graph::Edge> edges;
    std::ranges::copy_if(g.edges(), std::back_inserter(edges), [&](const graph::Edge& e) {
      return !is_gone(g.vertices()[g.index_of(e.a)]) && !is_gone(g.vertices()[g.index_of(e.b)]);
    });
    left.append({std::move(vertices), std::move(edges)});
  }
  graph::MatchOptions options;
  options.flicker = flicker;
  return graph::match(left, options);
}

/// The highest probability of an event of this class near here.
double probability(const std::vector<graph::Event>& events, EventType type, int frame, Point place) {
  double best = 0;
  for (const graph::Event& e : events)
    if (e.type == type && std::abs(e.frame - frame) <= 2 && distance(e.position, place) < 20)
      best = std::max(best, e.probability);
  return best;
}

double line(Point p, double x, double top, double bottom) {
  return 50 * segment({x, top}, {x, bottom}, 3, 1)(p);
}

}  // namespace

TEST_CASE("What is born and breaks in a clip is told from what stays", "[posterior]") {
  // The first line stays, the second is born in frame 10 and dies in 20, the third has a gap from 15 on.
  const core::Clip clip = film(
      [](Point p, int t) {
        const double x = 3 * std::sin(0.4 * t);
        double level = 80 + line(p, 30 + x, 15, 105);
        if (t >= 10 && t < 20) level += line(p, 80 + x, 15, 105);
        level += t < 15 ? line(p, 130 + x, 15, 105) : line(p, 130 + x, 15, 50) + line(p, 130 + x, 72, 105);
        return level;
      },
      2);
  const graph::MotionGraph motion = matched(clip);
  const auto events = posterior(clip, motion);
  CHECK(probability(events, EventType::birth, 10, {80, 60}) > 0.8);
  CHECK(probability(events, EventType::death, 20, {80, 60}) > 0.8);
  CHECK(probability(events, EventType::split, 15, {130, 60}) > 0.8);
  CHECK(std::ranges::count_if(events, [](const auto& e) { return e.probability >= 0.5; }) == 3);
}

TEST_CASE("What leaves the picture has not died", "[posterior]") {
  // A line goes down by 3 px a frame; once it is in the middle when it ends, once on the border.
  const auto factor_of_death = [](double start) {
    const core::Clip clip = film(
        [&](Point p, int t) {
          const double y = start + 3 * t;
          return 80 + (t < 15 ? 50 * segment({20, y}, {140, y}, 3, 1)(p) : 0) + line(p, 80, 10, 30);
        },
        2);
    const graph::MotionGraph motion = matched(clip);
    core::ClipSource source(clip);
    double factor = -mcmc::kMostChangeFactor;
    for (const auto& [event, evidence] : pipeline::weigh_events(source, motion))
      if (event.type == EventType::death && std::abs(event.frame - 15) <= 2)
        factor = std::max(factor, evidence.log_factor);
    return factor;
  };
  CHECK(factor_of_death(40) > 5);
  CHECK(factor_of_death(76) < 2);
}

TEST_CASE("A short line that crosses the border comes in or goes out", "[posterior]") {
  // It is 16 px long. When a third of it is outside the picture, its visible part is too short to be drawn.
  const auto believed = [](int last) {
    const core::Clip clip = film(
        [&](Point p, int t) {
          const double x = 128 + 2.3 * t;
          return 80 + (t <= last ? 60 * segment({x - 8, 60}, {x + 8, 60}, 3, 1)(p) : 0) +
                 line(p, 40, 15, 105);
        },
        2);
    auto events = posterior(clip, matched(clip));
    std::erase_if(events, [](const graph::Event& e) { return e.probability < 0.5; });
    return events;
  };
  CHECK(believed(kPosteriorFrames).empty());
  const auto dies = believed(5);
  REQUIRE(dies.size() == 1);
  CHECK(dies[0].type == EventType::death);
}

TEST_CASE("Of an event the contrast is measured, and the frames until its opposite or the clip's end",
          "[posterior]") {
  const core::Clip clip = film(
      [](Point p, int t) {
        return 80 + (t >= 6 ? line(p, 40, 15, 105) : 0) + line(p, 110, 15, 50) +
               line(p, 110, t < 20 ? 50 : 72, 105);
      },
      0);
  const double frames = static_cast<double>(clip.frames.size());
  const graph::MotionGraph motion = matched(clip);
  core::ClipSource source(clip);
  const auto weighed = pipeline::weigh_events(source, motion);
  REQUIRE(weighed.size() == 2);
  for (const auto& [event, evidence] : weighed) {
    INFO(graph::name(event.type) << " in frame " << event.frame);
    CHECK(evidence.since == (event.type == EventType::birth ? 6 : 20));
    CHECK(evidence.until == frames - evidence.since);
    CHECK_THAT(evidence.contrast, WithinAbs(43, 5));  // a line of 50 levels, 3 px wide, blurred by 1 px
  }
}

TEST_CASE("Events that were put into the graphs alone are not believed", "[posterior]") {
  // A still picture: the graphs lose a stroke for a while, and break another.
  const core::Clip clip =
      film([](Point p, int) { return 80 + line(p, 40, 15, 105) + line(p, 110, 15, 105); }, 2);
  graph::MotionGraph motion = matched(clip);
  REQUIRE(graph::stroke_events(motion).empty());
  motion = matched_without(motion, [](int t, const graph::Patch& patch) {
    const auto [x, y] = patch.position;
    return (t >= 8 && t < 20 && x < 75) || (t >= 14 && x > 75 && std::abs(y - 60) < 8);
  });
  const auto read = graph::stroke_events(motion);
  REQUIRE(read.size() == 3);  // a death, a birth, a split
  core::ClipSource source(clip);
  for (const auto& [event, evidence] : pipeline::weigh_events(source, motion)) {
    INFO(graph::name(event.type) << " in frame " << event.frame);
    CHECK(evidence.log_factor < -3);
  }
  for (const graph::Event& e : posterior(clip, motion)) {
    INFO(graph::name(e.type) << " in frame " << e.frame);
    CHECK(e.probability < 0.2);
  }
}

TEST_CASE("The probabilities do not depend on which way a clip is played", "[posterior]") {
  core::Clip clip = film(
      [](Point p, int t) {
        return 80 + line(p, 40, 15, 105) + (t >= 12 ? line(p, 110, 15, 105) : line(p, 110, 15, 40));
      },
      2);
  const graph::MotionGraph motion = matched(clip);
  auto forwards = posterior(clip, motion);
  std::ranges::reverse(clip.frames);
  const auto backwards = graph::reverse_time(posterior(clip, graph::reverse_time(motion)), kPosteriorFrames);
  REQUIRE(forwards.size() == backwards.size());
  for (std::size_t i = 0; i < forwards.size(); ++i) {
    CHECK(forwards[i].type == backwards[i].type);
    CHECK_THAT(forwards[i].probability, WithinAbs(backwards[i].probability, 0.05));
  }
}

TEST_CASE("Opposite events count, in one frame as one frame apart", "[posterior]") {
  const core::Clip clip =
      film([](Point p, int) { return 80 + line(p, 40, 15, 105) + line(p, 110, 15, 105); }, 0);
  const graph::MotionGraph motion = matched(clip);
  const auto nearest_opposites = [&](const graph::MotionGraph& read) {
    core::ClipSource source(clip);
    std::vector<double> result;
    for (const auto& [event, evidence] : pipeline::weigh_events(source, read))
      result.push_back(std::min(evidence.since, evidence.until));
    return result;
  };
  const auto gone = matched_without(
      motion, [](int t, const graph::Patch& patch) { return patch.position.x > 75 && (t == 14 || t == 15); },
      0);
  CHECK(nearest_opposites(gone) == std::vector<double>{2, 2});
  graph::MotionGraph unlinked = motion;
  std::erase_if(unlinked.links[14], [&](const graph::Link& link) {
    const graph::AttributeGraph& after = unlinked.sketch.frames[14];
    return after.patch(static_cast<std::uint32_t>(after.index_of(link.after))).position.x > 75;
  });
  const graph::MotionGraph identified = graph::identify(std::move(unlinked));
  CHECK(nearest_opposites(identified) == std::vector<double>{1, 1});
}

TEST_CASE("A clip of another length than its graphs is refused", "[posterior]") {
  core::Clip clip = film([](Point p, int) { return 80 + line(p, 40, 15, 105); }, 2);
  const graph::MotionGraph motion = matched(clip);
  clip.frames.pop_back();
  CHECK_THROWS_AS(posterior(clip, motion), core::InputError);
}
