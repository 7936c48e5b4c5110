// SPDX-License-Identifier: Apache-2.0
#include "mcmc/simulation/simulated_strokes.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <tuple>

#include "mcmc/learning/stroke_places.hpp"
#include "mcmc/simulation/rounding.hpp"
#include "mcmc/simulation/smooth_noise.hpp"

namespace emberfold::mcmc::detail {

namespace {

using graph::Point;

constexpr std::uint32_t coupled_settling = 30;  // frames

double next_value(const Autoregression& m, double now, double before, double neighbour_mean, double push) {
  return m.a1 * now + m.a2 * before + m.coupling * (neighbour_mean - now) + m.noise * push;
}

graph::PatchType type_of(const graph::Patch& rest, std::size_t degree) {
  using enum graph::PatchType;
  if (degree == 1) return terminator;
  if (degree == 3) return rest.type == t_junction ? t_junction : y_junction;
  if (degree > 3) return crossing;
  if (degree == 2 && rest.type == corner) return corner;
  if (graph::on_step(rest)) return step;
  return rest.contrast < 0 ? valley : ridge;
}

// Turn of the patch's surroundings from rest, rad.
double rotation_from_rest(const SimulatedStrokes& p, const std::vector<std::uint32_t>& sides, std::size_t i) {
  const SimulatedPatch& me = p.list[i];
  const Point along{std::cos(me.rest.theta), std::sin(me.rest.theta)};
  Point at_rest, now;
  for (const auto j : sides) {
    const Point chord = p.list[j].rest.position - me.rest.position;
    const double sense = graph::dot(chord, along) < 0 ? -1 : 1;
    at_rest = at_rest + chord * sense;
    now = now + (p.list[j].position() - me.position()) * sense;
  }
  return std::atan2(at_rest.x * now.y - at_rest.y * now.x, graph::dot(at_rest, now));
}

double contrast_share(const SimulatedPatch& simulated, const MotionModel& model) {
  const auto within = [](const auto& shares, int i) {
    return i >= 0 && i < static_cast<int>(shares.size()) ? shares[static_cast<std::size_t>(i)] : 1.0;
  };
  return std::min(within(model.appearing, simulated.age), within(model.vanishing, simulated.frames_left));
}

graph::AttributeGraph make_graph(const SimulatedStrokes& p, const MotionModel* model) {
  const auto sides = neighbour_lists(p);
  std::vector<graph::Vertex> vertices(p.list.size());
  for (std::size_t i = 0; i < p.list.size(); ++i) {
    const SimulatedPatch& simulated = p.list[i];
    graph::Patch patch = simulated.rest;
    patch.position = simulated.position();
    patch.type = type_of(patch, sides[i].size());
    patch.theta = std::remainder(patch.theta + rotation_from_rest(p, sides[i], i), 2 * std::numbers::pi);
    if (model) scale_contrast(patch, std::exp(simulated.gain) * contrast_share(simulated, *model));
    vertices[i] = {{p.ids[i]}, {}, patch};
  }
  std::vector<graph::Edge> edges;
  edges.reserve(p.edges.size());
  for (const auto& [a, b] : p.edges) edges.push_back({{p.ids[a]}, {p.ids[b]}});
  return {std::move(vertices), std::move(edges)};
}

}  // namespace

void scale_contrast(graph::Patch& patch, double factor) {
  patch.contrast *= factor;
  const auto f = static_cast<float>(factor);
  for (std::size_t c = 0; c < 3; ++c) {
    const float mean = (patch.left[c] + patch.right[c]) / 2;
    if (graph::on_step(patch)) {
      patch.left[c] = mean + f * (patch.left[c] - mean);
      patch.right[c] = mean + f * (patch.right[c] - mean);
      patch.middle[c] = mean;
    } else {
      patch.middle[c] = mean + f * (patch.middle[c] - mean);
    }
  }
}

std::vector<std::vector<std::uint32_t>> neighbour_lists(const SimulatedStrokes& p) {
  std::vector<std::vector<std::uint32_t>> result(p.list.size());
  for (const auto& [a, b] : p.edges) {
    result[a].push_back(b);
    result[b].push_back(a);
  }
  return result;
}

std::uint32_t SimulatedStrokes::add(const SimulatedPatch& simulated) {
  ids.push_back(next_id++);
  list.push_back(simulated);
  return static_cast<std::uint32_t>(list.size() - 1);
}

void remove_patches(SimulatedStrokes& p, const std::vector<bool>& marked) {
  std::vector<std::uint32_t> place(p.list.size());
  std::uint32_t kept = 0;
  for (std::size_t i = 0; i < p.list.size(); ++i) {
    if (marked[i]) continue;
    p.ids[kept] = p.ids[i];
    p.list[kept] = p.list[i];
    place[i] = kept++;
  }
  std::erase_if(p.edges, [&](const auto& edge) { return marked[edge.first] || marked[edge.second]; });
  for (auto& [a, b] : p.edges) a = place[a], b = place[b];
  p.ids.resize(kept);
  p.list.resize(kept);
}

graph::AttributeGraph stroke_graph(const SimulatedStrokes& strokes) {
  return make_graph(strokes, nullptr);
}

graph::AttributeGraph drawn_graph(const SimulatedStrokes& strokes, const MotionModel& model) {
  return make_graph(strokes, &model);
}

void step_motion(SimulatedStrokes& p, const MotionModel& model, std::uint64_t seed, Purpose purpose,
                 std::uint32_t step) {
  const auto sides = neighbour_lists(p);
  const auto push = draw_noise(p, model, seed, purpose, step);
  const std::vector<SimulatedPatch> now(p.list);
  for (std::size_t i = 0; i < now.size(); ++i) {
    const SimulatedPatch& me = now[i];
    Point offset = me.offset;
    double gain = me.gain;
    if (!sides[i].empty()) {
      offset = {}, gain = 0;
      for (const auto j : sides[i]) offset = offset + now[j].offset, gain += now[j].gain;
      const double share = 1 / static_cast<double>(sides[i].size());
      offset = offset * share, gain *= share;
    }
    SimulatedPatch& next = p.list[i];
    next.offset = {next_value(model.displacement, me.offset.x, me.offset_before.x, offset.x, push[i].x),
                   next_value(model.displacement, me.offset.y, me.offset_before.y, offset.y, push[i].y)};
    next.gain = next_value(model.contrast, me.gain, me.gain_before, gain, push[i].gain);
    next.offset_before = me.offset, next.gain_before = me.gain;
  }
}

void draw_stationary_motion(SimulatedStrokes& p, const MotionModel& model, std::uint64_t seed) {
  // Draws two frames of the stationary state: noise fields with the law's lag-one correlation.
  const std::uint32_t of = p.ids.empty() ? 0 : p.ids.front();
  const auto before = draw_noise(p, model, seed, Purpose::start, 0, of);
  const auto fresh = draw_noise(p, model, seed, Purpose::start, 1, of);
  const auto pair = [](const Autoregression& m, double deviation, double first, double second) {
    const double alike = m.a1 / (1 - m.a2);
    return std::pair{deviation * first, deviation * (alike * first + std::sqrt(1 - alike * alike) * second)};
  };
  const double displacement_sd = rounded(stationary_deviation(model.displacement)),
               gain_deviation = rounded(stationary_deviation(model.contrast));
  for (std::size_t i = 0; i < p.list.size(); ++i) {
    SimulatedPatch& me = p.list[i];
    std::tie(me.offset_before.x, me.offset.x) =
        pair(model.displacement, displacement_sd, before[i].x, fresh[i].x);
    std::tie(me.offset_before.y, me.offset.y) =
        pair(model.displacement, displacement_sd, before[i].y, fresh[i].y);
    std::tie(me.gain_before, me.gain) = pair(model.contrast, gain_deviation, before[i].gain, fresh[i].gain);
  }
  // With coupling, the stationary state is approached by running the motion.
  if (model.displacement.coupling <= 0 && model.contrast.coupling <= 0) return;
  for (std::uint32_t step = 2; step < 2 + coupled_settling; ++step)
    step_motion(p, model, seed, Purpose::start, step);
}

namespace {

// Makes a new stroke move with the strokes next to it: mixes the deviations of its patches with those of the
// nearest patch of another stroke, one for all of them, so that the stroke keeps its shape. The correlation
// is exp(−h²/2 range²) for a patch h px away from that one; the variance is unchanged.
void copy_neighbour_motion(SimulatedStrokes& fresh, const SimulatedStrokes& there, const MotionModel& model) {
  const double reach = 3 * std::max({model.displacement.range, model.contrast.range, 1.0});
  double least = reach * reach;
  const SimulatedPatch* nearest = nullptr;
  for (const SimulatedPatch& me : fresh.list)
    for (const SimulatedPatch& other : there.list) {
      const Point apart = other.rest.position - me.rest.position;
      if (graph::dot(apart, apart) < least) least = graph::dot(apart, apart), nearest = &other;
    }
  if (!nearest) return;
  for (SimulatedPatch& me : fresh.list) {
    const Point apart = nearest->rest.position - me.rest.position;
    const auto mix = [&](double range, auto mine, auto other) {
      if (!(range > 0)) return mine;
      const double alike = rounded(std::exp(-0.5 * graph::dot(apart, apart) / (range * range)));
      return other * alike + mine * std::sqrt(1 - alike * alike);
    };
    me.offset = mix(model.displacement.range, me.offset, nearest->offset);
    me.offset_before = mix(model.displacement.range, me.offset_before, nearest->offset_before);
    me.gain = mix(model.contrast.range, me.gain, nearest->gain);
    me.gain_before = mix(model.contrast.range, me.gain_before, nearest->gain_before);
  }
}

}  // namespace

void add_stationary(SimulatedStrokes& p, const graph::AttributeGraph& graph, Point place, int age,
                    const MotionModel& model, std::uint64_t seed) {
  SimulatedStrokes fresh;
  fresh.next_id = p.next_id;
  for (const auto& vertex : graph.vertices()) {
    SimulatedPatch simulated;
    simulated.rest = vertex.patch;
    simulated.rest.position = simulated.rest.position + place;
    simulated.age = age;
    fresh.add(simulated);
  }
  for (const auto& stroke : vertices_by_stroke(graph::components(graph))) {
    double share = 0;
    for (const auto v : stroke)
      share += interpolate(model.displacement_scale, fresh.list[v].rest.position) / double(stroke.size());
    for (const auto v : stroke) fresh.list[v].share = share;
  }
  const auto number = [&](graph::VertexId id) { return static_cast<std::uint32_t>(graph.index_of(id)); };
  for (const auto& edge : graph.edges()) fresh.edges.emplace_back(number(edge.a), number(edge.b));
  draw_stationary_motion(fresh, model, seed);
  copy_neighbour_motion(fresh, p, model);
  for (SimulatedPatch& me : fresh.list) me.rest.position = me.rest.position - me.offset * me.share;
  const auto before = static_cast<std::uint32_t>(p.list.size());
  for (const auto& [a, b] : fresh.edges) p.edges.emplace_back(a + before, b + before);
  p.ids.insert(p.ids.end(), fresh.ids.begin(), fresh.ids.end());
  p.list.insert(p.list.end(), fresh.list.begin(), fresh.list.end());
  p.next_id = fresh.next_id;
}

}  // namespace emberfold::mcmc::detail
