// SPDX-License-Identifier: Apache-2.0
#include "sketch/rendering/render.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include <opencv2/core.hpp>

#include "core/error.hpp"
#include "core/rng.hpp"
#include "sketch/inpainting/fill.hpp"
#include "tests/support/catch.hpp"

using namespace emberfold;
using namespace emberfold::test;
using graph::AttributeGraph;
using graph::Patch;
using graph::Point;

namespace {

graph::Level grey(float level) {
  return {level, level, level};
}

Patch stroke_patch(Point position, double theta) {
  Patch p;
  p.position = position;
  p.theta = theta;
  p.width = 3;
  p.blur = 1.2;
  p.left = grey(40);
  p.middle = grey(210);
  p.right = grey(90);
  return p;
}

/// The patches joined in order.
AttributeGraph chain(const std::vector<Patch>& patches, bool ring = false) {
  std::vector<graph::Vertex> vertices;
  std::vector<graph::Edge> edges;
  const auto n = static_cast<std::uint32_t>(patches.size());
  for (std::uint32_t i = 0; i < n; ++i) {
    vertices.push_back({{i}, {}, patches[i]});
    if (i > 0) edges.push_back({{i - 1}, {i}});
  }
  if (ring) edges.push_back({{0}, {n - 1}});
  return {vertices, edges};
}

AttributeGraph straight(Point from, double theta, int patches, double spacing = 5) {
  std::vector<Patch> all;
  for (int i = 0; i < patches; ++i)
    all.push_back(stroke_patch(from + Point{std::cos(theta), std::sin(theta)} * (i * spacing), theta));
  return chain(all);
}

/// A ring run through clockwise as the image is seen: its right side is inside.
AttributeGraph ring(Point centre, double radius, double spacing = 5) {
  const int n = static_cast<int>(std::lround(2 * std::numbers::pi * radius / spacing));
  std::vector<Patch> all;
  for (int i = 0; i < n; ++i) {
    const double a = 2 * std::numbers::pi * i / n;
    all.push_back(stroke_patch(centre + Point{std::cos(a), std::sin(a)} * radius,
                               std::remainder(a + std::numbers::pi / 2, 2 * std::numbers::pi)));
  }
  return chain(all, true);
}

/// The profile at distance d, convolved with the Gaussian by summation.
double blurred(const Patch& p, double d) {
  double sum = 0, total = 0;
  for (int i = -4000; i <= 4000; ++i) {
    const double offset = i * 6 * p.blur / 4000, e = d + offset;
    const double weight = std::exp(-offset * offset / (2 * p.blur * p.blur));
    const auto level = std::abs(e) <= p.width / 2 ? p.middle[0] : e < 0 ? p.left[0] : p.right[0];
    sum += weight * static_cast<double>(level);
    total += weight;
  }
  return sum / total;
}

/// Largest difference on the mask to `truth(x, y)`.
double error_on_mask(const sketch::Sketchable& drawn, const std::function<double(int, int)>& truth) {
  double most = 0;
  for (int y = 0; y < drawn.mask.rows; ++y)
    for (int x = 0; x < drawn.mask.cols; ++x)
      if (drawn.mask.at<uchar>(y, x) != 0)
        most = std::max(most, std::abs(static_cast<double>(drawn.levels.at<float>(y, x)) - truth(x, y)));
  return most;
}

/// A net of strokes of many kinds: a T, a crossing, a bend, a lone patch, steps and bars.
AttributeGraph net(core::Rng& rng) {
  std::vector<graph::Vertex> vertices;
  std::vector<graph::Edge> edges;
  const auto add = [&](double x, double y, double theta) {
    Patch p = stroke_patch({x, y}, theta);
    p.width = rng.uniform(0, 5);
    p.blur = rng.uniform(0.5, 2);
    for (auto* level : {&p.left, &p.middle, &p.right})
      for (float& value : *level) value = static_cast<float>(rng.uniform(0, 255));
    vertices.push_back({{static_cast<std::uint32_t>(vertices.size())}, {}, p});
  };
  const auto join = [&](std::uint32_t a, std::uint32_t b) { edges.push_back({{a}, {b}}); };
  for (int i = 0; i < 9; ++i) add(10.3 + 5 * i, 20.7 + 0.4 * i * i, std::atan(0.16 * i));
  for (std::uint32_t i = 1; i < 9; ++i) join(i - 1, i);
  for (int i = 0; i < 4; ++i) add(30.1, 30.2 + 5 * i, std::numbers::pi / 2 - 0.1);
  join(4, 9);
  for (std::uint32_t i = 10; i < 13; ++i) join(i - 1, i);
  add(35.4, 47.9, 0.3);
  join(12, 13);
  add(60.2, 10.1, 1.1);
  return {vertices, edges};
}

AttributeGraph changed(const AttributeGraph& g, const std::function<Patch(Patch)>& change) {
  std::vector<graph::Vertex> vertices(g.vertices().begin(), g.vertices().end());
  for (graph::Vertex& v : vertices) v.patch = change(v.patch);
  return {vertices, {g.edges().begin(), g.edges().end()}};
}

Patch swapped(Patch p) {
  std::swap(p.left, p.right);
  return p;
}

void check_same(const sketch::Sketchable& a, const sketch::Sketchable& b) {
  CHECK(cv::norm(a.mask, b.mask, cv::NORM_INF) == 0);
  CHECK(cv::norm(a.levels, b.levels, cv::NORM_INF) < 0.02);
}

}  // namespace

