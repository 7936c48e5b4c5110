// SPDX-License-Identifier: Apache-2.0
#include "sketch/detection/boundaries.hpp"

#include <algorithm>
#include <cmath>

#include <opencv2/core.hpp>

#include "core/error.hpp"
#include "sketch/extract.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/sketch_scene.hpp"

using namespace emberfold;
using namespace emberfold::test;
using graph::AttributeGraph;

namespace {

const cv::Size kBoundariesSize{160, 120};

/// Left and right halves of this level, this strong in checks of 2 px.
cv::Mat1f halves(double left, double right, double rough_left, double rough_right) {
  return with_noise(draw(kBoundariesSize,
                         [=](Point p) {
                           const bool first = p.x < 80;
                           const int check = (static_cast<int>(p.x) / 2 + static_cast<int>(p.y) / 2) % 2;
                           return (first ? left : right) + (check - 0.5) * (first ? rough_left : rough_right);
                         }),
                    2, 3);
}

double greatest(const cv::Mat1f& map, int from, int to) {
  double most = 0;
  cv::minMaxLoc(map.colRange(from, to).rowRange(30, 90), nullptr, &most);
  return most;
}

double length(const AttributeGraph& graph) {
  double sum = 0;
  for (const graph::Edge& e : graph.edges())
    sum +=
        graph::distance(graph.patch(graph.index_of(e.a)).position, graph.patch(graph.index_of(e.b)).position);
  return sum;
}

double length_near(const AttributeGraph& graph, double x) {
  double sum = 0;
  for (const graph::Edge& e : graph.edges()) {
    const graph::Patch &a = graph.patch(graph.index_of(e.a)), &b = graph.patch(graph.index_of(e.b));
    if (std::abs(a.position.x - x) < 4 && std::abs(b.position.x - x) < 4)
      sum += graph::distance(a.position, b.position);
  }
  return sum;
}

}  // namespace

TEST_CASE("A boundary is where brightness or texture differ, not where both are the same", "[sketch]") {
  const auto level = sketch::find_boundaries(halves(80, 170, 0, 0)),
             texture = sketch::find_boundaries(halves(120, 120, 4, 120)),
             same = sketch::find_boundaries(halves(120, 120, 60, 60));
  CHECK(greatest(level, 77, 83) > 0.9);
  CHECK(greatest(texture, 75, 86) > 0.5);
  CHECK(greatest(same, 30, 130) < 0.2);
  CHECK(greatest(level, 30, 60) < 0.1);
}

TEST_CASE("Colours alone make a boundary", "[sketch]") {
  const cv::Mat1f grey(kBoundariesSize, 120.0F);
  cv::Mat1f more = grey.clone(), less = grey.clone();
  more.colRange(80, 160) += 60.0F;  // red; green falls so that luma stays
  less.colRange(80, 160) -= 60.0F * 0.299F / 0.587F;
  cv::Mat colour;
  cv::merge(std::vector<cv::Mat>{grey, less, more}, colour);
  CHECK(greatest(sketch::find_boundaries(colour), 77, 83) > 0.5);
  CHECK(greatest(sketch::find_boundaries(cv::Mat(grey)), 77, 83) < 0.2);
}

TEST_CASE("Boundaries are drawn as steps, more of them the more sensitive the sketch", "[sketch]") {
  const cv::Mat1f frame = halves(100, 140, 10, 60);
  double before = -1;
  for (const double sensitivity : {0.0, 0.25, 0.5, 0.75, 1.0}) {
    const AttributeGraph graph = sketch::extract(frame, {.sensitivity = sensitivity, .boundaries = true});
    INFO("sensitivity " << sensitivity);
    CHECK(std::ranges::all_of(graph.vertices(), [](const auto& v) { return graph::on_step(v.patch); }));
    CHECK(length(graph) >= 0.95 * before);
    before = length(graph);
  }
  CHECK(length_near(sketch::extract(frame, {.boundaries = true}), 79.5) > 80);
}

TEST_CASE("The boundaries of a picture on its side are those of the picture") {
  // Stripes along, beside a smooth part: as rough as stripes across.
  cv::Mat1f levels(kBoundariesSize);
  for (int y = 0; y < levels.rows; ++y)
    for (int x = 0; x < levels.cols; ++x)
      levels(y, x) = static_cast<float>(110 + (x < 80 ? 0 : 40 * std::sin(1.2 * y)));
  const cv::Mat1f found = sketch::find_boundaries(levels),
                  turned = sketch::find_boundaries(cv::Mat(levels.t()));
  double most = 0, apart = 0;
  cv::minMaxLoc(found, nullptr, &most);
  cv::minMaxLoc(cv::Mat(cv::abs(found - cv::Mat1f(turned.t()))), nullptr, &apart);
  CHECK(most > 0.5);
  CHECK(apart < 0.05);
}
