// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

#include "graph/motion_graph.hpp"

namespace emberfold::graph::detail {

/// The unchecked content of one line of sketch.jsonl or motion.jsonl.
struct FrameLine {
  std::uint32_t frame = 0;
  std::vector<Vertex> vertices;
  std::vector<Edge> edges;
  std::vector<Link> links, skipped;
  bool has_links = false;
};

/// Parses one line of a clip of `width` × `height` px; unknown keys are ignored.
/// Memory is bounded by the length of the text. Throws IoError (without a prefix) unless it is a frame.
FrameLine parse_frame_line(std::string_view text, int width, int height);

}  // namespace emberfold::graph::detail
