// SPDX-License-Identifier: Apache-2.0
#include "sketch/detection/weak_curves.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <vector>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "sketch/detection/half_resolution.hpp"
#include "sketch/detection/oriented_response.hpp"
#include "sketch/extract.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/sketch_scene.hpp"

using namespace emberfold;
using namespace emberfold::test;
using graph::AttributeGraph;
using graph::Point;
using sketch::Derivative;
using sketch::OrientedResponse;

namespace {

const cv::Size kWeakCurvesSize{160, 120};
constexpr Point kMiddle{79, 59};

sketch::ScaleLevel level_of(const cv::Mat1f& frame, int number) {
  return sketch::scale_space(frame, 1.2, number + 1).back();
}

/// A Gaussian line through the middle, of SD `s`.
cv::Mat1f line(double theta, double s, double height) {
  const Point across{-std::sin(theta), std::cos(theta)};
  return draw(kWeakCurvesSize, [=](Point p) {
    return 100 + height * std::exp(-0.5 * std::pow(graph::dot(p - kMiddle, across) / s, 2));
  });
}

/// Texture in the frame's lower half, in which single points of a line of 40 levels do not stand out; above
/// it, in the calm, such a line with a gap of so many px in its middle.
cv::Mat1f broken_line_above_texture(double gap, std::uint64_t seed) {
  cv::Mat1f texture = with_noise(cv::Mat1f(kWeakCurvesSize, 0.0F), 1, seed);
  cv::GaussianBlur(texture, texture, {}, 1.2);
  cv::Mat1f frame = draw(kWeakCurvesSize, [=](Point p) {
    const double along = std::abs(p.x - kMiddle.x), beyond = std::max({0.0, along - 45, gap / 2 - along});
    return 90 + 40 * std::exp(-0.5 * (std::pow((p.y - 30) / 1.8, 2) + std::pow(beyond / 1.2, 2)));
  });
  frame.rowRange(60, kWeakCurvesSize.height) += 150 * texture.rowRange(60, kWeakCurvesSize.height);
  return with_noise(frame, 2, seed + 1);
}

/// The length of the edges within `reach` px of the line through the middle, and of all others.
struct Drawn {
  double on = 0, off = 0;
};
Drawn drawn(const AttributeGraph& graph, double theta, double reach) {
  const Point across{-std::sin(theta), std::cos(theta)};
  Drawn result;
  for (const graph::Edge& e : graph.edges()) {
    const Point a = graph.patch(graph.index_of(e.a)).position, b = graph.patch(graph.index_of(e.b)).position;
    const double away = std::abs(graph::dot((a + b) * 0.5 - kMiddle, across));
    (away <= reach ? result.on : result.off) += graph::distance(a, b);
  }
  return result;
}

}  // namespace

TEST_CASE("Averaging along a line changes neither its response nor its direction", "[sketch][weak]") {
  // A Gaussian line responds with h s / (s² + σ²)^{3/2} at every place; 16 directions are 11.25° apart.
  const double s = 1.8, height = 40;
  for (const int way : {0, 2, 5, 8, 11}) {
    const double theta = way * std::numbers::pi / 16;
    for (const int number : {1, 2, 3}) {
      const sketch::ScaleLevel level = level_of(line(theta, s, height), number);
      const OrientedResponse r = sketch::compute_oriented_response(level, Derivative::second, 4, 1);
      const double expected = height * s / std::pow(s * s + level.sigma * level.sigma, 1.5);
      INFO("direction " << way << ", scale " << level.sigma);
      // From central differences and taps on whole pixels: some percent.
      CHECK_THAT(double{r.negative(59, 79)}, WithinRel(expected, 0.12));
      CHECK(int{r.negative_way(59, 79)} == way);
    }
  }
}

TEST_CASE("The ground follows the noise, and a line does not raise it", "[sketch][weak]") {
  const cv::Mat1f flat(240, 320, 100.0F);
  const auto halved_level_of = [](const cv::Mat1f& frame, std::size_t number) {
    return sketch::HalfResolution(frame.size()).halved(sketch::scale_space(frame, 1.2, 4))[number];
  };
  for (const std::size_t number : {1U, 3U}) {
    const sketch::ScaleLevel level = halved_level_of(with_noise(flat, 5, 3), number);
    const OrientedResponse r = sketch::compute_oriented_response(level, Derivative::second, 2, 0.29);
    // Across the strongest of 16 directions the response of white noise is a little less than in any
    // direction.
    const double any = 5 * level.hessian_sd * std::sqrt(level.sigma / 2);
    for (int y = 0; y < r.ground.rows; ++y)
      for (int x = 0; x < r.ground.cols; ++x) {
        CHECK(double{r.ground(y, x)} > 0.4 * any);
        CHECK(double{r.ground(y, x)} < 1.3 * any);
      }
  }
  const auto ground_beside = [&](double height) {
    const OrientedResponse r = sketch::compute_oriented_response(
        halved_level_of(with_noise(line(0.3, 2, height), 5, 3), 2), Derivative::second, 2, 0.29);
    return double{r.ground(r.ground.rows / 2, r.ground.cols / 2)};
  };
  CHECK(ground_beside(80) < 1.4 * ground_beside(0));
}

