// SPDX-License-Identifier: Apache-2.0
#include "graph/io/motion_io.hpp"

#include <bit>
#include <chrono>
#include <sstream>

#include "core/error.hpp"
#include "graph/curves/curve_identity.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/graphs.hpp"
#include "tests/support/messages.hpp"
#include "tests/support/sanitizer.hpp"

using namespace emberfold;
using test::contains;

namespace {

std::string written(const graph::MotionGraph& motion) {
  std::ostringstream out;
  graph::write_motion(out, motion);
  return out.str();
}

graph::MotionGraph motion_of(const std::string& text) {
  std::istringstream in(text);
  return graph::read_motion(in, "m.jsonl");
}

std::string refusal(const std::string& text) {
  return test::message_of<core::IoError>([&] { motion_of(text); });
}

std::string replaced(std::string text, const std::string& what, const std::string& with) {
  const auto at = text.find(what);
  REQUIRE(at != std::string::npos);
  return text.replace(at, what.size(), with);
}

const std::string kHeader =
    R"({"format":"emberfold.motion","version":1,"width":320,"height":240,"fps":25,"frames":2})"
    "\n";

std::string vertex(int id) {
  return R"({"id":)" + std::to_string(id) +
         R"(,"subgraph":1,"type":"ridge","x":1.5,"y":2,"theta":0.5,"width":2,"blur":1,"contrast":30,)"
         R"("left":100,"middle":[130,131,132],"right":100})";
}

std::string good() {
  return kHeader + R"({"frame":0,"vertices":[)" + vertex(0) + "," + vertex(1) +
         R"(],"edges":[[0,1]],"links":[]})" + "\n" + R"({"frame":1,"vertices":[)" + vertex(2) + "," +
         vertex(3) + R"(],"edges":[[2,3]],"links":[[0,2],[1,3]]})" + "\n";
}

}  // namespace

TEST_CASE("Motion of version 1 has no curves, one of version 2 has", "[graph][io]") {
  for (const auto& frame : motion_of(good()).sketch.frames)
    for (const auto& v : frame.vertices()) CHECK(v.curve == graph::CurveId{});
  const auto with =
      replaced(replaced(good(), R"("version":1)", R"("version":2)"), R"("id":2,)", R"("id":2,"curve":7,)");
  CHECK(motion_of(with).sketch.frames[1].vertices()[0].curve == graph::CurveId{7});
  CHECK_THAT(refusal(replaced(with, R"("curve":7)", R"("curve":-7)")),
             test::Contains("\"curve\" must be a whole number"));
}

TEST_CASE("Motion and sketch files read back the same, bit for bit", "[graph][io]") {
  for (std::uint64_t seed = 0; seed < 30; ++seed) {
    auto motion = graph::identify_curves(graph::identify(test::random_motion(seed, 4, 15))).motion;
    motion.sketch.fps = 30000.0 / 1001;
    const std::string text = written(motion);
    CHECK(motion_of(text) == motion);
    CHECK(written(motion_of(text)) == text);
    std::stringstream sketch;
    graph::write_sketch(sketch, motion.sketch);
    CHECK(graph::read_sketch(sketch, "s.jsonl") == motion.sketch);
    std::istringstream as_sketch(text);
    CHECK(graph::read_sketch(as_sketch, "m.jsonl") == motion.sketch);
  }
}

