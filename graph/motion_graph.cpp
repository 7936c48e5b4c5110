// SPDX-License-Identifier: Apache-2.0
#include "graph/motion_graph.hpp"

#include <algorithm>
#include <iterator>
#include <limits>
#include <optional>
#include <string>
#include <tuple>
#include <utility>

#include "core/error.hpp"
#include "graph/matching/frame_links.hpp"

namespace emberfold::graph {

namespace {

constexpr std::uint32_t kNoCourse = ~std::uint32_t{0};

std::string text(VertexId id) {
  return std::to_string(id.value);
}

std::string text(const Link& link) {
  return "the link from vertex " + text(link.before) + " to vertex " + text(link.after);
}

/// Returns the highest id of the frames [0, end).
std::optional<VertexId> last_id(const std::vector<AttributeGraph>& frames, std::size_t end) {
  while (end > 0) {
    --end;
    if (!frames[end].empty()) return frames[end].vertices().back().id;
  }
  return std::nullopt;
}

}  // namespace

void SketchSequence::append(const AttributeGraph& graph) {
  const auto last = last_id(frames, frames.size());
  const std::uint64_t first = last ? std::uint64_t{last->value} + 1 : 0;
  if (first + graph.size() > std::numeric_limits<std::uint32_t>::max()) {
    throw core::InputError("sketch: frame " + std::to_string(frames.size()) + " has " +
                           std::to_string(graph.size()) + " vertices, more than there are numbers left");
  }
  const auto renumbered = [&](std::size_t index) {
    return VertexId{static_cast<std::uint32_t>(first + index)};
  };
  std::vector<Vertex> vertices(graph.vertices().begin(), graph.vertices().end());
  for (std::size_t i = 0; i < vertices.size(); ++i) vertices[i].id = renumbered(i);
  std::vector<Edge> edges;
  edges.reserve(graph.edges().size());
  for (std::size_t i = 0; i < graph.size(); ++i) {
    for (const std::size_t j : graph.neighbours(i)) {
      if (i < j) edges.push_back({renumbered(i), renumbered(j)});
    }
  }
  frames.emplace_back(std::move(vertices), std::move(edges), graph.memory());
}

void validate_links(const AttributeGraph& before, const AttributeGraph& after, std::span<const Link> links) {
  for (std::size_t k = 0; k < links.size(); ++k) {
    if (before.index_of(links[k].before) == before.size()) {
      throw core::InputError(text(links[k]) + " begins at a vertex that is not in the frame before");
    }
    if (after.index_of(links[k].after) == after.size()) {
      throw core::InputError(text(links[k]) + " ends at a vertex that is not in its frame");
    }
    if (k > 0 && links[k] == links[k - 1]) throw core::InputError(text(links[k]) + " is there twice");
    if (k > 0 && links[k] < links[k - 1]) {
      throw core::InputError(text(links[k]) + " stands behind a higher one: links are sorted");
    }
  }
  const detail::FrameLinks found = detail::index_links(before, after, links);
  for (std::size_t k = 0; k < links.size(); ++k) {
    if (found.successors[found.links[k].first] > 1 && found.predecessors[found.links[k].second] > 1) {
      throw core::InputError(text(links[k]) +
                             " has a partner at both of its ends: a vertex that splits cannot merge at once");
    }
  }
}

std::vector<Link> all_links(const MotionGraph& motion, std::size_t frame) {
  if (motion.skipped.empty()) return motion.links[frame];
  std::vector<Link> all;
  std::ranges::merge(motion.links[frame], motion.skipped[frame], std::back_inserter(all));
  return all;
}

void validate(const MotionGraph& motion) {
  const auto& frames = motion.sketch.frames;
  if (motion.links.size() != frames.size()) {
    throw core::InputError("motion graph: " + std::to_string(motion.links.size()) + " lists of links for " +
                           std::to_string(frames.size()) + " frames");
  }
  if (!motion.skipped.empty() && motion.skipped.size() != frames.size()) {
    throw core::InputError("motion graph: " + std::to_string(motion.skipped.size()) +
                           " lists of links of skipped patches for " + std::to_string(frames.size()) +
                           " frames");
  }
  for (std::size_t t = 0; t < frames.size(); ++t) {
    const std::string where = "motion graph: frame " + std::to_string(t) + ": ";
    const auto anchor = std::ranges::find_if(frames[t].vertices(), is_anchor, &Vertex::patch);
    if (anchor != frames[t].vertices().end()) {
      throw core::InputError(where + "vertex " + text(anchor->id) +
                             " is an anchor, which is for sketches alone");
    }
    const auto last = last_id(frames, t);
    if (last && !frames[t].empty() && frames[t].vertices().front().id <= *last) {
      throw core::InputError(where + "vertex " + text(frames[t].vertices().front().id) +
                             " is not above the ids of the frames before (" + text(*last) + ")");
    }
    const std::vector<Link> links = all_links(motion, t);
    if (t == 0 && !links.empty()) {
      throw core::InputError(where + text(links.front()) + " comes from no frame");
    }
    if (t == 0) continue;
    try {
      validate_links(frames[t - 1], frames[t], links);
    } catch (const core::InputError& error) {
      throw core::InputError(where + error.what());
    }
  }
}

MotionGraph identify(MotionGraph motion) {
  validate(motion);
  std::uint32_t last = 0;
  std::vector<std::uint32_t> identity_before;
  Components parts_before;
  auto& frames = motion.sketch.frames;
  for (std::size_t t = 0; t < frames.size(); ++t) {
    Components parts = components(frames[t]);
    std::vector<std::uint32_t> identity(parts.count, 0);
    if (t > 0) {
      const detail::FrameLinks found = detail::index_links(frames[t - 1], frames[t], motion.links[t]);
      const auto pairs = detail::component_pairs(frames[t - 1], frames[t], parts_before, parts, found);
      std::vector<std::uint32_t> ties_before(parts_before.count, 0), ties(parts.count, 0);
      for (const auto& pair : pairs) ++ties_before[pair.before], ++ties[pair.after];
      for (const auto& pair : pairs) {
        if (ties_before[pair.before] == 1 && ties[pair.after] == 1) {
          identity[pair.after] = identity_before[pair.before];
        }
      }
    }
    for (std::uint32_t& id : identity) {
      if (id == 0) id = ++last;
    }
    std::vector<SubgraphId> of_vertex(frames[t].size());
    for (std::size_t i = 0; i < of_vertex.size(); ++i) of_vertex[i] = {identity[parts.of_vertex[i]]};
    frames[t] = frames[t].with_subgraphs(of_vertex);
    identity_before = std::move(identity);
    parts_before = std::move(parts);
  }
  return motion;
}

std::vector<Trajectory> trajectories(const MotionGraph& motion) {
  validate(motion);
  std::vector<Trajectory> result;
  std::vector<std::uint32_t> course_before;  // trajectory of each vertex of the frame before
  const auto& frames = motion.sketch.frames;
  for (std::size_t t = 0; t < frames.size(); ++t) {
    std::vector<std::uint32_t> course(frames[t].size(), kNoCourse);
    if (t > 0) {
      const detail::FrameLinks found = detail::index_links(frames[t - 1], frames[t], all_links(motion, t));
      // A patch that parts or joins goes on with the nearest one.
      std::vector<std::tuple<double, std::uint32_t, std::uint32_t>> nearest;
      for (const auto& [i, j] : found.links)
        nearest.emplace_back(distance(frames[t - 1].patch(i).position, frames[t].patch(j).position), i, j);
      std::ranges::sort(nearest);
      for (const auto& [way, i, j] : nearest) {
        if (course[j] != kNoCourse || course_before[i] == kNoCourse) continue;
        course[j] = std::exchange(course_before[i], kNoCourse);
      }
    }
    for (std::size_t j = 0; j < course.size(); ++j) {
      if (course[j] == kNoCourse) {
        course[j] = static_cast<std::uint32_t>(result.size());
        result.push_back({static_cast<int>(t), {}});
      }
      result[course[j]].vertices.push_back(frames[t].vertices()[j].id);
    }
    course_before = std::move(course);
  }
  return result;
}

}  // namespace emberfold::graph