TEST_CASE("A mirrored or turned frame has the mirrored or turned response", "[sketch][weak]") {
  const cv::Mat1f frame = with_noise(line(0.4, 2, 20), 8, 9);
  const auto respond = [](const cv::Mat1f& f) {
    return sketch::compute_oriented_response(level_of(f, 1), Derivative::second, 4, 1);
  };
  const OrientedResponse r = respond(frame);
  for (const int flip : {0, 1, -1}) {
    cv::Mat1f other, expected;
    cv::flip(frame, other, flip);
    cv::flip(r.negative, expected, flip);
    CHECK(cv::norm(respond(other).negative, expected, cv::NORM_INF) == 0);
  }
  cv::Mat1f turned, expected;
  cv::transpose(frame, turned);
  cv::transpose(r.negative, expected);
  CHECK(cv::norm(respond(turned).negative, expected, cv::NORM_INF) < 1e-3);
}

TEST_CASE("A line that no point of it shows is found by its length", "[sketch][weak]") {
  int found_at_all = 0;
  for (const double theta : {0.0, 0.35, 1.1, 2.2}) {
    const cv::Mat1f frame = with_noise(line(theta, 1.5, 9), 7, static_cast<std::uint64_t>(10 * theta) + 1);
    const Drawn seen = drawn(sketch::extract(frame, {.edges = false}), theta, 2);
    INFO("theta " << theta << ": on the line " << seen.on << " px, elsewhere " << seen.off);
    CHECK(seen.on > 70);
    CHECK(seen.off < 15);
    // What its points alone show is little of it.
    const Drawn strict = drawn(sketch::extract(frame, {.sensitivity = 0, .edges = false}), theta, 2);
    found_at_all += strict.on > 70 ? 1 : 0;
  }
  CHECK(found_at_all <= 1);
}

TEST_CASE("A gap that averaging along a line closes is cut open, and the short parts beside it are drawn",
          "[sketch][weak]") {
  for (const double gap : {0.0, 12.0, 50.0})
    for (const std::uint64_t seed : {1U, 5U, 9U}) {
      INFO("gap " << gap << ", seed " << seed);
      const AttributeGraph graph =
          sketch::extract(broken_line_above_texture(gap, seed), {.sensitivity = 0.3, .edges = false});
      double drawn_length = 0, in_gap = 0;  // px
      for (const graph::Edge& e : graph.edges()) {
        const Point a = graph.patch(graph.index_of(e.a)).position,
                    b = graph.patch(graph.index_of(e.b)).position, middle = (a + b) * 0.5;
        if (std::abs(middle.y - 30) > 3) continue;
        drawn_length += graph::distance(a, b);
        if (std::abs(middle.x - kMiddle.x) < gap / 2 - 2) in_gap += graph::distance(a, b);
      }
      CHECK(drawn_length > 0.8 * (90 - gap));
      CHECK(in_gap == 0);
    }
}

TEST_CASE("A step that no point of it shows is found by its length, with the brighter side on its right",
          "[sketch][weak]") {
  double found = 0, strictly = 0;
  for (const double theta : {0.2, 1.3, 2.5}) {
    const Point across{-std::sin(theta), std::cos(theta)};
    const cv::Mat1f clean =
        draw(kWeakCurvesSize, [=](Point p) { return 100 + 7 * reached(graph::dot(p - kMiddle, across), 1); });
    const auto steps = [&](const AttributeGraph& graph) {
      double length = 0;
      for (const graph::Edge& e : graph.edges()) {
        const graph::Patch &a = graph.patch(graph.index_of(e.a)), &b = graph.patch(graph.index_of(e.b));
        if (!graph::on_step(a) || !graph::on_step(b)) continue;
        CHECK(std::abs(graph::dot(a.position - kMiddle, across)) < 2.5);
        const Point right{-std::sin(a.theta), std::cos(a.theta)};
        CHECK(graph::dot(right, across) * a.contrast > 0);
        length += graph::distance(a.position, b.position);
      }
      return length;
    };
    const cv::Mat1f frame = with_noise(clean, 5, static_cast<std::uint64_t>(10 * theta));
    found += steps(sketch::extract(frame, {}));
    strictly += steps(sketch::extract(frame, {.sensitivity = 0}));
  }
  CHECK(found > 120);  // px, of some 400
  CHECK(strictly < 40);
}

