// SPDX-License-Identifier: Apache-2.0
#include "mcmc/learning/exemplars.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <span>

#include "mcmc/learning/stroke_places.hpp"
#include "mcmc/simulation/simulated_strokes.hpp"

namespace emberfold::mcmc {

namespace {

using graph::AttributeGraph;
using graph::Point;
using Index = std::uint32_t;

constexpr double far_away = 1000;   // px, from a stroke that is alone
constexpr std::size_t enough = 12;  // exemplars of a size
constexpr double most_gain = 1;     // of the logarithm of the contrast: beyond it a track has gone astray

// A stroke of a frame, by the index of one of its vertices' component.
struct StrokeReference {
  std::uint32_t frame = 0, part = 0;
};

Exemplar exemplar(const AttributeGraph& graph, const std::vector<Index>& indices) {
  std::vector<graph::Vertex> vertices;
  std::vector<graph::Edge> edges;
  const Point place = stroke_middle(graph, indices);
  const auto number = [&](Index v) {
    return graph::VertexId{static_cast<Index>(std::ranges::lower_bound(indices, v) - indices.begin())};
  };
  for (const Index v : indices) {
    graph::Patch patch = graph.patch(v);
    patch.position = patch.position - place;
    vertices.push_back({number(v), {}, patch});
    for (const Index w : graph.neighbours(v))
      if (v < w) edges.push_back({number(v), number(w)});
  }
  double clearance = far_away;
  for (Index w = 0; w < graph.size(); ++w)
    if (!std::ranges::binary_search(indices, w))
      for (const Index v : indices)
        clearance = std::min(clearance, graph::distance(graph.patch(w).position, graph.patch(v).position));
  return {AttributeGraph(std::move(vertices), std::move(edges)), place, clearance};
}

}  // namespace

std::vector<std::vector<double>> contrast_deviations(const graph::MotionGraph& motion,
                                                     const std::vector<detail::CurveTrack>& all) {
  std::vector<double> means;
  for (const auto& track : all) {
    double sum = 0;
    for (const auto& sample : track.samples) sum += sample.contrast;
    means.push_back(sum / static_cast<double>(track.samples.size()));
  }
  const auto& frames = motion.sketch.frames;
  std::vector<std::vector<double>> result;
  detail::visit_frames(all, frames.size(), [&](std::size_t t, std::span<const Index> there) {
    std::vector<detail::TrackValue> shone;
    for (const Index i : there) {
      const auto& sample = all[i].samples[t - static_cast<std::size_t>(all[i].first)];
      shone.push_back({sample.vertex, {sample.contrast - means[i], 0}});
    }
    result.emplace_back();
    for (const Point& gain : detail::smooth_over_patches(frames[t], shone))
      result.back().push_back(std::clamp(gain.x, -most_gain, most_gain));
  });
  return result;
}

AttributeGraph with_usual_contrast(const AttributeGraph& graph, std::span<const double> deviation) {
  std::vector<graph::Vertex> vertices;
  std::vector<graph::Edge> edges;
  for (Index v = 0; v < graph.size(); ++v) {
    vertices.push_back({{v}, {}, graph.patch(v)});
    detail::scale_contrast(vertices[v].patch, std::exp(-deviation[v]));
    // They are the frame's, not the stroke's.
    vertices[v].patch.cost = vertices[v].patch.gain = vertices[v].patch.evidence = 0;
    for (const Index w : graph.neighbours(v))
      if (v < w) edges.push_back({{v}, {w}});
  }
  return {std::move(vertices), std::move(edges)};
}

std::vector<Exemplar> sample_exemplars(const graph::MotionGraph& motion,
                                       const std::vector<std::vector<double>>& deviation, std::size_t most) {
  const auto& frames = motion.sketch.frames;
  std::array<std::vector<StrokeReference>, kSizeClasses> seen;
  std::size_t all = 0;
  for (std::uint32_t t = 0; t < frames.size(); ++t) {
    const auto found = vertices_by_stroke(graph::components(frames[t]));
    all += found.size();
    for (std::uint32_t part = 0; part < found.size(); ++part)
      seen[size_class(found[part].size())].push_back({t, part});
  }
  std::vector<Exemplar> result;
  for (const auto& of_size : seen) {
    const std::size_t share = all > 0 ? most * of_size.size() / all : 0;
    const std::size_t wanted = std::min(of_size.size(), std::max(share, enough));
    for (std::size_t i = 0; i < wanted; ++i) {
      const StrokeReference one = of_size[i * of_size.size() / wanted];
      const auto graph = with_usual_contrast(frames[one.frame], deviation[one.frame]);
      result.push_back(exemplar(graph, vertices_by_stroke(graph::components(graph))[one.part]));
    }
  }
  return result;
}

double estimate_refractory_period(std::span<const graph::Event> events) {
  std::map<graph::SubgraphId, int> begun;
  for (const auto& event : events)
    if (event.type == graph::EventType::birth) begun[event.after.at(0)] = event.frame;
  std::vector<int> lives;
  for (const auto& event : events) {
    if (event.type != graph::EventType::death) continue;
    if (const auto found = begun.find(event.before.at(0)); found != begun.end())
      lives.push_back(event.frame - found->second);
  }
  if (lives.size() < 5) return 0;
  const auto at = lives.begin() + static_cast<std::ptrdiff_t>(lives.size() / 10);
  std::ranges::nth_element(lives, at);
  return std::min(8.0, static_cast<double>(*at));
}

std::array<double, kSizeClasses> count_births_by_size(const graph::MotionGraph& motion,
                                                      std::span<const graph::Event> events) {
  // Sizes of each stroke in its frames, in order.
  std::map<graph::SubgraphId, std::vector<std::size_t>> sizes;
  for (const auto& graph : motion.sketch.frames) {
    std::map<graph::SubgraphId, std::size_t> now;
    for (const auto& vertex : graph.vertices()) ++now[vertex.subgraph];
    for (const auto& [stroke, size] : now) sizes[stroke].push_back(size);
  }
  std::array<double, kSizeClasses> births{};
  for (const auto& event : events) {
    if (event.type != graph::EventType::birth) continue;
    const auto& life = sizes.at(event.after.at(0));
    ++births[size_class(life[life.size() / 2])];
  }
  return births;
}

}  // namespace emberfold::mcmc
