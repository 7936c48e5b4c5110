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

Exemplar exemplar(const AttributeGraph& rest, const std::vector<Index>& indices) {
  std::vector<graph::Vertex> vertices;
  std::vector<graph::Edge> edges;
  const Point place = stroke_middle(rest, indices);
  const auto number = [&](Index v) {
    return graph::VertexId{static_cast<Index>(std::ranges::lower_bound(indices, v) - indices.begin())};
  };
  for (const Index v : indices) {
    graph::Patch patch = rest.patch(v);
    patch.position = patch.position - place;
    vertices.push_back({number(v), {}, patch});
    for (const Index w : rest.neighbours(v))
      if (v < w) edges.push_back({number(v), number(w)});
  }
  double clearance = far_away;
  for (Index w = 0; w < rest.size(); ++w)
    if (!std::ranges::binary_search(indices, w))
      for (const Index v : indices)
        clearance = std::min(clearance, graph::distance(rest.patch(w).position, rest.patch(v).position));
  return {AttributeGraph(std::move(vertices), std::move(edges)), place, clearance};
}

}  // namespace

std::vector<std::vector<Deviation>> patch_deviations(const graph::MotionGraph& motion,
                                                     const std::vector<detail::CurveTrack>& all,
                                                     const Series& normal_displacement) {
  struct Mean {
    double displacement = 0, contrast = 0;
  };
  std::vector<Mean> means;
  for (std::size_t i = 0; i < all.size(); ++i) {
    const auto& samples = all[i].samples;
    const double length = double(samples.size());
    means.push_back(
        {std::accumulate(normal_displacement[i].begin(), normal_displacement[i].end(), 0.0) / length, 0});
    for (const auto& sample : samples) means.back().contrast += sample.contrast / length;
  }
  const auto& frames = motion.sketch.frames;
  std::vector<std::vector<Deviation>> result;
  detail::visit_frames(all, frames.size(), [&](std::size_t t, std::span<const Index> there) {
    std::vector<detail::TrackValue> moved, shone;
    for (const Index i : there) {
      const auto k = t - static_cast<std::size_t>(all[i].first);
      const auto& sample = all[i].samples[k];
      moved.push_back({sample.vertex, sample.normal * (normal_displacement[i][k] - means[i].displacement)});
      shone.push_back({sample.vertex, {sample.contrast - means[i].contrast, 0}});
    }
    const auto offsets = detail::smooth_over_patches(frames[t], moved);
    const auto gains = detail::smooth_over_patches(frames[t], shone);
    result.emplace_back().reserve(offsets.size());
    for (std::size_t v = 0; v < offsets.size(); ++v)
      result.back().push_back({offsets[v], std::clamp(gains[v].x, -most_gain, most_gain)});
  });
  return result;
}

std::vector<InitialMotion> estimate_initial_motion(const graph::MotionGraph& motion,
                                                   const std::vector<std::vector<Deviation>>& all,
                                                   std::size_t frame, const CellMap& displacement_scale) {
  const auto &now = motion.sketch.frames[frame], &before = motion.sketch.frames[frame - 1];
  std::vector<InitialMotion> result;
  for (Index v = 0; v < now.size(); ++v) {
    const Deviation& d = all[frame][v];
    const double share = 1 / std::max(displacement_scale.at(now.patch(v).position - d.offset), 0.1);
    result.push_back({d.offset * share, d.offset * share, d.gain, d.gain});
  }
  for (const auto& link : motion.links[frame]) {
    const auto v = now.index_of(link.after), u = before.index_of(link.before);
    const Deviation& d = all[frame - 1][u];
    const double share =
        1 / std::max(displacement_scale.at(now.patch(v).position - all[frame][v].offset), 0.1);
    result[v].offset_before = d.offset * share, result[v].gain_before = d.gain;
  }
  return result;
}

AttributeGraph graph_at_rest(const AttributeGraph& graph, std::span<const Deviation> deviation) {
  std::vector<graph::Vertex> vertices;
  std::vector<graph::Edge> edges;
  for (Index v = 0; v < graph.size(); ++v) {
    vertices.push_back({{v}, {}, graph.patch(v)});
    vertices[v].patch.position = graph.patch(v).position - deviation[v].offset;
    detail::scale_contrast(vertices[v].patch, std::exp(-deviation[v].gain));
    // They are the frame's, not the stroke's.
    vertices[v].patch.cost = vertices[v].patch.gain = vertices[v].patch.evidence = 0;
    for (const Index w : graph.neighbours(v))
      if (v < w) edges.push_back({{v}, {w}});
  }
  return {std::move(vertices), std::move(edges)};
}

std::vector<Exemplar> sample_exemplars(const graph::MotionGraph& motion,
                                       const std::vector<std::vector<Deviation>>& deviation,
                                       std::size_t most) {
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
      const auto rest = graph_at_rest(frames[one.frame], deviation[one.frame]);
      result.push_back(exemplar(rest, vertices_by_stroke(graph::components(rest))[one.part]));
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
