// SPDX-License-Identifier: Apache-2.0
#include "dytex/surface/surface_layout.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "core/error.hpp"
#include "core/text/format_number.hpp"
#include "core/text/size_text.hpp"
#include "dytex/surface/mesh_edges.hpp"

namespace emberfold::dytex {

namespace {

constexpr int kLargestTexture = 16384;  // px
constexpr double kMostStretch = 16;     // source pixels a texel, or texels a source pixel
constexpr double kMostShear = 4;
constexpr double kOnEdge = 1e-6;  // px: centres this near an edge are on it

using TexelTriangle = std::array<cv::Point2d, 3>;

/// The corners of a mesh in px of the texture, whose first row is on top.
class TexturePlaces {
 public:
  TexturePlaces(const UvMesh& mesh, cv::Size size) : mesh_(mesh), size_(size) {}

  [[nodiscard]] cv::Point2d place(std::int32_t uv) const {
    const auto& p = mesh_.uvs[static_cast<std::size_t>(uv)];
    return {p.x * size_.width - 0.5, (1 - p.y) * size_.height - 0.5};
  }
  [[nodiscard]] TexelTriangle triangle(std::size_t t) const {
    const auto& corners = mesh_.triangles[t];
    return {place(corners[0].uv), place(corners[1].uv), place(corners[2].uv)};
  }
  [[nodiscard]] GluedSide side(const detail::MeshEdge& edge) const {
    return {edge.triangle, place(edge.uv_from), place(edge.uv_to)};
  }

