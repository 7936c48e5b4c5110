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

MotionIndex::MotionIndex(const graph::MotionGraph& motion) : motion_(motion) {
  for (const graph::AttributeGraph& g : motion.sketch.frames)
    frames_.push_back({std::vector(g.size(), kNone), std::vector(g.size(), kNone),
                       graph::detail::PointGrid(places(g), graph::kCoincidence)});
  for (std::size_t t = 1; t < frames_.size(); ++t)
    for (const graph::Link& link : motion.links[t]) {
      const std::size_t before = motion.sketch.frames[t - 1].index_of(link.before),
                        after = motion.sketch.frames[t].index_of(link.after);
      if (frames_[t - 1].next[before] == kNone)
        frames_[t - 1].next[before] = static_cast<std::uint32_t>(after);
      if (frames_[t].previous[after] == kNone)
        frames_[t].previous[after] = static_cast<std::uint32_t>(before);
    }
}

std::optional<std::uint32_t> MotionIndex::linked(int frame, std::uint32_t vertex, int step) const {
  const Frame& at = frames_[static_cast<std::size_t>(frame)];
  const std::uint32_t found = step > 0 ? at.next[vertex] : at.previous[vertex];
  return found == kNone ? std::nullopt : std::optional(found);
}

std::optional<std::uint32_t> MotionIndex::coinciding(int frame, const graph::Patch& patch) const {
  std::optional<std::uint32_t> best;
  double least = std::numeric_limits<double>::infinity();
  for (const std::uint32_t v : frames_[static_cast<std::size_t>(frame)].places.find_near(patch.position)) {
    const auto apart = graph::coincidence(patch, graph(frame).patch(v));
    if (apart && *apart < least) least = *apart, best = v;
  }
  return best;
}

}  // namespace emberfold::pipeline
