// SPDX-License-Identifier: Apache-2.0
#include "graph/events/event_names.hpp"

#include <numbers>
#include <sstream>

#include "core/error.hpp"
#include "graph/curves/curve_identity.hpp"
#include "graph/io/contact_tables.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/touching_curves.hpp"

using namespace emberfold;
using graph::Contact;

namespace {

/// Two frames: lines apart, then joined by an edge between two of their patches; the joined ones first where
/// they come apart. Each line has twelve patches.
Contact contact_of(std::uint32_t at_first, std::uint32_t at_second, bool unite) {
  test::Frame apart;
  apart.line(test::segment({20, 100}, {86, 100}, 12));
  apart.line(test::segment({20, 108}, {86, 108}, 12));
  test::Frame joined = apart;
  joined.edge(at_first, 12 + at_second);
  std::vector<std::pair<std::uint32_t, std::uint32_t>> links;
  for (std::uint32_t v = 0; v < 24; ++v) links.emplace_back(v, v);
  const auto motion = graph::identify(unite ? test::motion({apart.graph(), joined.graph()}, {links})
                                            : test::motion({joined.graph(), apart.graph()}, {links}));
  const auto events = graph::stroke_events(motion);
  REQUIRE(events.size() == 1);
  return graph::event_contacts(motion, events)[0];
}

}  // namespace

TEST_CASE("Unions and separations are of tips or of sides", "[graph][events]") {
  for (const bool unite : {true, false}) {
    CHECK(contact_of(11, 11, unite) == Contact::tip_tip);
    CHECK(contact_of(11, 0, unite) == Contact::tip_tip);
    CHECK(contact_of(0, 6, unite) == Contact::tip_side);
    CHECK(contact_of(5, 11, unite) == Contact::tip_side);
    CHECK(contact_of(5, 6, unite) == Contact::side_side);
  }
}

TEST_CASE("Births and deaths, and what is no event of the graph, have no contact", "[graph][events]") {
  for (std::uint64_t seed = 1; seed <= 30; ++seed) {
    const auto motion = graph::identify(test::random_motion(seed, 5, 8));
    auto events = graph::stroke_events(motion);
    const auto contacts = graph::event_contacts(motion, events);
    REQUIRE(contacts.size() == events.size());
    for (std::size_t k = 0; k < events.size(); ++k) {
      const bool whole =
          events[k].type == graph::EventType::birth || events[k].type == graph::EventType::death;
      CHECK((contacts[k] == Contact::none) == whole);
      events[k].position.x += 0.5;
    }
    for (const Contact contact : graph::event_contacts(motion, events)) CHECK(contact == Contact::none);
  }
}

TEST_CASE("A curve that crosses another begins and ends to do so once", "[graph][events]") {
  int crossings = 0;
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    // an upright line of 60 px that passes a lying one of 120 px, and leaves it
    const test::TouchingCurves scene({test::moving_line({160, 120}, {}, 0, 120),
                                      test::moving_line({160, 66}, {0, 6}, std::numbers::pi / 2, 60)},
                                     20, seed);
    const auto contacts = graph::curve_contacts(graph::identify_curves(scene.motion).motion);
    REQUIRE(contacts.size() == 1);
    CHECK((!contacts[0].from_start && !contacts[0].to_end));
    CHECK((contacts[0].first >= 3 && contacts[0].first <= 5));
    CHECK((contacts[0].last >= 13 && contacts[0].last <= 15));
    CHECK(graph::distance(contacts[0].position, {160, 120}) < 12);
    crossings += contacts[0].crosses ? 1 : 0;
  }
  CHECK(crossings == 10);
}

TEST_CASE("Two curves cross if they do so in most frames of their contact", "[graph][events]") {
  // A lying line of five patches and an upright one that ends at its middle, or goes through it.
  const auto frame = [](bool through) {
    test::Frame made;
    made.line({{100, 100}, {105, 100}, {110, 100}, {115, 100}, {120, 100}});
    made.line({{110, 85}, {110, 90}, {110, 95}});
    made.edge(2, 7);
    if (through) made.edge(2, made.line({{110, 105}, {110, 110}, {110, 115}}));
    std::vector<graph::CurveId> curves(made.vertices.size(), {2});
    std::fill_n(curves.begin(), 5, graph::CurveId{1});
    return made.graph().with_curves(curves);
  };
  for (const int crossing : {0, 3, 4, 5, 8}) {
    graph::MotionGraph motion;
    for (int t = 0; t < 8; ++t) motion.sketch.append(frame(t < crossing));
    motion.links.resize(8);
    const auto contacts = graph::curve_contacts(motion);
    REQUIRE(contacts.size() == 1);
    CHECK(contacts[0].crosses == (crossing > 4));
  }
}

TEST_CASE("Tables of contacts and of named events, in px and in units", "[graph][io]") {
  std::ostringstream contacts, named, broken;
  graph::write_contacts(contacts, {{{2}, {5}, 3, 9, true, {10, 20}, false, true}}, {0.5, 0.1});
  CHECK(contacts.str() ==
        "curve_a,curve_b,crosses,first,last,from_start,to_end,x,y,first_s,last_s,x_um,y_um\n"
        "2,5,1,3,9,0,1,10,20,1.5,4.5,1,2\n");
  const std::vector<graph::Event> events{{4, graph::EventType::connect, {1, 2}, 0.75, {{1}, {2}}, {{3}}}};
  const std::vector<Contact> tips{Contact::tip_side};
  graph::write_named_events(named, events, tips, {});
  CHECK(named.str() == "frame,x,y,type,contact,probability\n4,1,2,connect,tip_side,0.75\n");
  CHECK_THROWS_AS(graph::write_named_events(named, events, {}, {}), core::InputError);
  broken.setstate(std::ios::failbit);
  CHECK_THROWS_AS(graph::write_contacts(broken, {}, {}), core::IoError);
}
