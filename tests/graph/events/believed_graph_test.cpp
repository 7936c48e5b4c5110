// SPDX-License-Identifier: Apache-2.0
#include "graph/events/believed_graph.hpp"

#include <algorithm>
#include <map>
#include <set>

#include "tests/support/catch.hpp"
#include "tests/support/graphs.hpp"

using namespace emberfold;

namespace {

using Pairs = std::vector<std::pair<std::uint32_t, std::uint32_t>>;

Pairs same(std::uint32_t patches) {
  Pairs pairs;
  for (std::uint32_t v = 0; v < patches; ++v) pairs.push_back({v, v});
  return pairs;
}

// A line of seven patches, 5 px apart, that lacks the middle one in frames 2 and 3 of six.
graph::MotionGraph broken_for_a_while() {
  test::Frame whole, broken;
  whole.line(test::segment({50, 100}, {80, 100}, 7));
  broken.line(test::segment({50, 100}, {60, 100}, 3));
  broken.line(test::segment({70, 100}, {80, 100}, 3));
  const Pairs opens = {{0, 0}, {1, 1}, {2, 2}, {4, 3}, {5, 4}, {6, 5}},
              closes = {{0, 0}, {1, 1}, {2, 2}, {3, 4}, {4, 5}, {5, 6}};
  return graph::identify(test::motion(
      {whole.graph(), whole.graph(), broken.graph(), broken.graph(), whole.graph(), whole.graph()},
      {same(7), opens, same(6), closes, same(7)}));
}

std::vector<graph::Event> events_of(const graph::MotionGraph& motion, std::vector<double> probabilities) {
  auto events = graph::stroke_events(motion);
  REQUIRE(events.size() == probabilities.size());
  for (std::size_t k = 0; k < events.size(); ++k) events[k].probability = probabilities[k];
  return events;
}

// A line at x = 100 that stays, and one of `patches` that is there in frames 2 to 4 of seven and moves by
// `step` a frame.
graph::MotionGraph short_life(graph::Point from, graph::Point to, int patches, graph::Point step = {}) {
  std::vector<graph::AttributeGraph> frames;
  std::vector<Pairs> links;
  for (int t = 0; t < 7; ++t) {
    test::Frame frame;
    frame.line(test::segment({100, 50}, {100, 80}, 7));
    if (t >= 2 && t <= 4) frame.line(test::segment(from + step * (t - 2), to + step * (t - 2), patches));
    if (t > 0) links.push_back(same(t == 3 || t == 4 ? 7 + static_cast<std::uint32_t>(patches) : 7));
    frames.push_back(frame.graph());
  }
  return graph::identify(test::motion(frames, links));
}

std::vector<std::size_t> sizes(const graph::MotionGraph& motion) {
  std::vector<std::size_t> result;
  for (const auto& frame : motion.sketch.frames) result.push_back(frame.size());
  return result;
}

const std::vector<std::size_t> kSevenEach(7, 7);

// Four lines side by side that lack patches, touch, and are linked across at random: all near each other.
graph::MotionGraph neighbours(std::uint64_t seed) {
  constexpr std::uint32_t kLines = 4, kPatches = 8, kAll = kLines * kPatches;
  core::Rng rng(seed);
  std::vector<graph::AttributeGraph> frames;
  std::vector<Pairs> links;
  std::vector<std::uint32_t> index_before;
  for (int t = 0; t < 8; ++t) {
    test::Frame frame;
    std::vector<std::uint32_t> index(kAll, kAll);
    for (std::uint32_t v = 0; v < kAll; ++v) {
      if (rng.uniform() < 0.2) continue;
      const std::uint32_t row = v / kPatches;
      index[v] = frame.line({{100 + 5.0 * (v % kPatches), 100 + 6.0 * row}});
      for (const std::uint32_t w : {v - 1, v - kPatches})
        if (w < v && index[w] < kAll && rng.uniform() < (w == v - 1 ? 0.9 : 0.05))
          frame.edge(index[w], index[v]);
    }
    if (t > 0) {
      Pairs tries, star;
      for (std::uint32_t v = 0; v < kAll; ++v) {
        const std::uint32_t w = rng.uniform() < 0.8 ? v : (v + kPatches * rng.below(kLines)) % kAll;
        if (index_before[v] < kAll && index[w] < kAll) tries.push_back({index_before[v], index[w]});
      }
      for (const auto& [i, j] : tries)
        if (std::ranges::none_of(star,
                                 [i = i, j = j](const auto& l) { return l.first == i || l.second == j; }) ||
            (std::ranges::none_of(star, [i = i](const auto& l) { return l.first == i; }) &&
             std::ranges::none_of(star, [&, j = j](const auto& l) {
               return l.second == j && std::ranges::count(star, l.first, &Pairs::value_type::first) > 1;
             })))
          star.push_back({i, j});
      links.push_back(star);
    }
    frames.push_back(frame.graph());
    index_before = index;
  }
  return graph::identify(test::motion(frames, links));
}

}  // namespace