TEST_CASE("Hard numbers read back the same", "[graph][io]") {
  core::Rng rng(9);
  std::vector<graph::Vertex> vertices;
  for (std::uint32_t i = 0; i < 20000; ++i) {
    auto v = test::vertex(i, 0, 0);
    v.patch.position.x = std::ldexp(rng.uniform(-1, 1), -static_cast<int>(rng.below(300)));
    for (float& value : v.patch.left) {
      const auto bits = rng.bits() & 0xbfffffffU;  // |value| < 2
      value = std::isfinite(std::bit_cast<float>(bits)) ? std::bit_cast<float>(bits) : 0;
    }
    v.patch.middle.fill(v.patch.left[0]);
    vertices.push_back(v);
  }
  vertices[0].patch.position = {-0.0, 5e-324};
  vertices[0].patch.left = {-0.0F, 0.0F, 0.0F};
  vertices[0].patch.right = {-0.0F, -0.0F, -0.0F};
  graph::MotionGraph motion;
  motion.sketch.width = 1;
  motion.sketch.height = 65536;
  motion.sketch.frames.emplace_back(vertices, std::vector<graph::Edge>{});
  motion.links.resize(1);
  const graph::MotionGraph back = motion_of(written(motion));
  CHECK(back == motion);
  const auto& patch = back.sketch.frames[0].patch(0);
  CHECK(std::signbit(patch.position.x));
  CHECK(std::signbit(patch.left[0]));
  CHECK_FALSE(std::signbit(patch.left[1]));
  CHECK(std::signbit(patch.right[2]));
}

TEST_CASE("A grey level is one number, a colour three, and both are read", "[graph][io]") {
  const auto motion = motion_of(good());
  const auto& patch = motion.sketch.frames[0].patch(0);
  CHECK(patch.left == graph::Level{100, 100, 100});
  CHECK(patch.middle == graph::Level{130, 131, 132});
  CHECK(contains(written(motion), R"("left":100,"middle":[130,131,132],"right":100})"));
  CHECK(motion.links[1] == std::vector<graph::Link>{{{0}, {2}}, {{1}, {3}}});
}

TEST_CASE("What a reader may meet and take", "[graph][io]") {
  const auto motion = motion_of(good());
  CHECK(motion_of(replaced(good(), R"("frame":1,)", R"("frame":1,"note":{"a":[1,{"b":null}],"id":7},)")) ==
        motion);
  CHECK(motion_of(replaced(good(), R"("blur":1,)", R"("blur":1,"mark":[[],{"x":[]}],)")) == motion);
  CHECK(motion_of(good() + "\n\r\n") == motion);
  CHECK(motion_of(good().substr(0, good().size() - 1)) == motion);  // without the last line break
  CHECK(motion_of(replaced(good(), "[[0,2],[1,3]]", "[[1,3],[0,2]]")) == motion);
  CHECK(motion_of(replaced(kHeader, R"("frames":2)", R"("frames":0)")).sketch.frames.empty());
}

