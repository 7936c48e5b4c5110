// SPDX-License-Identifier: Apache-2.0
#include "pipeline/inference/lasting_patches.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>
#include <vector>

#include <opencv2/core.hpp>

#include "core/error.hpp"
#include "core/parallel.hpp"
#include "graph/matching/coincidence.hpp"
#include "graph/matching/time_reversal.hpp"
#include "pipeline/sketch_clip.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/messages.hpp"
#include "tests/support/sketch_scene.hpp"

using namespace emberfold;
using namespace emberfold::test;

namespace {

constexpr int kLastingFrames = 30;

core::Clip lasting_film(const std::function<double(Point, int)>& level) {
  core::Clip clip;
  clip.info.width = 160, clip.info.height = 120, clip.info.channels = 1, clip.info.frames = kLastingFrames;
  for (int t = 0; t < kLastingFrames; ++t) {
    const cv::Mat1f levels = with_noise(draw({160, 120}, [&](Point p) { return level(p, t); }), 2,
                                        static_cast<std::uint64_t>(t) + 7);
    cv::Mat bytes;
    levels.convertTo(bytes, CV_8U);
    clip.frames.push_back(bytes);
  }
  return clip;
}

/// An upright line at x that reaches from y = 15 to `end`.
double upright(Point p, double x, double end) {
  return p.y >= 15 && p.y <= end ? 60 * std::exp(-0.5 * (p.x - x) * (p.x - x) / 4) : 0;
}

graph::SketchSequence sketch_of(const core::Clip& clip) {
  core::ClipSource source(clip);
  return pipeline::sketch_clip(source, pipeline::kFollowedSketch, {}).sketch;
}

graph::SketchSequence lasting(const core::Clip& clip, const graph::SketchSequence& sketch) {
  core::ClipSource source(clip);
  return pipeline::add_lasting_patches(source, sketch);
}

/// Leaves out the patches for which is_out(frame, position) holds.
template <class IsOut>
graph::SketchSequence without(const graph::SketchSequence& sketch, const IsOut& is_out) {
  graph::SketchSequence left{sketch.width, sketch.height, sketch.fps, {}};
  for (int t = 0; t < kLastingFrames; ++t) {
    const graph::AttributeGraph& g = sketch.frames[static_cast<std::size_t>(t)];
    const auto is_gone = [&](const graph::Vertex& v) { return is_out(t, v.patch.position); };
    std::vector<graph::Vertex> vertices;
    std::ranges::remove_copy_if(g.vertices(), std::back_inserter(vertices), is_gone);
    std::vector<graph::Edge> edges;
    std::ranges::copy_if(g.edges(), std::back_inserter(edges), [&](const graph::Edge& e) {
      return !is_gone(g.vertices()[g.index_of(e.a)]) && !is_gone(g.vertices()[g.index_of(e.b)]);
    });
    left.append({std::move(vertices), std::move(edges)});
  }
  return left;
}

/// Counts the patches of a frame between two heights.
std::size_t count_between(const graph::SketchSequence& sketch, int frame, double top, double bottom) {
  return static_cast<std::size_t>(std::ranges::count_if(
      sketch.frames[static_cast<std::size_t>(frame)].vertices(),
      [&](const auto& v) { return v.patch.position.y > top && v.patch.position.y < bottom; }));
}

double swaying(int t) {
  return 80 + 8 * std::sin(0.4 * t);
}

}  // namespace

TEST_CASE("lasting patches: what some frames' sketches lack is carried into them, onto its true path") {
  const core::Clip clip = lasting_film([](Point p, int t) { return 80 + upright(p, swaying(t), 105); });
  const auto drawn = sketch_of(clip);
  const auto is_hidden = [](int t) { return t >= 12 && t < 17; };
  const auto left = without(drawn, [&](int t, Point p) { return is_hidden(t) && p.y > 40 && p.y < 80; });
  const auto added = lasting(clip, left);
  REQUIRE(added.frames.size() == left.frames.size());
  for (int t = 12; t < 17; ++t) {
    CAPTURE(t);
    REQUIRE(count_between(left, t, 41, 79) == 0);
    CHECK(count_between(added, t, 40, 80) + 2 >= count_between(drawn, t, 40, 80));
    CHECK(graph::components(added.frames[static_cast<std::size_t>(t)]).count == 1);
    for (const auto& v : added.frames[static_cast<std::size_t>(t)].vertices()) {
      CHECK_THAT(v.patch.position.x, WithinAbs(swaying(t), 1));
      CHECK(graph::orientation_difference(v.patch.theta, 1.5708) < 0.3);
    }
  }
  for (const int t : {5, 11, 17, 25})
    CHECK(added.frames[static_cast<std::size_t>(t)].size() ==
          left.frames[static_cast<std::size_t>(t)].size());
}

