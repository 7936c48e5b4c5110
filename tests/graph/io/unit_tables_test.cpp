// SPDX-License-Identifier: Apache-2.0
#include "graph/io/unit_tables.hpp"

#include <functional>
#include <sstream>

#include <nlohmann/json.hpp>

#include "graph/io/motion_io.hpp"
#include "graph/io/units_json.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/graphs.hpp"

using namespace emberfold;

namespace {

/// A line that lives in frames 1 to 3 of five, moves down by 2 px a frame and grows by 4.
graph::MotionGraph growing_line() {
  std::vector<graph::AttributeGraph> frames;
  for (int t = 0; t < 5; ++t) {
    test::Frame frame;
    frame.line({{100, 10}, {108, 10}});  // there from first to last
    if (t >= 1 && t <= 3)
      frame.line({{10. - 2 * t, 20. + 2 * t}, {20, 20. + 2 * t}, {30. + 2 * t, 20. + 2 * t}});
    frames.push_back(frame.graph());
  }
  return graph::identify(test::motion(frames, {{{0, 0}, {1, 1}},
                                               {{0, 0}, {1, 1}, {2, 2}, {3, 3}, {4, 4}},
                                               {{0, 0}, {1, 1}, {2, 2}, {3, 3}, {4, 4}},
                                               {{0, 0}, {1, 1}}}));
}

std::string text_of(const std::function<void(std::ostream&)>& write) {
  std::ostringstream out;
  write(out);
  return out.str();
}

std::string line_of(const std::string& text, int number) {
  std::istringstream lines(text);
  std::string line;
  for (int i = 0; i <= number; ++i) std::getline(lines, line);
  return line;
}

}  // namespace

TEST_CASE("A life has its length, growth, speed and frames", "[graph][io]") {
  const auto lives = graph::stroke_lives(growing_line());
  REQUIRE(lives.size() == 2);
  const auto& all = lives[0].first == 0 ? lives[0] : lives[1];
  const auto& line = lives[0].first == 0 ? lives[1] : lives[0];
  CHECK(all.frames() == 5);
  CHECK_FALSE(all.whole);
  CHECK(all.growth == 0);
  CHECK(all.speed == 0);
  CHECK(line.first == 1);
  CHECK(line.last == 3);
  CHECK(line.whole);
  CHECK(line.length == Approx(28));
  CHECK(line.growth == Approx(4));
  CHECK(line.speed == Approx(2));
  const auto text = text_of([&](std::ostream& out) { graph::write_lives(out, lives, {0.5, 0.25}); });
  CHECK(line_of(text, 0) ==
        "stroke,first,last,frames,whole,length,growth,speed,life_s,length_um,growth_um_s,speed_um_s");
  CHECK(text.find(",1,3,3,1,28,4,2,1.5,7,2,1\n") != std::string::npos);
  const auto plain = text_of([&](std::ostream& out) { graph::write_lives(out, lives, {}); });
  CHECK(line_of(plain, 0) == "stroke,first,last,frames,whole,length,growth,speed");
}

TEST_CASE("Columns in seconds and micrometres stand behind the others, where they are known", "[graph][io]") {
  const auto motion = growing_line();
  const std::vector<graph::Event> events{{2, graph::EventType::birth, {30, 40}, 1, {}, {}}};
  const auto plain = text_of([&](std::ostream& out) { graph::write_events_csv(out, events); });
  CHECK(plain == text_of([&](std::ostream& out) { graph::write_events_csv(out, events, {}); }));
  const auto both = text_of([&](std::ostream& out) { graph::write_events_csv(out, events, {0.1, 0.5}); });
  CHECK(line_of(both, 0) == line_of(plain, 0) + ",time_s,x_um,y_um");
  CHECK(line_of(both, 1) == line_of(plain, 1) + ",0.2,15,20");
  const auto time = text_of([&](std::ostream& out) { graph::write_events_csv(out, events, {0.1, {}}); });
  CHECK(line_of(time, 0) == line_of(plain, 0) + ",time_s");
  const auto table = text_of([&](std::ostream& out) { graph::write_strokes(out, motion); });
  const auto long_table = text_of([&](std::ostream& out) { graph::write_strokes(out, motion, {2, 0.5}); });
  CHECK(line_of(long_table, 0) == line_of(table, 0) + ",time_s,x_um,y_um,length_um");
  CHECK(line_of(long_table, 1) == line_of(table, 1) + ",0,52,5,4");
}

TEST_CASE("Times are those of the frames and positions count from the source", "[graph][io]") {
  graph::Units units{0.15, 0.5, {1, 1.1, 1.2, 1.5, 1.6}, {100, 40, 1, "source"}};
  const std::vector<graph::Event> events{{3, graph::EventType::birth, {30, 40}, 1, {}, {}}};
  const auto csv = text_of([&](std::ostream& out) { graph::write_events_csv(out, events, units); });
  CHECK(line_of(csv, 0) == "frame,type,x,y,probability,before,after,time_s,x_um,y_um,counted_from");
  CHECK(line_of(csv, 1) == "3,birth,130,80,1,,,1.5,65,40,source");
  const auto json = text_of([&](std::ostream& out) { graph::write_events(out, events, units); });
  CHECK_THAT(json, test::Contains("\"counted_from\":\"source\"") && test::Contains("\"x\":130,\"y\":80"));
  std::istringstream in(json);
  CHECK(graph::moved(graph::read_events(in, "e.json"), {-100, -40}) == events);

  const auto motion = growing_line();
  const auto lives =
      text_of([&](std::ostream& out) { graph::write_lives(out, graph::stroke_lives(motion), units); });
  // Frames 1 to 3 from 1.1 s up to 1.6 s; 4 px and 2 px a frame of 0.2 s each.
  CHECK_THAT(lives, test::Contains(",1,3,3,1,28,4,2,0.5") && test::Contains(",14,10"));
  const auto strokes = text_of([&](std::ostream& out) { graph::write_strokes(out, motion, units); });
  CHECK(line_of(strokes, 1).starts_with("1,0,204,50,8,"));
  CHECK(line_of(strokes, 1).ends_with(",1,102,25,4,source"));
  const auto paths = text_of([&](std::ostream& out) { graph::write_trajectories(out, motion, units); });
  CHECK(line_of(paths, 0).ends_with(",contrast,counted_from"));
  CHECK_THAT(line_of(paths, 1), test::Contains(",200,50,"));
}

TEST_CASE("Units come back from the JSON of a clip", "[graph][io]") {
  const graph::Units units{0.15, 0.5, {1, 1.1, 1.35}, {100, 40, 1, "source"}};
  nlohmann::ordered_json clip = {{"fps", 1 / 0.15}, {"fps_is_known", true}, {"pixel_um", 0.5}};
  graph::add_units(clip, units);
  const auto found = graph::read_units(nlohmann::json::parse(clip.dump()));
  CHECK(found.seconds.value() == Approx(0.15));
  CHECK(found.um == units.um);
  CHECK(found.times == units.times);
  CHECK(found.origin == units.origin);
  CHECK(found.span(0, 2) == Approx(0.35));
  CHECK(found.step(0, 2) == Approx(0.175));
  CHECK(found.time(3) == Approx(1.5));  // one mean step after the last
  nlohmann::ordered_json plain = {{"fps", 25}};
  graph::add_units(plain, {0.04, {}});
  CHECK(plain.size() == 1);
}
