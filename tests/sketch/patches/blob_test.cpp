// SPDX-License-Identifier: Apache-2.0
#include "sketch/patches/blob.hpp"

#include <cmath>
#include <numbers>

#include <opencv2/core.hpp>

#include "core/math/luma.hpp"
#include "sketch/patches/blob_shape.hpp"
#include "tests/support/catch.hpp"

using namespace emberfold;
using namespace emberfold::test;

TEST_CASE("A blob on a ramp is fitted exactly, whichever way the ramp rises") {
  constexpr double kReach = 6, kLevel = 100, kSlope = 4, kBump = 50;
  const cv::Point centre(20, 17);
  for (const double rises : {0.0, 0.9, 1.7, 3.0, -2.2, -1.0}) {
    cv::Mat1f levels(40, 44);
    for (int y = 0; y < levels.rows; ++y)
      for (int x = 0; x < levels.cols; ++x) {
        const double dx = x - centre.x, dy = y - centre.y;
        levels(y, x) = static_cast<float>(kLevel + kSlope * (dx * std::cos(rises) + dy * std::sin(rises)) +
                                          kBump * std::exp(-0.5 * (dx * dx + dy * dy) / (4 * 4)));
      }
    const auto blob = sketch::fit_blob(levels, centre, kReach);
    CAPTURE(rises);
    CHECK(blob.type == graph::PatchType::blob);
    // Its right, along the normal (−sin θ, cos θ), is the brighter side.
    CHECK_THAT(-std::sin(blob.theta), WithinAbs(std::cos(rises), 1e-4));
    CHECK_THAT(std::cos(blob.theta), WithinAbs(std::sin(rises), 1e-4));
    for (std::size_t c = 0; c < 3; ++c) {
      CHECK_THAT(double{blob.left[c]}, WithinAbs(kLevel - kSlope * kReach, 0.01));
      CHECK_THAT(double{blob.right[c]}, WithinAbs(kLevel + kSlope * kReach, 0.01));
      CHECK_THAT(double{blob.middle[c]}, WithinAbs(kLevel + kBump, 0.01));
    }
    CHECK_THAT(blob.contrast, WithinAbs(kBump, 0.01));
    CHECK_THAT(blob.width / 2 + blob.blur, WithinAbs(4, 1e-9));
    CHECK_THAT(sketch::BlobShape(blob).reach(), WithinAbs(kReach, 1e-9));
  }
}

TEST_CASE("A blob's contrast is that of luma, where its channels differ") {
  cv::Mat3f levels(40, 40);
  const cv::Vec3d bump(20, -30, 60);
  for (int y = 0; y < levels.rows; ++y)
    for (int x = 0; x < levels.cols; ++x) {
      const double height = std::exp(-0.5 * (std::pow(x - 20, 2) + std::pow(y - 20, 2)) / 16);
      for (int c = 0; c < 3; ++c) levels(y, x)[c] = static_cast<float>(90 + bump[c] * height + 2 * (y - 20));
    }
  const auto blob = sketch::fit_blob(levels, {20, 20}, 6);
  CHECK_THAT(blob.contrast, WithinAbs(core::luma(bump[0], bump[1], bump[2]), 0.01));
  for (int c = 0; c < 3; ++c) {
    const auto k = static_cast<std::size_t>(c);
    CHECK_THAT(double{blob.middle[k]}, WithinAbs(90 + bump[c], 0.01));
    CHECK_THAT(double{blob.right[k]}, WithinAbs(90 + 12, 0.01));
  }
}

TEST_CASE("The levels that a blob shows are its middle at the centre and its ramp elsewhere") {
  graph::Patch blob;
  blob.type = graph::PatchType::blob;
  blob.width = 2, blob.blur = 1, blob.theta = 0.7;
  const sketch::BlobShape shape(blob);
  const double nx = -std::sin(blob.theta), ny = std::cos(blob.theta);
  CHECK_THAT(shape.reach(), WithinAbs(3, 1e-12));
  CHECK_THAT(shape.at(0, 0).middle, WithinAbs(1, 1e-12));
  for (const double d : {-3.0, -1.0, 0.5, 2.0, 3.0}) {
    const auto shares = shape.at(d * nx, d * ny);
    const double bump = std::exp(-0.5 * d * d / (2 * 2)), right = 0.5 + d / 6;
    CHECK_THAT(shares.middle, WithinAbs(bump, 1e-12));
    CHECK_THAT(shares.right, WithinAbs(right - bump / 2, 1e-12));
    CHECK_THAT(shares.left + shares.middle + shares.right, WithinAbs(1, 1e-12));
  }
}