TEST_CASE("Lines explain the steps on their flanks, the less so the more sensitive the sketch",
          "[sketch][weak]") {
  const cv::Mat1f frame = with_noise(line(0.3, 2.5, 60), 2, 5);
  const auto steps = [&](double sensitivity) {
    const AttributeGraph graph = sketch::extract(frame, {.sensitivity = sensitivity});
    return std::ranges::count_if(graph.vertices(), [](const auto& v) { return graph::on_step(v.patch); });
  };
  CHECK(steps(0.3) == 0);
  CHECK(steps(0.5) == 0);
  CHECK(steps(1) > 30);
}

TEST_CASE("More sensitivity draws more, and what it adds has less evidence", "[sketch][weak]") {
  const cv::Mat1f frame = with_noise(
      draw(kWeakCurvesSize,
           [](Point p) {
             double level = 100;
             for (int i = 0; i < 5; ++i)
               level += (4 + 9 * i) * segment({15.0, 15.0 + 22 * i}, {145.0, 22.0 + 22 * i}, 3, 1)(p);
             return level;
           }),
      6, 4);
  double before = 0;
  for (const double sensitivity : {0.0, 0.25, 0.5, 0.75}) {
    const AttributeGraph graph = sketch::extract(frame, {.sensitivity = sensitivity, .edges = false});
    double length = 0;
    for (const graph::Edge& e : graph.edges())
      length += graph::distance(graph.patch(graph.index_of(e.a)).position,
                                graph.patch(graph.index_of(e.b)).position);
    INFO("sensitivity " << sensitivity);
    CHECK(length >= before - 10);
    before = length;
    for (const graph::Vertex& v : graph.vertices()) CHECK(v.patch.evidence > 0);
  }
  // A line of four times the contrast has more evidence.
  const AttributeGraph graph = sketch::extract(frame, {.edges = false});
  const auto evidence_near = [&](double y) {
    double most = 0;
    for (const graph::Vertex& v : graph.vertices())
      if (std::abs(v.patch.position.y - y) < 6) most = std::max(most, v.patch.evidence);
    return most;
  };
  CHECK(evidence_near(18.5 + 88) > evidence_near(18.5 + 22));
}

TEST_CASE("Crowded static folds give the same full sketch in every frame", "[sketch][weak]") {
  // Bright ridges with valleys of half their depth between; each ridge raises its neighbours' response.
  for (const int period : {10, 16, 22}) {
    const double s = period / 6.0;
    const auto folds = draw({200, 160}, [&](Point p) {
      const double x = p.x + 3 * std::sin(p.y / 37);
      const auto at = [&](double c) { return std::exp(-0.5 * std::pow((x - c) / s, 2)); };
      double level = 120;
      for (int c = period; c < 200 - period / 2; c += period) level += 40 * at(c) - 20 * at(c + period / 2.0);
      return level;
    });
    double drawn_length = 0, kept = 0, of = 0, true_length = 0;
    for (int c = period; c < 200 - period / 2; c += period) true_length += 160;
    AttributeGraph before;
    for (const std::uint64_t seed : {1U, 2U, 3U}) {
      const AttributeGraph now = sketch::extract(with_noise(folds, 1.5, seed), {.edges = false});
      for (const graph::Edge& e : now.edges()) {
        const graph::Patch &a = now.patch(now.index_of(e.a)), &b = now.patch(now.index_of(e.b));
        if (a.contrast > 0 && b.contrast > 0) drawn_length += graph::distance(a.position, b.position);
      }
      const auto is_near = [](const AttributeGraph& graph, const graph::Patch& patch) {
        return std::ranges::any_of(graph.vertices(), [&](const graph::Vertex& v) {
          return v.patch.contrast * patch.contrast > 0 &&
                 graph::distance(v.patch.position, patch.position) < 5;
        });
      };
      if (!before.empty())
        for (const graph::Vertex& v : before.vertices())
          if (v.patch.contrast > 0) kept += is_near(now, v.patch) ? 1 : 0, of += 1;
      before = now;
    }
    INFO("period " << period << ": " << drawn_length / (3 * true_length) << " of the length, kept "
                   << kept / of);
    CHECK(drawn_length > 0.93 * 3 * true_length);
    CHECK(drawn_length < 1.05 * 3 * true_length);
    CHECK(kept >= 0.99 * of);
  }
}
