// SPDX-License-Identifier: Apache-2.0
#include "sketch/patches/patch_smoothing.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include "core/rng.hpp"
#include "tests/support/catch.hpp"

using namespace emberfold;
using namespace emberfold::test;

namespace {

constexpr double kSpacing = 5;

graph::Patch patch_at(graph::Point position, double theta, double contrast, double width = 1) {
  graph::Patch patch;
  patch.position = position, patch.theta = theta, patch.contrast = contrast;
  patch.width = width, patch.blur = 1;
  patch.left = {60, 60, 60}, patch.right = {80, 80, 80}, patch.middle = {150, 150, 150};
  return patch;
}

graph::AttributeGraph chain(const std::vector<graph::Patch>& patches, bool ring = false) {
  std::vector<graph::Vertex> vertices;
  std::vector<graph::Edge> edges;
  for (std::uint32_t i = 0; i < patches.size(); ++i) {
    vertices.push_back({{i}, {}, patches[i]});
    if (i > 0) edges.push_back({{i - 1}, {i}});
  }
  if (ring) edges.push_back({{0}, {static_cast<std::uint32_t>(patches.size() - 1)}});
  return {std::move(vertices), std::move(edges)};
}

/// A level line, its patches off it by so much.
std::vector<graph::Patch> level_line(const std::vector<double>& off, double contrast, double width = 1) {
  std::vector<graph::Patch> patches;
  for (std::size_t i = 0; i < off.size(); ++i)
    patches.push_back(patch_at({20 + kSpacing * static_cast<double>(i), 40 + off[i]}, 0, contrast, width));
  return patches;
}

std::vector<double> jitter(std::size_t count, double size, std::uint64_t seed) {
  core::Rng rng(seed);
  std::vector<double> off(count);
  for (double& value : off) value = rng.uniform(-size, size);
  return off;
}

/// Visible share of a line's core of this width under a blur of 1 px.
double core_share(double width) {
  return std::erf(width / (2 * std::numbers::sqrt2));
}

}  // namespace

TEST_CASE("A faint curve loses its jitter, a strong one stays where it was found") {
  const auto off = jitter(30, 0.6, 1);
  const auto faint = sketch::smooth_patches(chain(level_line(off, 4)), 2);
  const auto strong = sketch::smooth_patches(chain(level_line(off, 250)), 0.05);
  double rough = 0, smooth = 0;
  for (std::uint32_t i = 1; i + 1 < off.size(); ++i) {
    const auto second = [&](auto place) { return place(i - 1) - 2 * place(i) + place(i + 1); };
    rough += std::pow(second([&](std::uint32_t k) { return off[k]; }), 2);
    smooth += std::pow(second([&](std::uint32_t k) { return faint.patch(k).position.y; }), 2);
    CHECK_THAT(strong.patch(i).position.y, WithinAbs(40 + off[i], 0.02));
    CHECK_THAT(faint.patch(i).position.x, WithinAbs(20 + kSpacing * i, 1e-9));
  }
  CHECK(smooth < 0.04 * rough);
}

TEST_CASE("Smoothing is the same from either end of a curve, and wherever a ring begins") {
  auto patches = level_line(jitter(24, 0.6, 2), 6);
  const auto there = sketch::smooth_patches(chain(patches), 2);
  std::ranges::reverse(patches);
  const auto back = sketch::smooth_patches(chain(patches), 2);
  const auto last = static_cast<std::uint32_t>(patches.size() - 1);
  for (std::uint32_t i = 0; i <= last; ++i)
    CHECK_THAT(graph::distance(there.patch(i).position, back.patch(last - i).position), WithinAbs(0, 1e-6));

  std::vector<graph::Patch> round;
  core::Rng rng(3);
  for (int i = 0; i < 24; ++i) {
    const double angle = 2 * std::numbers::pi * i / 24, radius = 20 + rng.uniform(-0.6, 0.6);
    round.push_back(patch_at(graph::Point{60, 60} + graph::Point{std::cos(angle), std::sin(angle)} * radius,
                             angle + std::numbers::pi / 2, 6));
  }
  const auto ring = sketch::smooth_patches(chain(round, true), 2);
  std::rotate(round.begin(), round.begin() + 9, round.end());
  const auto turned = sketch::smooth_patches(chain(round, true), 2);
  for (std::uint32_t i = 0; i < 24; ++i)
    CHECK_THAT(graph::distance(ring.patch((i + 9) % 24).position, turned.patch(i).position),
               WithinAbs(0, 1e-6));
}

// Of 6 px of the curve: noise / √(6 ∫ slope²). A Gaussian ridge c exp(−x²/2s²) has ∫ slope² = c² √π / 2s, a
// blurred step c² / (2 s √π).
TEST_CASE("A patch far off moves by three standard errors of its place") {
  constexpr double kNoise = 3, kContrast = 20, kOff = 12;
  for (const double width : {1.0, 0.0}) {
    std::vector<double> off(21, 0);
    off[10] = kOff;
    const auto graph = sketch::smooth_patches(chain(level_line(off, kContrast, width)), kNoise);
    const double spread = std::sqrt(1 + width * width / 12), root = std::sqrt(std::numbers::pi);
    const double slopes = kContrast * kContrast * (width > 0 ? root / (2 * spread) : 1 / (2 * spread * root));
    const double error = kNoise / std::sqrt(6 * slopes);
    CAPTURE(width);
    CHECK_THAT(graph.patch(10).position.y, WithinAbs(40 + kOff - 3 * error, 1e-9));
  }
}

TEST_CASE("Where a line's width is evened, what is seen of its contrast stays") {
  auto patches = level_line(std::vector<double>(20, 0), 8);
  for (std::size_t i = 0; i < patches.size(); ++i) patches[i].width = i % 2 == 0 ? 1 : 3;
  const auto graph = sketch::smooth_patches(chain(patches), 3);
  for (std::uint32_t i = 0; i < patches.size(); ++i) {
    const auto& patch = graph.patch(i);
    CHECK_THAT(patch.width, WithinAbs(2, 0.5));
    CHECK_THAT(patch.blur, WithinAbs(1, 1e-9));
    CHECK_THAT(core_share(patch.width) * (double{patch.middle[0]} - 70),
               WithinAbs(core_share(patches[i].width) * 80, 1e-3));
  }
}