TEST_CASE("A graph changes where an event is believed, and nowhere else", "[graph][believed_graph]") {
  const auto motion = broken_for_a_while();
  for (const auto& [split, merge] : {std::pair{0.2, 0.2}, {0.8, 0.2}, {0.8, 0.8}}) {
    auto settled = motion;
    auto events = events_of(motion, {split, merge});
    graph::keep_believed(settled, events, {}, 0.5);
    graph::validate(settled);
    std::erase_if(events, [](const auto& event) { return event.probability < 0.5; });
    auto left = graph::stroke_events(settled);
    REQUIRE(left.size() == events.size());
    for (std::size_t k = 0; k < left.size(); ++k) {
      left[k].probability = events[k].probability;
      CHECK(left[k] == events[k]);
    }
  }
  // The break that is not believed is bridged between the nearest patches.
  auto settled = motion;
  auto events = events_of(motion, {0.2, 0.2});
  graph::keep_believed(settled, events, {}, 0.5);
  const auto& frame = settled.sketch.frames[2];
  CHECK(frame.edges().size() == 5);
  CHECK(std::ranges::find(frame.neighbours(2), 3u) != frame.neighbours(2).end());
}

TEST_CASE("Where all events are believed a graph is unchanged", "[graph][believed_graph]") {
  for (const auto& motion : {broken_for_a_while(), short_life({150, 50}, {150, 70}, 5)}) {
    auto settled = motion;
    auto events = graph::stroke_events(motion);
    graph::keep_believed(settled, events, {}, 0.5);
    CHECK(settled == motion);
    CHECK(events == graph::stroke_events(motion));
  }
}

TEST_CASE("A stroke is there with both of its ends, or not at all", "[graph][believed_graph]") {
  const auto motion = short_life({150, 50}, {150, 70}, 5);
  for (const double birth : {0.0, 0.15, 0.3, 0.45, 0.6, 0.9, 0.99})
    for (const double death : {0.0, 0.15, 0.3, 0.45, 0.6, 0.9, 0.99}) {
      auto settled = motion;
      auto events = events_of(motion, {birth, death});
      graph::keep_believed(settled, events, {}, 0.5);
      // An end counts for 0.1 to 0.6.
      const double p = std::clamp(birth, 0.1, 0.6), q = std::clamp(death, 0.1, 0.6);
      const double odds = p * q / ((1 - p) * (1 - q));
      const bool is_there = birth >= 0.5 || death >= 0.5 ? odds > 1 : false;
      INFO("birth " << birth << ", death " << death);
      CHECK((sizes(settled) == kSevenEach) != is_there);
      for (const auto& event : events) CHECK((event.probability >= 0.5) == is_there);
      if (is_there && birth >= 0.5 && death >= 0.5) CHECK(events[0].probability == birth);
      if (is_there && birth < 0.5)
        CHECK_THAT(events[0].probability, test::WithinAbs(odds / (1 + odds), 1e-12));
      CHECK(graph::stroke_events(settled).size() == (is_there ? 2 : 0));
    }
  // What a review says stays.
  auto reviewed = motion;
  auto facts = events_of(motion, {0, 1});
  graph::keep_believed(reviewed, facts, {}, 0.5);
  CHECK(facts[1].probability == 1);
  CHECK(sizes(reviewed) != kSevenEach);
  // Where the picture changes nothing is born or dies.
  auto settled = motion;
  auto events = events_of(motion, {0, 0});
  graph::keep_believed(settled, events, std::vector{1, 6}, 0.5);
  CHECK(settled == motion);
  graph::keep_believed(settled, events, std::vector{1}, 0.5);
  CHECK(sizes(settled) == kSevenEach);
}

