// SPDX-License-Identifier: Apache-2.0
#include "pipeline/inference/visible_contrast.hpp"

#include <cmath>

#include "tests/support/catch.hpp"

using namespace emberfold;
using Catch::Matchers::WithinAbs;

namespace {

graph::Patch line(double ground, double peak, double contrast) {
  graph::Patch patch;
  patch.width = 3;
  const auto grey = [](double level) {
    const auto v = static_cast<float>(level);
    return graph::Level{v, v, v};
  };
  patch.left = patch.right = grey(ground);
  patch.middle = grey(peak);
  patch.contrast = contrast;
  return patch;
}

/// Lightness of a share of white on a screen that reflects a hundredth of it.
double lightness(double share) {
  return std::pow((std::pow(share, 2.2) + 0.01) / 1.01, 1 / 2.2);
}

}  // namespace

TEST_CASE("visible contrast: a step of lightness, with the light that a screen reflects", "[pipeline]") {
  constexpr double kWhite = 200;
  for (const double level : {2., 8., 16., 40., 100., 180.}) {
    const graph::Patch patch = line(level - 1, level + 1, 2);
    const double step = lightness((level + 1) / kWhite) - lightness((level - 1) / kWhite);
    CHECK_THAT(pipeline::visible_contrast(patch, kWhite), WithinAbs(kWhite * step, 0.01));
  }
  CHECK(pipeline::visible_contrast(line(8, 12, 4), kWhite) < 0.35 * 4);
  CHECK(pipeline::visible_contrast(line(90, 130, 30), kWhite) > 0.95 * 30);
  CHECK(pipeline::visible_contrast(line(130, 90, -30), kWhite) ==
        pipeline::visible_contrast(line(90, 130, 30), kWhite));
}

TEST_CASE("visible contrast: what is beyond black and white counts as these", "[pipeline]") {
  CHECK(pipeline::visible_contrast(line(-20, -4, 16), 255) == 0);
  CHECK_THAT(pipeline::visible_contrast(line(300, 280, -16), 255), WithinAbs(16 / 1.01, 1e-9));
}

TEST_CASE("visible contrast: the brightest part of any patch is white", "[pipeline]") {
  graph::SketchSequence sketch{100, 100, 25, {}};
  CHECK(pipeline::brightest_patch(sketch) == 0);
  sketch.frames.push_back(
      graph::AttributeGraph({{{0}, {}, line(20, 60, 40)}, {{1}, {}, line(90, 30, -60)}}, {}));
  CHECK_THAT(pipeline::brightest_patch(sketch), WithinAbs(90, 1e-5));
  sketch.frames.push_back(graph::AttributeGraph({{{0}, {}, line(20, 400, 380)}}, {}));
  CHECK(pipeline::brightest_patch(sketch) == 255);
}
