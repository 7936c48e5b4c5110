// SPDX-License-Identifier: Apache-2.0
// Places and attributes of sketched structures, compared with frames drawn by formula.
#include "sketch/extract.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "tests/support/catch.hpp"
#include "tests/support/sketch_scene.hpp"

using namespace emberfold;
using namespace emberfold::test;
using graph::AttributeGraph;
using graph::Patch;
using graph::PatchType;

namespace {

const cv::Size kExtractSize{140, 140};
constexpr int kAngles = 12;

/// Mean and root mean square of what is put in.
struct Spread {
  double sum = 0, squares = 0, count = 0;
  void add(double v) {
    sum += v;
    squares += v * v;
    count += 1;
  }
  [[nodiscard]] double mean() const { return sum / count; }
  [[nodiscard]] double rms() const { return std::sqrt(squares / count); }
};

/// A straight structure through the frame's middle, never twice the same to the pixel grid.
struct Straight {
  Point origin;
  double theta = 0;
  [[nodiscard]] Point along() const { return unit(theta); }
  [[nodiscard]] double across(Point p) const {
    return graph::dot(p - origin, unit(theta + std::numbers::pi / 2));
  }
};

Straight at_angle(int k, double whole_turn) {
  return {{69.5 + 0.37 * std::cos(k * 1.7), 69.5 + 0.41 * std::sin(k * 2.3)},
          0.013 + whole_turn * k / kAngles};
}

/// Errors of the inner patches of bars.
struct BarErrors {
  Spread position, theta, width, blur, contrast, side;
  double patches = 0, strays = 0;
};

void add_bar(BarErrors& errors, const AttributeGraph& found, const Straight& bar, double width, double blur,
             double sign) {
  const float ground = sign > 0 ? 60 : 180;
  for (std::size_t i = 0; i < found.size(); ++i) {
    const Patch& p = found.patch(i);
    errors.patches += 1;
    const double d = bar.across(p.position);
    if (p.width == 0 || p.contrast * sign < 0 || std::abs(d) > 3) {
      errors.strays += 1;
      continue;
    }
    if (found.degree(i) != 2) continue;
    errors.position.add(d);
    errors.theta.add(graph::orientation_difference(p.theta, bar.theta));
    errors.width.add(p.width - width);
    errors.blur.add(p.blur - blur);
    errors.contrast.add(std::abs(p.contrast) - 80 * seen(0, width, blur));
    errors.side.add(static_cast<double>(p.left[0] - ground));
    errors.side.add(static_cast<double>(p.right[0] - ground));
  }
}

BarErrors measure_bars(double width, double blur, double sign, double noise) {
  BarErrors errors;
  for (int k = 0; k < kAngles; ++k) {
    const Straight bar = at_angle(k, std::numbers::pi);
    auto frame = draw(kExtractSize,
                      {segment(bar.origin - bar.along() * 48, bar.origin + bar.along() * 48, width, blur)},
                      sign > 0 ? 60 : 180, 80 * sign);
    if (noise > 0) frame = with_noise(frame, noise, static_cast<std::uint64_t>(k) + 1);
    add_bar(errors, sketch::extract(frame, {}), bar, width, blur, sign);
  }
  return errors;
}

}  // namespace

TEST_CASE("Straight bars lie within 0.04 px of their middle, and their profiles are told") {
  for (const double width : {3.0, 5.0, 8.0})
    for (const double sign : {1.0, -1.0}) {
      const BarErrors e = measure_bars(width, 1.2, sign, 0);
      INFO("width " << width << ", sign " << sign << ", " << e.patches << " patches, " << e.strays
                    << " strays, position " << e.position.rms() << ", theta " << e.theta.rms() << ", width "
                    << e.width.mean() << " ± " << e.width.rms() << ", blur " << e.blur.rms() << ", contrast "
                    << e.contrast.rms() << ", side " << e.side.rms());
      CHECK(e.patches >= kAngles * 18);
      CHECK(e.strays == 0);
      CHECK(e.position.rms() <= 0.04);
      CHECK(e.theta.rms() <= 0.015);
      CHECK(e.width.rms() <= 0.2);
      CHECK(e.blur.rms() <= 0.1);
      CHECK(e.contrast.rms() <= 3);
      CHECK(e.side.rms() <= 1);
    }
}

