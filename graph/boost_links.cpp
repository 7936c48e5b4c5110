// SPDX-License-Identifier: Apache-2.0
#include "graph/boost_links.hpp"

#include <algorithm>
#include <numeric>

namespace emberfold::graph {

namespace {

/// Turns counts at 1… into where each one's part begins.
void sum_up(std::vector<std::uint32_t>& counts) {
  std::partial_sum(counts.begin(), counts.end(), counts.begin());
}

}  // namespace

LinkGraph::LinkGraph(const MotionGraph& motion) : motion_(&motion), first_of_frame_{0} {
  validate(motion);
  for (const AttributeGraph& g : motion.sketch.frames)
    first_of_frame_.push_back(first_of_frame_.back() + static_cast<std::uint32_t>(g.size()));
  std::vector<Edge> all;
  for (std::size_t t = 1; t < motion.links.size(); ++t)
    for (const Link& link : motion.links[t])
      all.push_back({vertex(t - 1, motion.sketch.frames[t - 1].index_of(link.before)),
                     vertex(t, motion.sketch.frames[t].index_of(link.after))});
  const std::size_t patches = first_of_frame_.back();
  first_out_.assign(patches + 1, 0);
  first_in_.assign(patches + 1, 0);
  for (const Edge& edge : all) ++first_out_[edge.source + 1], ++first_in_[edge.target + 1];
  sum_up(first_out_);
  sum_up(first_in_);
  targets_.resize(all.size());
  sources_.resize(all.size());
  auto out = first_out_, in = first_in_;
  // Links are sorted by the patch before, then after: both lists of a vertex ascend.
  for (const Edge& edge : all) {
    targets_[out[edge.source]++] = edge.target;
    sources_[in[edge.target]++] = edge.source;
  }
}

std::size_t LinkGraph::frame_of(std::uint32_t vertex) const {
  return static_cast<std::size_t>(std::ranges::upper_bound(first_of_frame_, vertex) -
                                  first_of_frame_.begin() - 1);
}

const Vertex& LinkGraph::patch(std::uint32_t vertex) const {
  const std::size_t frame = frame_of(vertex);
  return motion_->sketch.frames[frame].vertices()[vertex - first_of_frame_[frame]];
}

}  // namespace emberfold::graph