TEST_CASE("Every bad motion file is refused with name, line and cause", "[graph][io]") {
  struct Case {
    std::string what, with, line, cause;
  };
  const std::vector<Case> cases = {
      {"emberfold.motion", "emberfold.sketch", "line 1", "no links"},
      {"emberfold.motion", "some\\nthing", "line 1", "the format is \"some?thing\""},
      {R"("format":"emberfold.motion",)", "", "line 1", "names no \"format\""},
      {R"("version":1)", R"("version":3)", "line 1", "version 3 is newer"},
      {R"("version":1)", R"("version":0)", "line 1", "\"version\" must be a whole number from 1"},
      {R"("version":1)", R"("version":"1")", "line 1", "\"version\""},
      {R"("width":320)", R"("width":0)", "line 1", "\"width\" must be a whole number from 1 to 65536"},
      {R"("width":320)", R"("width":65537)", "line 1", "\"width\""},
      {R"("height":240)", R"("height":-240)", "line 1", "\"height\""},
      {R"("height":240)", R"("height":2.5)", "line 1", "\"height\""},
      {R"("height":240,)", "", "line 1", "\"height\" is missing"},
      {R"("fps":25)", R"("fps":0)", "line 1", "\"fps\" must be a number above 0, up to 1e6"},
      {R"("fps":25)", R"("fps":1000001)", "line 1", "\"fps\""},
      {R"("fps":25)", R"("fps":null)", "line 1", "\"fps\""},
      {R"("fps":25)", R"("fps":NaN)", "line 1", "no valid JSON at column"},
      {R"("fps":25)", R"("fps":1e999)", "line 1", "out of range"},
      {R"("frames":2)", R"("frames":3)", "line 4", "ends after 2 of 3 frames"},
      {R"("frames":2)", R"("frames":2000000000)", "line 4", "ends after 2 of 2000000000 frames"},
      {R"("frames":2)", R"("frames":1)", "line 3", "goes on after the 1 frames"},
      {R"("frames":2)", R"("frames":-1)", "line 1", "\"frames\""},
      {R"({"format")", R"([{"format")", "line 1", "no valid JSON"},
      {R"("frame":1)", R"("frame":2)", "line 3", "\"frame\" is 2, expected 1"},
      {R"("frame":1)", R"("frame":1.5)", "line 3", "\"frame\" must be a whole number"},
      {R"("frame":1)", R"("frame":[1])", "line 3", "\"frame\" must be a whole number"},
      {R"("frame":1,)", "", "line 3", "\"frame\" is missing"},
      {R"("frame":1,)", R"("frame":1,"frame":1,)", "line 3", "\"frame\" is there twice"},
      {R"("links":[[0,2],[1,3]])", R"("lanks":[])", "line 3", "\"links\" is missing"},
      {R"("edges":[[2,3]],)", "", "line 3", "\"edges\" is missing"},
      {R"("edges":[[2,3]])", R"("edges":7)", "line 3", "\"edges\" must be a list"},
      {R"("edges":[[2,3]])", R"("edges":[2,3])", "line 3", "\"edges\" must be a pair of ids"},
      {R"("edges":[[2,3]])", R"("edges":[[2,3,4]])", "line 3", "\"edges\" must be a pair of ids"},
      {R"("edges":[[2,3]])", R"("edges":[[2]])", "line 3", "\"edges\" must be a pair of ids"},
      {R"("edges":[[2,3]])", R"("edges":[[2,-3]])", "line 3", "\"edges\" must hold whole numbers"},
      {R"("edges":[[2,3]])", R"("edges":[[2,"3"]])", "line 3", "\"edges\""},
      {R"("edges":[[2,3]])", R"("edges":[[2,9]])", "line 3", "vertex 9, which is not there"},
      {R"("edges":[[2,3]])", R"("edges":[[2,2]])", "line 3", "vertex 2 has an edge to itself"},
      {R"("edges":[[2,3]])", R"("edges":[[2,3],[3,2]])", "line 3", "there twice"},
      {R"([0,2],)", R"([2,0],)", "line 3", "link from vertex 2 to vertex 0 begins at"},
      {R"([0,2],)", R"([0,1],)", "line 3", "ends at a vertex"},
      {R"([0,2],)", R"([1,3],)", "line 3", "there twice"},
      {R"([0,2],)", R"([0,2],[0,3],)", "line 3", "partner at both of its ends"},
      {R"([0,2],)", R"([[0],2],)", "line 3", "\"links\" must be a pair of ids"},
      {R"("links":[]})", R"("links":[[0,1]]})", "line 2", "not in the frame before"},
      {R"({"id":2,)", R"({"id":3,)", "line 3", "vertex 3 is there twice"},
      {R"({"id":2,)", R"({"id":4294967296,)", "line 3", "vertex 0 of the list: \"id\" must be a whole"},
      {R"({"id":2,)", R"({"id":-2,)", "line 3", "\"id\" must be a whole"},
      {R"({"id":2,)", R"({"id":2.0,)", "line 3", "\"id\" must be a whole"},
      {R"({"id":2,)", R"({)", "line 3", "vertex 0 of the list: \"id\" is missing"},
      {R"({"id":1,)", R"({"id":1,"id":1,)", "line 2", "vertex 1 of the list: \"id\" is there twice"},
      {R"("type":"ridge")", R"("type":"rodge")", "line 2", "the type \"rodge\" is not known"},
      {R"("type":"ridge")", R"("type":"double_ridge")", "line 2", "the type \"double_ridge\" is not known"},
      {R"("type":"ridge")", R"("type":4)", "line 2", "\"type\" must be a text"},
      {R"("x":1.5)", R"("x":"1.5")", "line 2", "\"x\" must be a number, is a text"},
      {R"("x":1.5)", R"("x":true)", "line 2", "\"x\" must be a number"},
      {R"("x":1.5)", R"("x":[1.5])", "line 2", "\"x\" must be a number, is a list"},
      {R"("x":1.5)", R"("x":{"v":1.5})", "line 2", "\"x\" must be a number, is an object"},
      {R"("x":1.5)", R"("x":1e300)", "line 2", "\"x\" is 1e+300, allowed is -1000000 to 1000000"},
      {R"("x":1.5)", R"("x":1e999)", "line 2", "out of range"},
      {R"("x":1.5)", R"("x":nan)", "line 2", "no valid JSON at column"},
      {R"("width":2)", R"("width":-2)", "line 2", "\"width\" is -2, allowed is 0 to 1000000"},
      {R"("blur":1)", R"("blur":-1)", "line 2", "\"blur\""},
      {R"("left":100)", R"("left":1e200)", "line 2", "\"left\" is not finite"},
      {R"("left":100)", R"("left":[1,2])", "line 2", "\"left\" must be one number or three"},
      {R"("left":100)", R"("left":[1,2,3,4])", "line 2", "\"left\" must be one number or three"},
      {R"("left":100)", R"("left":[1,[2],3])", "line 2", "\"left\" must hold numbers"},
      {R"("left":100)", R"("left":[])", "line 2", "\"left\" must be one number or three"},
      {R"("vertices":[)", R"("vertices":[7,)", "line 2", "\"vertices\" must hold objects"},
      {R"("vertices":[)", R"("vertices":[[)", "line 2", "\"vertices\" must hold objects"},
      {R"({"frame":0)", R"(7{"frame":0)", "line 2", "must be an object"},
      {R"({"frame":0)", R"({"frame":0,,)", "line 2", "no valid JSON at column"},
      {R"({"frame":0)", "\n{\"frame\":0", "line 2", "no valid JSON"},
      {R"(]})", R"(]}x)", "line 2", "no valid JSON at column"},
  };
  for (const Case& c : cases) {
    const std::string message = refusal(replaced(good(), c.what, c.with));
    CAPTURE(c.what, c.with, message);
    CHECK(contains(message, "m.jsonl: " + c.line + ": "));
    CHECK(contains(message, c.cause));
    CHECK(message.find('\n') == std::string::npos);
    CHECK(message.size() < 250);
  }
  CHECK(contains(refusal(""), "m.jsonl: line 1: the file is empty"));
  const std::string low = replaced(replaced(good(), R"({"id":2,)", R"({"id":1,)"), "[[2,3]]", "[[1,3]]");
  CHECK(contains(refusal(low), "line 3: vertex 1 is not above the ids of the frames before, 1"));
}

