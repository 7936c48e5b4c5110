// SPDX-License-Identifier: Apache-2.0
#include "sketch/refinement/coding_length.hpp"

#include <limits>
#include <numbers>

#include <opencv2/imgproc.hpp>

#include "core/clip.hpp"
#include "core/error.hpp"
#include "sketch/inpainting/fill.hpp"
#include "sketch/patches/profile.hpp"
#include "sketch/rendering/render.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/sketch_scene.hpp"

using namespace emberfold;
using namespace emberfold::sketch;
using namespace emberfold::test;

namespace {

graph::Level grey(double level) {
  const auto l = static_cast<float>(level);
  return {l, l, l};
}

graph::Patch line_patch(Point at, double theta, double left, double middle, double right) {
  graph::Patch patch;
  patch.position = at;
  patch.theta = theta;
  patch.width = 3;
  patch.blur = 1;
  patch.left = grey(left), patch.middle = grey(middle), patch.right = grey(right);
  patch.contrast = middle - (left + right) / 2;
  return patch;
}

graph::Patch step_patch(Point at, double theta, double left, double right) {
  graph::Patch patch = line_patch(at, theta, left, (left + right) / 2, right);
  patch.type = graph::PatchType::step;
  patch.width = 0;
  patch.contrast = right - left;
  return patch;
}

/// Nine patches in a row through the middle, drawn and filled.
struct Drawn {
  std::vector<graph::Patch> patches;
  cv::Mat1f frame;
};
Drawn draw_row(const graph::Patch& middle, cv::Size size) {
  Drawn drawn;
  std::vector<graph::Vertex> vertices;
  std::vector<graph::Edge> edges;
  for (std::uint32_t i = 0; i < 9; ++i) {
    graph::Patch patch = middle;
    patch.position = middle.position + unit(middle.theta) * (5.0 * (i - 4.0));
    drawn.patches.push_back(patch);
    vertices.push_back({graph::VertexId{i}, {}, patch});
    if (i > 0) edges.push_back({graph::VertexId{i - 1}, graph::VertexId{i}});
  }
  const auto part = draw_fitted({vertices, edges}, size, 1);
  drawn.frame = fill(part.levels, part.mask).levels;
  return drawn;
}

cv::Mat1f flat(cv::Size size, double level) {
  return {size, static_cast<float>(level)};
}

/// The share of patches, fitted to a frame at places of chance, that gain.
double false_alarms(const std::vector<cv::Mat1f>& frames, int count) {
  using sketch::fit_patch;
  core::Rng rng(11);
  int alarms = 0, all = 0;
  for (const auto& frame : frames) {
    const CodingContext prepared = prepare_coding(frame);
    for (int i = 0; i < count; ++i, ++all) {
      const Point at{rng.uniform(15, frame.cols - 16), rng.uniform(15, frame.rows - 16)};
      const auto kind = i % 3 == 0 ? CreaseKind::ridge : i % 3 == 1 ? CreaseKind::valley : CreaseKind::step;
      const auto patch = fit_patch(frame, at, rng.uniform(-std::numbers::pi, std::numbers::pi), kind,
                                   rng.uniform(1.2, 4), 5);
      alarms += coding_gain(prepared, patch) > 0 ? 1 : 0;
    }
  }
  return static_cast<double>(alarms) / all;
}

/// White noise of SD 10 on a plane.
cv::Mat1f noisy_plane(std::uint64_t seed) {
  core::Rng rng(seed);
  cv::Mat1f frame(300, 300);
  for (int y = 0; y < frame.rows; ++y)
    for (int x = 0; x < frame.cols; ++x)
      frame(y, x) = static_cast<float>(0.2 * x + 0.5 * y + 10 * rng.normal());
  return frame;
}

}  // namespace