TEST_CASE("A straight stroke is redrawn from its attributes", "[sketch][render]") {
  for (const double theta : {0.0, 0.4, 1.2, std::numbers::pi / 2, 2.5, -0.9, std::numbers::pi}) {
    const Point from = Point{50.3, 49.6} - Point{std::cos(theta), std::sin(theta)} * 30;
    const auto drawn = sketch::draw_fitted(straight(from, theta, 13), {100, 100}, 1);
    const Patch p = stroke_patch(from, theta);
    INFO("theta " << theta);
    CHECK(drawn.share() > 0.035);
    CHECK(error_on_mask(drawn, [&](int x, int y) {
            return blurred(p, -std::sin(theta) * (x - from.x) + std::cos(theta) * (y - from.y));
          }) < 0.1);
  }
}

TEST_CASE("A ring is redrawn from patches every five pixels", "[sketch][render]") {
  for (const double radius : {9.0, 15.0, 30.0}) {
    const Point centre{49.3, 50.8};
    const auto drawn = sketch::draw_fitted(ring(centre, radius), {100, 100}, 1);
    const Patch p = stroke_patch(centre, 0);
    INFO("radius " << radius);
    CHECK(error_on_mask(drawn, [&](int x, int y) {
            return blurred(p, radius - std::hypot(x - centre.x, y - centre.y));
          }) < 1);
    const double band = 2 * (p.width / 2 + 2 * p.blur);
    CHECK_THAT(drawn.share(), WithinAbs(2 * std::numbers::pi * radius * band / 1e4,
                                        0.04 * 2 * std::numbers::pi * radius * band / 1e4));
  }
}

TEST_CASE("A step edge has one blurred step", "[sketch][render]") {
  std::vector<Patch> patches;
  for (int i = 0; i < 8; ++i) {
    Patch p = stroke_patch({10.0 + 5 * i, 20.25}, 0);
    p.type = graph::PatchType::step;
    p.width = 0;
    p.middle = grey(65);
    patches.push_back(p);
  }
  const auto drawn = sketch::draw_fitted(chain(patches), {60, 40}, 1);
  for (int y = 18; y <= 22; ++y) {
    const double expected = 40 + 50 * 0.5 * std::erfc(-(y - 20.25) / 1.2 / std::sqrt(2.0));
    CHECK_THAT(drawn.levels.at<float>(y, 31), WithinAbs(expected, 0.01));
  }
}