TEST_CASE("What goes through the picture's border is neither born nor dies", "[graph][believed_graph]") {
  // The picture is 320 px wide. A line stands, or moves to the right and back, 3 px from the border.
  for (const double step : {0.0, 1.0, -1.0}) {
    auto motion = short_life({315 - 2 * step, 50}, {315 - 2 * step, 70}, 5, {step, 0});
    auto events = events_of(motion, {0, 0});
    graph::keep_believed(motion, events, {}, 0.5);
    CHECK(sizes(motion) == kSevenEach);  // one end is not at the border
  }
  // From the first frame on until it leaves.
  std::vector<graph::AttributeGraph> frames;
  for (int t = 0; t < 6; ++t) {
    test::Frame frame;
    if (t < 4) frame.line(test::segment({304.0 + 4 * t, 50}, {304.0 + 4 * t, 70}, 5));
    frames.push_back(frame.graph());
  }
  auto leaving = graph::identify(test::motion(frames, {same(5), same(5), same(5), {}, {}}));
  const auto before = leaving;
  auto events = events_of(leaving, {0});
  graph::keep_believed(leaving, events, {}, 0.5);
  CHECK(leaving.sketch == before.sketch);
}

TEST_CASE("The outline of a large thing stays", "[graph][believed_graph]") {
  for (const int patches : {16, 24}) {
    std::vector<graph::AttributeGraph> frames;
    for (int t = 0; t < 3; ++t) {
      test::Frame frame;
      std::vector<graph::Point> circle;
      for (int k = 0; k < patches; ++k) {
        const double angle = 2 * 3.14159265358979 * k / patches;
        circle.push_back({150 + 0.8 * patches * std::cos(angle), 120 + 0.8 * patches * std::sin(angle)});
      }
      if (t == 1) {
        const auto first = frame.line(circle);
        frame.edge(first, first + static_cast<std::uint32_t>(patches) - 1);
      }
      frames.push_back(frame.graph());
    }
    auto motion = graph::identify(test::motion(frames, {{}, {}}));
    auto events = events_of(motion, {0, 0});
    graph::keep_believed(motion, events, {}, 0.5);
    CHECK(motion.sketch.frames[1].size() == (patches > 20 ? 24 : 0));
  }
}

TEST_CASE("Pieces of a stroke are joined over gaps of 30 px at most", "[graph][believed_graph]") {
  for (const double gap : {29.0, 31.0}) {
    test::Frame whole, apart;
    whole.line(test::segment({50, 100}, {70 + gap, 100}, 12));
    apart.line(test::segment({50, 100}, {60, 100}, 3));
    apart.line(test::segment({60 + gap, 100}, {70 + gap, 100}, 3));
    auto motion = graph::identify(
        test::motion({whole.graph(), apart.graph()}, {{{0, 0}, {1, 1}, {2, 2}, {9, 3}, {10, 4}, {11, 5}}}));
    auto events = events_of(motion, {0});
    graph::keep_believed(motion, events, {}, 0.5);
    CHECK(motion.sketch.frames[1].size() == (gap < 30 ? 6 : 3));
    CHECK(graph::components(motion.sketch.frames[1]).count == 1);
    CHECK(graph::stroke_events(motion).empty());
  }
}