 private:
  const UvMesh& mesh_;
  cv::Size size_;
};

double twice_texels(const TexelTriangle& at) {
  return (at[1] - at[0]).cross(at[2] - at[0]);
}

/// A triangle's position on the surface: its steps for a texel to the right and one down.
struct SurfaceSteps {
  cv::Point3d right, down;
  double texels = 0;  // its area in the texture; 0: it has none
  [[nodiscard]] double area() const { return cv::norm(right.cross(down)) * texels; }
};

SurfaceSteps steps_of(const UvMesh& mesh, std::size_t t, const TexelTriangle& at) {
  const auto point = [&](std::size_t k) {
    return mesh.points[static_cast<std::size_t>(mesh.triangles[t][k].point)];
  };
  const double twice = twice_texels(at);
  if (twice == 0) return {};
  const cv::Point2d e = at[1] - at[0], f = at[2] - at[0];
  const cv::Point3d p = point(1) - point(0), q = point(2) - point(0);
  return {(f.y * p - e.y * q) / twice, (e.x * q - f.x * p) / twice, std::abs(twice) / 2};
}

SurfaceFrame frame_of_steps(const SurfaceSteps& steps, double pixel) {
  if (steps.texels == 0) return {};
  const auto within = [](double stretch) { return std::clamp(stretch, 1 / kMostStretch, kMostStretch); };
  const double length = cv::norm(steps.right);
  SurfaceFrame frame;
  frame.across = within(length / pixel);
  frame.down = within(length > 0 ? cv::norm(steps.right.cross(steps.down)) / length / pixel : 0);
  const double shear = length > 0 ? steps.right.dot(steps.down) / length / pixel : 0;
  frame.shear = std::clamp(shear, -kMostShear * frame.down, kMostShear * frame.down);
  return frame;
}

// Calls take(x, inside) for the texels of a row whose centres a triangle covers, its border included.
template <class Take>
void cover_row(const TexelTriangle& at, int y, int width, const Take& take) {
  double left = width, right = -1;
  for (std::size_t k = 0; k < 3; ++k) {
    const cv::Point2d &a = at[k], &b = at[(k + 1) % 3];
    if (std::min(a.y, b.y) > y + kOnEdge || std::max(a.y, b.y) < y - kOnEdge) continue;
    const bool flat = std::abs(b.y - a.y) <= 2 * kOnEdge;
    const double share = flat ? 0 : std::clamp((y - a.y) / (b.y - a.y), 0.0, 1.0);
    const double begin = a.x + share * (b.x - a.x), end = flat ? b.x : begin;
    left = std::min({left, begin, end}), right = std::max({right, begin, end});
  }
  const int first = std::max(0, static_cast<int>(std::ceil(left - kOnEdge)));
  const int last = std::min(width - 1, static_cast<int>(std::floor(right + kOnEdge)));
  for (int x = first; x <= last; ++x) take(x, x > left + kOnEdge && x < right - kOnEdge);
}

void cover_texels(SurfaceLayout& layout, std::int32_t triangle, const TexelTriangle& at) {
  const double top = std::min({at[0].y, at[1].y, at[2].y}), bottom = std::max({at[0].y, at[1].y, at[2].y});
  const int first = std::max(0, static_cast<int>(std::ceil(top - kOnEdge)));
  const int last = std::min(layout.size.height - 1, static_cast<int>(std::floor(bottom + kOnEdge)));
  for (int y = first; y <= last; ++y)
    cover_row(at, y, layout.size.width, [&](int x, bool inside) {
      std::int32_t& there = layout.triangles[layout.index({x, y})];
      inside = inside && y > top + kOnEdge && y < bottom - kOnEdge;
      if (there < 0)
        there = triangle, ++layout.covered;
      else if (inside)
        ++layout.repeated;
    });
}

void check_texture(cv::Size size, double pixel) {
  if (std::min(size.width, size.height) < 1 || std::max(size.width, size.height) > kLargestTexture)
    throw core::InputError("the texture's size is " + core::size_text(size) +
                           "; allowed is 1 to 16384 each way");
  if (!(pixel >= 0 && std::isfinite(pixel)))
    throw core::InputError("the pixel on the surface is " + core::number_text(pixel) +
                           "; allowed is a size above 0, or 0 for that of a texel");
}

int count_hidden(const SurfaceLayout& layout) {
  std::vector<bool> seen(static_cast<std::size_t>(layout.chart_count));
  for (const std::int32_t t : layout.triangles)
    if (t >= 0) seen[static_cast<std::size_t>(layout.charts[static_cast<std::size_t>(t)])] = true;
  return static_cast<int>(std::ranges::count(seen, false));
}

}  // namespace

SurfaceLayout lay_out_surface(const UvMesh& mesh, cv::Size size, double pixel) {
  check_texture(size, pixel);
  const TexturePlaces places(mesh, size);
  std::vector<SurfaceSteps> steps;
  double area = 0, texels = 0;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    steps.push_back(steps_of(mesh, t, places.triangle(t)));
    area += steps.back().area(), texels += steps.back().texels;
  }
  if (!(area > 0)) throw core::InputError("the surface has no area that a texture covers");
  auto edges = detail::mesh_edges(mesh);
  SurfaceLayout layout;
  layout.size = size;
  layout.pixel = pixel > 0 ? pixel : std::sqrt(area / texels);
  layout.charts = std::move(edges.charts);
  layout.chart_count = edges.chart_count;
  layout.triangles.assign(static_cast<std::size_t>(size.area()), -1);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto at = places.triangle(t);
    layout.frames.push_back(frame_of_steps(steps[t], layout.pixel));
    layout.centres.push_back((at[0] + at[1] + at[2]) / 3);
    if (steps[t].texels > 0) cover_texels(layout, static_cast<std::int32_t>(t), at);
  }
  if (layout.covered == 0)
    throw core::InputError("the surface covers no texel of a texture of " + core::size_text(size));
  const auto has_area = [&](const detail::MeshEdge& edge) {
    return steps[static_cast<std::size_t>(edge.triangle)].texels > 0;
  };
  for (const auto& [a, b] : edges.glued)
    if (has_area(a) && has_area(b)) layout.glued.push_back({places.side(a), places.side(b)});
  layout.hidden_charts = count_hidden(layout);
  return layout;
}

}  // namespace emberfold::dytex
