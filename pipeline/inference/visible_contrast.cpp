// SPDX-License-Identifier: Apache-2.0
#include "pipeline/inference/visible_contrast.hpp"

#include <algorithm>
#include <cmath>

#include "core/math/luma.hpp"

namespace emberfold::pipeline {

namespace {

constexpr double kGamma = 2.2;   // screen gamma (sRGB as a power law)
constexpr double kFlare = 0.01;  // share of white: light that a screen reflects in a lit room

double luma_of(const graph::Level& level) {
  return core::luma(level[0], level[1], level[2]);
}

}  // namespace

double brightest_patch(const graph::SketchSequence& sketch) {
  double brightest = 0;
  for (const graph::AttributeGraph& graph : sketch.frames)
    for (const graph::Vertex& vertex : graph.vertices())
      for (const auto* level : {&vertex.patch.left, &vertex.patch.middle, &vertex.patch.right})
        brightest = std::max(brightest, luma_of(*level));
  return std::min(brightest, 255.0);
}

double visible_contrast(const graph::Patch& patch, double white) {
  const double level = 0.5 * luma_of(patch.middle) + 0.25 * (luma_of(patch.left) + luma_of(patch.right)),
               share = std::clamp(level / white, 0.0, 1.0);
  // The slope of ((share^γ + flare) / (1 + flare))^(1/γ).
  const double slope = std::pow(share, kGamma - 1) *
                       std::pow((std::pow(share, kGamma) + kFlare) / (1 + kFlare), 1 / kGamma - 1) /
                       (1 + kFlare);
  return std::abs(patch.contrast) * slope;
}

}  // namespace emberfold::pipeline
