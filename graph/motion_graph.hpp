// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "graph/attribute_graph.hpp"

namespace emberfold::graph {

/// The attribute graphs of all frames of a clip.
/// Vertex ids are unique in the clip and ascend from frame to frame.
struct SketchSequence {
  int width = 0, height = 0;  ///< px
  double fps = 25;            ///< frames a second, > 0
  std::vector<AttributeGraph> frames;

  /// Appends a frame and renumbers its vertices, in order, after those of the frames before.
  /// The first frame's begin at 0. Throws InputError when 32 bits do not suffice.
  void append(const AttributeGraph& graph);
  bool operator==(const SketchSequence&) const = default;
};

/// A link from a patch in frame t − 1 to one in frame t.
struct Link {
  VertexId before, after;
  auto operator<=>(const Link&) const = default;
};

/// A sketch sequence with the links between neighbouring frames.
/// links[t], sorted, join frame t − 1 to frame t; links[0] is empty. Between two frames the links form a star
/// forest: a vertex may have several successors (a split) or several predecessors (a merge), but no link has
/// a competing link at both of its ends. Its frames hold no anchors.
struct MotionGraph {
  SketchSequence sketch;
  std::vector<std::vector<Link>> links;
  /// Further links, which complete those to a star forest (link_skipped_patches); empty, or a sorted list a
  /// frame. They are written and make trajectories; events, curves and models are read off the others.
  std::vector<std::vector<Link>> skipped = {};

  bool operator==(const MotionGraph&) const = default;
};

/// Returns the links of both kinds from the frame before, sorted.
std::vector<Link> all_links(const MotionGraph& motion, std::size_t frame);

/// Checks the links between two frames.
/// Throws InputError, naming the ids, if links miss an end, repeat, are unsorted or form no star forest.
void validate_links(const AttributeGraph& before, const AttributeGraph& after, std::span<const Link> links);

/// Checks a whole motion graph: every list of links, their number, that ids ascend from frame to frame, and
/// that there are no anchors.
/// Throws InputError, naming frame and ids. O(n log n).
void validate(const MotionGraph& motion);

/// Assigns every vertex the identity of its stroke.
/// A component keeps its identity while it is linked with one component only, and that one with no other.
/// After a birth, split, merge, connect or disconnect it is a new stroke. Identities count from 1 in order of
/// appearance. Throws InputError as validate() does. O(n log n).
MotionGraph identify(MotionGraph motion);

/// The trajectory of one patch: vertices that follow each other by links, where patches part or join by the
/// shortest.
struct Trajectory {
  int first_frame = 0;
  std::vector<VertexId> vertices;  ///< one a frame
};
/// Splits a motion graph into trajectories; every vertex lies in exactly one.
/// Ordered by first frame, then first vertex. Throws InputError as validate() does.
std::vector<Trajectory> trajectories(const MotionGraph& motion);

}  // namespace emberfold::graph
