// SPDX-License-Identifier: Apache-2.0
// Laws of every sketch: symmetries, small frames, bad input, independence of threads.
#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include <opencv2/core.hpp>

#include "core/error.hpp"
#include "core/parallel.hpp"
#include "sketch/extract.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/messages.hpp"
#include "tests/support/sketch_scene.hpp"

using namespace emberfold;
using namespace emberfold::test;
using graph::AttributeGraph;

namespace {

const cv::Size kExtractLawsSize{200, 160};

/// Strokes of three widths, a ring, a T, and a step edge.
cv::Mat1f scene() {
  const std::vector<Cover> shapes = {segment({20, 20.3}, {90, 50.2}, 3, 1),
                                     segment({20, 140}, {100, 100}, 5, 1.2), ring({60, 95.3}, 25, 4, 1),
                                     segment({110, 20}, {112.3, 140}, 4, 1),
                                     segment({111, 75.2}, {150, 60}, 3, 1)};
  return draw(kExtractLawsSize, [&](Point p) {
    double bare = 1;
    for (const Cover& shape : shapes) bare *= 1 - shape(p);
    return 60 + 60 * reached(graph::dot(p - Point{150, 80}, unit(0.2)), 1.5) + 80 * (1 - bare);
  });
}

/// Bright and dark lines of all widths and directions, some 8 px apart.
cv::Mat1f thicket() {
  std::vector<Cover> bright, dark;
  for (int i = 0; i < 60; ++i) {
    const auto part = [&](double step) { return std::fmod(i * step, 1.0); };  // evenly over 0…1
    const Point middle{kExtractLawsSize.width * part(0.6180339887),
                       kExtractLawsSize.height * part(0.7548776662)};
    const Point half = unit(std::numbers::pi * part(0.5698402910)) * (12 + 20 * part(0.3247179572));
    (i % 2 == 0 ? bright : dark)
        .push_back(segment(middle - half, middle + half, 1.5 + 4 * part(0.2207440846), 1));
  }
  return draw(kExtractLawsSize, [&](Point p) {
    double up = 1, down = 1;
    for (const Cover& line : bright) up *= 1 - line(p);
    for (const Cover& line : dark) down *= 1 - line(p);
    return 120 + 70 * (down - up);
  });
}

using Mapping = std::function<Point(Point)>;

/// The share of `from`, mapped, of which `is_near` holds.
template <class Near>
double share_near(const AttributeGraph& from, const Mapping& map, const Near& is_near) {
  const auto found = std::ranges::count_if(
      from.vertices(), [&](const graph::Vertex& v) { return is_near(map(v.patch.position)); });
  return static_cast<double>(found) / static_cast<double>(from.size());
}

/// The share of `from`, mapped, that has a vertex of `to` within `tolerance` px.
double share_at_vertices(const AttributeGraph& from, const AttributeGraph& to, const Mapping& map,
                         double tolerance) {
  return share_near(from, map, [&](Point p) {
    return std::ranges::any_of(to.vertices(), [&](const graph::Vertex& w) {
      return graph::distance(p, w.patch.position) <= tolerance;
    });
  });
}

double distance_to_segment(Point p, Point a, Point b) {
  const double length2 = graph::dot(b - a, b - a);
  const double s = std::clamp(graph::dot(p - a, b - a) / length2, 0.0, 1.0);
  return graph::distance(p, a + (b - a) * s);
}

/// The share of `from`, mapped, that has an edge of `to` within `tolerance` px.
double share_on_edges(const AttributeGraph& from, const AttributeGraph& to, const Mapping& map,
                      double tolerance) {
  return share_near(from, map, [&](Point p) {
    return std::ranges::any_of(to.edges(), [&](const graph::Edge& e) {
      return distance_to_segment(p, to.patch(to.index_of(e.a)).position,
                                 to.patch(to.index_of(e.b)).position) <= tolerance;
    });
  });
}

struct Case {
  std::string name;
  cv::Mat1f frame;
  Mapping map;
};

std::vector<Case> symmetric_frames(const cv::Mat1f& frame) {
  const double right = frame.cols - 1, bottom = frame.rows - 1;
  const Mapping same = [](Point p) { return p; };
  std::vector<Case> cases = {{"mirrored left to right",
                              {},
                              [=](Point p) {
                                return Point{right - p.x, p.y};
                              }},
                             {"upside down",
                              {},
                              [=](Point p) {
                                return Point{p.x, bottom - p.y};
                              }},
                             {"turned",
                              {},
                              [=](Point p) {
                                return Point{right - p.x, bottom - p.y};
                              }},
                             {"transposed",
                              {},
                              [](Point p) {
                                return Point{p.y, p.x};
                              }},
                             {"brighter", {}, same},
                             {"half the contrast", {}, same},
                             {"negative", {}, same}};
  cv::flip(frame, cases[0].frame, 1);
  cv::flip(frame, cases[1].frame, 0);
  cv::flip(frame, cases[2].frame, -1);
  cv::transpose(frame, cases[3].frame);
  frame.convertTo(cases[4].frame, CV_32F, 1, 16);
  frame.convertTo(cases[5].frame, CV_32F, 0.5);
  frame.convertTo(cases[6].frame, CV_32F, -1, 255);
  return cases;
}

}  // namespace

