// SPDX-License-Identifier: Apache-2.0
#include "pipeline/figures/figures.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <utility>

#include "graph/events/event_family.hpp"
#include "pipeline/figures/figure_changes.hpp"
#include "pipeline/figures/figure_graphs.hpp"

namespace emberfold::pipeline {

using graph::detail::family;

namespace {

constexpr int kLeastSide = 32;    // px of the view: smaller frames hold no figures
constexpr double kOnOutline = 4;  // px
// Frames that a figure of less than half of its contrast is seen at most.
constexpr std::size_t kFadingFrames = 2;

/// Returns the strokes' changes, each with the probability and place of the change of regions that it is.
std::vector<graph::Event> events_of(const DrawnFigures& drawn, const std::vector<FigureEvent>& weighed,
                                    const FigureView& view) {
  using Region = std::pair<std::size_t, std::size_t>;  // polarity and index
  std::map<Region, graph::SubgraphId> stroke_of;
  for (std::size_t t = 0; t < drawn.region_of.size(); ++t)
    for (std::size_t v = 0; v < drawn.region_of[t].size(); ++v)
      stroke_of[{drawn.polarity_of[t][v], drawn.region_of[t][v]}] =
          drawn.motion.sketch.frames[t].vertices()[v].subgraph;
  std::multimap<std::size_t, const FigureEvent*> of_frame;
  for (const FigureEvent& event : weighed) of_frame.emplace(event.change.frame, &event);
  std::set<const FigureEvent*> told;  // each by one event
  auto events = graph::stroke_events(drawn.motion);
  for (graph::Event& event : events) {
    event.probability = 0;
    const FigureEvent* best = nullptr;
    const auto names = [&](Region region) {
      const auto stroke = stroke_of.find(region);
      return stroke != stroke_of.end() &&
             (std::ranges::find(event.before, stroke->second) != event.before.end() ||
              std::ranges::find(event.after, stroke->second) != event.after.end());
    };
    const auto [first, last] = of_frame.equal_range(static_cast<std::size_t>(event.frame));
    for (auto it = first; it != last; ++it) {
      const FigureEvent& is = *it->second;
      if (family(is.change.type) != family(event.type) || is.probability <= event.probability ||
          !names({is.polarity, is.change.whole}) || !names({is.polarity, is.change.part}) ||
          told.contains(&is))
        continue;
      event.probability = is.probability;
      event.position = view.in_frame(is.change.at.x, is.change.at.y);
      best = &is;
    }
    if (best != nullptr) told.insert(best);
  }
  graph::sort_events(events);
  return events;
}

/// Returns which patches of a frame's lines have a flank on one of these outlines.
std::vector<bool> on_outlines(const graph::AttributeGraph& lines, const graph::AttributeGraph& outlines,
                              cv::Size size) {
  if (outlines.empty()) return std::vector<bool>(lines.size());
  const cv::Mat1f distance = distance_from_edges(outlines, {1, size});
  std::vector<bool> on;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const graph::Patch& patch = lines.patch(i);
    const int x = std::clamp(cvRound(patch.position.x), 0, size.width - 1),
              y = std::clamp(cvRound(patch.position.y), 0, size.height - 1);
    on.push_back(distance(y, x) <= kOnOutline + patch.width / 2 + patch.blur);
  }
  return on;
}

std::set<graph::SubgraphId> strokes_of(const graph::AttributeGraph& graph) {
  std::set<graph::SubgraphId> strokes;
  for (const graph::Vertex& vertex : graph.vertices()) strokes.insert(vertex.subgraph);
  return strokes;
}

/// Returns a graph without these strokes.
graph::AttributeGraph without(const graph::AttributeGraph& graph,
                              const std::set<graph::SubgraphId>& strokes) {
  std::vector<bool> stays;
  for (const graph::Vertex& vertex : graph.vertices()) stays.push_back(!strokes.contains(vertex.subgraph));
  return graph::induced_subgraph(graph, stays);
}

}  // namespace

Figures find_figures(core::FrameSource& source, const graph::SketchSequence& lines,
                     const core::Context& context) {
  const FigureView view = figure_view(source.info());
  if (std::min(view.size.width, view.size.height) < kLeastSide) return {};
  const FigureGround ground = measure_figure_ground(source, context);
  FigureRegions regions = find_figure_regions(source, ground, context);
  link_figure_regions(regions, ground, lines, context);
  const auto weighed = weigh_figure_changes(regions, ground, context);
  DrawnFigures drawn = draw_figures(source, regions, ground, context);
  auto events = events_of(drawn, weighed, ground.view);
  return {std::move(drawn.motion), std::move(events)};
}

