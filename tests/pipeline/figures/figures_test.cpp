// SPDX-License-Identifier: Apache-2.0
#include "pipeline/figures/figures.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <utility>
#include <vector>

#include <opencv2/core.hpp>

#include "core/clip/masked_source.hpp"
#include "core/parallel.hpp"
#include "pipeline/figures/figure_changes.hpp"
#include "pipeline/figures/figure_ground.hpp"
#include "pipeline/figures/figure_regions.hpp"
#include "pipeline/sketch_clip.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/sketch_scene.hpp"

using namespace emberfold;
using namespace emberfold::test;
using graph::EventType;

namespace {

constexpr int kWidth = 160, kHeight = 120, kFrames = 40;

using Scene = std::function<double(Point, int)>;

core::Clip film(const Scene& level, cv::Size size = {kWidth, kHeight}) {
  core::Clip clip;
  clip.info.width = size.width, clip.info.height = size.height, clip.info.channels = 1;
  clip.info.frames = kFrames;
  for (int t = 0; t < kFrames; ++t) {
    const cv::Mat1f levels =
        with_noise(draw(size, [&](Point p) { return level(p, t); }), 2, static_cast<std::uint64_t>(t) + 1);
    cv::Mat bytes;
    levels.convertTo(bytes, CV_8U);
    clip.frames.push_back(bytes);
  }
  return clip;
}

pipeline::Figures figures_of(core::FrameSource& source) {
  const auto lines = pipeline::sketch_clip(source, pipeline::kFollowedSketch, {}).sketch;
  return pipeline::find_figures(source, lines);
}
pipeline::Figures figures_of(const core::Clip& clip) {
  core::ClipSource source(clip);
  return figures_of(source);
}

/// 1 inside a disc, 0 outside, with an edge blurred by 1.5 px.
double disc(Point p, Point centre, double radius) {
  return reached(radius - distance(p, centre), 1.5);
}

double levels(double cover, bool bright) {
  return bright ? 60 + 90 * cover : 150 - 90 * cover;
}

/// Two discs that approach each other and touch in the middle of the clip, then stay.
Scene approaching(bool bright) {
  return [=](Point p, int t) {
    const double half = std::max(14., 26 - 0.5 * t);  // touch at 16
    return levels(std::max(disc(p, {80 - half, 60}, 16), disc(p, {80 + half, 60}, 16)), bright);
  };
}

std::vector<graph::Event> believed(const pipeline::Figures& figures) {
  std::vector<graph::Event> events;
  std::ranges::copy_if(figures.events, std::back_inserter(events),
                       [](const graph::Event& e) { return e.probability >= 0.5; });
  return events;
}

bool unites(EventType type) {
  return type == EventType::merge || type == EventType::connect;
}
bool separates(EventType type) {
  return type == EventType::split || type == EventType::disconnect;
}

/// A clip whose structure counts in its left half alone.
class LeftHalf final : public core::FrameSource, public core::ClipKnowledge {
 public:
  explicit LeftHalf(const core::Clip& clip) : source_(clip) {}
  [[nodiscard]] const core::ClipInfo& info() const override { return source_.info(); }
  cv::Mat next() override { return source_.next(); }
  void rewind() override { source_.rewind(); }
  [[nodiscard]] cv::Mat mask() const override {
    cv::Mat mask(kHeight, kWidth, CV_8U, cv::Scalar(0));
    mask(cv::Rect(0, 0, kWidth / 2, kHeight)) = 255;
    return mask;
  }
  [[nodiscard]] std::vector<core::CameraMotion> drift() const override { return {}; }

 private:
  core::ClipSource source_;
};

core::Clip backwards(core::Clip clip) {
  std::ranges::reverse(clip.frames);
  return clip;
}

}  // namespace

