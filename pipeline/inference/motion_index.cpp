// SPDX-License-Identifier: Apache-2.0
#include "pipeline/inference/motion_index.hpp"

#include <limits>

#include "graph/matching/coincidence.hpp"

namespace emberfold::pipeline {

namespace {

constexpr std::uint32_t kNone = ~std::uint32_t{0};

std::vector<graph::Point> places(const graph::AttributeGraph& graph) {
  std::vector<graph::Point> points;
  for (const graph::Vertex& v : graph.vertices()) points.push_back(v.patch.position);
  return points;
}

}  // namespace

MotionIndex::Frame MotionIndex::index(std::size_t t) const {
  const auto& graphs = motion_.sketch.frames;
  Frame frame{std::vector(graphs[t].size(), kNone), std::vector(graphs[t].size(), kNone),
              graph::detail::PointGrid(places(graphs[t]), graph::kCoincidence)};
  const auto link = [](std::vector<std::uint32_t>& with, std::size_t from, std::size_t to) {
    if (with[from] == kNone) with[from] = static_cast<std::uint32_t>(to);
  };
  if (t > 0)
    for (const graph::Link& l : motion_.links[t])
      link(frame.previous, graphs[t].index_of(l.after), graphs[t - 1].index_of(l.before));
  if (t + 1 < graphs.size())
    for (const graph::Link& l : motion_.links[t + 1])
      link(frame.next, graphs[t].index_of(l.before), graphs[t + 1].index_of(l.after));
  return frame;
}

void MotionIndex::hold(int first, int end) {
  for (; first_ < first && !frames_.empty(); ++first_) frames_.pop_front();
  if (frames_.empty()) first_ = first;
  while (first_ + static_cast<int>(frames_.size()) < end)
    frames_.push_back(index(static_cast<std::size_t>(first_) + frames_.size()));
}

std::optional<std::uint32_t> MotionIndex::linked(int frame, std::uint32_t vertex, int step) const {
  const Frame& at = held(frame);
  const std::uint32_t found = step > 0 ? at.next[vertex] : at.previous[vertex];
  return found == kNone ? std::nullopt : std::optional(found);
}

std::optional<std::uint32_t> MotionIndex::coinciding(int frame, const graph::Patch& patch) const {
  std::optional<std::uint32_t> best;
  double least = std::numeric_limits<double>::infinity();
  for (const std::uint32_t v : held(frame).places.find_near(patch.position)) {
    const auto apart = graph::coincidence(patch, graph(frame).patch(v));
    if (apart && *apart < least) least = *apart, best = v;
  }
  return best;
}

}  // namespace emberfold::pipeline
