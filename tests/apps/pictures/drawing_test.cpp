// SPDX-License-Identifier: Apache-2.0
#include <set>

#include <opencv2/core.hpp>

#include "apps/pictures/draw.hpp"
#include "apps/pictures/match_picture.hpp"
#include "apps/pictures/overlay.hpp"
#include "graph/events/events.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/clip_fixture.hpp"
#include "tests/support/drawn_motion.hpp"

using namespace emberfold;
using namespace emberfold::apps;
using namespace emberfold::test;

namespace {

double changed(const cv::Mat& a, const cv::Mat& b) {
  return cv::norm(a, b, cv::NORM_L1);
}

graph::Vertex vertex(std::uint32_t id, double x, double y, std::uint32_t stroke = 1) {
  graph::Vertex v{{id}, {stroke}, {}};
  v.patch.position = {x, y};
  v.patch.width = 2;
  return v;
}

int distance(const cv::Vec3b& pixel, Colour colour) {
  return std::max(
      {std::abs(pixel[2] - colour.red), std::abs(pixel[1] - colour.green), std::abs(pixel[0] - colour.blue)});
}

graph::Event event(int frame, graph::EventType type, graph::Point place = {30, 30}) {
  graph::Event e;
  e.frame = frame, e.type = type, e.position = place;
  return e;
}

}  // namespace

TEST_CASE("a frame is enlarged to 480 px, never reduced, never beyond bounds, to even sizes") {
  for (const cv::Size size :
       {cv::Size(2, 2), {320, 240}, {352, 640}, {641, 481}, {1280, 720}, {5000, 3}, {1, 1}}) {
    const double scale = enlargement(size, 480);
    const cv::Mat large = enlarge(cv::Mat(size, CV_8UC3, cv::Scalar(9, 9, 9)), scale);
    INFO(size << " scale " << scale << " gives " << large.size());
    CHECK(scale >= 1);
    CHECK(large.cols % 2 == 0);
    CHECK(large.rows % 2 == 0);
    CHECK((large.cols <= 3841 || scale == 1));
    CHECK((std::min(large.cols, large.rows) >= 480 || std::max(large.cols, large.rows) >= 3840));
    CHECK(changed(large, cv::Mat(large.size(), CV_8UC3, cv::Scalar(9, 9, 9))) == 0);
  }
}

TEST_CASE("a clip's pixel centre falls on the centre of its block in the enlarged picture") {
  const Placement place{4, {100, 50}};
  // pixel 0 covers picture columns 100…103, whose centre is 101.5
  CHECK(place({0, 0}).x == 101.5);
  CHECK(place({0, 0}).y == 51.5);
  CHECK(place({3, 2}).x - place({2, 2}).x == 4);
}

TEST_CASE("neighbouring identities have colours that differ, the same identity the same one") {
  std::set<std::string> seen;
  for (std::uint32_t id = 1; id < 200; ++id) {
    const auto a = stroke_colour(id), b = stroke_colour(id + 1);
    CHECK(std::abs(a.red - b.red) + std::abs(a.green - b.green) + std::abs(a.blue - b.blue) > 90);
    CHECK(a.red + a.green + a.blue > 200);  // none that a dark frame swallows
    seen.insert(hex(a));
  }
  CHECK(seen.size() > 150);
  CHECK(hex({0, 171, 255}) == "#00abff");
}

TEST_CASE("a curve is drawn in its stroke's colour, where it lies") {
  const graph::AttributeGraph graph(
      {vertex(0, 10, 20, 7), vertex(1, 15, 20, 7), vertex(2, 50, 20, 7), vertex(3, 30, 40, 9)},
      {{{0}, {1}}, {{1}, {2}}});
  const cv::Mat frame(60, 80, CV_8UC3, cv::Scalar(60, 60, 60));
  const cv::Mat picture = draw_sketch(frame, graph);
  const Placement place{enlargement(frame.size(), 480), {}};
  const auto at = [&](graph::Point p) {
    return picture.at<cv::Vec3b>(cv::Point(cvRound(place(p).x), cvRound(place(p).y)));
  };
  CHECK(distance(at({32, 20}), stroke_colour(7)) < 8);
  CHECK(distance(at({30, 40}), stroke_colour(9)) < 8);
  const Colour ground{47, 47, 47};  // 0.78 of 60
  CHECK(distance(at({32, 24}), ground) < 2);
  CHECK(distance(at({60, 20}), ground) < 2);
}