TEST_CASE("A motion file cut off anywhere is refused", "[graph][io]") {
  const std::string text = good();
  for (std::size_t length = 0; length + 1 < text.size(); ++length) {
    const std::string message = refusal(text.substr(0, length));
    CAPTURE(length, message);
    CHECK(contains(message, "m.jsonl: line "));
  }
  CHECK(contains(refusal(text.substr(0, text.size() - 9)), "line 3: no valid JSON at column"));
  CHECK(contains(refusal(text.substr(0, text.size() - 9)), "the file is cut off there"));
}

TEST_CASE("Deep nesting is refused or passed over, never followed", "[graph][io]") {
  const std::string deep(200000, '['), shut(200000, ']');
  CHECK(contains(refusal(deep + "\n"), "line 1: "));
  CHECK(contains(refusal("{\"format\":" + deep.substr(0, 100) + shut.substr(0, 100) + "}\n"),
                 "nested more than"));
  CHECK(contains(refusal(kHeader + deep + "\n"), "line 2: must be an object, is a list"));
  CHECK(contains(refusal(kHeader + "{\"frame\":0,\"note\":" + deep + "\n"), "line 2: no valid JSON"));
  CHECK(motion_of(replaced(good(), R"("frame":1,)", R"("frame":1,"note":)" + deep + shut + ",")) ==
        motion_of(good()));
  std::istringstream events("{\"events\":" + deep + shut + "}");
  CHECK(contains(test::message_of<core::IoError>([&] { graph::read_events(events, "e.json"); }),
                 "nested more than"));
}