TEST_CASE("The band has the reach and the ends that the header tells", "[sketch][render]") {
  // Half a width and two blurs are 3.9 px: 7 rows; 60 px from end to end and 1 px behind each: 63 columns.
  CHECK(cv::countNonZero(sketch::draw_fitted(straight({20, 30}, 0, 13), {120, 60}, 1).mask) == 7 * 63);
  const auto rows_of = [](double width, double blur) {
    const auto g = changed(straight({20, 30}, 0, 13), [&](Patch p) {
      p.width = width;
      p.blur = blur;
      return p;
    });
    return cv::countNonZero(sketch::draw_fitted(g, {120, 60}, 1).mask.col(50));
  };
  CHECK(rows_of(0, 0) == 3);     // at least 1.5 px
  CHECK(rows_of(40, 5) == 25);   // at most 12
  CHECK(rows_of(-7, 0.1) == 3);  // no negative widths
  CHECK(rows_of(8, 1) == 13);    // 6
  CHECK(rows_of(3, 0.1) == 5);   // a sharp line holds a pixel of each side
  // Alone: 2.5 px to each side.
  const auto lone = sketch::draw_fitted(chain({stroke_patch({40, 30}, std::numbers::pi / 2)}), {80, 60}, 1);
  CHECK(cv::countNonZero(lone.mask) == 7 * 5);
  CHECK(lone.mask.at<uchar>(32, 43) == 255);
  CHECK(lone.mask.at<uchar>(33, 40) == 0);
}

TEST_CASE("Attributes go over from one patch to the next", "[sketch][render]") {
  Patch a = stroke_patch({10, 20}, 0), b = stroke_patch({30, 20}, 0);
  b.middle = grey(110);
  a.width = b.width = 8;
  a.blur = b.blur = 0.5;
  const auto drawn = sketch::draw_fitted(chain({a, b}), {40, 40}, 1);
  for (int x = 10; x <= 30; ++x)
    CHECK_THAT(drawn.levels.at<float>(20, x), WithinAbs(210 - 5.0 * (x - 10), 0.01));
}

TEST_CASE("Colour is drawn channel by channel, and as luma for one channel", "[sketch][render]") {
  Patch p = stroke_patch({20, 20}, 0);
  p.left = {10, 20, 30};
  p.middle = {200, 100, 50};
  p.right = {0, 255, 128};
  const auto colour = sketch::draw_fitted(chain({p}), {40, 40}, 3);
  const auto luma = sketch::draw_fitted(chain({p}), {40, 40}, 1);
  CHECK(cv::norm(colour.mask, luma.mask, cv::NORM_INF) == 0);
  for (int y = 17; y <= 23; ++y) {
    const cv::Vec3d c = colour.levels.at<cv::Vec3f>(y, 20);
    for (int i = 0; i < 3; ++i) {
      const auto k = static_cast<std::size_t>(i);
      Patch one = p;
      one.left = grey(p.left[k]);
      one.middle = grey(p.middle[k]);
      one.right = grey(p.right[k]);
      CHECK_THAT(c[i], WithinAbs(blurred(one, y - 20), 0.05));
    }
    CHECK_THAT(luma.levels.at<float>(y, 20), WithinAbs(0.114 * c[0] + 0.587 * c[1] + 0.299 * c[2], 0.01));
  }
}

TEST_CASE("Turning patches about, sides exchanged, changes nothing", "[sketch][render]") {
  core::Rng rng(21);
  const AttributeGraph g = net(rng);
  int i = 0;
  const auto turned = changed(g, [&](Patch p) {
    if (++i % 2 == 0) return p;
    p.theta += p.theta > 0 ? -std::numbers::pi : std::numbers::pi;
    return swapped(p);
  });
  check_same(sketch::draw_fitted(g, {80, 60}, 3), sketch::draw_fitted(turned, {80, 60}, 3));
}