TEST_CASE("In noise of SD 15 straight bars lie within 0.13 px of their middle") {
  for (const double width : {3.0, 5.0, 8.0})
    for (const double sign : {1.0, -1.0}) {
      const BarErrors e = measure_bars(width, 1.2, sign, 15);
      INFO("width " << width << ", sign " << sign << ", " << e.patches << " patches, " << e.strays
                    << " strays, position " << e.position.rms() << ", theta " << e.theta.rms() << ", width "
                    << e.width.mean() << " ± " << e.width.rms() << ", blur " << e.blur.rms() << ", contrast "
                    << e.contrast.mean() << " ± " << e.contrast.rms() << ", side " << e.side.rms());
      CHECK(e.patches >= kAngles * 18);
      CHECK(e.strays <= 0.02 * e.patches);
      CHECK(e.position.rms() <= 0.13);
      CHECK(e.theta.rms() <= 0.035);
      CHECK(e.width.rms() <= 0.8);
      CHECK(e.blur.rms() <= 0.4);
      CHECK(e.contrast.rms() <= 10);
      CHECK(e.side.rms() <= 5);
    }
}

TEST_CASE("A fitted profile shows what the image shows") {
  // Width and middle of a bar that blur has rounded off stand in for one another; the profile they make
  // together does not: it is the image's.
  for (const double width : {3.0, 5.0, 8.0})
    for (const double blur : {0.8, 1.5, 2.0}) {
      Spread error;
      for (int k = 0; k < kAngles; ++k) {
        const Straight bar = at_angle(k, std::numbers::pi);
        const auto frame =
            draw(kExtractSize, [&](Point p) { return 60 + 80 * seen(bar.across(p), width, blur); });
        const AttributeGraph found = sketch::extract(frame, {});
        for (std::size_t i = 0; i < found.size(); ++i) {
          const Patch& p = found.patch(i);
          if (p.width == 0 || !well_inside(p.position, kExtractSize, 12) || found.degree(i) != 2) continue;
          for (double d = -6; d <= 6; d += 0.5) {
            const double enter = reached(d + p.width / 2, p.blur), leave = reached(d - p.width / 2, p.blur);
            const auto left = static_cast<double>(p.left[0]), middle = static_cast<double>(p.middle[0]),
                       right = static_cast<double>(p.right[0]);
            const double fitted = left + (middle - left) * enter + (right - middle) * leave;
            error.add(fitted - (60 + 80 * seen(d, width, blur)));
          }
        }
      }
      INFO("width " << width << ", blur " << blur << ": " << error.mean() << " ± " << error.rms());
      REQUIRE(error.count > 1000);
      CHECK(error.rms() <= 1);
    }
}

TEST_CASE("Arcs lie in their middle, not towards the centre as smoothing moves them") {
  for (const double noise : {0.0, 15.0})
    for (const double width : {3.0, 5.0})
      for (const double radius : {25.0, 40.0, 55.0}) {
        Spread error;
        for (int k = 0; k < 3; ++k) {
          const double sign = k == 1 ? -1 : 1;
          const Point centre{69.5 + 0.3 * k, 69.3 - 0.2 * k};
          auto frame = draw(kExtractSize, {ring(centre, radius, width, 1)}, sign > 0 ? 60 : 180, sign * 80);
          if (noise > 0) frame = with_noise(frame, noise, static_cast<std::uint64_t>(k) + 1);
          const AttributeGraph found = sketch::extract(frame, {});
          for (std::size_t i = 0; i < found.size(); ++i) {
            const double d = graph::distance(found.patch(i).position, centre) - radius;
            if (found.patch(i).width > 0 && std::abs(d) < 3) error.add(d);
          }
        }
        INFO("noise " << noise << ", width " << width << ", radius " << radius << ": " << error.mean()
                      << " ± " << error.rms() << " of " << error.count);
        CHECK(error.count >= 0.9 * 3 * 2 * std::numbers::pi * radius / 5);
        CHECK(std::abs(error.mean()) <= (noise > 0 ? 0.05 : 0.02));
        CHECK(error.rms() <= (noise > 0 ? 0.15 : 0.05));
      }
}

