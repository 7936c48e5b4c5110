// SPDX-License-Identifier: Apache-2.0
#include "pipeline/inference/lasting_patches.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <deque>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "core/clip/frame_stream.hpp"
#include "core/error.hpp"
#include "core/parallel.hpp"
#include "graph/matching/coincidence.hpp"
#include "pipeline/inference/carried_patches.hpp"
#include "pipeline/inference/frame_window.hpp"
#include "sketch/patches/patch_types.hpp"

namespace emberfold::pipeline {

using graph::AttributeGraph;

namespace {

constexpr double kLongestEdge = 10;  // px, two patch spacings

/// A frame's sketch to which patches are added.
class GrowingSketch {
 public:
  explicit GrowingSketch(const AttributeGraph& own)
      : own_(own), vertices_(own.vertices().begin(), own.vertices().end()) {}

  void add(const DrawnAgain& carried) {
    places_of_.emplace(SourceVertex(carried.source, carried.vertex), carried.drawn);
  }

  /// Adds the patch, unless an added one shows the same place.
  void add(const LastingPatch& carried) {
    const SourceVertex key(carried.source, carried.vertex);
    auto same = find_added(carried.patch);
    if (!same) {
      same = vertices_.size();
      const std::uint32_t next = vertices_.empty() ? 0 : vertices_.back().id.value + 1;
      vertices_.push_back({graph::VertexId{next}, {}, carried.patch});
      cells_[cell_of(carried.patch.position)].push_back(*same);
      added_.emplace_back(key, *same);
    }
    places_of_.emplace(key, *same);
  }

  /// Joins added patches by their source frame's edges, and drops those that are joined to nothing.
  [[nodiscard]] AttributeGraph graph(const graph::SketchSequence& sketch) const {
    if (added_.empty()) return own_;
    std::vector<char> is_joined(vertices_.size(), 0);
    std::set<graph::Edge> joined;
    Neighbours next_to;
    for (const graph::Edge& edge : own_.edges())
      next_to[edge.a].insert(edge.b), next_to[edge.b].insert(edge.a);
    for (const auto& [key, index] : added_)
      for (const std::uint32_t u :
           sketch.frames[static_cast<std::size_t>(key.first)].neighbours(key.second)) {
        const auto other = places_of_.find({key.first, u});
        if (other == places_of_.end() || other->second == index) continue;
        const graph::Vertex &a = vertices_[std::min(index, other->second)],
                            &b = vertices_[std::max(index, other->second)];
        if (distance(a.patch.position, b.patch.position) > kLongestEdge || have_common(next_to, a.id, b.id))
          continue;
        joined.insert({a.id, b.id});
        next_to[a.id].insert(b.id), next_to[b.id].insert(a.id);
        is_joined[index] = is_joined[other->second] = 1;
      }
    std::vector<graph::Vertex> vertices;
    for (std::size_t i = 0; i < vertices_.size(); ++i)
      if (i < own_.size() || is_joined[i] != 0) vertices.push_back(vertices_[i]);
    std::vector<graph::Edge> edges(own_.edges().begin(), own_.edges().end());
    edges.insert(edges.end(), joined.begin(), joined.end());
    return sketch::name_patch_types(std::move(vertices), std::move(edges)).kept_in(own_.memory());
  }

 private:
  using Neighbours = std::map<graph::VertexId, std::set<graph::VertexId>>;
  /// Returns whether an edge between two patches would close a triangle.
  static bool have_common(const Neighbours& next_to, graph::VertexId a, graph::VertexId b) {
    const auto of_a = next_to.find(a), of_b = next_to.find(b);
    return of_a != next_to.end() && of_b != next_to.end() &&
           std::ranges::any_of(of_a->second, [&](graph::VertexId c) { return of_b->second.contains(c); });
  }

  using Cell = std::pair<int, int>;
  static Cell cell_of(graph::Point p) {
    return {static_cast<int>(std::floor(p.x / graph::kCoincidence)),
            static_cast<int>(std::floor(p.y / graph::kCoincidence))};
  }
  /// Returns the first added patch that may show the same place.
  [[nodiscard]] std::optional<std::size_t> find_added(const graph::Patch& patch) const {
    std::optional<std::size_t> first;
    const auto [column, row] = cell_of(patch.position);
    for (int x = column - 1; x <= column + 1; ++x)
      for (int y = row - 1; y <= row + 1; ++y) {
        const auto cell = cells_.find({x, y});
        if (cell == cells_.end()) continue;
        for (const std::size_t i : cell->second)
          if ((!first || i < *first) && graph::coincidence(patch, vertices_[i].patch)) first = i;
      }
    return first;
  }