TEST_CASE("A mirrored graph gives the mirrored drawing", "[sketch][render]") {
  core::Rng rng(22);
  const AttributeGraph g = net(rng);
  const auto drawn = sketch::draw_fitted(g, {80, 60}, 3);
  sketch::Sketchable expected;
  cv::flip(drawn.levels, expected.levels, 1);
  cv::flip(drawn.mask, expected.mask, 1);
  check_same(sketch::draw_fitted(changed(g,
                                         [](Patch p) {
                                           p.position.x = 79 - p.position.x;
                                           p.theta = std::numbers::pi - p.theta;
                                           return swapped(p);
                                         }),
                                 {80, 60}, 3),
             expected);
  expected = {drawn.levels.t(), drawn.mask.t()};
  check_same(sketch::draw_fitted(changed(g,
                                         [](Patch p) {
                                           std::swap(p.position.x, p.position.y);
                                           p.theta = std::numbers::pi / 2 - p.theta;
                                           return swapped(p);
                                         }),
                                 {60, 80}, 3),
             expected);
}

TEST_CASE("Numbering does not matter", "[sketch][render]") {
  core::Rng rng(23);
  const AttributeGraph g = net(rng);
  std::vector<graph::Vertex> vertices;
  std::vector<graph::Edge> edges;
  for (const graph::Vertex& v : g.vertices()) vertices.push_back({{100 - v.id.value}, {}, v.patch});
  for (const graph::Edge& e : g.edges()) edges.push_back({{100 - e.a.value}, {100 - e.b.value}});
  check_same(sketch::draw_fitted(g, {80, 60}, 3), sketch::draw_fitted({vertices, edges}, {80, 60}, 3));
}

TEST_CASE("A frame shows its part of the drawing", "[sketch][render]") {
  core::Rng rng(24);
  const AttributeGraph g = net(rng);
  const auto whole = sketch::draw_fitted(g, {80, 60}, 3);
  const cv::Rect part(23, 18, 20, 21);
  const auto clipped = sketch::draw_fitted(changed(g,
                                                   [&](Patch p) {
                                                     p.position = p.position - Point{23, 18};
                                                     return p;
                                                   }),
                                           part.size(), 3);
  check_same(clipped, {whole.levels(part).clone(), whole.mask(part).clone()});
}

TEST_CASE("A side arm reaches its stroke without changing it", "[sketch][render]") {
  auto main = straight({10, 30}, 0, 11);
  std::vector<graph::Vertex> vertices(main.vertices().begin(), main.vertices().end());
  std::vector<graph::Edge> edges(main.edges().begin(), main.edges().end());
  for (std::uint32_t i = 0; i < 3; ++i) {
    vertices.push_back({{11 + i}, {}, stroke_patch({35, 35.0 + 5 * i}, std::numbers::pi / 2)});
    edges.push_back({{i == 0 ? 5 : 10 + i}, {11 + i}});
  }
  const auto drawn = sketch::draw_fitted({vertices, edges}, {80, 60}, 1);
  for (int y = 30; y <= 45; ++y) CHECK(drawn.mask.at<uchar>(y, 35) == 255);
  CHECK_THAT(drawn.levels.at<float>(30, 35),
             WithinAbs(sketch::draw_fitted(main, {80, 60}, 1).levels.at<float>(30, 35), 20));
  // Beyond the arm's band the stroke is what it was.
  for (int y = 27; y <= 33; ++y)
    CHECK_THAT(drawn.levels.at<float>(y, 25), WithinAbs(blurred(stroke_patch({}, 0), y - 30), 0.05));
  CHECK_THAT(drawn.levels.at<float>(40, 35), WithinAbs(blurred(stroke_patch({}, 0), 0), 0.05));
}