TEST_CASE("outlines along the border, and what only joins outlines, are not drawn") {
  const auto step = [](std::uint32_t id, double x, double y, double contrast) {
    graph::Vertex v = vertex(id, x, y, 7);
    v.patch.width = 0, v.patch.contrast = contrast;
    return v;
  };
  const graph::AttributeGraph graph({step(0, 10, 20, 40), step(1, 40, 20, 40), step(2, 70, 20, 40),
                                     step(3, 40, 40, 40), step(4, 10, 1, 0), step(5, 70, 1, 0)},
                                    {{{0}, {1}}, {{1}, {2}}, {{1}, {3}}, {{4}, {5}}});
  const cv::Mat frame(60, 80, CV_8UC3, cv::Scalar(60, 60, 60));
  const cv::Mat picture = draw_sketch(frame, graph);
  const Placement place{enlargement(frame.size(), 480), {}};
  const auto at = [&](graph::Point p) {
    return picture.at<cv::Vec3b>(cv::Point(cvRound(place(p).x), cvRound(place(p).y)));
  };
  const Colour ground{47, 47, 47};  // 0.78 of 60
  CHECK(distance(at({25, 20}), stroke_colour(7)) < 8);
  for (const graph::Point p : {graph::Point{40, 30}, {40, 1}, {10, 1}}) CHECK(distance(at(p), ground) < 2);
}

TEST_CASE("an event's mark is there from its frame on for six frames, fading, and only near its place") {
  const cv::Mat frame(240, 320, CV_8UC3, cv::Scalar(50, 50, 50));
  const std::vector<graph::Event> events{event(10, graph::EventType::merge, {100, 100})};
  const cv::Rect picture(0, 0, 640, 480);
  const auto shown = [&](int t) { return draw_overlay(frame, {}, t, events)(picture).clone(); };
  const cv::Mat none = shown(9);
  CHECK(changed(none, draw_overlay(frame, {}, 9, {})(picture)) == 0);
  double last = 1e300;
  for (int t = 10; t < 16; ++t) {
    const cv::Mat now = shown(t);
    const double difference = changed(now, none);
    INFO("frame " << t);
    CHECK(difference > 0);
    CHECK(difference < last);
    last = difference;
    cv::Mat elsewhere = now.clone(), ground = none.clone();
    const cv::Rect near(200 - 20, 200 - 20, 42, 42);
    elsewhere(near).setTo(0);
    ground(near).setTo(0);
    CHECK(changed(elsewhere, ground) == 0);
  }
  CHECK(changed(shown(16), none) == 0);
}

TEST_CASE("the six marks differ in shape, not in colour alone, and may lie outside of the picture") {
  std::vector<cv::Mat> shapes;
  for (const auto type : graph::all_event_types()) {
    cv::Mat picture(60, 60, CV_8UC3, cv::Scalar::all(0));
    draw_mark(picture, {30, 30}, type, 13);
    cv::Mat grey;
    cv::transform(picture, grey, cv::Matx13f(1, 1, 1));
    shapes.push_back(grey > 0);
    cv::Mat untouched(20, 20, CV_8UC3, cv::Scalar::all(7));
    draw_mark(untouched, {-80, 500}, type, 13);
    CHECK(changed(untouched, cv::Mat(20, 20, CV_8UC3, cv::Scalar::all(7))) == 0);
    draw_mark(untouched, {0, 19}, type, 13);
    CHECK(changed(untouched, cv::Mat(20, 20, CV_8UC3, cv::Scalar::all(7))) > 0);
  }
  for (std::size_t a = 0; a < shapes.size(); ++a)
    for (std::size_t b = a + 1; b < shapes.size(); ++b)
      CHECK(cv::norm(shapes[a], shapes[b], cv::NORM_HAMMING) > 8 * 60);
}

TEST_CASE("every picture of an overlay has the same size, whatever happens in it") {
  const auto strokes = made_strokes(8, 90, 160, 12);
  const auto motion = made_motion(strokes, 90, 160, 12);
  const auto events = graph::stroke_events(motion);
  std::set<std::pair<int, int>> sizes;
  for (const int t : {0, 3, 11}) {
    const auto& graph = motion.sketch.frames[static_cast<std::size_t>(t)];
    const cv::Mat overlay = draw_overlay(made_picture(strokes, 90, 160, t), graph, t, events);
    sizes.emplace(overlay.cols, overlay.rows);
    CHECK(overlay.cols % 2 + overlay.rows % 2 == 0);
    sizes.emplace(draw_overlay(made_picture(strokes, 90, 160, t), graph, 12345, events).cols, overlay.rows);
  }
  CHECK(sizes.size() == 1);
}

TEST_CASE("the surer an event the stronger its mark and below one half it has none") {
  const cv::Mat frame(48, 64, CV_8UC3, cv::Scalar(40, 40, 40));
  const auto drawn = [&](double probability) {
    auto shown = event(3, graph::EventType::split, {30, 24});
    shown.probability = probability;
    return draw_overlay(frame, {}, 3, {&shown, 1});
  };
  const cv::Mat none = draw_overlay(frame, {}, 3, {});
  CHECK(changed(drawn(0.49), none) == 0);
  double before = 0;
  for (const double probability : {0.5, 0.7, 0.9, 1.0}) {
    const double now = changed(drawn(probability), none);
    CHECK(now > 1.1 * before);
    before = now;
  }
  CHECK(mark_opacity(1) == 1);
}