TEST_CASE("two discs that touch are one union, at the place and time where they do") {
  const bool bright = GENERATE(true, false);
  CAPTURE(bright);
  const auto clip = film(approaching(bright));
  const auto figures = figures_of(clip);
  graph::validate(figures.motion);
  const auto events = believed(figures);
  REQUIRE(events.size() == 1);
  CHECK(unites(events[0].type));
  CHECK(std::abs(events[0].frame - 20) <= 4);
  CHECK(distance(events[0].position, {80, 60}) < 8);
  CHECK(events[0].probability > 0.9);
  CHECK(events[0].probability <= 1);
  CHECK(events[0].before.size() == 2);
  CHECK(graph::components(figures.motion.sketch.frames.front()).count == 2);
  CHECK(graph::components(figures.motion.sketch.frames.back()).count == 1);
}

TEST_CASE("three discs that touch at once are two unions, each at its place") {
  // The right one touches so little that not all thresholds see it: its union is less probable.
  const auto figures = figures_of(film([](Point p, int t) {
    const double left = t < 20 ? 40 : 28, right = t < 20 ? 34 : 25.3;
    return levels(
        std::max({disc(p, {70 - left, 60}, 20), disc(p, {70, 60}, 14), disc(p, {70 + right, 60}, 11)}), true);
  }));
  std::vector<graph::Event> unions;
  for (const graph::Event& event : figures.events)
    if (unites(event.type) && event.probability > 0) unions.push_back(event);
  REQUIRE(unions.size() == 2);
  CHECK(std::abs(unions[0].position.x - unions[1].position.x) > 15);
}

TEST_CASE("a disc that goes from one figure to another at once is a separation and a union") {
  const auto figures = figures_of(film([](Point p, int t) {
    const double neck =
        std::min(reached(12 - std::abs(p.x - (t < 20 ? 62 : 98)), 1.5), reached(5 - std::abs(p.y - 60), 1.5));
    return levels(std::max({disc(p, {34, 60}, 24), disc(p, {80, 60}, 12), disc(p, {126, 60}, 24), neck}),
                  true);
  }));
  const auto events = believed(figures);
  REQUIRE(events.size() == 2);
  for (const graph::Event& event : events) {
    CHECK(event.frame == 20);
    CHECK((separates(event.type) || unites(event.type)));
    CHECK(distance(event.position, separates(event.type) ? Point{62, 60} : Point{98, 60}) < 10);
  }
  CHECK(separates(events[0].type) != separates(events[1].type));
}

TEST_CASE("a separation is as sure as thresholds see it at its place, joined elsewhere or not") {
  const auto clip = film([](Point p, int t) {
    const double gap = t < 20 ? 0 : reached(5 - std::abs(p.x - 80), 1.5);
    return levels(
        std::min({reached(75 - std::abs(p.x - 80), 1.5), reached(8 - std::abs(p.y - 70), 1.5), 1 - gap}),
        true);
  });
  core::ClipSource source(clip);
  const auto lines = pipeline::sketch_clip(source, pipeline::kFollowedSketch, {}).sketch;
  const auto ground = pipeline::measure_figure_ground(source, {});
  auto all = pipeline::find_figure_regions(source, ground, {});
  pipeline::link_figure_regions(all, ground, lines, {});
  const auto probability = [&] {
    const auto changes = pipeline::weigh_figure_changes(all, ground, {});
    REQUIRE(changes.size() == 1);
    CHECK(changes[0].change.type == EventType::split);
    CHECK(changes[0].change.frame == 20);
    return changes[0].probability;
  };
  const auto paint = [&](cv::Rect where, int from) {  // above −.2
    for (int t = from; t < kFrames; ++t)
      for (int y = where.y; y < where.br().y; ++y)
        for (int x = where.x; x < where.br().x; ++x)
          all.labels[static_cast<std::size_t>(t)](y, x) |=
              static_cast<std::uint8_t>(pipeline::label_bit(1, 1));
  };
  CHECK(probability() == 1);
  paint({40, 10, 80, 5}, 0), paint({40, 10, 5, 60}, 0), paint({115, 10, 5, 60}, 0);  // round above
  CHECK(probability() == 1);
  paint({50, 64, 60, 12}, 23);  // apart for three frames
  CHECK(probability() == 1);
  paint({50, 64, 60, 12}, 20);
  CHECK(probability() == Approx(2 / 3.));
}

