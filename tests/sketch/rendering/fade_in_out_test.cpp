// SPDX-License-Identifier: Apache-2.0
#include "sketch/rendering/fade_in_out.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>
#include <vector>

#include <opencv2/core.hpp>

#include "core/rng.hpp"
#include "sketch/rendering/frame_renderer.hpp"
#include "tests/support/catch.hpp"

using namespace emberfold;

namespace {

/// A patch's first and last frame.
struct Life {
  int first = 0, last = 0;
};

graph::AttributeGraph graph_at(const std::vector<Life>& lives, int t) {
  std::vector<graph::Vertex> vertices;
  std::vector<graph::Edge> edges;
  for (std::uint32_t i = 0; i < lives.size(); ++i) {
    if (t < lives[i].first || t > lives[i].last) continue;
    graph::Patch patch;
    patch.position = {5.0 * i + t, 20};
    // A chain of those that are there.
    if (!vertices.empty()) edges.push_back({vertices.back().id, {i}});
    vertices.push_back({{i}, {}, patch});
  }
  return {std::move(vertices), std::move(edges)};
}

std::vector<sketch::FadedGraph> faded(const std::vector<graph::AttributeGraph>& graphs) {
  sketch::FadeInOut fader;
  std::vector<sketch::FadedGraph> all;
  for (std::size_t t = 0; t + sketch::FadeInOut::kAhead < graphs.size(); ++t) {
    std::vector<const graph::AttributeGraph*> ahead;
    for (std::size_t k = 1; k <= sketch::FadeInOut::kAhead; ++k) ahead.push_back(&graphs[t + k]);
    all.push_back(fader.next(graphs[t], ahead));
  }
  return all;
}

double opacity_of(const sketch::FadedGraph& fading, std::uint32_t id) {
  const auto i = fading.graph.index_of({id});
  return i < fading.graph.size() ? double{fading.opacity[i]} : 0;
}

}  // namespace

TEST_CASE("patches come and go by a sixth a frame at most, and are there for as long as they were") {
  core::Rng rng(3);
  std::vector<Life> lives{{0, 30}};
  for (int i = 0; i < 60; ++i) {
    const int first = 3 + static_cast<int>(rng.below(60));
    lives.push_back({first, first + static_cast<int>(rng.below(25))});
  }
  std::vector<graph::AttributeGraph> graphs;
  for (int t = 0; t < 120; ++t) graphs.push_back(graph_at(lives, t));
  const auto frames = faded(graphs);
  CHECK(opacity_of(frames[0], 0) == 1);
  for (std::uint32_t i = 1; i < lives.size(); ++i) {
    double sum = 0, before = 0, most = 0;
    for (const auto& frame : frames) {
      const double now = opacity_of(frame, i);
      CHECK(std::abs(now - before) <= 1 / 6.0 + 1e-6);
      sum += now, before = now, most = std::max(most, now);
    }
    CHECK(before == 0);
    const int life = lives[i].last - lives[i].first + 1;
    if (life < 9) continue;
    CHECK(most == 1);
    CHECK_THAT(sum, Catch::Matchers::WithinAbs(life - 2, 1e-4));  // a frame less at either end
  }
}

TEST_CASE("before its first frame and after its last a patch stands where it was then, in its stroke") {
  const std::vector<Life> lives{{0, 40}, {10, 20}};
  std::vector<graph::AttributeGraph> graphs;
  for (int t = 0; t < 40; ++t) graphs.push_back(graph_at(lives, t));
  const auto frames = faded(graphs);
  const auto place = [&](std::size_t t) {
    const auto& graph = frames[t].graph;
    return graph.patch(graph.index_of({1})).position.x;
  };
  CHECK(frames[7].graph.size() == 1);
  CHECK(frames[23].graph.size() == 1);
  for (const std::size_t t : {8U, 9U}) CHECK(place(t) == 15);
  for (std::size_t t = 10; t <= 20; ++t) CHECK(place(t) == 5.0 + static_cast<double>(t));
  for (const std::size_t t : {21U, 22U}) CHECK(place(t) == 25);
  for (std::size_t t = 8; t <= 22; ++t) CHECK(frames[t].graph.edges().size() == 1);
}