  using SourceVertex = std::pair<int, std::uint32_t>;  // frame and vertex
  const AttributeGraph& own_;
  std::vector<graph::Vertex> vertices_;
  std::map<Cell, std::vector<std::size_t>> cells_;  // added patches
  std::vector<std::pair<SourceVertex, std::size_t>> added_;
  std::map<SourceVertex, std::size_t> places_of_;
};

/// Adds propagated patches to a frame; of several that show the same place, the one from the nearest frame.
AttributeGraph with_carried(const graph::SketchSequence& sketch, int frame, CarriedPatches carried) {
  const auto rank = [&](const LastingPatch& c) {
    return std::tuple(std::abs(c.source - frame), -c.amplitude, c.patch.position.x, c.patch.position.y,
                      c.source, c.vertex);
  };
  std::ranges::sort(carried.lasting, {}, rank);
  GrowingSketch growing(sketch.frames[static_cast<std::size_t>(frame)]);
  for (const DrawnAgain& one : carried.drawn) growing.add(one);
  for (const LastingPatch& one : carried.lasting) growing.add(one);
  return growing.graph(sketch);
}

/// Propagates patches through a clip that is read frame by frame.
class LastingPatches {
 public:
  LastingPatches(const graph::SketchSequence& sketch, const core::Context& context)
      : sketch_(sketch),
        context_(context),
        drawn_(sketch),
        result_{sketch.width, sketch.height, sketch.fps, {}} {}

  void push(WindowFrame frame) {
    window_.push(std::move(frame));
    arrived_.emplace_back();
  }

  /// Propagates from all frames with enough neighbours in the window.
  void proceed() {
    const int frames = drawn_.frames(), end = window_.end();
    window_.prepare(context_);
    const int ready = end == frames ? frames : std::max(carried_, end - kFramesCarried);
    drawn_.hold(window_.first(), end);
    std::vector<CarriedPatches> from(2 * static_cast<std::size_t>(ready - carried_));
    core::parallel_for(from.size(), context_, [&](std::size_t k) {
      from[k] = carry_patches(carried_ + static_cast<int>(k / 2), k % 2 == 0 ? 1 : -1, drawn_, window_);
    });
    const auto finished = static_cast<int>(result_.frames.size());
    const auto arrived = [&](int frame) -> CarriedPatches& {
      return arrived_[static_cast<std::size_t>(frame - finished)];
    };
    for (CarriedPatches& some : from) {
      for (const LastingPatch& one : some.lasting) arrived(one.frame).lasting.push_back(one);
      for (const DrawnAgain& one : some.drawn) arrived(one.frame).drawn.push_back(one);
      some = {};
    }
    carried_ = ready;
    finish(ready == frames ? frames : std::max(finished, ready - kFramesCarried));
    window_.drop_before(ready - kFramesCarried);
  }

  [[nodiscard]] graph::SketchSequence take() { return std::move(result_); }

 private:
  /// Appends the frames before `end`, which no further patches reach.
  void finish(int end) {
    const auto first = static_cast<int>(result_.frames.size());
    std::vector<AttributeGraph> graphs(static_cast<std::size_t>(end - first));
    core::parallel_for(graphs.size(), context_, [&](std::size_t k) {
      graphs[k] = with_carried(sketch_, first + static_cast<int>(k), std::move(arrived_[k]));
    });
    for (const AttributeGraph& graph : graphs) {
      result_.append(graph);
      arrived_.pop_front();
    }
  }

  const graph::SketchSequence& sketch_;
  const core::Context& context_;
  DrawnPatches drawn_;
  FrameWindow window_;
  std::deque<CarriedPatches> arrived_;  // in unfinished frames
  int carried_ = 0;                     // frames whose patches were propagated
  graph::SketchSequence result_;
};

}  // namespace

graph::SketchSequence add_lasting_patches(core::FrameSource& source, const graph::SketchSequence& sketch,
                                          const core::Context& context) {
  const int frames = static_cast<int>(sketch.frames.size());
  LastingPatches lasting(sketch, context);
  const auto& info = source.info();
  const int batch = frames_at_once(info);
  const int read = core::stream_frames(
      source, "carry", frames, context,
      [&](int, const cv::Mat& frame) { return make_window_frame(frame, info); },
      [&](int t, WindowFrame frame) {
        lasting.push(std::move(frame));
        if ((t + 1) % batch == 0 && t + 1 < frames) lasting.proceed();
      });
  if (read != frames)
    throw core::InputError("carry: the clip has " + std::to_string(read) + " frames, its sketch " +
                           std::to_string(frames));
  lasting.proceed();
  return lasting.take();
}

}  // namespace emberfold::pipeline