TEST_CASE("a clip played backwards parts where it unites") {
  const auto clip = film(approaching(true));
  const auto there = believed(figures_of(clip)), back = believed(figures_of(backwards(clip)));
  REQUIRE(there.size() == 1);
  REQUIRE(back.size() == 1);
  CHECK(separates(back[0].type));
  CHECK(back[0].frame == kFrames - there[0].frame);
  CHECK(distance(back[0].position, there[0].position) < 2);
}

TEST_CASE("a disc that shrinks away dies; one that leaves the picture, or shrinks at its border, does not") {
  const auto clip = film([](Point p, int t) {
    const double radius = 14 - 0.5 * t;
    const double shrinking = radius > 0 ? disc(p, {50, 60}, radius) : 0;
    const double cut = radius > 0 ? disc(p, {50, 119}, radius + 4) : 0;
    return levels(std::max({shrinking, cut, disc(p, {110 + 2. * t, 60}, 14)}), true);
  });
  const auto events = believed(figures_of(clip));
  REQUIRE(events.size() == 1);
  CHECK(events[0].type == EventType::death);
  CHECK(distance(events[0].position, {50, 60}) < 5);
  CHECK(events[0].frame > 16);
  CHECK(events[0].frame <= 30);
}

TEST_CASE("thin lines, noise, and smooth shading are no figures") {
  const auto scene = GENERATE(0, 1, 2);
  CAPTURE(scene);
  const auto clip = film([=](Point p, int t) {
    if (scene == 0) return levels(segment({30, 40}, {130, 80}, 3, 1)(p), true);
    if (scene == 1) return 100.;
    return 100 + 30 * std::sin((p.x + t) / 40) * std::cos(p.y / 50);
  });
  for (const auto& graph : figures_of(clip).motion.sketch.frames) CHECK(graph.empty());
}

TEST_CASE("where bright stripes part and dark ones join the bright ones do") {
  // Stripes 16 px wide in a frame of grey; one of the bright ones parts.
  const auto clip = film([](Point p, int t) {
    const double inside = reached(std::min({p.x - 20, 140 - p.x, p.y - 20, 100 - p.y}), 1.5);
    const double stripes = 75 * std::tanh(2 * std::sin((p.y - 48) * CV_PI / 16));
    const double gap = 150 * reached(t - 20., 2) * disc(p, {80, 56}, 9);
    return 110 + inside * (stripes - gap);
  });
  const auto figures = figures_of(clip);
  const auto events = believed(figures);
  REQUIRE(events.size() == 1);
  CHECK(separates(events[0].type));
  CHECK(std::abs(events[0].frame - 20) <= 3);
  CHECK(distance(events[0].position, {80, 56}) < 10);
  // Of the two stripes that share an outline it is the bright one's.
  const auto& drawn = figures.motion.sketch.frames.front();
  CHECK(graph::components(drawn).count == 2);
  for (const auto& vertex : drawn.vertices())
    CHECK(std::min(std::abs(vertex.patch.position.y - 56), std::abs(vertex.patch.position.y - 88)) < 11);
}

TEST_CASE("ground that discs cut off from half of the border is no figure, half discs there are") {
  const std::vector<Point> centres{{80, 60}, {0, 30},  {0, 90},   {159, 30}, {159, 90},
                                   {40, 0},  {120, 0}, {40, 119}, {120, 119}};
  const auto clip = film([&](Point p, int) {
    double cover = 0;
    for (const Point c : centres) cover = std::max(cover, disc(p, c, 16));
    return levels(cover, false);
  });
  for (const auto& graph : figures_of(clip).motion.sketch.frames)
    CHECK(graph::components(graph).count == centres.size());
}

