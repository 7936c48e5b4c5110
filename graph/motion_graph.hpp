// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "graph/attribute_graph.hpp"

namespace emberfold::graph {

/// The graphs of all frames of a clip. Vertex ids are unique in the clip and ascend from frame to frame.
struct SketchSequence {
  int width = 0, height = 0;  ///< px
  double fps = 25;
  std::vector<AttributeGraph> frames;

  /// Appends a frame, its vertices renumbered in their order to follow on those of the frame before (from 0
  /// in a first frame). InputError where the numbers would end.
  void append(const AttributeGraph& graph);
  bool operator==(const SketchSequence&) const = default;
};

/// One patch going on from frame t − 1 to t.
struct Link {
  VertexId before, after;
  auto operator<=>(const Link&) const = default;
};

/// The graphs of all frames and the links between neighbouring ones: links[t], sorted, join frame t − 1 to
/// frame t; links[0] is empty. Between two frames the links are a star forest: a vertex may have several
/// successors (a split) or several predecessors (a merge), but no link has a partner at both its ends.
struct MotionGraph {
  SketchSequence sketch;
  std::vector<std::vector<Link>> links;

  bool operator==(const MotionGraph&) const = default;
};

/// Throws InputError, naming the ids, where links miss an end, repeat, are unsorted or form no star forest.
void validate_links(const AttributeGraph& before, const AttributeGraph& after, std::span<const Link> links);

/// The same for all frames, naming the frame too; and that there is a list of links for every frame, the
/// first of them empty, and that ids ascend from frame to frame. O(n log n).
void validate(const MotionGraph& motion);

/// Gives every vertex its stroke's identity: a component keeps the identity of the one component it is linked
/// with as long as neither is linked with another; a component after a birth, split, merge, connect or
/// disconnect is a new stroke. Identities count from 1 in order of appearance.
MotionGraph identify(MotionGraph motion);

/// The course of one patch: the vertices that follow each other by links that are 1–1.
struct Trajectory {
  int first_frame = 0;
  std::vector<VertexId> vertices;  ///< one a frame
};
/// Every vertex lies in exactly one trajectory; ordered by first frame, then first vertex.
std::vector<Trajectory> trajectories(const MotionGraph& motion);

}  // namespace emberfold::graph