TEST_CASE("A header line without end is given up on", "[graph][io]") {
  CHECK(contains(refusal(std::string(1 << 17, ' ')), "line 1: longer than 64 KiB"));
}

TEST_CASE("Writers refuse what readers would, and say so where the stream fails", "[graph][io]") {
  graph::MotionGraph motion = test::random_motion(3, 3, 5);
  const auto complaint = [&] { return test::message_of<core::InputError>([&] { written(motion); }); };
  motion.sketch.width = 0;
  CHECK(contains(complaint(), "0 x 240"));
  motion.sketch.width = 320;
  motion.sketch.fps = std::nan("");
  CHECK(contains(complaint(), "fps"));
  motion.sketch.fps = 25;
  auto far = test::vertex(0, 2e6, 0);
  motion.sketch.frames = {graph::AttributeGraph({far}, {})};
  motion.links.resize(1);
  CHECK(contains(complaint(), "vertex 0: \"x\" is 2e+06"));
  motion.sketch.frames.clear();
  motion.links.clear();
  std::ostringstream broken;
  broken.setstate(std::ios::badbit);
  CHECK_THROWS_AS(graph::write_motion(broken, motion), core::IoError);
  CHECK_THROWS_AS(graph::write_events(broken, {}), core::IoError);
  CHECK_THROWS_AS(graph::write_trajectories(broken, motion), core::IoError);
}

TEST_CASE("Events read back the same", "[graph][io]") {
  core::Rng rng(12);
  std::vector<graph::Event> events;
  for (int k = 0; k < 50; ++k) {
    graph::Event event{
        k, static_cast<graph::EventType>(k % 6), {rng.uniform(-5, 400), rng.normal()}, rng.uniform(), {}, {}};
    for (int i = 0; i < k % 3; ++i) event.before.push_back({rng.bits()});
    for (int i = 0; i < k % 4; ++i) event.after.push_back({rng.bits()});
    events.push_back(event);
  }
  for (const auto& list : {events, std::vector<graph::Event>{}}) {
    std::stringstream file;
    graph::write_events(file, list);
    CHECK(graph::read_events(file, "e.json") == list);
  }
}

TEST_CASE("A scene's truth is read for its events", "[graph][io]") {
  std::istringstream truth(R"({"kind": "fire", "events": [{"frame": 3, "type": "merge", "x": 1.5, "y": 7}],
    "strokes": [[{"points": [[1, 2], [3, 4]]}]]})");
  const auto events = graph::read_events(truth, "truth.json");
  REQUIRE(events.size() == 1);
  CHECK(events[0] == graph::Event{3, graph::EventType::merge, {1.5, 7}, 1, {}, {}});
}

