// SPDX-License-Identifier: Apache-2.0
#include "graph/morphing/patch_blend.hpp"

#include <cmath>
#include <numbers>
#include <utility>

namespace emberfold::graph::detail {

namespace {

Level mix(const Level& a, const Level& b, double share) {
  Level result;
  for (std::size_t c = 0; c < result.size(); ++c)
    result[c] = static_cast<float>((1 - share) * double{a[c]} + share * double{b[c]});
  return result;
}

}  // namespace

double wrap_angle(double angle) {
  using std::numbers::pi;
  const double turned = std::remainder(angle, 2 * pi);
  return turned <= -pi ? pi : turned;
}

Patch turn_round(Patch patch) {
  patch.theta = wrap_angle(patch.theta + std::numbers::pi);
  std::swap(patch.left, patch.right);
  if (on_step(patch)) patch.contrast = -patch.contrast;
  return patch;
}

Patch blend_patches(const Patch& a, const Patch& b, double share, double turn) {
  const auto mixed = [share](double from, double to) { return (1 - share) * from + share * to; };
  Patch result = share < 0.5 ? a : b;
  result.position = a.position * (1 - share) + b.position * share;
  result.theta = wrap_angle(a.theta + share * turn);
  result.width = mixed(a.width, b.width);
  result.blur = mixed(a.blur, b.blur);
  result.contrast = mixed(a.contrast, b.contrast);
  result.left = mix(a.left, b.left, share);
  result.middle = mix(a.middle, b.middle, share);
  result.right = mix(a.right, b.right, share);
  result.cost = mixed(a.cost, b.cost);
  result.gain = mixed(a.gain, b.gain);
  result.evidence = mixed(a.evidence, b.evidence);
  return result;
}

Patch patch_between(const Patch& a, const Patch& b, double share) {
  constexpr double kSame = 1e-9;
  if (share < kSame) return a;
  if (share > 1 - kSame) return b;
  Patch result = blend_patches(a, b, share, wrap_angle(b.theta - a.theta));
  result.type = on_step(result)        ? PatchType::step
                : result.contrast >= 0 ? PatchType::ridge
                                       : PatchType::valley;
  return result;
}

}  // namespace emberfold::graph::detail
