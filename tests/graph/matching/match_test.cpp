// SPDX-License-Identifier: Apache-2.0
#include "graph/matching/match.hpp"

#include <map>
#include <numbers>
#include <set>

#include "core/error.hpp"
#include "graph/events/events.hpp"
#include "graph/matching/chosen_links.hpp"
#include "graph/matching/time_reversal.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/graphs.hpp"
#include "tests/support/messages.hpp"

using namespace emberfold;
using graph::EventType;
using graph::Point;

namespace {

/// Curved strokes that sway about their rest by a second-order auto-regression, cut into patches anew in
/// every frame: the phase along the stroke, the ends, places, angles and contrasts vary.
class Swaying {
 public:
  struct Stroke {
    Point rest;  // of its middle
    double length, angle, bend, contrast;
    Point offset, past;                                     // of the sway
    std::vector<std::pair<double, double>> pieces{{0, 1}};  // what of it is there, as shares of its length
  };

  explicit Swaying(std::uint64_t seed) : rng_(seed) {}

  std::size_t add(Point rest, double length, double angle, double contrast = 40) {
    strokes_.push_back({rest, length, angle, rng_.uniform(-0.01, 0.01), contrast, {}, {}, {{0, 1}}});
    return strokes_.size() - 1;
  }
  Stroke& operator[](std::size_t k) { return strokes_[k]; }
  /// A straight bridge from the middle of one stroke to that of another, or none.
  void bridge(std::size_t a, std::size_t b) { bridges_.emplace_back(a, b); }
  void unbridge() { bridges_.clear(); }

  [[nodiscard]] Point at(const Stroke& stroke, double share) const {
    const double s = (share - 0.5) * stroke.length;
    const Point along{std::cos(stroke.angle), std::sin(stroke.angle)}, normal{-along.y, along.x};
    // The sway turns the stroke a little as well.
    const double turn = 0.004 * stroke.offset.x * s;
    return stroke.rest + stroke.offset + along * s + normal * (0.5 * stroke.bend * s * s + turn);
  }

  void step() {
    for (Stroke& stroke : strokes_) {
      const Point next =
          stroke.offset * 1.7 + stroke.past * -0.85 + Point{0.7 * rng_.normal(), 0.7 * rng_.normal()};
      stroke.past = stroke.offset;
      stroke.offset = next;
    }
  }

  /// The frame, and of each of its vertices the stroke it lies on (bridges count on after the strokes).
  graph::AttributeGraph frame(std::vector<std::size_t>& owner) {
    test::Frame frame;
    owner.clear();
    std::map<std::size_t, std::uint32_t> middles;
    for (std::size_t k = 0; k < strokes_.size(); ++k) {
      const Stroke& stroke = strokes_[k];
      for (const auto& [from, to] : stroke.pieces) {
        const double low = from + 1.5 * rng_.normal() / stroke.length,
                     high = to + 1.5 * rng_.normal() / stroke.length;
        const bool joined = std::any_of(bridges_.begin(), bridges_.end(), [k](const auto& pair) {
          return pair.first == k || pair.second == k;
        });
        std::vector<double> cuts = steps(low, joined ? 0.5 : high, stroke.length);
        if (joined) {
          middles[k] = static_cast<std::uint32_t>(frame.vertices.size() + cuts.size() - 1);
          const auto rest = steps(0.5, high, stroke.length);
          cuts.insert(cuts.end(), rest.begin() + 1, rest.end());
        }
        std::vector<Point> points;
        for (const double share : cuts) points.push_back(noisy(at(stroke, share)));
        frame.line(points, stroke.contrast * std::exp(0.1 * rng_.normal()));
        owner.resize(frame.vertices.size(), k);
      }
    }
    for (std::size_t b = 0; b < bridges_.size(); ++b) {
      const auto [i, j] = bridges_[b];
      const Point from = at(strokes_[i], 0.5), to = at(strokes_[j], 0.5);
      const auto cuts = steps(0, 1, graph::distance(from, to));
      std::vector<Point> points;
      for (std::size_t k = 1; k + 1 < cuts.size(); ++k) points.push_back(noisy(from + (to - from) * cuts[k]));
      const auto first = frame.line(points, strokes_[i].contrast);
      frame.edge(middles.at(i), first);
      frame.edge(static_cast<std::uint32_t>(frame.vertices.size() - 1), middles.at(j));
      owner.resize(frame.vertices.size(), strokes_.size() + b);
    }
    for (auto& v : frame.vertices) {
      v.patch.theta += 0.06 * rng_.normal() + (rng_.uniform() < 0.5 ? std::numbers::pi : 0);
    }
    return frame.graph();
  }