TEST_CASE("Mirrored, turned, transposed, brighter, fainter and negative frames have the same sketch") {
  for (const double noise : {0.0, 5.0}) {
    const cv::Mat1f frame = noise > 0 ? with_noise(scene(), noise, 1) : scene();
    const AttributeGraph original = sketch::extract(frame, {});
    REQUIRE(original.size() > 100);
    for (const auto& [name, changed, map] : symmetric_frames(frame)) {
      const AttributeGraph found = sketch::extract(changed, {});
      const double vertices = share_at_vertices(original, found, map, 0.1);
      const double edges = share_on_edges(original, found, map, 0.25);
      INFO(name << ", noise " << noise << ": " << found.size() << " of " << original.size()
                << " patches, components " << components(found).count << " of " << components(original).count
                << ", shares " << vertices << ", " << edges);
      const double more = static_cast<double>(found.size()) / static_cast<double>(original.size());
      // Half the contrast has half the noise, but not half the rounding to grey levels that is reckoned with.
      CHECK(std::abs(more - 1) <= 0.02);
      CHECK(vertices >= 0.98);
      CHECK(edges >= 0.98);
    }
  }
}

TEST_CASE("Where curves lie close to each other, flipped and turned frames have the same sketch as well") {
  const cv::Mat1f frame = with_noise(thicket(), 2, 3);
  const AttributeGraph original = sketch::extract(frame, {});
  REQUIRE(original.size() > 200);
  for (const auto& [name, changed, map] : symmetric_frames(frame)) {
    if (name == "half the contrast" || name == "negative") continue;
    const AttributeGraph found = sketch::extract(changed, {});
    INFO(name << ": " << found.size() << " of " << original.size() << " patches");
    const double share = share_at_vertices(original, found, map, 0.1);
    CHECK(share >= 0.985);
  }
}

TEST_CASE("A shift of all levels leaves every patch where it is") {
  const cv::Mat1f frame = with_noise(scene(), 3, 2);
  const AttributeGraph here = sketch::extract(frame, {}), there = sketch::extract(frame + 32, {});
  REQUIRE(share_at_vertices(
              here, there, [](Point p) { return p; }, 0.01) >= 0.98);
}

TEST_CASE("Frames too small for a stroke have none, and are taken") {
  for (const cv::Size size :
       {cv::Size(1, 1), cv::Size(1, 50), cv::Size(50, 1), cv::Size(2, 2), cv::Size(3, 50), cv::Size(50, 3),
        cv::Size(2, 50), cv::Size(5, 5), cv::Size(9, 9)})
    for (const int scales : {1, 5, 12}) {
      const sketch::ExtractOptions options{.scales = scales};
      INFO(size.width << " × " << size.height << ", " << scales << " scales");
      REQUIRE(sketch::extract(cv::Mat1f(size, 100.0F), options).empty());
      REQUIRE(sketch::extract(with_noise(cv::Mat1f(size, 100.0F), 20, 1), options).empty());
      const auto chequered =
          draw(size, [](Point p) { return static_cast<int>(p.x + p.y) % 2 == 0 ? 0.0 : 255.0; });
      REQUIRE(sketch::extract(chequered, options).empty());
      REQUIRE(sketch::extract(cv::Mat(size, CV_32FC3, cv::Scalar(1, 2, 3)), options).empty());
    }
}

TEST_CASE("A frame that is part of a larger one is read as itself") {
  const cv::Mat1f frame = scene();
  cv::Mat1f larger(frame.rows + 20, frame.cols + 30, 200.0F);
  frame.copyTo(larger(cv::Rect(10, 10, frame.cols, frame.rows)));
  REQUIRE(sketch::extract(larger(cv::Rect(10, 10, frame.cols, frame.rows)), {}) ==
          sketch::extract(frame, {}));
}