graph::SketchSequence without_outlines(const graph::SketchSequence& lines,
                                       const graph::SketchSequence& outlines) {
  const cv::Size size{lines.width, lines.height};
  graph::SketchSequence left{lines.width, lines.height, lines.fps, {}};
  for (std::size_t t = 0; t < lines.frames.size(); ++t) {
    const auto& of_lines = lines.frames[t];
    const std::vector<bool> on = on_outlines(of_lines, outlines.frames[t], size);
    std::vector<bool> shown = on;  // there, or by a figure that fades
    const auto there = strokes_of(outlines.frames[t]);
    const std::size_t first = t - std::min(t, kFadingFrames),
                      last = std::min(t + kFadingFrames, lines.frames.size() - 1);
    for (std::size_t near = first; near <= last; ++near) {
      const auto fading = on_outlines(of_lines, without(outlines.frames[near], there), size);
      for (std::size_t i = 0; i < shown.size(); ++i) shown[i] = shown[i] || fading[i];
    }
    const graph::Components strokes = graph::components(of_lines);
    std::vector<bool> wholly_shown(strokes.count, true), stays;
    for (std::size_t i = 0; i < shown.size(); ++i)
      if (!shown[i]) wholly_shown[strokes.of_vertex[i]] = false;
    for (std::size_t i = 0; i < on.size(); ++i)
      stays.push_back(!on[i] && !wholly_shown[strokes.of_vertex[i]]);
    left.append(graph::induced_subgraph(of_lines, stays));
  }
  return left;
}

void add_figures(graph::MotionGraph& lines, std::vector<graph::Event>& events, Figures figures) {
  graph::MotionGraph joined;
  joined.sketch = {lines.sketch.width, lines.sketch.height, lines.sketch.fps, {}};
  joined.links.resize(lines.sketch.frames.size());
  using Ids = std::map<graph::VertexId, graph::VertexId>;
  struct Part {
    graph::MotionGraph& motion;
    Ids before, now;
  };
  std::array<Part, 2> parts{Part{lines, {}, {}}, Part{figures.motion, {}, {}}};
  std::uint32_t first = 0;
  for (std::size_t t = 0; t < joined.links.size(); ++t) {
    std::vector<graph::Vertex> vertices;
    std::vector<graph::Edge> edges;
    for (Part& part : parts) {
      part.before = std::exchange(part.now, {});
      const graph::AttributeGraph& graph = part.motion.sketch.frames[t];
      for (const graph::Vertex& vertex : graph.vertices()) {
        const graph::VertexId id{first + static_cast<std::uint32_t>(vertices.size())};
        part.now.emplace(vertex.id, id);
        vertices.push_back({id, {}, vertex.patch});
      }
      for (const graph::Edge& edge : graph.edges()) edges.push_back({part.now[edge.a], part.now[edge.b]});
      for (const graph::Link& link : part.motion.links[t])
        joined.links[t].push_back({part.before[link.before], part.now[link.after]});
    }
    std::ranges::sort(joined.links[t]);
    first += static_cast<std::uint32_t>(vertices.size());
    const auto memory = lines.sketch.frames[t].memory();
    joined.sketch.append(graph::AttributeGraph(std::move(vertices), std::move(edges), memory));
  }
  joined = graph::identify(std::move(joined));
  std::array<std::map<graph::SubgraphId, graph::SubgraphId>, 2> names;
  for (std::size_t t = 0; t < joined.links.size(); ++t) {
    std::size_t i = 0;
    for (std::size_t k = 0; k < parts.size(); ++k)
      for (const graph::Vertex& vertex : parts[k].motion.sketch.frames[t].vertices())
        names[k].emplace(vertex.subgraph, joined.sketch.frames[t].vertices()[i++].subgraph);
  }
  const auto rename = [&](std::vector<graph::Event>& of, std::size_t k) {
    for (graph::Event& event : of)
      for (auto* strokes : {&event.before, &event.after})
        for (graph::SubgraphId& stroke : *strokes) stroke = names[k].at(stroke);
  };
  rename(events, 0), rename(figures.events, 1);
  events.insert(events.end(), figures.events.begin(), figures.events.end());
  lines = std::move(joined);
}

}  // namespace emberfold::pipeline
