// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
#include <string_view>

namespace emberfold::graph {

/// A point or vector in the image plane.
struct Point {
  double x = 0, y = 0;  ///< px; x right, y down, pixel centres at integers

  bool operator==(const Point&) const = default;
  Point operator+(Point o) const { return {x + o.x, y + o.y}; }
  Point operator-(Point o) const { return {x - o.x, y - o.y}; }
  Point operator*(double s) const { return {x * s, y * s}; }
};

/// Returns the scalar product.
inline double dot(Point a, Point b) {
  return a.x * b.x + a.y * b.y;
}
/// Returns the Euclidean length.
inline double norm(Point a) {
  return std::sqrt(dot(a, a));
}
/// Returns the Euclidean distance.
inline double distance(Point a, Point b) {
  return norm(a - b);
}

/// The type ℓ of a patch.
enum class PatchType : std::uint8_t {
  ridge,
  valley,
  bar,
  step,
  corner,
  terminator,
  l_junction,
  t_junction,
  y_junction,
  crossing,
  anchor
};

/// Returns the name of a type as files write it.
std::string_view name(PatchType type);
/// Returns the type of this name, if there is one.
std::optional<PatchType> patch_type(std::string_view name);

/// Levels of blue, green and red (equal for a grey clip), white = 255.
using Level = std::array<float, 3>;

/// One oriented image patch π = (ℓ, α, β); its degree γ follows from the graph.
///
/// The normal (−sin θ, cos θ) points to the right of the direction θ on the screen; d is the signed distance
/// along it. By type, the profile across the patch is
/// - line: `left` for d ≪ 0, `middle` on a core of `width` px about d = 0, `right` for d ≫ 0, blurred by a
///   Gaussian of SD `blur`;
/// - step: the same without a core; `width` is 0 and `middle` the mean of both sides;
/// - anchor: no part of a stroke, but the pixel nearest to `position`, which has the level `middle`.
struct Patch {
  PatchType type = PatchType::ridge;
  Point position;
  double theta = 0;     ///< rad, direction of the curve, in (−π, π]
  double width = 0;     ///< px, of the core before blurring
  double blur = 1;      ///< px, SD
  double contrast = 0;  ///< luma, signed: blurred peak of a line above the mean of its sides (ridge > 0 >
                        ///< valley); right − left of a step
  Level left{}, middle{}, right{};
  double cost = 0;      ///< nats, ≥ 0: description length of the numbers above; 0: not computed
  double gain = 0;      ///< nats saved in coding the frame, less the cost; 0: not computed
  double evidence = 0;  ///< nats, ≥ 0: for the curve that the patch lies on, against texture; 0: not computed

  bool operator==(const Patch&) const = default;
};

/// Returns an anchor; its other numbers are those of a new patch.
Patch make_anchor(Point pixel, const Level& level);

/// Returns whether the patch is an anchor.
inline bool is_anchor(const Patch& patch) {
  return patch.type == PatchType::anchor;
}

/// Returns whether the patch lies on a step edge, which has no core, whatever its type.
inline bool on_step(const Patch& patch) {
  return patch.width <= 0;
}

/// The longest gap in a line, px: of two steps that are farther apart nothing is seen between them.
constexpr double kLongestGap = 30;

/// Returns whether an edge between two patches only tells that both belong to one thing: both lie on steps,
/// and neither step runs along the edge (within 50°), or they are more than `kLongestGap` apart.
bool joins_outlines(const Patch& a, const Patch& b);

/// Returns whether the patch only closes an outline, along the picture's border: a step without contrast.
bool closes_at_border(const Patch& patch);

/// Returns whether something is seen along an edge between two patches: it neither joins outlines nor runs
/// along the picture's border.
bool is_seen(const Patch& a, const Patch& b);

/// Returns whether two patches can be linked in time: both lines of one sign, or both steps.
bool same_kind(const Patch& a, const Patch& b);

/// Returns the angle between two undirected orientations, rad, 0…π/2.
double orientation_difference(double theta_a, double theta_b);

}  // namespace emberfold::graph