 private:
  std::vector<double> steps(double from, double to, double length) {
    const int count =
        std::max(1, static_cast<int>(std::lround((to - from) * length / 5 + rng_.uniform(-0.5, 0.5))));
    std::vector<double> result;
    for (int k = 0; k <= count; ++k) result.push_back(from + (to - from) * k / count);
    return result;
  }
  Point noisy(Point p) { return p + Point{0.3 * rng_.normal(), 0.3 * rng_.normal()}; }

  core::Rng rng_;
  std::vector<Stroke> strokes_;
  std::vector<std::pair<std::size_t, std::size_t>> bridges_;
};

/// A field of strokes about 35 px apart.
Swaying field(std::uint64_t seed) {
  Swaying scene(seed);
  core::Rng rng(seed + 77);
  for (int row = 0; row < 4; ++row) {
    for (int column = 0; column < 6; ++column) {
      scene.add({30.0 + 45 * column, 35.0 + 55 * row}, rng.uniform(30, 45), 1.3 + rng.uniform(-0.3, 0.3),
                (row + column) % 3 == 0 ? -35 : 40);
    }
  }
  return scene;
}

struct Expected {
  int frame;
  EventType type;
  Point place;
};

std::vector<graph::Link> identity(const graph::AttributeGraph& g) {
  std::vector<graph::Link> links;
  for (const auto& v : g.vertices()) links.push_back({v.id, v.id});
  return links;
}

graph::AttributeGraph shifted(const graph::AttributeGraph& g, Point by) {
  std::vector<graph::Vertex> vertices(g.vertices().begin(), g.vertices().end());
  for (auto& v : vertices) v.patch.position = v.patch.position + by;
  return {vertices, {g.edges().begin(), g.edges().end()}};
}

}  // namespace

TEST_CASE("Swaying strokes are followed, and exactly what changes is an event", "[graph][match]") {
  for (std::uint64_t seed = 0; seed < 6; ++seed) {
    Swaying scene = field(seed);
    std::vector<Expected> expected;
    graph::SketchSequence sketch;
    sketch.width = 320;
    sketch.height = 240;
    std::vector<std::vector<std::size_t>> owners;
    for (int t = 0; t < 30; ++t) {
      scene.step();
      const auto mark = [&](EventType type, Point place) { expected.push_back({t, type, place}); };
      const auto middle = [&](std::size_t k) { return scene.at(scene[k], 0.5); };
      const auto between = [&] { return (middle(7) + middle(8)) * 0.5; };
      if (t == 4) scene[2].pieces.clear(), mark(EventType::death, middle(2));
      if (t == 6) scene[4].pieces = {{0, 0.32}, {0.68, 1}}, mark(EventType::split, middle(4));
      if (t == 9) scene.bridge(7, 8), mark(EventType::connect, between());
      if (t == 12) scene[2].pieces = {{0, 1}}, mark(EventType::birth, middle(2));
      if (t == 15) scene[4].pieces = {{0, 1}}, mark(EventType::merge, middle(4));
      if (t == 17) scene[20].pieces = {{0.2, 0.8}};  // shrinks: no event
      if (t == 18) scene.unbridge(), mark(EventType::disconnect, between());
      if (t == 24) scene[20].pieces = {{0, 1}};
      owners.emplace_back();
      sketch.append(scene.frame(owners.back()));
    }
    const auto result = graph::match(sketch, {});
    const auto events = graph::stroke_events(result);
    CAPTURE(seed, events.size());
    REQUIRE(events.size() == expected.size());
    for (std::size_t k = 0; k < events.size(); ++k) {
      CHECK(events[k].frame == expected[k].frame);
      CHECK(events[k].type == expected[k].type);
      CHECK(graph::distance(events[k].position, expected[k].place) < 6);
    }
    std::size_t links = 0, right = 0, patches = 0;
    for (std::size_t t = 1; t < owners.size(); ++t) {
      const auto &before = result.sketch.frames[t - 1], &after = result.sketch.frames[t];
      patches += before.size();
      for (const auto& link : result.links[t]) {
        ++links;
        right += owners[t - 1][before.index_of(link.before)] == owners[t][after.index_of(link.after)];
      }
    }
    CHECK(static_cast<double>(right) >= 0.998 * static_cast<double>(links));
    CHECK(static_cast<double>(links) >= 0.9 * static_cast<double>(patches));
  }
}