TEST_CASE("a drawn patch gains at its place and less the farther it is moved or turned") {
  const cv::Size size{96, 96};
  for (const auto& patch :
       {line_patch({48.3, 47.6}, 0.4, 60, 140, 60), line_patch({47.1, 48}, -1.1, 90, 40, 70),
        line_patch({48, 48}, 1.9, 30, 90, 80), step_patch({48.3, 47.6}, 0.4, 50, 110)}) {
    const Drawn drawn = draw_row(patch, size);
    const CodingContext frame = prepare_coding(with_noise(drawn.frame, 3, 5));
    for (const auto& one : drawn.patches) CHECK(coding_gain(frame, one) > 20);
    const Point across{-std::sin(patch.theta), std::cos(patch.theta)};
    for (const double side : {-1.0, 1.0}) {
      double before = coding_gain(frame, patch);
      for (const double by : {0.75, 1.5, 2.25, 3.0}) {
        graph::Patch moved = patch;
        moved.position = patch.position + across * (side * by);
        const double gain = coding_gain(frame, moved);
        CHECK(gain < before);
        before = gain;
      }
      before = coding_gain(frame, patch);
      for (const double by : {0.3, 0.6, 0.9, 1.2}) {
        graph::Patch turned = patch;
        turned.theta += side * by;
        const double gain = coding_gain(frame, turned);
        CHECK(gain < before);
        before = gain;
      }
    }
    graph::Patch far = patch;
    far.position = patch.position + across * 20;
    CHECK(coding_gain(frame, far) < 0);
    graph::Patch opposite = patch;
    std::swap(opposite.left, opposite.right);
    opposite.middle = grey(double{patch.left[0]} + double{patch.right[0]} - double{patch.middle[0]});
    CHECK(coding_gain(frame, opposite) < 0);
  }
}

TEST_CASE(
    "patches fitted to white noise gain less than once in a thousand times and to clumped noise in a "
    "hundred") {
  std::vector<cv::Mat1f> white, clumped;
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    white.push_back(with_noise(flat({160, 120}, 100), seed == 1 ? 0.6 : 5.0 * double(seed), seed));
    cv::Mat1f soft;
    cv::GaussianBlur(with_noise(flat({160, 120}, 0), 20, seed), soft, {}, 0.4 + 0.4 * double(seed));
    soft += 100;
    clumped.push_back(soft);
  }
  CHECK(false_alarms(white, 4000) < 0.001);
  CHECK(false_alarms(clumped, 4000) < 0.01);
}

TEST_CASE("the noise of a frame is measured beside its strokes") {
  const Drawn drawn = draw_row(line_patch({100, 60}, 0.3, 50, 160, 70), {200, 120});
  for (const double sd : {1.0, 4.0, 12.0}) {
    const CodingContext frame = prepare_coding(with_noise(drawn.frame, sd, 9));
    CHECK_THAT(frame.noise, WithinRel(sd, 0.06));
    CHECK(std::max(frame.noise_correlation[0], frame.noise_correlation[1]) < 1.6);
  }
  // twice the noise, a quarter of the nats: the cost is what both have in common
  const auto patch = drawn.patches[4];
  double quiet = 0, loud = 0;
  for (std::uint64_t seed = 0; seed < 30; ++seed) {
    CodingContext frame = prepare_coding(with_noise(drawn.frame, 4, seed));
    frame.noise_correlation = {1, 1};
    quiet += coding_gain(frame, patch) / 30;
    frame = prepare_coding(with_noise(drawn.frame, 8, seed));
    frame.noise_correlation = {1, 1};
    loud += coding_gain(frame, patch) / 30;
  }
  const double cost =
      -coding_gain(prepare_coding(flat({200, 120}, 50)), line_patch({100, 60}, 0.3, 50, 50, 50));
  CHECK_THAT((quiet + cost) / (loud + cost), WithinRel(4.0, 0.1));
}

TEST_CASE("the gain is the sum that its formula tells, for an upright patch between whole pixels") {
  cv::Mat1f picture = with_noise(flat({40, 40}, 0), 6, 3);
  for (int y = 0; y < 40; ++y)
    for (int x = 0; x < 40; ++x)
      picture(y, x) += static_cast<float>(80 + 1.5 * x + (std::abs(x - 20) <= 1 ? 30 : 0));
  CodingContext frame = prepare_coding(picture);
  frame.noise_correlation = {1.7, 1.7};
  const auto patch =
      line_patch({20, 17}, std::numbers::pi / 2, 115, 140, 105);  // upright: its left is at greater x
  // footprint: rows 15…19, columns 20 ± 3; bands: on to 8 away, and half of the column that is 9 away
  double n = 0, mean = 0, profile = 0, ramp = 0;
  std::array<double, 2> band{}, place{};
  for (const double side : {-1.0, 1.0})
    for (int d = 4; d <= 9; ++d)
      for (int y = 15; y <= 19; ++y) {
        const auto k = static_cast<std::size_t>(side > 0);
        const double w = (d == 9 ? 0.5 : 1) / 27.5;
        band[k] += w * double{picture(y, 20 + static_cast<int>(side) * d)};
        place[k] += w * side * d;
      }
  const double slope = (band[1] - band[0]) / (place[1] - place[0]);
  for (int y = 15; y <= 19; ++y)
    for (int d = -3; d <= 3; ++d) {
      const double level = double{picture(y, 20 + d)};
      const double core = seen(d, 3, 1);
      const double model = 140 * core + 115 * reached(d - 1.5, 1) + 105 * (1 - core - reached(d - 1.5, 1));
      profile += (level - model) * (level - model);
      mean += (level - slope * d) / 35;
      ++n;
    }
  for (int y = 15; y <= 19; ++y)
    for (int d = -3; d <= 3; ++d) ramp += std::pow(double{picture(y, 20 + d)} - slope * d - mean, 2);
  const double expected =
      (ramp - profile) / (2 * frame.noise * frame.noise * 1.7) - 3.5 * std::log(1 + n / 1.7);
  CHECK_THAT(coding_gain(frame, patch), WithinRel(expected, 1e-6));
}