TEST_CASE("lasting patches: a stroke that ends, and a gap that opens, stay empty") {
  const core::Clip clip = lasting_film([](Point p, int t) {
    const bool is_open = t >= 15 && p.y > 54 && p.y < 66;
    return 80 + (is_open ? 0 : upright(p, swaying(t), 105)) + (t < 15 ? upright(p, 40, 60) : 0);
  });
  const auto drawn = sketch_of(clip);
  const auto added = lasting(clip, drawn);
  for (int t = 15; t < kLastingFrames; ++t) {
    CAPTURE(t);
    const auto& graph = added.frames[static_cast<std::size_t>(t)];
    // A sketch may draw a speck of noise in the gap; nothing is added there.
    const std::size_t specks = count_between(drawn, t, 56, 64);
    if (specks == 0) CHECK(graph::components(graph).count == 2);
    CHECK(count_between(added, t, 56, 64) == specks);
    for (const auto& v : graph.vertices()) CHECK(v.patch.position.x > 60);
  }
  for (int t = 0; t < 15; ++t) {
    CAPTURE(t);
    CHECK(graph::components(added.frames[static_cast<std::size_t>(t)]).count == 2);
  }
}

TEST_CASE("lasting patches: what one frame alone draws is not carried") {
  const core::Clip clip = lasting_film([](Point p, int t) { return 80 + upright(p, swaying(t), 105); });
  const auto drawn = sketch_of(clip);
  const auto once = without(drawn, [](int t, Point) { return t != 10; });
  CHECK(lasting(clip, once) == once);
  const auto twice = without(drawn, [](int t, Point) { return t != 10 && t != 11; });
  const auto added = lasting(clip, twice);
  for (int t = 0; t < kLastingFrames; ++t) {
    CAPTURE(t);
    CHECK(added.frames[static_cast<std::size_t>(t)].empty() == (t < 0 || t > 21));
  }
}

TEST_CASE("lasting patches: a clip played backwards gets the same patches") {
  const core::Clip clip = lasting_film([](Point p, int t) { return 80 + upright(p, swaying(t), 105); });
  core::Clip backwards = clip;
  std::ranges::reverse(backwards.frames);
  const auto left =
      without(sketch_of(clip), [](int t, Point p) { return t % 9 > 5 && p.y > 40 && p.y < 80; });
  const auto on = lasting(clip, left), back = lasting(backwards, graph::reverse_time(left));
  REQUIRE(on != left);
  for (std::size_t t = 0; t < on.frames.size(); ++t) {
    const auto &a = on.frames[t], &b = back.frames[on.frames.size() - 1 - t];
    REQUIRE(a.size() == b.size());
    CHECK(a.edges().size() == b.edges().size());
    for (std::size_t i = 0; i < a.size(); ++i) CHECK(a.patch(i) == b.patch(i));
  }
}

TEST_CASE("lasting patches: the same bytes at one and at four threads, and errors in words") {
  const core::Clip clip = lasting_film([](Point p, int t) { return 80 + upright(p, swaying(t), 105); });
  const auto left = without(sketch_of(clip), [](int t, Point p) { return t % 7 > 3 && p.y > 60; });
  core::ClipSource source(clip);
  std::vector<graph::SketchSequence> found;
  for (const std::size_t threads : {1, 4}) {
    const core::ThreadLimit limit(threads);
    found.push_back(pipeline::add_lasting_patches(source, left));
  }
  CHECK(found[0] == found[1]);
  graph::SketchSequence longer = left;
  longer.append({});
  CHECK_THAT(message_of<core::InputError>([&] { (void)pipeline::add_lasting_patches(source, longer); }),
             Contains("30 frames") && Contains("31"));
}