TEST_CASE("A graph matches itself vertex by vertex", "[graph][match]") {
  for (std::uint64_t seed = 0; seed < 10; ++seed) {
    Swaying scene = field(seed);
    scene.bridge(7, 8);
    scene.bridge(13, 14);
    std::vector<std::size_t> owner;
    const auto frame = scene.frame(owner);
    CHECK(graph::match_frames(frame, frame, {}, {}) == identity(frame));
  }
  test::Frame ring;
  std::vector<Point> points;
  for (int k = 0; k < 20; ++k)
    points.push_back({50 + 16 * std::cos(0.1 * k * 3.1416), 50 + 16 * std::sin(0.1 * k * 3.1416)});
  ring.line(points);
  ring.edge(0, 19);
  CHECK(graph::match_frames(ring.graph(), ring.graph(), {}, {}) == identity(ring.graph()));
}

TEST_CASE("A match does not depend on where the frame's origin is", "[graph][match]") {
  for (std::uint64_t seed = 0; seed < 10; ++seed) {
    Swaying scene = field(seed);
    std::vector<std::size_t> owner;
    scene.step();
    const auto before = scene.frame(owner);
    scene.step();
    scene.bridge(7, 8);
    const auto after = scene.frame(owner);
    const auto links = graph::match_frames(before, after, {}, {});
    CHECK(links.size() > 100);
    for (const Point by : {Point{64, 32}, Point{-1024, 4096}, Point{3.7, -0.2}}) {
      CHECK(graph::match_frames(shifted(before, by), shifted(after, by), {}, {}) == links);
      // Strokes that move at the given velocity are matched as if they stood still, however fast.
      const std::vector<Point> velocity(before.size(), by);
      CHECK(graph::match_frames(before, shifted(after, by), velocity, {}) == links);
    }
  }
}

TEST_CASE("A motion that goes on is followed although it is faster than strokes are apart",
          "[graph][match]") {
  // Upright strokes 14 px apart that move aside, faster and faster, up to 10 px a frame.
  graph::SketchSequence sketch;
  sketch.width = sketch.height = 400;
  double x = 0, speed = 0;
  for (int t = 0; t < 30; ++t) {
    test::Frame frame;
    for (int k = 0; k < 8; ++k) frame.line(test::segment({x + 14.0 * k, 20}, {x + 14.0 * k + 3, 60}, 9));
    sketch.append(frame.graph());
    speed = std::min(10.0, speed + 1);
    x += speed;
  }
  const auto result = graph::match(sketch, {});
  CHECK(graph::stroke_events(result).empty());
  for (std::size_t t = 1; t < sketch.frames.size(); ++t) {
    REQUIRE(result.links[t].size() == 72);
    for (const auto& link : result.links[t]) CHECK(link.after.value - link.before.value == 72);
  }
}

TEST_CASE("A patch slips along its stroke rather than across", "[graph][match]") {
  for (const double theta : {0.0, 1.0}) {
    const Point along{std::cos(theta), std::sin(theta)}, across{-along.y, along.x};
    const auto patch = [&](std::uint32_t id, Point at) { return test::vertex(id, at.x, at.y, theta); };
    const graph::AttributeGraph before({patch(0, {50, 50})}, {});
    const graph::AttributeGraph after(
        {patch(0, Point{50, 50} + across * 5), patch(1, Point{50, 50} + along * 4)}, {});
    const auto links = graph::match_frames(before, after, {}, {});
    REQUIRE(links.size() == 1);
    CHECK(links[0].after.value == 1);
  }
}

TEST_CASE("Strokes of another kind or too far are not the same", "[graph][match]") {
  const auto stroke = [](Point at, double contrast) {
    test::Frame frame;
    frame.line(test::segment(at, at + Point{0, 40}, 9), contrast);
    return frame.graph();
  };
  CHECK(graph::match_frames(stroke({0, 0}, 40), stroke({1, 0}, 40), {}, {}).size() == 9);
  CHECK(graph::match_frames(stroke({0, 0}, 40), stroke({1, 0}, -40), {}, {}).empty());
  CHECK(graph::match_frames(stroke({0, 0}, 40), stroke({30, 0}, 40), {}, {}).empty());
  graph::MatchOptions strict;
  strict.max_motion = 2;
  CHECK(graph::match_frames(stroke({0, 0}, 40), stroke({2.5, 0}, 40), {}, strict).empty());
}

