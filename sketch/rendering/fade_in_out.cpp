// SPDX-License-Identifier: Apache-2.0
#include "sketch/rendering/fade_in_out.hpp"

#include <algorithm>
#include <set>
#include <utility>

namespace emberfold::sketch {

namespace {

constexpr int half = 3;                                     // frames, of a fade
constexpr int beyond = half - 1;                            // that a patch shows before its first frame
constexpr int whole = static_cast<int>(FadeInOut::kAhead);  // an age at which all of it is there

/// `age`: frames since its first, or until its last.
float opacity(int age) {
  return std::clamp((static_cast<float>(age + half) - 0.5F) / (2 * half), 0.0F, 1.0F);
}

bool holds(const graph::AttributeGraph& graph, graph::VertexId id) {
  return graph.index_of(id) < graph.size();
}

/// The patches of several graphs, of each the first that has it, with the edges it has there.
class Union {
 public:
  void add(const graph::AttributeGraph& graph) {
    std::set<std::uint32_t> fresh;
    for (const auto& vertex : graph.vertices())
      if (all_.insert(vertex.id.value).second) {
        fresh.insert(vertex.id.value);
        vertices_.push_back(vertex);
      }
    for (const auto& edge : graph.edges())
      if (fresh.contains(edge.a.value) || fresh.contains(edge.b.value)) edges_.push_back(edge);
  }
  [[nodiscard]] graph::AttributeGraph take() { return {std::move(vertices_), std::move(edges_)}; }

 private:
  std::set<std::uint32_t> all_;
  std::vector<graph::Vertex> vertices_;
  std::vector<graph::Edge> edges_;
};

/// Frames from now until the patch's last; negative where that is past.
int frames_left(graph::VertexId id, const graph::AttributeGraph& now,
                std::span<const graph::AttributeGraph* const> ahead,
                const std::deque<graph::AttributeGraph>& behind) {
  if (holds(now, id)) {
    int left = 0;
    while (left < whole && static_cast<std::size_t>(left) < ahead.size() &&
           holds(*ahead[static_cast<std::size_t>(left)], id))
      ++left;
    return left;
  }
  for (std::size_t i = 0; i < behind.size(); ++i)
    if (holds(behind[i], id)) return -1 - static_cast<int>(i);
  return whole;  // still to come
}

}  // namespace

FadedGraph FadeInOut::next(const graph::AttributeGraph& now,
                           std::span<const graph::AttributeGraph* const> ahead) {
  Union shown;
  shown.add(now);
  for (const auto* graph : ahead.first(std::min<std::size_t>(ahead.size(), beyond)))
    shown.add(graph::without_anchors(*graph));
  for (const auto& graph : behind_) shown.add(graph);
  FadedGraph result{shown.take(), {}};
  std::map<std::uint32_t, int> ages;
  for (const auto& vertex : result.graph.vertices()) {
    if (graph::is_anchor(vertex.patch)) {
      result.opacity.push_back(1);
      continue;
    }
    const auto before = ages_.find(vertex.id.value);
    int age = 0;
    if (before != ages_.end()) {
      age = std::min(before->second + 1, whole);
    } else if (!holds(now, vertex.id)) {
      while (!holds(*ahead[static_cast<std::size_t>(-age)], vertex.id)) --age;
      --age;
    } else if (!begun_) {
      age = whole;
    }
    ages.emplace_hint(ages.end(), vertex.id.value, age);
    result.opacity.push_back(opacity(std::min(age, frames_left(vertex.id, now, ahead, behind_))));
  }
  ages_ = std::move(ages);
  begun_ = true;
  behind_.push_front(graph::without_anchors(now));
  if (behind_.size() > beyond) behind_.pop_back();
  return result;
}

}  // namespace emberfold::sketch
