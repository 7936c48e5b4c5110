// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string_view>

namespace emberfold::graph {

struct Point {
  double x = 0, y = 0;  ///< px; x right, y down, pixel centres at integers

  bool operator==(const Point&) const = default;
  Point operator+(Point o) const { return {x + o.x, y + o.y}; }
  Point operator-(Point o) const { return {x - o.x, y - o.y}; }
  Point operator*(double s) const { return {x * s, y * s}; }
};

inline double dot(Point a, Point b) {
  return a.x * b.x + a.y * b.y;
}
double norm(Point a);
double distance(Point a, Point b);

/// ℓ: what a patch shows.
enum class PatchType : std::uint8_t {
  ridge,
  valley,
  bar,
  step,
  double_ridge,
  corner,
  terminator,
  l_junction,
  t_junction,
  y_junction,
  crossing,
  blob
};

std::string_view name(PatchType type);
std::optional<PatchType> patch_type(std::string_view name);

/// A level of each channel (blue, green, red, or the grey level three times), white = 255.
using Level = std::array<float, 3>;

/// π = (ℓ, α, β): one oriented image patch. Its degree γ is the graph's to tell.
///
/// The profile across the patch, at signed distance d along the normal (−sin θ, cos θ), which points right of
/// the direction θ as the image is seen: a line has the level `left` for d ≪ 0, `middle` on a core of `width`
/// about d = 0, `right` for d ≫ 0, all blurred by a Gaussian of SD `blur`; a step has no core: `width` is 0
/// and `middle` the mean of both sides. A double ridge is a line whose core is hollow: two thin lines, and
/// `between` on `hollow` px about d = 0, blurred alike. A blob has no curve: it is a disc about `position`
/// that shows, at (a, d) along and across, an even ramp from `left` to `right` over its diameter, and on it,
/// in its centre, as much as `middle` differs from the ramp, falling off by a Gaussian of SD width / 2 +
/// blur.
struct Patch {
  PatchType type = PatchType::ridge;
  Point position;
  double theta = 0;     ///< rad, direction of the curve, in (−π, π]
  double width = 0;     ///< px, of the core before blurring
  double blur = 1;      ///< px, SD
  double contrast = 0;  ///< luma, signed: a line's peak, as seen, above the mean of its sides (ridge > 0 >
                        ///< valley); of a double ridge, that of its two lines; a step's right − left
  Level left{}, middle{}, right{};
  double hollow = 0;  ///< px, 0…width, of a double ridge; 0: a line of its core's level
  Level between{};    ///< where it is hollow
  double cost = 0;    ///< nats, ≥ 0: the description length of the numbers above; 0 where nobody counted
  double gain = 0;    ///< nats that showing the patch saves in coding its frame, the cost paid; likewise

  bool operator==(const Patch&) const = default;
};

/// Whether the patch lies on a step edge, whatever its place in the graph makes its type: a step has no core.
inline bool on_step(const Patch& patch) {
  return patch.width <= 0;
}

/// Whether two patches may be the same thing at different times: lines of one sign, or steps.
bool same_kind(const Patch& a, const Patch& b);

/// The angle between two undirected orientations, 0…π/2.
double orientation_difference(double theta_a, double theta_b);

}  // namespace emberfold::graph