TEST_CASE("Every bad events file is refused with name and cause", "[graph][io]") {
  const auto message_for = [](const std::string& text) {
    return test::message_of<core::IoError>([&] {
      std::istringstream in(text);
      graph::read_events(in, "e.json");
    });
  };
  const auto one = [](const std::string& event) { return "{\"events\":[" + event + "]}"; };
  const std::vector<std::pair<std::string, std::string>> cases = {
      {"", "is empty"},
      {"[]", "no JSON object"},
      {"{}", "no list \"events\""},
      {R"({"events":{}})", "no list \"events\""},
      {"{\"events\":[\n\n{]", "no valid JSON at line 3, column 2"},
      {R"({"format":"emberfold.motion","events":[]})", "format is \"emberfold.motion\""},
      {R"({"format":3,"events":[]})", "format is no text"},
      {R"({"format":"emberfold.events","version":2,"events":[]})", "version 2 is newer"},
      {R"({"format":"emberfold.events","events":[]})", "\"version\" must be"},
      {one("3"), "event 0: must be an object"},
      {one(R"({"type":"birth","x":1,"y":2})"), "event 0: \"frame\" is missing"},
      {one(R"({"frame":1.5,"type":"birth","x":1,"y":2})"), "\"frame\" must be a whole number"},
      {one(R"({"frame":-1,"type":"birth","x":1,"y":2})"), "\"frame\" must be a number from 0 to"},
      {one(R"({"frame":1,"type":"bath","x":1,"y":2})"), "the type \"bath\" is none of"},
      {one(R"({"frame":1,"type":1,"x":1,"y":2})"), "\"type\" must be a text"},
      {one(R"({"frame":1,"type":"birth","x":1e300,"y":2})"), "\"x\" must be a number from"},
      {one(R"({"frame":1,"type":"birth","x":1})"), "\"y\" is missing"},
      {one(R"({"frame":1,"type":"birth","x":1,"y":2,"probability":1.5})"), "\"probability\""},
      {one(R"({"frame":1,"type":"birth","x":1,"y":2,"before":[-1]})"), "\"before\" must hold"},
      {one(R"({"frame":1,"type":"birth","x":1,"y":2,"after":1})"), "\"after\" must be a list"},
  };
  for (const auto& [text, cause] : cases) {
    const std::string message = message_for(text);
    CAPTURE(text, message);
    CHECK(contains(message, "e.json: "));
    CHECK(contains(message, cause));
    CHECK(message.find('\n') == std::string::npos);
  }
}

TEST_CASE("Events and trajectories have their tables", "[graph][io]") {
  std::ostringstream events;
  graph::write_events_csv(events, {{2, graph::EventType::split, {1.25, 3}, 0.5, {{4}}, {{5}, {6}}}});
  CHECK(events.str() == "frame,type,x,y,probability,before,after\n2,split,1.25,3,0.5,4,5;6\n");
  std::ostringstream table;
  graph::write_trajectories(table, motion_of(good()));
  CHECK(contains(table.str(),
                 "trajectory,frame,vertex,stroke,x,y,theta,width,blur,contrast\n"
                 "0,0,0,1,1.5,2,0.5,2,1,30\n0,1,2,1,1.5,2,0.5,2,1,30\n1,0,1,1"));
}

TEST_CASE("A long clip's motion is written and read in a moment", "[graph][io]") {
  core::Rng rng(4);
  test::Frame frame;
  for (int k = 0; k < 50; ++k) {
    frame.line(test::segment({rng.uniform(0, 300), rng.uniform(0, 200)},
                             {rng.uniform(0, 300), rng.uniform(0, 200)}, 10));
  }
  const graph::AttributeGraph one = frame.graph();
  std::vector<std::pair<std::uint32_t, std::uint32_t>> straight;
  for (std::uint32_t i = 0; i < one.size(); ++i) straight.emplace_back(i, i);
  const auto motion = test::motion(std::vector(300, one), std::vector(299, straight));
  const auto start = std::chrono::steady_clock::now();
  const std::string text = written(motion);
  const auto middle = std::chrono::steady_clock::now();
  CHECK(motion_of(text) == motion);
  const std::chrono::duration<double> write = middle - start,
                                      read_time = std::chrono::steady_clock::now() - middle;
  CAPTURE(write.count(), read_time.count());
  CHECK(write.count() < 5 * test::kSlowdown);
  CHECK(read_time.count() < 5 * test::kSlowdown);
}