TEST_CASE("Frames of another kind, empty ones, and values that are not finite are refused") {
  for (const int type : {CV_8UC1, CV_8UC3, CV_16UC1, CV_64FC1, CV_32FC2, CV_32FC4})
    REQUIRE_THROWS_AS(sketch::extract(cv::Mat::zeros(20, 20, type), {}), core::InputError);
  REQUIRE_THROWS_AS(sketch::extract(cv::Mat(), {}), core::InputError);
  for (const float bad : {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity(),
                          -std::numeric_limits<float>::infinity()}) {
    cv::Mat1f frame(40, 40, 100.0F);
    frame(39, 39) = bad;
    const std::string message = message_of<core::InputError>([&] { (void)sketch::extract(frame, {}); });
    REQUIRE(message.find("not finite") != std::string::npos);
    cv::Mat3f colour(40, 40, cv::Vec3f(1, 2, 3));
    colour(0, 0)[2] = bad;
    REQUIRE_THROWS_AS(sketch::extract(colour, {}), core::InputError);
  }
}

TEST_CASE("Options out of range are refused by name, value and range") {
  using sketch::ExtractOptions;
  const double nan = std::numeric_limits<double>::quiet_NaN(),
               infinite = std::numeric_limits<double>::infinity();
  struct Wrong {
    ExtractOptions options;
    const char *field, *value, *allowed;
  };
  const std::vector<Wrong> all = {{{.finest_scale = 0.5}, "finest_scale", "0.5", "0.7 to 20"},
                                  {{.finest_scale = nan}, "finest_scale", "not finite", "0.7 to 20"},
                                  {{.finest_scale = infinite}, "finest_scale", "not finite", "0.7 to 20"},
                                  {{.scales = 0}, "scales", "0", "1 to 12"},
                                  {{.scales = 13}, "scales", "13", "1 to 12"},
                                  {{.sensitivity = 1.5}, "sensitivity", "1.5", "0 to 1"},
                                  {{.sensitivity = nan}, "sensitivity", "not finite", "0 to 1"},
                                  {{.min_contrast = -1}, "min_contrast", "-1", "at least 0"},
                                  {{.min_length = -2}, "min_length", "-2", "at least 0"},
                                  {{.min_length = infinite}, "min_length", "not finite", "at least 0"},
                                  {{.spacing = 1.5}, "spacing", "1.5", "2 to 100"},
                                  {{.spacing = nan}, "spacing", "not finite", "2 to 100"}};
  for (const Wrong& wrong : all) {
    const std::string message = message_of<core::InputError>([&] { wrong.options.validate(); });
    INFO(wrong.field << ": " << message);
    REQUIRE(message.find(wrong.field) != std::string::npos);
    REQUIRE(message.find(wrong.value) != std::string::npos);
    REQUIRE(message.find(wrong.allowed) != std::string::npos);
    REQUIRE(message_of<core::InputError>(
                [&] { (void)sketch::extract(cv::Mat1f(9, 9, 1.0F), wrong.options); }) == message);
  }
  REQUIRE_NOTHROW(ExtractOptions{}.validate());
}

TEST_CASE("Options do what they say") {
  const cv::Mat1f frame = scene();
  const auto with = [&](const sketch::ExtractOptions& options) { return sketch::extract(frame, options); };
  const AttributeGraph all = with({}), lines = with({.edges = false}), wide = with({.spacing = 10});
  const auto steps = [](const AttributeGraph& g) {
    return std::count_if(g.vertices().begin(), g.vertices().end(),
                         [](const graph::Vertex& v) { return v.patch.width == 0; });
  };
  REQUIRE(steps(all) > 10);
  REQUIRE(steps(lines) == 0);
  REQUIRE(std::abs(static_cast<double>(wide.size()) / static_cast<double>(all.size()) - 0.5) < 0.1);
  REQUIRE(with({.min_contrast = 150}).empty());
  REQUIRE(with({.min_length = 1000}).empty());
}

TEST_CASE("The same frame gives the same sketch, on any number of threads") {
  std::vector<cv::Mat1f> frames;
  for (std::uint64_t seed = 1; seed <= 6; ++seed) frames.push_back(with_noise(scene(), 5, seed));
  std::vector<AttributeGraph> alone, together(frames.size());
  for (const cv::Mat1f& frame : frames) alone.push_back(sketch::extract(frame, {}));
  for (const std::size_t threads : {1U, 4U}) {
    const core::ThreadLimit limit(threads);
    core::parallel_for(frames.size(), {},
                       [&](std::size_t i) { together[i] = sketch::extract(frames[i], {}); });
    REQUIRE(together == alone);
  }
}