TEST_CASE("what has half of the border is a figure where outlines are not hollow") {
  const auto clip = film([](Point p, int) {
    const double half = reached(60 - p.x, 1.5);
    return levels(std::max({half, disc(p, {110, 35}, 14), disc(p, {110, 85}, 14)}), true);
  });
  for (const auto& graph : figures_of(clip).motion.sketch.frames) CHECK(graph::components(graph).count == 3);
}

TEST_CASE("edges that are soft explain a figure as sharp ones do") {
  const auto clip = film([](Point p, int) { return levels(reached(16 - distance(p, {80, 60}), 5), true); });
  core::ClipSource source(clip);
  const auto ground = pipeline::measure_figure_ground(source, {});
  const auto all = pipeline::find_figure_regions(source, ground, {});
  const auto& bright = all.of[1].regions;
  REQUIRE(bright.size() == kFrames);
  for (const auto& region : bright) {
    CHECK(region.gain() > 1.7);
    CHECK(region.sharp_gain() < 1.5);
    CHECK(region.turning == 1);
  }
}

TEST_CASE("a drop from which thin lines run is no figure, a drop with a short tail is") {
  for (const bool long_lines : {true, false}) {
    const auto clip = film([=](Point p, int) {
      const double reach = long_lines ? 70 : 13;
      double cover = disc(p, {80, 60}, 9);
      for (const double y : {57., 60., 63.})  // spread from the drop
        if (const double x = std::abs(p.x - 80); x < reach)
          cover = std::max(cover, reached(2.5 - std::abs(p.y - y - (y - 60) * x / 6), 1));
      return levels(cover, true);
    });
    bool any = false;
    for (const auto& graph : figures_of(clip).motion.sketch.frames) any |= !graph.empty();
    CHECK(any != long_lines);
  }
}

TEST_CASE("a figure of two frames is born and dies") {
  const auto clip = film([](Point p, int t) {
    const double brief = t == 20 || t == 21 ? disc(p, {110, 60}, 14) : 0;
    return levels(std::max(disc(p, {40, 60}, 14), brief), true);
  });
  const auto events = believed(figures_of(clip));
  REQUIRE(events.size() == 2);
  CHECK(events[0].type == EventType::birth);
  CHECK(events[0].frame == 20);
  CHECK(events[1].type == EventType::death);
  CHECK(events[1].frame == 22);
}

TEST_CASE("what is left of a figure before it dies does not move its death") {
  const auto clip = film([](Point p, int t) {
    const double from = t < 20 ? 50 : 98;  // a bar to 110; its end is left for one frame
    const double along = std::min(p.x - from, 110 - p.x), across = 10 - std::abs(p.y - 60);
    return levels(t > 20 ? 0 : reached(std::min(along, across), 1), true);
  });
  const auto events = believed(figures_of(clip));
  REQUIRE(events.size() == 1);
  CHECK(events[0].type == EventType::death);
  CHECK(distance(events[0].position, {80, 60}) < 4);
}

TEST_CASE("outlines lie on the edge, with the levels of both sides and the bright one to the right") {
  const bool bright = GENERATE(true, false);
  CAPTURE(bright);
  const Point centre{80, 60};
  const auto clip = film([=](Point p, int) { return levels(disc(p, centre, 24), bright); });
  const auto figures = figures_of(clip);
  CHECK(figures.events.empty());
  const auto& graph = figures.motion.sketch.frames[kFrames / 2];
  REQUIRE(graph.size() > 20);
  CHECK(graph.edges().size() == graph.size());
  CHECK(graph::components(graph).count == 1);
  for (const graph::Vertex& vertex : graph.vertices()) {
    const graph::Patch& patch = vertex.patch;
    CHECK(std::abs(distance(patch.position, centre) - 24) < 0.7);
    CHECK(std::abs(patch.right[0] - 150) < 12);
    CHECK(std::abs(patch.left[0] - 60) < 12);
    CHECK(patch.contrast > 70);
    CHECK(std::abs(patch.blur - 1.5) < 0.7);
    const Point right{-std::sin(patch.theta), std::cos(patch.theta)};
    CHECK((dot(right, centre - patch.position) > 0) == bright);
    CHECK(patch.evidence > 0);
  }
}