TEST_CASE("Anchors are in sketches with what they need, and read back bit for bit", "[graph][io][anchors]") {
  core::Rng rng(8);
  graph::SketchSequence sketch;
  sketch.width = 320, sketch.height = 240;
  for (int t = 0; t < 4; ++t) sketch.append(test::with_anchors(test::random_graph(rng, 3, 1), rng, t * 20));
  const auto lines = [](const graph::SketchSequence& of) {
    std::ostringstream out;
    graph::write_sketch(out, of);
    return out.str();
  };
  const auto read_lines = [](const std::string& text) {
    std::istringstream in(text);
    return graph::read_sketch(in, "s.jsonl");
  };
  CHECK(read_lines(lines(sketch)) == sketch);
  sketch.frames = {graph::AttributeGraph(
      {test::anchor(0, 0, 0, {1.25F, 1.25F, 1.25F}), test::anchor(1, 319, 239, {1, 2, 3.5F})}, {})};
  const std::string text = lines(sketch),
                    last = R"({"id":1,"type":"anchor","x":319,"y":239,"middle":[1,2,3.5]})";
  CHECK(contains(text, R"([{"id":0,"type":"anchor","x":0,"y":0,"middle":1.25},)" + last + "]"));
  // What an anchor does not need is passed over.
  CHECK(read_lines(replaced(text, last, R"({"theta":7,"subgraph":4,"left":9,)" + last.substr(1))) == sketch);
  const std::vector<std::pair<std::string, std::string>> cases = {
      {R"("x":320,"y":239,"middle":1})",
       "\"x\" of an anchor is 320, allowed is a whole number from 0 to 319"},
      {R"("x":1.5,"y":239,"middle":1})", "\"x\" of an anchor is 1.5"},
      {R"("x":0,"y":-1,"middle":1})", "\"y\" of an anchor is -1, allowed is a whole number from 0 to 239"},
      {R"("x":0,"y":0,"middle":1e300})", "\"middle\" is not finite"},
      {R"("x":0,"y":0,"middle":1e999})", "out of range"},
      {R"("x":0,"y":0,"middle":[1,2]})", "\"middle\" must be one number or three"},
      {R"("x":0,"y":0})", "\"middle\" is missing"},
      {R"("y":0,"middle":1})", "\"x\" is missing"}};
  for (const auto& [with, cause] : cases) {
    const std::string wrong = replaced(text, last.substr(last.find("\"x\"")), with);
    const auto message = test::message_of<core::IoError>([&] { read_lines(wrong); });
    CAPTURE(with, message);
    CHECK(contains(message, "s.jsonl: line 2: "));
    CHECK(contains(message, cause));
    CHECK(message.find('\n') == std::string::npos);
  }
  const auto tied = test::message_of<core::IoError>(
      [&] { read_lines(replaced(text, R"("edges":[])", R"("edges":[[0,1]])")); });
  CHECK(contains(tied, "line 2: "));
  CHECK(contains(tied, "an anchor"));
  sketch.width = 319;
  CHECK(contains(test::message_of<core::InputError>([&] { lines(sketch); }), "vertex 1: \"x\" of an anchor"));
  // A motion graph has none.
  const std::string none = R"({"id":2,"type":"anchor","x":1,"y":2,"middle":3})";
  CHECK(contains(refusal(replaced(replaced(good(), vertex(2), none), R"([[2,3]],"links":[[0,2],[1,3]])",
                                  R"([],"links":[[1,3]])")),
                 "line 3: a vertex is an anchor"));
}

TEST_CASE("A sketch written frame after frame reads as one written at once", "[graph][io]") {
  core::Rng rng(9);
  for (const int frames : {0, 1, 2, 12}) {
    graph::SketchSequence sketch;
    sketch.width = 320, sketch.height = 240, sketch.fps = 29.97;
    std::ostringstream out;
    graph::SketchWriter writer(out, sketch.width, sketch.height, sketch.fps);
    for (int t = 0; t < frames; ++t) {
      const auto graph = t % 3 == 1 ? graph::AttributeGraph{} : test::random_graph(rng, 3, 1);
      sketch.append(graph);
      writer.add(graph);
    }
    writer.finish();
    std::istringstream in(out.str());
    CHECK(graph::read_sketch(in, "s.jsonl") == sketch);
  }
  std::ostringstream broken;
  graph::SketchWriter writer(broken, 320, 240, 25);
  broken.setstate(std::ios::badbit);
  CHECK_THROWS_AS(writer.finish(), core::IoError);
}