TEST_CASE("A stroke continues where its end and its beginning are not believed", "[graph][believed_graph]") {
  // A line moves down by 1 px a frame and is not drawn in `gap` − 1 frames.
  for (const int gap : {2, 5, 10, 11})
    for (const auto& [death, birth] : {std::pair{0.1, 0.2}, {0.1, 0.8}, {0.8, 0.2}}) {
      const int frames = 8 + gap;
      std::vector<graph::AttributeGraph> drawn;
      std::vector<Pairs> links;
      for (int t = 0; t < frames; ++t) {
        test::Frame frame;
        const bool is_there = t <= 4 || t >= 4 + gap;
        if (is_there) frame.line(test::segment({50, 100.0 + t}, {80, 100.0 + t}, 7));
        drawn.push_back(frame.graph());
        if (t > 0) links.push_back(is_there && t != 4 + gap ? same(7) : Pairs{});
      }
      auto motion = graph::identify(test::motion(drawn, links));
      auto events = events_of(motion, {death, birth});
      REQUIRE(events[0].type == graph::EventType::death);
      graph::keep_believed(motion, events, {}, 0.5);
      graph::validate(motion);
      const bool goes_on = gap <= 10 && death < 0.5 && birth < 0.5;
      if (goes_on) CHECK(graph::stroke_events(motion).empty());
      for (int t = 0; t < frames; ++t) {
        const auto& frame = motion.sketch.frames[static_cast<std::size_t>(t)];
        const bool is_there = goes_on || (t <= 4 && death > 0.5) || (t >= 4 + gap && birth > 0.5);
        CHECK(frame.size() == (is_there ? 7 : 0));
        CHECK(frame.edges().size() == (is_there ? 6 : 0));
        for (const auto& vertex : frame.vertices()) {
          CHECK(vertex.patch.position.y == Approx(100 + t));
          if (goes_on) CHECK(vertex.subgraph == motion.sketch.frames[0].vertices()[0].subgraph);
        }
      }
      CHECK(events[0].before.size() == (goes_on || death > 0.5));
      CHECK(events[1].after.size() == (goes_on || birth > 0.5));
    }
}

TEST_CASE("Of pieces far apart the one that continues the frame before stays", "[graph][believed_graph]") {
  // The first patches of a line and its last ones, three and four in turns.
  const auto line = test::segment({50, 100}, {160, 100}, 12);
  std::vector<graph::AttributeGraph> frames;
  std::vector<Pairs> links;
  std::vector<std::uint32_t> shown(12);
  for (std::uint32_t v = 0; v < 12; ++v) shown[v] = v;
  test::Frame whole;
  whole.line(line);
  frames.push_back(whole.graph());
  for (std::uint32_t t = 1; t < 6; ++t) {
    const std::uint32_t first = 3 + t % 2, last = 7 - first;
    test::Frame apart;
    apart.line({line.begin(), line.begin() + first});
    apart.line({line.end() - last, line.end()});
    std::vector<std::uint32_t> now;
    for (std::uint32_t v = 0; v < 12; ++v)
      if (v < first || v >= 12 - last) now.push_back(v);
    links.emplace_back();
    for (std::uint32_t i = 0; i < shown.size(); ++i)
      for (std::uint32_t j = 0; j < now.size(); ++j)
        if (shown[i] == now[j]) links.back().push_back({i, j});
    frames.push_back(apart.graph());
    shown = now;
  }
  auto motion = graph::identify(test::motion(frames, links));
  auto events = events_of(motion, {0});
  graph::keep_believed(motion, events, {}, 0.5);
  CHECK(graph::stroke_events(motion).empty());
  for (std::size_t t = 1; t < 6; ++t)
    for (const auto& vertex : motion.sketch.frames[t].vertices()) CHECK(vertex.patch.position.x < 100);
}

