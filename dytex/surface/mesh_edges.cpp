// SPDX-License-Identifier: Apache-2.0
#include "dytex/surface/mesh_edges.hpp"

#include <algorithm>
#include <tuple>
#include <vector>

#include <boost/pending/disjoint_sets.hpp>

namespace emberfold::dytex::detail {

namespace {

std::vector<MeshEdge> sorted_edges(const UvMesh& mesh) {
  std::vector<MeshEdge> edges;
  edges.reserve(3 * mesh.triangles.size());
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    for (std::size_t k = 0; k < 3; ++k) {
      const UvCorner &a = mesh.triangles[t][k], &b = mesh.triangles[t][(k + 1) % 3];
      if (a.point == b.point) continue;
      const UvCorner &low = a.point < b.point ? a : b, &high = a.point < b.point ? b : a;
      edges.push_back({low.point, high.point, low.uv, high.uv, static_cast<std::int32_t>(t)});
    }
  std::ranges::sort(
      edges, {}, [](const MeshEdge& e) { return std::tuple(e.from, e.to, e.uv_from, e.uv_to, e.triangle); });
  return edges;
}

bool joined(const MeshEdge& a, const MeshEdge& b) {
  return a.from == b.from && a.to == b.to;
}

bool joined_in_texture(const MeshEdge& a, const MeshEdge& b) {
  return joined(a, b) && a.uv_from == b.uv_from && a.uv_to == b.uv_to;
}

}  // namespace

MeshEdges mesh_edges(const UvMesh& mesh) {
  const auto edges = sorted_edges(mesh);
  std::vector<std::size_t> rank(mesh.triangles.size()), parent(mesh.triangles.size());
  boost::disjoint_sets sets(rank.data(), parent.data());
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) sets.make_set(t);
  MeshEdges found;
  for (std::size_t begin = 0, end = 0; begin < edges.size(); begin = end) {
    std::vector<MeshEdge> open;  // alone in the texture
    while (end < edges.size() && joined(edges[begin], edges[end])) {
      const std::size_t first = end;
      while (end < edges.size() && joined_in_texture(edges[first], edges[end]))
        sets.union_set(static_cast<std::size_t>(edges[first].triangle),
                       static_cast<std::size_t>(edges[end++].triangle));
      if (end - first == 1) open.push_back(edges[first]);
    }
    const bool pair =
        open.size() == 2 && open[0].uv_from != open[0].uv_to && open[1].uv_from != open[1].uv_to;
    if (pair) found.glued.push_back({open[0], open[1]});
  }
  std::vector<std::int32_t> number(mesh.triangles.size(), -1);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    std::int32_t& chart = number[sets.find_set(t)];
    if (chart < 0) chart = found.chart_count++;
    found.charts.push_back(chart);
  }
  return found;
}

}  // namespace emberfold::dytex::detail