TEST_CASE("A line whose sides differ lies in its middle") {
  // Its crease is drawn towards the brighter side, by some 0.025 px for each grey level between the sides.
  for (const double width : {3.0, 5.0})
    for (const double more : {10.0, 20.0, 40.0}) {
      Spread position, left, right;
      for (int k = 0; k < kAngles; ++k) {
        const Straight bar = at_angle(k, std::numbers::pi);
        const auto frame = draw(kExtractSize, [&](Point p) {
          const double d = bar.across(p);
          return 60 + 80 * reached(d + width / 2, 1) + (more - 80) * reached(d - width / 2, 1);
        });
        const AttributeGraph found = sketch::extract(frame, {});
        for (std::size_t i = 0; i < found.size(); ++i) {
          const Patch& p = found.patch(i);
          if (p.width == 0 || p.contrast < 0 || !well_inside(p.position, kExtractSize, 10)) continue;
          const bool same_way = graph::dot(unit(p.theta), bar.along()) > 0;
          position.add(bar.across(p.position));
          left.add(static_cast<double>(same_way ? p.left[0] : p.right[0]) - 60);
          right.add(static_cast<double>(same_way ? p.right[0] : p.left[0]) - 60 - more);
        }
      }
      INFO("width " << width << ", sides differ by " << more << ": position " << position.mean() << " ± "
                    << position.rms() << ", left " << left.rms() << ", right " << right.rms() << " of "
                    << position.count);
      CHECK(position.count >= kAngles * 10);
      CHECK(std::abs(position.mean()) <= 0.02);
      CHECK(position.rms() <= 0.1);
      CHECK(left.rms() <= 5);
      CHECK(right.rms() <= 5);
    }
}

TEST_CASE("Step edges: place, blur, both levels, and the sign that the side convention asks for") {
  for (const double noise : {0.0, 15.0})
    for (const double blur : {0.8, 1.5, 3.0}) {
      Spread position, theta, width, left, right, contrast;
      std::size_t wrong_sign = 0;
      for (int k = 0; k < kAngles; ++k) {
        const Straight edge = at_angle(k, 2 * std::numbers::pi);
        auto frame = draw(kExtractSize, [&](Point p) { return 60 + 80 * reached(edge.across(p), blur); });
        if (noise > 0) frame = with_noise(frame, noise, static_cast<std::uint64_t>(k) + 1);
        const AttributeGraph found = sketch::extract(frame, {});
        for (std::size_t i = 0; i < found.size(); ++i) {
          const Patch& p = found.patch(i);
          if (p.width > 0 || !well_inside(p.position, kExtractSize, 8)) continue;
          const bool same_way = graph::dot(unit(p.theta), edge.along()) > 0;
          position.add(edge.across(p.position));
          theta.add(graph::orientation_difference(p.theta, edge.theta));
          width.add(p.blur - blur);
          left.add(static_cast<double>(p.left[0]) - (same_way ? 60 : 140));
          right.add(static_cast<double>(p.right[0]) - (same_way ? 140 : 60));
          contrast.add(p.contrast - (same_way ? 80 : -80));
          wrong_sign += (p.contrast > 0) != same_way ? 1U : 0U;
          REQUIRE_THAT(static_cast<double>(p.middle[0]),
                       WithinAbs(static_cast<double>(p.left[0] + p.right[0]) / 2, 1e-3));
        }
      }
      INFO("noise " << noise << ", blur " << blur << ": position " << position.rms() << ", theta "
                    << theta.rms() << ", blur " << width.mean() << " ± " << width.rms() << ", levels "
                    << left.rms() << " " << right.rms() << ", contrast " << contrast.rms() << " of "
                    << position.count);
      CHECK(position.count >= kAngles * 22);
      CHECK(position.rms() <= (noise > 0 ? 0.3 : 0.03));
      CHECK(std::abs(position.mean()) <= (noise > 0 ? 0.05 : 0.02));
      CHECK(theta.rms() <= (noise > 0 ? 0.06 : 0.02));
      CHECK(width.rms() <= (noise > 0 ? 0.5 : 0.05));
      CHECK(left.rms() <= (noise > 0 ? 4 : 0.6));
      CHECK(right.rms() <= (noise > 0 ? 4 : 0.6));
      CHECK(contrast.rms() <= (noise > 0 ? 6 : 1));
      CHECK(wrong_sign == 0);
    }
}

