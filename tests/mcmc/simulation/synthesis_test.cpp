// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <set>

#include "core/error.hpp"
#include "graph/events/events.hpp"
#include "mcmc/learning/fit.hpp"
#include "mcmc/simulation/synthesize.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/motion_models.hpp"
#include "tests/support/motion_scene.hpp"

using namespace emberfold;

namespace {

// About ten strokes that move, appear and disappear.
test::Scene scene_of_life(int frames) {
  test::Scene scene;
  scene.frames = frames;
  scene.strokes = test::living(0.3, 0.03, frames, scene.width, scene.height, 51);
  scene.displacement = {1.5, -0.6, 0.25, 30};
  scene.gain = {1.3, -0.5, 0.05, 30};
  return scene;
}

// Statistics of a clip, frame by frame.
struct Series {
  std::vector<double> strokes, patches, contrast, x, y, wide, high;
};
Series series(const graph::MotionGraph& motion) {
  Series s;
  for (const auto& graph : motion.sketch.frames) {
    double contrast = 0, x = 0, y = 0, xx = 0, yy = 0;
    const auto n = std::max(1.0, double(graph.size()));
    for (const auto& vertex : graph.vertices()) {
      const auto p = vertex.patch.position;
      contrast += std::abs(vertex.patch.contrast) / n;
      x += p.x / n, y += p.y / n, xx += p.x * p.x / n, yy += p.y * p.y / n;
    }
    s.strokes.push_back(double(graph::components(graph).count));
    s.patches.push_back(double(graph.size()));
    s.contrast.push_back(contrast);
    s.x.push_back(x), s.y.push_back(y);
    s.wide.push_back(std::sqrt(xx - x * x)), s.high.push_back(std::sqrt(yy - y * y));
  }
  return s;
}

double mean(const std::vector<double>& values) {
  double sum = 0;
  for (const double v : values) sum += v / double(values.size());
  return sum;
}

// The slope of the means of `blocks` blocks over their order, in SDs of such a slope (Student's t) were there
// none.
double trend(const std::vector<double>& values, std::size_t blocks) {
  const std::size_t length = values.size() / blocks;
  std::vector<double> means;
  for (std::size_t b = 0; b < blocks; ++b)
    means.push_back(mean({values.begin() + long(b * length), values.begin() + long((b + 1) * length)}));
  const double centre = (double(blocks) - 1) / 2, level = mean(means);
  double tt = 0, ty = 0, rest = 0;
  for (std::size_t b = 0; b < blocks; ++b)
    tt += std::pow(double(b) - centre, 2), ty += (double(b) - centre) * (means[b] - level);
  for (std::size_t b = 0; b < blocks; ++b)
    rest += std::pow(means[b] - level - ty / tt * (double(b) - centre), 2);
  return ty / tt / std::sqrt(rest / (double(blocks) - 2) / tt);
}

}  // namespace

TEST_CASE("A synthesized clip stays as the learned one was for a thousand frames", "[synthesis][slow]") {
  const auto data = test::make(scene_of_life(400), 52).motion;
  const auto fitted = mcmc::fit(data);
  const auto clip = mcmc::synthesize(fitted.model, 1000, 53);
  REQUIRE(clip.sketch.frames.size() == 1000);
  const Series was = series(data), is = series(clip);
  const auto check = [](const std::string& what, const std::vector<double>& data_values,
                        const std::vector<double>& values, double scale) {
    CAPTURE(what, mean(data_values), mean(values), trend(values, 10));
    CHECK(std::abs(trend(values, 10)) < 4);
    CHECK(std::abs(mean(values) - mean(data_values)) < 0.2 * scale);
  };
  check("strokes", was.strokes, is.strokes, mean(was.strokes));
  check("patches", was.patches, is.patches, mean(was.patches));
  check("contrast", was.contrast, is.contrast, mean(was.contrast));
  check("x", was.x, is.x, 160);
  check("y", was.y, is.y, 120);
  check("wide", was.wide, is.wide, mean(was.wide));
  check("high", was.high, is.high, mean(was.high));
  // Strokes live as long: in 400 frames of the data 120 die, so that their rate is known to a tenth, and as
  // many are drawn to balance births with.
  const auto deaths = [](const graph::MotionGraph& motion) {
    double count = 0;
    for (const auto& event : graph::stroke_events(motion)) count += event.type == graph::EventType::death;
    return count / double(motion.sketch.frames.size() - 1);
  };
  CHECK_THAT(deaths(clip), Catch::Matchers::WithinRel(deaths(data), 0.25));
}