TEST_CASE("strokes tied by links share a cluster, those without have none") {
  // before: a line 0-1-2-3, alone 4; after: the line in two, a new 9
  graph::MotionGraph motion;
  motion.sketch.width = motion.sketch.height = 60;
  motion.sketch.frames.emplace_back(
      std::vector{vertex(0, 5, 5), vertex(1, 10, 5), vertex(2, 15, 5), vertex(3, 20, 5), vertex(4, 40, 40)},
      std::vector<graph::Edge>{{{0}, {1}}, {{1}, {2}}, {{2}, {3}}});
  motion.sketch.frames.emplace_back(
      std::vector{vertex(5, 5, 6), vertex(6, 10, 6), vertex(7, 15, 6), vertex(8, 20, 6), vertex(9, 50, 10)},
      std::vector<graph::Edge>{{{5}, {6}}, {{7}, {8}}});
  motion.links = {{}, {{{0}, {5}}, {{1}, {6}}, {{2}, {7}}, {{3}, {8}}}};
  const auto clusters = gap_clusters(motion, 1);
  CHECK(clusters.before == std::vector<std::uint32_t>{1, 1, 1, 1, 0});
  CHECK(clusters.after == std::vector<std::uint32_t>{1, 1, 1, 1, 0});
}

TEST_CASE("clusters are the same as by identities where nothing happens") {
  const auto strokes = made_strokes(20, 300, 200, 40, 5);
  const auto motion = made_motion(strokes, 300, 200, 40);
  const auto events = graph::stroke_events(motion);
  for (int t = 1; t < 40; ++t) {
    if (!events_between(events, t, t).empty()) continue;
    const auto clusters = gap_clusters(motion, t);
    const auto& before = motion.sketch.frames[static_cast<std::size_t>(t) - 1];
    std::set<std::pair<std::uint32_t, std::uint32_t>> pairs;
    for (std::size_t i = 0; i < before.size(); ++i)
      pairs.emplace(clusters.before[i], before.vertices()[i].subgraph.value);
    CHECK(pairs.size() == graph::components(before).count);
  }
}

TEST_CASE("the most eventful gaps: by number, then time, never two neighbours") {
  using enum graph::EventType;
  const std::vector<graph::Event> events{event(2, birth), event(5, birth), event(5, death), event(6, birth),
                                         event(6, split), event(9, merge), event(20, birth)};
  CHECK(eventful_gaps(events, 6) == std::vector<int>{2, 5, 9, 20});
  CHECK(eventful_gaps(events, 2) == std::vector<int>{2, 5});
  CHECK(eventful_gaps({}, 6).empty());
}

TEST_CASE("a matched pair: both frames side by side, one colour for a stroke on both") {
  const graph::AttributeGraph before({vertex(0, 10, 30), vertex(1, 50, 30)}, {{{0}, {1}}});
  const graph::AttributeGraph after(
      {vertex(2, 10, 30), vertex(3, 50, 30), vertex(4, 10, 10), vertex(5, 50, 10)}, {{{2}, {3}}, {{4}, {5}}});
  graph::MotionGraph motion;
  motion.sketch.width = 64, motion.sketch.height = 48;
  motion.sketch.frames = {before, after};
  motion.links = {{}, {{{0}, {2}}, {{1}, {3}}}};
  const cv::Mat frame(48, 64, CV_8UC3, cv::Scalar(40, 40, 40));
  const std::vector<graph::Event> events{event(1, graph::EventType::birth, {50, 40})};
  const cv::Mat picture = draw_match(frame, frame, motion, 1, events);
  const double scale = enlargement(frame.size(), 480);
  const auto at = [&](double x, double y, bool right) {
    const Placement place{scale, {right ? 640.0 + 12 : 0.0, 30}};
    const auto p = place({x, y});
    return picture.at<cv::Vec3b>(cv::Point(cvRound(p.x), cvRound(p.y)));
  };
  CHECK(distance(at(30, 30, false), stroke_colour(1)) < 8);
  CHECK(distance(at(30, 30, true), stroke_colour(1)) < 8);
  CHECK(distance(at(30, 10, true), {255, 255, 255}) < 8);
  CHECK(at(30, 10, false) == at(3, 3, false));
  // a birth is marked where it can be seen: in the later frame
  CHECK(distance(at(50, 40 - 13 / scale, true), event_colour(graph::EventType::birth)) < 60);
  CHECK(at(50, 40 - 13 / scale, false) == at(3, 3, false));
}