TEST_CASE("A stroke that dies beside one that grows is not the same", "[graph][match]") {
  test::Frame before, after;
  before.line(test::segment({0, 0}, {0, 40}, 9));
  before.line(test::segment({1, 46}, {1, 91}, 10));
  after.line(test::segment({0, 0}, {0, 52}, 12));  // grown over the first patches of the one below
  graph::SketchSequence sketch;
  sketch.append(before.graph());
  sketch.append(after.graph());
  graph::MatchOptions options;
  options.flicker = 0;  // two frames cannot tell what lasts
  const auto events = graph::stroke_events(graph::match(sketch, options));
  REQUIRE(events.size() == 1);
  CHECK(events[0].type == EventType::death);
  CHECK(graph::distance(events[0].position, {1, 68.5}) < 1e-9);
}

TEST_CASE("Whatever the graphs, the links are a star forest", "[graph][match]") {
  for (std::uint64_t seed = 0; seed < 60; ++seed) {
    core::Rng rng(seed);
    const auto before = test::random_graph(rng, rng.below(12), rng.below(12));
    const auto after = test::random_graph(rng, rng.below(12), rng.below(12));
    graph::SketchSequence sketch;
    for (const auto* frame : {&before, &after, &before, &after}) sketch.append(*frame);
    const auto result = graph::match(sketch, {});
    CHECK(test::message_of<core::InputError>([&] { graph::validate(result); }).empty());
    CHECK(result.sketch.frames.size() == 4);
  }
}

TEST_CASE("The graph of a clip played backwards is its graph backwards", "[graph][match]") {
  const auto check = [](const graph::SketchSequence& sketch) {
    CHECK(graph::reverse_time(graph::match(graph::reverse_time(sketch), {})) == graph::match(sketch, {}));
  };
  for (std::uint64_t seed = 0; seed < 4; ++seed) {
    Swaying scene = field(seed);
    graph::SketchSequence sketch;
    for (int t = 0; t < 20; ++t) {
      // Two steps a frame: where strokes sway by more than the half of what they are apart, the match is in
      // doubt.
      scene.step(), scene.step();
      if (t == 8) scene[4].pieces = {{0, 0.4}, {0.6, 1}};
      if (t == 12) scene.bridge(7, 8);
      std::vector<std::size_t> owner;
      sketch.append(scene.frame(owner));
    }
    check(sketch);
  }
  for (std::uint64_t seed = 0; seed < 60; ++seed) {
    core::Rng rng(seed);
    graph::SketchSequence sketch;
    for (int t = 0; t < 5; ++t) sketch.append(test::random_graph(rng, rng.below(12), rng.below(12)));
    check(sketch);
  }
}

TEST_CASE("Of two sets of links those with fewer changes count, then the more, then the shorter ones",
          "[graph][match]") {
  using Links = std::vector<graph::Link>;
  const auto line = [](test::Frame& frame, double y, int patches) {
    std::vector<Point> points;
    for (int k = 0; k < patches; ++k) points.push_back({10.0 + 5 * k, y});
    frame.line(points);
  };
  // Two strokes of three patches stay; a third one far away is a group of its own.
  const auto lines_from = [&](double y) {
    test::Frame frame;
    line(frame, y, 3), line(frame, y + 10, 3), line(frame, y + 70, 2);
    return frame.graph();
  };
  const auto before = lines_from(10), after = lines_from(11);
  const auto link = [](std::uint32_t a, std::uint32_t b) { return graph::Link{{a}, {b}}; };
  const auto chosen = [&](const Links& one, const Links& other) {
    auto links = graph::detail::choose_links(before, after, one, other);
    CHECK(graph::detail::choose_links(before, after, other, one) == links);
    return links;
  };
  const Links straight{link(0, 0), link(1, 1), link(2, 2), link(3, 3), link(4, 4), link(5, 5)};
  const Links one_lost{link(0, 0), link(1, 1), link(2, 2)};
  CHECK(chosen(straight, one_lost) == straight);
  const Links thinner{link(0, 0), link(2, 2), link(3, 3), link(4, 4)};
  CHECK(chosen(straight, thinner) == straight);
  const Links crossed{link(0, 3), link(1, 4), link(2, 5), link(3, 0), link(4, 1), link(5, 2)};
  CHECK(chosen(straight, crossed) == straight);
  const Links joined{link(0, 0), link(1, 1), link(2, 3), link(3, 4), link(4, 5), link(5, 2)};
  CHECK(chosen(straight, joined) == straight);
  // Each group by itself.
  const Links first{link(0, 3), link(1, 4), link(2, 5), link(3, 0),
                    link(4, 1), link(5, 2), link(6, 6), link(7, 7)};
  Links both = straight;
  both.insert(both.end(), {link(6, 6), link(7, 7)});
  CHECK(chosen(first, straight) == both);
  CHECK(chosen({}, {}).empty());
}