TEST_CASE("a stroke that closes off a region changes no pixel by more than its share in any frame") {
  // A dark step down the frame's middle, held apart by bright sides; to its left a bright line that stays.
  const auto upright = [](double x, std::uint32_t first, bool step) {
    std::vector<graph::Vertex> vertices;
    for (std::uint32_t k = 0; k < 14; ++k) {
      graph::Patch patch;
      patch.type = step ? graph::PatchType::step : graph::PatchType::ridge;
      patch.position = {x, 5.0 * k};
      patch.theta = 1.5707963267948966;
      patch.width = step ? 0 : 3, patch.blur = 1, patch.contrast = step ? -120 : 50;
      patch.left = step ? graph::Level{20, 20, 20} : graph::Level{180, 180, 180};
      patch.right = step ? graph::Level{140, 140, 140} : patch.left;
      patch.middle = step ? graph::Level{80, 80, 80} : graph::Level{230, 230, 230};
      vertices.push_back({{first + k}, {}, patch});
    }
    return vertices;
  };
  const auto stroke = [](std::vector<graph::Vertex> vertices, const std::vector<graph::Vertex>& more) {
    std::vector<graph::Edge> edges;
    vertices.insert(vertices.end(), more.begin(), more.end());
    for (std::size_t k = 1; k < vertices.size(); ++k)
      if (k != 14) edges.push_back({vertices[k - 1].id, vertices[k].id});
    return graph::AttributeGraph(std::move(vertices), std::move(edges));
  };
  const auto without = stroke(upright(16, 0, false), {}),
             with = stroke(upright(16, 0, false), upright(60, 50, true));
  std::vector<graph::AttributeGraph> graphs;
  for (int t = 0; t < 40; ++t) graphs.push_back(t >= 10 && t < 26 ? with : without);
  sketch::RenderOptions look{{100, 66}, 1, 7, {}};
  // A still ground to the right, some cells away from the line that stays.
  look.background.levels = cv::Mat(5, 7, CV_32F, cv::Scalar(90));
  look.background.still = cv::Mat::zeros(5, 7, CV_8U);
  look.background.still.colRange(4, 7).setTo(255);
  std::vector<sketch::FrameContent> parts;
  for (auto& one : faded(graphs)) parts.push_back({std::move(one.graph), std::move(one.opacity)});
  const auto frames = sketch::render_frames(parts, look, {});
  cv::Mat least = frames[0].clone(), most = frames[0].clone();
  for (const auto& frame : frames) cv::min(least, frame, least), cv::max(most, frame, most);
  cv::Mat range, step;
  cv::absdiff(most, least, range);
  double largest = 0, worst = 0;
  cv::minMaxLoc(range, nullptr, &largest);
  REQUIRE(largest > 50);
  for (std::size_t t = 1; t < frames.size(); ++t) {
    cv::absdiff(frames[t], frames[t - 1], step);
    worst = std::max(worst, cv::mean(step)[0]);
  }
  CHECK(worst <= cv::mean(range)[0] / 5);
  CHECK(cv::norm(frames.back(), frames.front(), cv::NORM_INF) <= 1);
}

TEST_CASE("anchors do not fade: they are there in their own frame alone") {
  std::vector<graph::AttributeGraph> graphs;
  for (std::uint32_t t = 0; t < 12; ++t) {
    const auto strokes = graph_at({{0, 11}, {2, 5}}, static_cast<int>(t));
    std::vector<graph::Vertex> vertices(strokes.vertices().begin(), strokes.vertices().end());
    vertices.push_back({{100 + t}, {}, graph::make_anchor({3, 4}, {1, 2, 3})});
    graphs.emplace_back(std::move(vertices),
                        std::vector<graph::Edge>(strokes.edges().begin(), strokes.edges().end()));
  }
  const auto frames = faded(graphs);
  for (std::uint32_t t = 0; t < frames.size(); ++t)
    for (std::uint32_t other = 0; other < 12; ++other)
      CHECK(opacity_of(frames[t], 100 + other) == (other == t ? 1 : 0));
}
