// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <iosfwd>
#include <string_view>
#include <vector>

#include <opencv2/core/types.hpp>

namespace emberfold::dytex {

/// A corner of a triangle by index: a point of the surface, and its place in the texture.
struct UvCorner {
  std::int32_t point = 0, uv = 0;
  bool operator==(const UvCorner&) const = default;
};

/// A surface of triangles over which a texture is laid.
struct UvMesh {
  std::vector<cv::Point3d> points;  ///< all different, in the mesh's own unit
  std::vector<cv::Point2d> uvs;  ///< all different, 0 … 1, right and up from the texture's lower left corner
  std::vector<std::array<UvCorner, 3>> triangles;
};

/// Reads a surface from a Wavefront OBJ file: `v`, `vt` and `f`. Polygons become triangles; repeated points
/// and places in the texture become one. Skips normals, groups and materials. Throws IoError, with `name` and
/// the line, for anything else, a face without or with a place beyond 0 … 1, and more than 2²⁴ points, places
/// or triangles. O(n log n).
UvMesh read_obj(std::istream& in, std::string_view name);

/// Writes points, places and triangles as an OBJ file; read_obj() gives the same mesh.
void write_obj(std::ostream& out, const UvMesh& mesh);

}  // namespace emberfold::dytex
