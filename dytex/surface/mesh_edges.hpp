// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "dytex/surface/uv_mesh.hpp"

/// Edges that triangles share. Inner header of surfaces.
namespace emberfold::dytex::detail {

/// An edge of a triangle, from its point of lower index to the other one.
struct MeshEdge {
  std::int32_t from = 0, to = 0;        // points
  std::int32_t uv_from = 0, uv_to = 0;  // their places in the texture
  std::int32_t triangle = 0;
};
struct MeshEdgePair {
  MeshEdge a, b;
};

struct MeshEdges {
  std::vector<std::int32_t> charts;  // of each triangle: triangles that share an edge also in the texture
  int chart_count = 0;
  std::vector<MeshEdgePair> glued;  // shared by two triangles on the surface, but not in the texture
};

/// Finds charts, numbered in the order of their first triangles, and glued edges. Where more than two
/// triangles meet without sharing their edge in the texture, nothing is glued. O(n log n).
MeshEdges mesh_edges(const UvMesh& mesh);

}  // namespace emberfold::dytex::detail