TEST_CASE("Many patches in one place are matched in a moment", "[graph][match]") {
  std::vector<graph::Vertex> vertices;
  for (std::uint32_t k = 0; k < 600; ++k) vertices.push_back(test::vertex(k, 5, 5));
  const graph::AttributeGraph heap(vertices, {});
  CHECK_FALSE(graph::match_frames(heap, heap, {}, {}).empty());
}

TEST_CASE("A match reports its progress, and a cancelled one throws", "[graph][match]") {
  Swaying scene = field(1);
  graph::SketchSequence sketch;
  std::vector<std::size_t> owner;
  for (int t = 0; t < 10; ++t) sketch.append((scene.step(), scene.frame(owner)));
  std::stop_source source;
  double last = -1, stop_at = 2;
  const core::Context context(source.get_token(), [&](std::string_view stage, double fraction) {
    CHECK(stage == "match");
    CHECK(fraction >= last);
    last = fraction;
    if (fraction >= stop_at) source.request_stop();
  });
  CHECK(graph::match(sketch, {}, context).sketch.frames.size() == 10);
  CHECK(last == 1);
  last = -1, stop_at = 0.3;
  CHECK_THROWS_AS(graph::match(sketch, {}, context), core::Cancelled);
  CHECK(last < 0.6);
  CHECK(graph::match({}, {}).sketch.frames.empty());
}

TEST_CASE("Options and velocities that cannot be are refused by name", "[graph][match]") {
  const auto refusal = [](auto spoil) {
    graph::MatchOptions options;
    spoil(options);
    return test::message_of<core::InputError>([&] { graph::match({}, options); });
  };
  CHECK(test::contains(refusal([](auto& o) { o.max_motion = 0; }), "max_motion"));
  CHECK(test::contains(refusal([](auto& o) { o.max_motion = -1; }), "max_motion"));
  CHECK(test::contains(refusal([](auto& o) { o.max_motion = std::nan(""); }), "max_motion"));
  CHECK(test::contains(refusal([](auto& o) { o.max_motion = 1 / 0.0; }), "max_motion"));
  test::Frame frame;
  frame.line(test::segment({0, 0}, {20, 0}, 5));
  const auto g = frame.graph();
  CHECK_THROWS_AS(graph::match_frames(g, g, std::vector<Point>(4), {}), core::InputError);
  CHECK_THROWS_AS(graph::match_frames(g, g, std::vector<Point>(5, Point{std::nan(""), 0}), {}),
                  core::InputError);
}

TEST_CASE("Anchors are not matched, and are no births and deaths", "[graph][match][anchors]") {
  Swaying scene(4);
  for (const double y : {40.0, 90.0, 140.0}) scene.add({120, y}, 90, 0.1);
  core::Rng rng(7);
  graph::SketchSequence strokes, both;
  strokes.width = both.width = 320, strokes.height = both.height = 240;
  for (int t = 0; t < 30; ++t) {
    scene.step();
    scene[1].pieces = t < 10 || t > 20 ? std::vector<std::pair<double, double>>{{0, 1}}
                                       : std::vector<std::pair<double, double>>{{0, 0.3}, {0.7, 1}};
    std::vector<std::size_t> owner;
    const auto frame = scene.frame(owner);
    strokes.append(frame);
    both.append(test::with_anchors(frame, rng, 200));
  }
  const auto expected = graph::match(strokes, {}), found = graph::match(both, {});
  const auto events = graph::stroke_events(expected);
  CHECK(events.size() >= 2);
  CHECK(graph::stroke_events(found) == events);
  // Of two frames alone, with a velocity for every vertex.
  const auto &a = both.frames[3], &b = both.frames[4];
  const auto links = graph::match_frames(a, b, std::vector<Point>(a.size(), {0.5, 0}), {});
  CHECK_FALSE(links.empty());
  CHECK(links == graph::match_frames(graph::without_anchors(a), graph::without_anchors(b),
                                     std::vector<Point>(graph::without_anchors(a).size(), {0.5, 0}), {}));
}