TEST_CASE("A colour frame's patches have its colours, and luma decides what is found") {
  const Straight bar = at_angle(2, std::numbers::pi);
  const auto cover = draw(kExtractSize, [&](Point p) { return seen(bar.across(p), 6, 1); });
  std::vector<cv::Mat> channels;
  for (const auto& [ground, core] : {std::pair{10.0, 61.0}, {20.0, 224.0}, {30.0, 132.0}})
    channels.emplace_back(cover * (core - ground) + ground);
  cv::Mat frame;
  cv::merge(channels, frame);
  const AttributeGraph found = sketch::extract(frame, {});
  REQUIRE(found.size() >= 20);
  for (std::size_t i = 0; i < found.size(); ++i) {
    const Patch& p = found.patch(i);
    if (!well_inside(p.position, kExtractSize, 12)) continue;
    for (const graph::Level& side : {p.left, p.right}) {
      REQUIRE_THAT(static_cast<double>(side[0]), WithinAbs(10, 3));
      REQUIRE_THAT(static_cast<double>(side[1]), WithinAbs(20, 6));
      REQUIRE_THAT(static_cast<double>(side[2]), WithinAbs(30, 4));
    }
    REQUIRE_THAT(static_cast<double>(p.middle[0]), WithinAbs(61, 4));
    REQUIRE_THAT(static_cast<double>(p.middle[1]), WithinAbs(224, 18));
    REQUIRE_THAT(static_cast<double>(p.middle[2]), WithinAbs(132, 9));
    const double luma = 0.114 * (61 - 10) + 0.587 * (224 - 20) + 0.299 * (132 - 30);
    REQUIRE_THAT(p.contrast, WithinAbs(luma * seen(0, 6, 1), 8));
  }
  // Grey in three channels is grey.
  const auto grey = draw(kExtractSize, {segment({20, 30}, {120, 100}, 4, 1)}, 60, 80);
  cv::merge(std::vector<cv::Mat>{grey, grey, grey}, frame);
  const AttributeGraph three = sketch::extract(frame, {}), one = sketch::extract(grey, {});
  REQUIRE(three.size() == one.size());
  for (std::size_t i = 0; i < one.size(); ++i)
    REQUIRE_THAT(graph::distance(three.patch(i).position, one.patch(i).position), WithinAbs(0, 0.01));
}

TEST_CASE("What is clipped at white keeps its place and its levels") {
  const Straight bar = at_angle(5, std::numbers::pi);
  auto frame = draw(kExtractSize,
                    {segment(bar.origin - bar.along() * 48, bar.origin + bar.along() * 48, 6, 1)}, 0, 400);
  cv::min(frame, 255.0F, frame);
  const AttributeGraph found = sketch::extract(frame, {});
  REQUIRE(components(found).count == 1);
  for (std::size_t i = 0; i < found.size(); ++i) {
    if (found.degree(i) != 2) continue;
    const Patch& p = found.patch(i);
    REQUIRE_THAT(bar.across(p.position), WithinAbs(0, 0.25));
    REQUIRE_THAT(static_cast<double>(p.middle[0]), WithinAbs(255, 15));
    REQUIRE_THAT(static_cast<double>(p.left[0]), WithinAbs(0, 10));
    REQUIRE_THAT(static_cast<double>(p.right[0]), WithinAbs(0, 10));
  }
}

namespace {

/// A stripe of one colour on ground of another: levels of blue, green, red.
cv::Mat3f stripe(const Straight& bar, double width, const cv::Vec3f& ground, const cv::Vec3f& core) {
  cv::Mat3f frame(kExtractSize);
  for (int y = 0; y < frame.rows; ++y)
    for (int x = 0; x < frame.cols; ++x) {
      const auto cover =
          static_cast<float>(seen(bar.across({static_cast<double>(x), static_cast<double>(y)}), width, 1));
      frame(y, x) = ground + (core - ground) * cover;
    }
  return frame;
}

// A disc of a radius of 30 px, blurred, in noise.
cv::Mat disc(const cv::Scalar& ground, const cv::Scalar& core) {
  cv::Mat3f frame(kExtractSize, cv::Vec3f(static_cast<float>(ground[0]), static_cast<float>(ground[1]),
                                          static_cast<float>(ground[2])));
  cv::circle(frame, {80, 60}, 30, core, cv::FILLED);
  cv::GaussianBlur(frame, frame, {0, 0}, 1);
  std::vector<cv::Mat> channels;
  cv::split(frame, channels);
  for (std::size_t c = 0; c < channels.size(); ++c) channels[c] = with_noise(channels[c], 1, c + 1);
  cv::Mat noisy;
  cv::merge(channels, noisy);
  return noisy;
}

}  // namespace