TEST_CASE("A sharp bend has no gap on its outer side", "[sketch][render]") {
  std::vector<Patch> patches;
  for (int i = 0; i < 4; ++i) patches.push_back(stroke_patch({10.0 + 5 * i, 40}, 0));
  for (int i = 1; i < 4; ++i) patches.push_back(stroke_patch({25, 40.0 - 5 * i}, -std::numbers::pi / 2));
  const auto drawn = sketch::draw_fitted(chain(patches), {60, 60}, 1);
  for (int y = 25; y < 46; ++y)
    for (int x = 10; x < 32; ++x) {
      const double along_first = std::hypot(std::max(x - 25.0, 0.0), y - 40.0);
      const double along_second = std::hypot(x - 25.0, std::max(y - 40.0, 0.0));
      if (std::min(along_first, along_second) < 3.8) {
        INFO(x << ", " << y);
        CHECK(drawn.mask.at<uchar>(y, x) == 255);
      }
    }
}

TEST_CASE("Nothing to draw, and places far away", "[sketch][render]") {
  const auto nothing = sketch::draw_fitted({}, {30, 20}, 3);
  CHECK(nothing.share() == 0);
  CHECK(nothing.levels.type() == CV_32FC3);
  CHECK(sketch::Sketchable{}.share() == 0);

  std::vector<Patch> far;
  for (int i = 0; i < 2000; ++i) far.push_back(stroke_patch({1e9 + 1e6 * i, i % 2 == 0 ? -1e12 : 1e12}, 0.1));
  CHECK(sketch::draw_fitted(chain(far), {30, 20}, 1).share() == 0);
  const double huge = std::numeric_limits<double>::max();
  CHECK(sketch::draw_fitted(chain({stroke_patch({-huge, huge}, 0), stroke_patch({huge, -huge}, 0)}), {30, 20},
                            1)
            .share() == 0);
  // An edge right across, from far to far, is a line.
  const auto across =
      sketch::draw_fitted(chain({stroke_patch({-1e6, 10}, 0), stroke_patch({1e6, 10}, 0)}), {30, 20}, 1);
  CHECK(cv::countNonZero(across.mask) == 30 * 7);
  // Two patches at one place still show.
  CHECK(sketch::draw_fitted(chain({stroke_patch({10, 10}, 0), stroke_patch({10, 10}, 0)}), {30, 20}, 1)
            .share() > 0);
}

TEST_CASE("Remembered pixels cover the same part", "[sketch][render]") {
  core::Rng rng(25);
  const AttributeGraph g = net(rng);
  cv::Mat frame(60, 80, CV_32FC3);
  for (auto& value : cv::Mat_<cv::Vec3f>(frame))
    for (int c = 0; c < 3; ++c) value[c] = static_cast<float>(rng.uniform(1, 255));
  const auto pixels = sketch::draw_pixels(g, frame);
  CHECK(cv::norm(pixels.mask, sketch::draw_fitted(g, {80, 60}, 1).mask, cv::NORM_INF) == 0);
  cv::Mat expected = frame.clone();
  expected.setTo(cv::Scalar::all(0), pixels.mask == 0);
  CHECK(cv::norm(pixels.levels, expected, cv::NORM_INF) == 0);
}

TEST_CASE("Drawn and filled, a ring stands between its two levels", "[sketch][render][fill]") {
  const Point centre{50, 50};
  const auto drawn = sketch::draw_fitted(ring(centre, 30), {101, 101}, 1);
  const cv::Mat filled = sketch::fill(drawn.levels, drawn.mask).levels;
  // The band's last pixels, up to one px inside its reach, show the sides but for what is left of the step
  // there: 12 per cent at most.
  CHECK_THAT(filled.at<float>(50, 50), WithinAbs(90, 0.12 * 120));
  CHECK_THAT(filled.at<float>(2, 2), WithinAbs(40, 0.12 * 170));
}

TEST_CASE("What cannot be drawn is refused", "[sketch][render]") {
  CHECK_THROWS_AS(sketch::draw_fitted({}, {30, 20}, 2), core::InputError);
  CHECK_THROWS_AS(sketch::draw_fitted({}, {0, 20}, 1), core::InputError);
  CHECK_THROWS_AS(sketch::draw_pixels({}, cv::Mat(20, 30, CV_8U, cv::Scalar(1))), core::InputError);
  CHECK_THROWS_AS(sketch::draw_pixels({}, cv::Mat()), core::InputError);
}
