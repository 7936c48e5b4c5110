// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

#include "graph/motion_graph.hpp"

namespace emberfold::graph::detail {

/// What a line of sketch.jsonl or motion.jsonl holds, as it stands there.
struct FrameLine {
  std::uint32_t frame = 0;
  std::vector<Vertex> vertices;
  std::vector<Edge> edges;
  std::vector<Link> links;
  bool has_links = false;
};

/// Reads one line. Takes memory for what is there, never for what is promised; keys it does not know are
/// passed over. IoError (no prefix) for anything else than a frame.
FrameLine parse_frame_line(std::string_view text);

}  // namespace emberfold::graph::detail