TEST_CASE("A stripe of another colour but the same luma is found in colour only") {
  // 0.587 · 80 = 0.299 · 157.06: red for green at equal luma.
  for (const double width : {3.0, 5.0, 8.0})
    for (int k = 0; k < kAngles; k += 3) {
      const Straight bar = at_angle(k, std::numbers::pi);
      const cv::Mat3f frame = stripe(bar, width, {40, 140, 40}, {40, 60, 197.06F});
      CHECK(sketch::extract(frame, {}).empty());
      const AttributeGraph found = sketch::extract(frame, {.colour = true});
      Spread place, wide, green, red;
      for (std::size_t i = 0; i < found.size(); ++i) {
        const Patch& p = found.patch(i);
        if (!well_inside(p.position, kExtractSize, 12)) continue;
        REQUIRE((p.type == PatchType::ridge || p.type == PatchType::bar));
        place.add(bar.across(p.position));
        wide.add(p.width - width);
        green.add(static_cast<double>(p.middle[1]) - 60);
        red.add(static_cast<double>(p.middle[2]) - 197.06);
      }
      INFO("width " << width << ", angle " << k << ": place " << place.rms() << ", width " << wide.rms()
                    << ", levels " << green.rms() << " " << red.rms() << " of " << place.count);
      CHECK(place.count >= 18);
      CHECK(place.rms() <= 0.1);
      CHECK(wide.rms() <= 0.3);
      CHECK(green.rms() <= 4);
      CHECK(red.rms() <= 4);
    }
}

TEST_CASE("A disc of another colour but the same luma has its outline in colour only") {
  const cv::Mat frame = disc({40, 140, 40}, {40, 60, 197.06F});
  sketch::ExtractOptions both;
  both.outlines = both.colour = true;
  CHECK(sketch::extract(frame, {.outlines = true}).empty());
  const AttributeGraph found = sketch::extract(frame, both);
  CHECK(components(found).count == 1);
  CHECK(found.edges().size() == found.size());  // a ring
  CHECK(found.size() >= 30);
  for (std::size_t i = 0; i < found.size(); ++i) {
    CHECK(found.patch(i).type == PatchType::step);
    CHECK_THAT(graph::distance(found.patch(i).position, {80, 60}), WithinAbs(30, 0.5));
  }
}

TEST_CASE("An edge of luma and of colour is one edge") {
  sketch::ExtractOptions both;
  both.outlines = both.colour = true;
  CHECK(components(sketch::extract(disc({40, 140, 40}, {40, 30, 230}), both)).count == 1);
  // A lens that displaces red by two pixels makes no second edge.
  std::vector<cv::Mat> channels;
  cv::split(disc({30, 60, 40}, {60, 120, 230}), channels);
  const cv::Mat1f red = channels[2].clone();  // copyMakeBorder must not write into its source
  cv::copyMakeBorder(red.colRange(0, red.cols - 2), channels[2], 0, 0, 2, 0, cv::BORDER_REPLICATE);
  cv::Mat displaced;
  cv::merge(channels, displaced);
  CHECK(components(sketch::extract(displaced, both)).count == 1);
}

TEST_CASE("Sharp spots of two to four pixels get an outline") {
  for (const int size : {2, 3, 4}) {
    cv::Mat1f frame(kExtractSize, 0.0F);
    frame(cv::Rect(40, 60, size, size)) = 255;
    INFO(size);
    CHECK(components(sketch::extract(frame, {.outlines = true})).count == 1);
  }
}

TEST_CASE("Colour changes nothing in grey frames") {
  const auto grey = with_noise(
      draw(kExtractSize, {segment({20, 30}, {120, 100}, 4, 1), ring({80, 60}, 30, 3, 1)}, 60, 80), 5, 1);
  cv::Mat three;
  cv::merge(std::vector<cv::Mat>{grey, grey, grey}, three);
  CHECK(sketch::extract(three, {.colour = true}) == sketch::extract(three, {}));
  CHECK(sketch::extract(grey, {.colour = true}) == sketch::extract(grey, {}));
}

TEST_CASE("Where luma falls and a colour rises on the same stripe there is one line") {
  const Straight bar = at_angle(2, std::numbers::pi);
  const AttributeGraph found =
      sketch::extract(stripe(bar, 5, {40, 140, 40}, {40, 20, 150}), {.colour = true});
  CHECK(components(found).count == 1);
  for (std::size_t i = 0; i < found.size(); ++i)
    if (well_inside(found.patch(i).position, kExtractSize, 12))
      CHECK_THAT(bar.across(found.patch(i).position), WithinAbs(0, 0.15));
}

TEST_CASE("Noise of colour has no strokes") {
  std::vector<cv::Mat> channels;
  for (std::uint64_t seed = 1; seed <= 3; ++seed)
    channels.emplace_back(with_noise(cv::Mat1f(256, 256, 128.0F), 12, seed));
  cv::Mat frame;
  cv::merge(channels, frame);
  CHECK(sketch::extract(frame, {.colour = true}).empty());
}