TEST_CASE("figures that stand still in flickering light do not change") {
  const auto clip = film([](Point p, int t) {
    const double light = t % 7 == 3 ? 1.4 : t % 5 == 0 ? 0.7 : 1;
    const double cover = std::max({disc(p, {45, 60}, 16), disc(p, {80, 60}, 16), disc(p, {125, 60}, 20)});
    return light * (60 + 90 * cover);
  });
  const auto figures = figures_of(clip);
  CHECK(believed(figures).empty());
  for (const auto& graph : figures.motion.sketch.frames) CHECK(graph::components(graph).count >= 2);
}

TEST_CASE("figures count inside the mask, and do not die at its border") {
  const auto clip = film([](Point p, int t) {
    return levels(std::max({disc(p, {30, 30}, 14), disc(p, {50 + 2. * t, 85}, 14), disc(p, {130, 40}, 14)}),
                  true);
  });
  LeftHalf source(clip);
  const auto figures = figures_of(source);
  CHECK(believed(figures).empty());
  CHECK(graph::components(figures.motion.sketch.frames.front()).count == 2);
  CHECK(graph::components(figures.motion.sketch.frames.back()).count == 1);
  for (const auto& graph : figures.motion.sketch.frames)
    for (const graph::Vertex& vertex : graph.vertices()) CHECK(vertex.patch.position.x < 0.5 * kWidth + 2);
}

TEST_CASE("cells between lines are no figures, and shapes as thin that no line draws are") {
  // A grid of lines 30 px apart, and the same shapes with sharp edges.
  const auto from_grid = [](Point p) {
    const auto off = [](double x) { return std::abs(std::remainder(x - 20, 30)); };
    return std::min(off(p.x), off(p.y));
  };
  for (const bool bright : {true, false}) {
    const auto lines = film([&](Point p, int) {
      const double d = from_grid(p);
      return levels(std::exp(-d * d / 8), bright);
    });
    CHECK(figures_of(lines).motion.sketch.frames.front().empty());
    const auto bars = film([&](Point p, int t) {
      const double d = std::max(std::abs(p.y - 60) - 3.5, std::abs(p.x - 80) - (t < 20 ? 40 : 60));
      return levels(reached(-d, 0.7), bright);
    });
    core::ClipSource source(bars);
    const auto drawn = pipeline::sketch_clip(source, pipeline::kFollowedSketch, {}).sketch;
    graph::SketchSequence none{drawn.width, drawn.height, drawn.fps, {}};
    for (int t = 0; t < kFrames; ++t) none.append({});
    CHECK(pipeline::find_figures(source, drawn).motion.sketch.frames.front().empty());
    const auto undrawn = pipeline::find_figures(source, none).motion.sketch;
    for (const auto& frame : undrawn.frames) CHECK(graph::components(frame).count == 1);
  }
}

TEST_CASE("figures are the same bytes at any number of threads") {
  const auto clip = film(approaching(true));
  const auto with = [&](std::size_t threads) {
    const core::ThreadLimit limit(threads);
    return figures_of(clip);
  };
  const auto one = with(1), two = with(2);
  CHECK(one.motion == two.motion);
  CHECK(one.events == two.events);
}

TEST_CASE("large frames are reduced before figures are looked for") {
  CHECK(pipeline::figure_view({.width = 320, .height = 240}).factor == 1);
  const auto view = pipeline::figure_view({.width = 1283, .height = 721});
  CHECK(view.factor == 2);
  CHECK(view.size == cv::Size(641, 360));
  CHECK(view.in_frame(0, 0).x == 0.5);
  constexpr double kScale = 4.5;
  const auto clip = film([](Point p, int t) { return approaching(true)(p * (1 / kScale), t); }, {720, 540});
  REQUIRE(pipeline::figure_view(clip.info).factor == 2);
  const auto events = believed(figures_of(clip));
  REQUIRE(events.size() == 1);
  CHECK(unites(events[0].type));
  CHECK(distance(events[0].position, Point{80, 60} * kScale) < 8 * kScale);
}

