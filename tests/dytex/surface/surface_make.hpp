// SPDX-License-Identifier: Apache-2.0
// Small surfaces for the tests of surfaces.
#pragma once

#include <array>
#include <cmath>
#include <numbers>
#include <sstream>
#include <string>

#include "dytex/surface/surface_layout.hpp"

namespace emberfold::test {

inline dytex::UvMesh mesh_of(const std::string& text) {
  std::istringstream in(text);
  return dytex::read_obj(in, "mesh.obj");
}

/// A flat rectangle over the whole texture, `width` × `height` large.
inline std::string flat_obj(double width, double height) {
  std::ostringstream out;
  out << "v 0 0 0\nv " << width << " 0 0\nv " << width << ' ' << height << " 0\nv 0 " << height << " 0\n"
      << "vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nf 1/1 2/2 3/3 4/4\n";
  return out.str();
}

/// A flat rectangle, 2 × 1, of two charts with room around them. The right one is turned a quarter in the
/// texture.
inline std::string two_charts_obj() {
  return "v 0 0 0\nv 1 0 0\nv 2 0 0\nv 2 1 0\nv 1 1 0\nv 0 1 0\n"
         "vt 0.1 0.3\nvt 0.4 0.3\nvt 0.4 0.6\nvt 0.1 0.6\nf 1/1 2/2 5/3 6/4\n"
         "vt 0.6 0.6\nvt 0.6 0.3\nvt 0.9 0.3\nvt 0.9 0.6\nf 2/5 3/6 4/7 5/8\n";
}

/// A cube of six charts, three beside two, each with a margin.
inline std::string cube_obj() {
  std::ostringstream out;
  for (int i = 0; i < 8; ++i) out << "v " << (i & 1) << ' ' << ((i >> 1) & 1) << ' ' << (i >> 2) << '\n';
  constexpr std::array<std::array<int, 4>, 6> kFaces{
      {{1, 3, 4, 2}, {5, 6, 8, 7}, {1, 2, 6, 5}, {3, 7, 8, 4}, {1, 5, 7, 3}, {2, 4, 8, 6}}};
  for (std::size_t f = 0; f < 6; ++f) {
    const double x = static_cast<double>(f % 3) / 3, y = static_cast<double>(f / 3) / 2;
    for (const auto& [u, v] : {std::pair(0.05, 0.05), {0.95, 0.05}, {0.95, 0.95}, {0.05, 0.95}})
      out << "vt " << x + u / 3 << ' ' << y + v / 2 << '\n';
    out << 'f';
    for (std::size_t k = 0; k < 4; ++k) out << ' ' << kFaces[f][k] << "/-" << 4 - k;
    out << '\n';
  }
  return out.str();
}

/// A ball of radius 1 by longitude and latitude: one chart over the whole texture, with a seam.
inline std::string ball_obj(int across, int down) {
  std::ostringstream out;
  for (int j = 0; j <= down; ++j)
    for (int i = 0; i <= across; ++i) {
      const double u = static_cast<double>(i) / across, v = static_cast<double>(j) / down;
      const double turn = 2 * std::numbers::pi * (i % across) / across, lift = std::numbers::pi * (v - 0.5);
      const double ring = j == 0 || j == down ? 0 : std::cos(lift);
      out << "v " << ring * std::cos(turn) << ' ' << ring * std::sin(turn) << ' ' << std::sin(lift) << "\nvt "
          << u << ' ' << v << '\n';
    }
  for (int j = 0; j < down; ++j)
    for (int i = 0; i < across; ++i) {
      const int a = j * (across + 1) + i + 1, b = a + 1, c = b + across + 1, d = a + across + 1;
      out << 'f';
      for (const int k : {a, b, c, d}) out << ' ' << k << '/' << k;
      out << '\n';
    }
  return out.str();
}

/// The point of the surface at a texel's middle.
inline cv::Point3d point_at(const dytex::UvMesh& mesh, const dytex::SurfaceLayout& layout,
                            const cv::Point& texel) {
  const auto& corners = mesh.triangles[static_cast<std::size_t>(layout.triangles[layout.index(texel)])];
  const auto uv = [&](std::size_t k) { return mesh.uvs[static_cast<std::size_t>(corners[k].uv)]; };
  const auto point = [&](std::size_t k) { return mesh.points[static_cast<std::size_t>(corners[k].point)]; };
  const cv::Point2d at((texel.x + 0.5) / layout.size.width, 1 - (texel.y + 0.5) / layout.size.height);
  const cv::Point2d e = uv(1) - uv(0), f = uv(2) - uv(0), d = at - uv(0);
  const double area = e.cross(f), s = d.cross(f) / area, t = e.cross(d) / area;
  return point(0) + s * (point(1) - point(0)) + t * (point(2) - point(0));
}

}  // namespace emberfold::test