TEST_CASE("an even frame has defined gains and nothing to gain") {
  for (const cv::Size size : {cv::Size{64, 48}, cv::Size{3, 2}, cv::Size{1, 1}}) {
    const CodingContext frame = prepare_coding(flat(size, 77));
    CHECK(frame.noise == 0.29);
    CHECK(frame.noise_correlation == std::array<double, 2>{1, 1});
    const Point middle{(size.width - 1) / 2.0, (size.height - 1) / 2.0};
    CHECK(coding_gain(frame, line_patch(middle, 0.7, 77, 77, 77)) < 0);
    CHECK(coding_gain(frame, line_patch(middle, 0.7, 60, 90, 60)) < 0);
  }
  const CodingContext frame = prepare_coding(flat({64, 48}, 77));
  // five rows of seven pixels
  CHECK_THAT(coding_gain(frame, line_patch({20, 20}, std::numbers::pi / 2, 77, 77, 77)),
             WithinAbs(-3.5 * std::log(36), 1e-6));
  // even shading is no stroke
  const auto slope = draw({64, 48}, [](Point p) { return 20 + 2 * p.x; });
  CHECK(coding_gain(prepare_coding(slope), line_patch({30, 24}, std::numbers::pi / 2, 88, 80, 72)) < 0);
}

TEST_CASE("outside of the frame there is nothing to gain or to pay") {
  const Drawn drawn = draw_row(line_patch({20, 4}, 0, 60, 140, 60), {60, 40});
  const CodingContext frame = prepare_coding(drawn.frame);
  for (const Point at : {Point{-40, 10}, Point{20, 90}, Point{1e6, -1e6}, Point{-1e9, 3}})
    CHECK(coding_gain(frame, line_patch(at, 0.3, 60, 140, 60)) == 0);
  for (const double x : {-2.0, -0.5, 0.0, 59.0, 61.0})
    CHECK(std::isfinite(coding_gain(frame, line_patch({x, 4}, 0, 60, 140, 60))));
}

TEST_CASE("the gain in a colour frame is that in its luma") {
  const Drawn drawn = draw_row(line_patch({48, 48}, 0.4, 60, 140, 60), {96, 96});
  cv::Mat colour;
  cv::merge(std::vector<cv::Mat>{drawn.frame * 0.5F, with_noise(drawn.frame, 4, 1), drawn.frame + 9}, colour);
  const CodingContext frame = prepare_coding(colour), grey_frame = prepare_coding(core::luma(colour));
  CHECK(frame.noise == grey_frame.noise);
  graph::Patch patch = drawn.patches[4];
  patch.middle = {100, 150, 130};
  const double luma = 0.114 * 100 + 0.587 * 150 + 0.299 * 130;
  graph::Patch grey_patch = patch;
  grey_patch.middle = grey(luma);
  CHECK_THAT(coding_gain(frame, patch), WithinRel(coding_gain(grey_frame, grey_patch), 1e-4));
}

TEST_CASE("a frame that is none is refused") {
  CHECK_THROWS_AS(prepare_coding(cv::Mat()), core::InputError);
  CHECK_THROWS_AS(prepare_coding(cv::Mat(4, 4, CV_8U, cv::Scalar(0))), core::InputError);
  cv::Mat1f broken = flat({20, 20}, 5);
  broken(3, 3) = std::numeric_limits<float>::quiet_NaN();
  CHECK_THROWS_AS(prepare_coding(broken), core::InputError);
}

TEST_CASE("The noise is measured without bias, whatever the slope below it") {
  double mean = 0;
  for (std::uint64_t seed = 1; seed <= 8; ++seed) mean += prepare_coding(noisy_plane(seed)).noise / 8;
  // The median of a mean square with 9² − 3 degrees of freedom (Wilson and Hilferty).
  CHECK_THAT(mean, WithinAbs(10 * std::pow(1 - 2 / (9 * 78.0), 1.5), 0.08));
}