TEST_CASE("Neither strokes nor contrast nor events drift in five thousand frames", "[synthesis][slow]") {
  auto model = mcmc::fit(test::make(scene_of_life(200), 58).motion).model;
  for (double& value : model.drift_x.values) value += 0.3;  // some leave the frame
  constexpr int frames = 5000;
  mcmc::Synthesis synthesis(model, 59);
  std::vector<double> strokes, contrast;
  std::array<std::vector<double>, 6> events;
  int unseen = 0;
  for (int t = 0; t < frames; ++t) {
    const auto graph = synthesis.next();
    const auto parts = graph::components(graph);
    double sum = 0;
    std::vector<bool> seen(parts.count);
    for (std::size_t v = 0; v < graph.size(); ++v) {
      const auto& patch = graph.patch(v);
      sum += std::abs(patch.contrast) / double(graph.size());
      // Bands are drawn 12 px wide at most.
      if (patch.position.x > -12 && patch.position.y > -12 && patch.position.x < model.width + 12 &&
          patch.position.y < model.height + 12)
        seen[parts.of_vertex[v]] = true;
    }
    strokes.push_back(double(parts.count));
    contrast.push_back(sum);
    for (std::size_t i = 0; i < 6; ++i) events[i].push_back(synthesis.operators()[i]);
    unseen += static_cast<int>(std::ranges::count(seen, false));
  }
  // A stroke that has left the frame stays for one frame at most.
  CHECK(unseen <= frames / 100);
  CHECK(std::abs(trend(strokes, 10)) < 4);
  CHECK(std::abs(trend(contrast, 10)) < 4);
  for (std::size_t i = 0; i < 6; ++i) {
    if (mean(events[i]) < 0.01) continue;
    CAPTURE(i, mean(events[i]));
    CHECK(std::abs(trend(events[i], 10)) < 4);
  }
  CHECK(mean(events[0]) > 0.1);
}

TEST_CASE("A model that was drawn from is learned again", "[synthesis][slow]") {
  test::Scene scene = scene_of_life(300);
  scene.strokes = test::scattered(6, 4, scene.width, scene.height, 50);
  const auto model = mcmc::fit(test::make(scene, 54).motion).model;
  const auto again = mcmc::fit(mcmc::synthesize(model, 400, 55)).model;
  CHECK_THAT(again.displacement.a1, Catch::Matchers::WithinRel(model.displacement.a1, 0.1));
  CHECK_THAT(again.displacement.a2, Catch::Matchers::WithinRel(model.displacement.a2, 0.1));
  CHECK_THAT(mcmc::stationary_deviation(again.displacement),
             Catch::Matchers::WithinRel(mcmc::stationary_deviation(model.displacement), 0.1));
  CHECK_THAT(again.contrast.a1, Catch::Matchers::WithinRel(model.contrast.a1, 0.1));
  CHECK_THAT(again.contrast.a2, Catch::Matchers::WithinRel(model.contrast.a2, 0.1));
  CHECK_THAT(mcmc::stationary_deviation(again.contrast),
             Catch::Matchers::WithinRel(mcmc::stationary_deviation(model.contrast), 0.1));
}