TEST_CASE("lines that lie on outlines are left out, others stay") {
  const auto clip = film([](Point p, int) { return levels(disc(p, {80, 60}, 24), true); });
  const auto outlines = figures_of(clip).motion.sketch;
  graph::Patch flank, apart;
  flank.position = {106, 60}, flank.width = 2, apart.position = {130, 60}, apart.width = 2;
  const auto vertex = [](std::uint32_t id, const graph::Patch& patch) {
    return graph::Vertex{graph::VertexId{id}, {}, patch};
  };
  graph::SketchSequence lines{kWidth, kHeight, 25, {}};
  for (int t = 0; t < kFrames; ++t)
    lines.append(graph::AttributeGraph({vertex(0, flank), vertex(1, apart)},
                                       {{graph::VertexId{0}, graph::VertexId{1}}}));
  const auto left = pipeline::without_outlines(lines, outlines);
  for (const auto& graph : left.frames) {
    REQUIRE(graph.size() == 1);
    CHECK(graph.patch(0) == apart);
  }
}

TEST_CASE("lines in a figure that fades are left out while it does") {
  const int last = kFrames / 2;  // at more than half of its contrast
  const auto clip = film([=](Point p, int t) {
    const double there = t <= last ? 1 : std::max(0., 0.4 - 0.1 * (t - last - 1));
    return levels(there * disc(p, {80, 60}, 12), true);
  });
  const auto outlines = figures_of(clip).motion.sketch;
  REQUIRE_FALSE(outlines.frames[static_cast<std::size_t>(last)].empty());
  REQUIRE(outlines.frames[static_cast<std::size_t>(last) + 1].empty());
  graph::Patch inside;
  inside.position = {72, 60}, inside.width = 8;
  graph::SketchSequence lines{kWidth, kHeight, 25, {}};
  for (int t = 0; t < kFrames; ++t)
    lines.append(graph::AttributeGraph({{graph::VertexId{0}, {}, inside}}, {}));
  const auto left = pipeline::without_outlines(lines, outlines);
  for (int t = last; t < kFrames; ++t)
    CHECK(left.frames[static_cast<std::size_t>(t)].empty() == (t <= last + 2));
}

TEST_CASE("figures join the lines of a clip, and events name the strokes of both") {
  const auto clip = film(approaching(true));
  auto figures = figures_of(clip);
  graph::MotionGraph lines;
  lines.sketch = {kWidth, kHeight, 25, {}};
  for (int t = 0; t < kFrames; ++t) {
    graph::Patch patch;
    patch.position = {10, 10};
    lines.sketch.append(t < 30 ? graph::AttributeGraph({{graph::VertexId{0}, {}, patch}}, {})
                               : graph::AttributeGraph());
    lines.links.emplace_back();
    const auto id = static_cast<std::uint32_t>(t);
    if (t > 0 && t < 30) lines.links.back().push_back({graph::VertexId{id - 1}, graph::VertexId{id}});
  }
  lines = graph::identify(lines);
  auto events = graph::stroke_events(lines);
  REQUIRE(events.size() == 1);
  const std::size_t of_figures = figures.events.size();
  const auto outlines = figures.motion.sketch;
  pipeline::add_figures(lines, events, std::move(figures));
  graph::validate(lines);
  CHECK(lines.sketch.frames[0].size() == outlines.frames[0].size() + 1);
  CHECK(lines.sketch.frames[39].size() == outlines.frames[39].size());
  REQUIRE(events.size() == of_figures + 1);
  CHECK(events.front().type == graph::EventType::death);  // those of the lines come first
  graph::sort_events(events);
  const auto again = graph::stroke_events(lines);
  REQUIRE(again.size() == events.size());
  for (std::size_t k = 0; k < events.size(); ++k) {
    CHECK(events[k].before == again[k].before);
    CHECK(events[k].after == again[k].after);
  }
}
