// SPDX-License-Identifier: Apache-2.0
#include "graph/events/fading.hpp"

#include <algorithm>
#include <cstdint>

namespace emberfold::graph::detail {

std::vector<bool> staying_patches(const MotionGraph& motion, std::size_t frame, bool ahead) {
  const AttributeGraph& graph = motion.sketch.frames[frame];
  if (ahead ? frame + 1 == motion.sketch.frames.size() : frame == 0)
    return std::vector<bool>(graph.size(), true);
  std::vector<bool> is_linked(graph.size(), false);
  for (const Link& link : motion.links[ahead ? frame + 1 : frame])
    is_linked[graph.index_of(ahead ? link.before : link.after)] = true;
  std::vector<bool> stays(graph.size());
  for (std::uint32_t v = 0; v < graph.size(); ++v) {
    const auto near = graph.neighbours(v);
    stays[v] = is_linked[v] ||
               (!near.empty() && std::ranges::all_of(near, [&](std::uint32_t w) { return is_linked[w]; }));
  }
  return stays;
}

void mark_fading_ends(const AttributeGraph& graph, const std::vector<bool>& stays,
                      std::vector<bool>& near_end) {
  std::vector<bool> is_seen(graph.size(), false);
  std::vector<std::uint32_t> fading;  // that lead to an end
  for (std::uint32_t v = 0; v < graph.size(); ++v) {
    if (stays[v] || graph.degree(v) > 1) continue;
    is_seen[v] = true;
    fading.push_back(v);
  }
  while (!fading.empty()) {
    const std::uint32_t v = fading.back();
    fading.pop_back();
    for (const std::uint32_t w : graph.neighbours(v)) {
      if (stays[w]) near_end[w] = true;
      if (stays[w] || is_seen[w]) continue;
      is_seen[w] = true;
      fading.push_back(w);
    }
  }
}

}  // namespace emberfold::graph::detail