TEST_CASE("The same seed gives the same graphs, another others, and a longer clip goes on",
          "[synthesis][heavy]") {
  auto model = mcmc::fit(test::make(scene_of_life(60), 56).motion).model;
  const auto clip = mcmc::synthesize(model, 60, 7);
  CHECK(mcmc::synthesize(model, 60, 7) == clip);
  // All begin as the source did; from the next frame on they differ.
  const auto other = mcmc::synthesize(model, 2, 8);
  const auto &first = clip.sketch.frames[0], &another = other.sketch.frames[0];
  REQUIRE(another.size() == first.size());
  for (std::uint32_t v = 0; v < first.size(); ++v) {
    CHECK(graph::distance(another.patch(v).position, first.patch(v).position) < 1e-9);
    CHECK_THAT(another.patch(v).contrast, Catch::Matchers::WithinAbs(first.patch(v).contrast, 1e-9));
  }
  CHECK(other.sketch.frames[1] != clip.sketch.frames[1]);
  CHECK(mcmc::synthesize(model, 2, (std::uint64_t{1} << 32) + 7).sketch.frames[1] != clip.sketch.frames[1]);
  CHECK(mcmc::synthesize(model, 1, 8, {}, mcmc::Start::stationary).sketch.frames[0] !=
        mcmc::synthesize(model, 1, 7, {}, mcmc::Start::stationary).sketch.frames[0]);
  auto beginning = mcmc::synthesize(model, 90, 7);
  beginning.sketch.frames.resize(60), beginning.links.resize(60);
  CHECK(beginning == clip);
  // Frame by frame it is the same, with ids that stay.
  mcmc::Synthesis synthesis(model, 7);
  std::set<std::uint32_t> gone, before;
  for (std::size_t t = 0; t < 60; ++t) {
    const auto graph = synthesis.next();
    REQUIRE(graph.size() == clip.sketch.frames[t].size());
    std::set<std::uint32_t> now;
    for (std::size_t v = 0; v < graph.size(); ++v) {
      CHECK(graph.patch(v) == clip.sketch.frames[t].patch(v));
      now.insert(graph.vertices()[v].id.value);
      CHECK(!gone.contains(graph.vertices()[v].id.value));
    }
    for (const auto id : before)
      if (!now.contains(id)) gone.insert(id);
    before = now;
  }
  CHECK(!gone.empty());
}

TEST_CASE("A synthesized clip is a valid motion graph", "[synthesis]") {
  const auto model = mcmc::fit(test::make(scene_of_life(80), 57).motion).model;
  const auto motion = mcmc::synthesize(model, 100, 1);
  CHECK(motion.sketch.width == model.width);
  CHECK(motion.sketch.height == model.height);
  CHECK(motion.sketch.fps == model.fps);
  CHECK_NOTHROW(graph::validate(motion));
  CHECK(graph::identify(motion) == motion);
  std::size_t linked = 0, all = 0;
  for (std::size_t t = 1; t < 100; ++t) {
    linked += motion.links[t].size();
    all += motion.sketch.frames[t].size();
    // Nothing jumps: patches that go on are near where they were.
    for (const auto& link : motion.links[t]) {
      const auto &a = motion.sketch.frames[t - 1], &b = motion.sketch.frames[t];
      CHECK(graph::distance(a.patch(a.index_of(link.before)).position,
                            b.patch(b.index_of(link.after)).position) < 4);
    }
  }
  CHECK(double(linked) > 0.9 * double(all));
}

TEST_CASE("Bad calls of the synthesis are refused", "[synthesis]") {
  auto model = test::empty_model();
  for (const int frames : {0, -5}) CHECK_THROWS_AS(mcmc::synthesize(model, frames, 1), core::InputError);
  model.displacement.a1 = 1.5;
  CHECK_THROWS_AS(mcmc::synthesize(model, 5, 1), core::InputError);
  CHECK_THROWS_AS(mcmc::Synthesis(model, 1), core::InputError);
}