TEST_CASE("Pieces of a large thing are joined over any gap", "[graph][believed_graph]") {
  std::vector<graph::AttributeGraph> frames;
  for (int t = 0; t < 3; ++t) {
    test::Frame frame;
    std::vector<std::uint32_t> first;
    for (const double x : {60.0, 160.0}) {
      std::vector<graph::Point> circle;
      for (int k = 0; k < 24; ++k) {
        const double angle = 2 * 3.14159265358979 * k / 24;
        circle.push_back({x + 20 * std::cos(angle), 120 + 20 * std::sin(angle)});
      }
      first.push_back(frame.line(circle));
      frame.edge(first.back(), first.back() + 23);
    }
    if (t != 1) frame.edge(first[0], first[1] + 12);
    frames.push_back(frame.graph());
  }
  auto motion = graph::identify(test::motion(frames, {same(48), same(48)}));
  auto events = events_of(motion, {0.3, 0.3});
  graph::keep_believed(motion, events, {}, 0.5);
  CHECK(graph::stroke_events(motion).empty());
  CHECK(motion.sketch.frames[1].edges().size() == 49);
}

TEST_CASE("A part that splits off without a link gets one", "[graph][believed_graph]") {
  test::Frame whole, parts;
  whole.line(test::segment({50, 100}, {80, 100}, 7));
  parts.line(test::segment({50, 100}, {60, 100}, 3));
  parts.line(test::segment({70, 112}, {80, 112}, 3));
  auto motion = graph::identify(test::motion({whole.graph(), whole.graph(), parts.graph(), parts.graph()},
                                             {same(7), same(3), same(6)}));
  const auto names = [&](std::size_t t, std::size_t v) {
    return motion.sketch.frames[t].vertices()[v].subgraph;
  };
  std::vector<graph::Event> events(1);
  events[0].frame = 2, events[0].type = graph::EventType::disconnect, events[0].probability = 0.9;
  events[0].before = {names(1, 0)}, events[0].after = {names(2, 0), names(2, 3)};
  graph::keep_believed(motion, events, {}, 0.5);
  graph::validate(motion);
  CHECK(motion.links[2].size() == 4);
  const auto left = graph::stroke_events(graph::identify(motion));
  REQUIRE(left.size() == 1);
  CHECK((left[0].frame == 2 && left[0].before.size() == 1 && left[0].after.size() == 2));
}

TEST_CASE("Strokes are components, and links join their patches or those of believed events",
          "[graph][believed_graph]") {
  for (std::uint64_t seed = 0; seed < 600; ++seed) {
    auto motion = seed % 2 == 0 ? neighbours(seed) : graph::identify(test::random_motion(seed, 5, 12));
    auto events = graph::stroke_events(motion);
    core::Rng rng(seed);
    for (auto& event : events) event.probability = rng.uniform();
    graph::keep_believed(motion, events, {}, 0.5);
    graph::validate(motion);
    for (const auto& frame : motion.sketch.frames) {
      const auto parts = graph::components(frame);
      std::map<std::uint32_t, std::uint32_t> part_of;
      std::set<std::uint32_t> strokes;
      for (std::uint32_t v = 0; v < frame.size(); ++v) {
        const auto stroke = frame.vertices()[v].subgraph.value;
        strokes.insert(stroke);
        CHECK(part_of.try_emplace(parts.of_vertex[v], stroke).first->second == stroke);
      }
      CHECK(strokes.size() == parts.count);
    }
    for (const graph::Event& event : graph::stroke_events(motion)) {
      if (event.type == graph::EventType::birth || event.type == graph::EventType::death) continue;
      const bool is_believed = std::ranges::any_of(events, [&](const graph::Event& one) {
        return one.frame == event.frame && one.probability >= 0.5;
      });
      CHECK(is_believed);
    }
  }
}
