// SPDX-License-Identifier: Apache-2.0
#include "pipeline/steady_frames.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include <opencv2/imgproc.hpp>

#include "core/context.hpp"
#include "graph/motion_graph.hpp"
#include "pipeline/sketch_clip.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/sketch_scene.hpp"

using namespace emberfold;
using namespace emberfold::test;
using pipeline::FrameReading;

namespace {

/// Faint lines among stronger ones, still or swaying, in noise.
core::Clip noisy_lines(int frames, double sway) {
  core::Clip clip;
  clip.info.width = 160, clip.info.height = 120, clip.info.channels = 1, clip.info.frames = frames;
  for (int t = 0; t < frames; ++t) {
    const double shift = sway * std::sin(0.5 * t);
    const cv::Mat1f levels =
        with_noise(draw({160, 120},
                        [&](Point p) {
                          double level = 90;
                          for (int i = 0; i < 6; ++i)
                            level += (4 + 2 * i) * segment({15.0 + 24 * i + shift, 10},
                                                           {22.0 + 24 * i + shift, 110}, 3, 1)(p);
                          return level;
                        }),
                   5, static_cast<std::uint64_t>(t) + 1);
    cv::Mat bytes;
    levels.convertTo(bytes, CV_8U);
    clip.frames.push_back(bytes);
  }
  return clip;
}

graph::SketchSequence sketched(const core::Clip& clip, bool steady) {
  core::ClipSource source(clip);
  sketch::ExtractOptions options;
  options.steady = steady;
  return pipeline::sketch_clip(source, options, {}).sketch;
}

/// The share of patches that have one near them in the next frame.
double kept(const graph::SketchSequence& sketch) {
  double found = 0, all = 0;
  for (std::size_t t = 0; t + 1 < sketch.frames.size(); ++t)
    for (const graph::Vertex& v : sketch.frames[t].vertices()) {
      found += std::ranges::any_of(sketch.frames[t + 1].vertices(),
                                   [&](const graph::Vertex& w) {
                                     return graph::distance(v.patch.position, w.patch.position) < 5;
                                   })
                   ? 1
                   : 0;
      ++all;
    }
  return found / all;
}

}  // namespace

TEST_CASE("Noise makes fewer strokes come and go in a clip than in single frames", "[steady]") {
  for (const double sway : {0.0, 2.0}) {
    const core::Clip clip = noisy_lines(14, sway);
    const double alone = kept(sketched(clip, false)), together = kept(sketched(clip, true));
    INFO("sway " << sway << ": kept " << alone << ", steadied " << together);
    CHECK(1 - together < 0.75 * (1 - alone));
  }
}

TEST_CASE("A clip played backwards has the same sketches", "[steady]") {
  core::Clip clip = noisy_lines(9, 0);
  const graph::SketchSequence on = sketched(clip, true);
  std::ranges::reverse(clip.frames);
  const graph::SketchSequence back = sketched(clip, true);
  REQUIRE(on.frames.size() == back.frames.size());
  for (std::size_t t = 0; t < on.frames.size(); ++t) {
    const auto &a = on.frames[t], &b = back.frames[on.frames.size() - 1 - t];
    REQUIRE(a.size() == b.size());
    for (std::size_t i = 0; i < a.size(); ++i) CHECK(a.patch(i) == b.patch(i));
  }
}

TEST_CASE("Frames are finished in order as soon as their neighbours are there", "[steady]") {
  const core::Clip clip = noisy_lines(8, 0);
  sketch::ExtractOptions options;
  pipeline::SteadyFrames frames(options);
  std::size_t done = 0;
  for (const cv::Mat& frame : clip.frames) {
    cv::Mat levels;
    frame.convertTo(levels, CV_32F);
    frames.push({FrameReading{levels, sketch::extract(levels, options)}});
    const std::size_t count = frames.prepare(false, {});
    for (std::size_t i = 0; i < count; ++i) CHECK(frames.steady(i).size() == 1);
    frames.drop(count);
    done += count;
    CHECK(frames.waiting() <= 3);
  }
  CHECK(done == 5);
  CHECK(frames.prepare(true, {}) == 3);
}

TEST_CASE("A clip of one frame, and one of none", "[steady]") {
  core::Clip clip = noisy_lines(1, 0);
  CHECK(sketched(clip, true) == sketched(clip, false));
  clip.frames.clear(), clip.info.frames = 0;
  CHECK(sketched(clip, true).frames.empty());
}

TEST_CASE("A mask leaves out patches by their own pixel, and what only joined them") {
  graph::Patch patch;
  patch.width = 2, patch.contrast = 20;
  const auto at = [&](std::uint32_t id, double x, double y) {
    patch.position = {x, y};
    return graph::Vertex{{id}, {}, patch};
  };
  cv::Mat mask(40, 60, CV_8U, cv::Scalar(0));
  mask.rowRange(0, 20).setTo(255);  // the upper half
  const graph::AttributeGraph graph({at(0, 50, 8), at(1, 50, 12), at(2, 8, 30), at(3, 40, 19), at(4, 40, 24)},
                                    {{{0}, {1}}, {{3}, {4}}});
  const auto left = pipeline::inside_mask(graph, mask);
  REQUIRE(left.size() == 2);  // vertex 3 has no neighbour inside
  CHECK(left.vertices()[0].id == graph::VertexId{0});
  CHECK(left.vertices()[1].id == graph::VertexId{1});
  CHECK(left.edges().size() == 1);
}
