// SPDX-License-Identifier: Apache-2.0
#include "mcmc/simulation/operators.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <span>

#include "mcmc/learning/drift.hpp"
#include "mcmc/learning/hard_core.hpp"
#include "mcmc/learning/operator_sites.hpp"
#include "mcmc/learning/stroke_places.hpp"
#include "mcmc/simulation/rounding.hpp"

namespace emberfold::mcmc::detail {

namespace {

using graph::EventType;
using graph::Patch;
using graph::Point;
using Index = std::uint32_t;

constexpr double crowd_reach = 2;      // cells
constexpr double spacing = 5;          // px between the patches of a bridge
constexpr double largest_jitter = 4;   // px, SD: how far from where it was seen an exemplar is born
constexpr double most_clearance = 40;  // px: strokes farther apart do not keep each other away

// A frame's strokes while operators are drawn for them.
struct OperatorFrame {
  SimulatedStrokes& strokes;
  const MotionModel& model;
  core::Rng rng;
  graph::AttributeGraph graph;
  graph::Components parts;
  double frame;                  ///< the one that is made
  CellMap density;               ///< patches around each cell, over what is usual there
  std::vector<bool> busy;        ///< strokes that have changed, or of which something fades
  std::array<int, 6> done = {};  ///< how many of each operator

  // Removals are more frequent where it is crowded ...
  bool draw_removal(Index vertex, double rate) {
    return rng.uniform() < rate * density.at(graph.patch(vertex).position) && !busy[parts.of_vertex[vertex]];
  }
  // ... and additions where it is sparse.
  bool draw_addition(Index vertex, double rate) {
    return rng.uniform() * density.at(graph.patch(vertex).position) < rate && !busy[parts.of_vertex[vertex]];
  }
  [[nodiscard]] double separation_modifier(Index vertex) const {
    const Point place = graph.patch(vertex).position;
    return model.rates.separation.at(place) *
           modifier_after(model.rates.modifiers.separation,
                          frames_since(strokes.unions, place, fade_out_end()));
  }
  [[nodiscard]] double union_modifier(Index a, Index b) const {
    const Point from = graph.patch(a).position, to = graph.patch(b).position;
    return modifier_after(model.rates.modifiers.unification, frames_since(strokes.separations, from, frame)) *
           model.rates.modifiers.bridging[gap_class(graph::distance(from, to))];
  }
  // `pair`: an end and a patch of another stroke, not in line.
  [[nodiscard]] double turn_modifier(const OperatorSites::Pair& pair) const {
    return model.rates.modifiers.turning[turn_class(turn_angle_towards(graph, pair))];
  }
  [[nodiscard]] double modifier_after(const std::array<double, kElapsedClasses>& multiples,
                                      double frames) const {
    return multiples[elapsed_class(frames * model.rates.modifiers.pace)];
  }
  // Returns the frame in which patches that begin to fade now are gone.
  [[nodiscard]] double fade_out_end() const { return frame + fade_out_frames() + 1; }
  [[nodiscard]] bool is_refractory(Index vertex) const { return strokes.list[vertex].refractory_left > 0; }
  // Starts the refractory period at a patch, after `fades` frames of fading.
  void start_refractory_period(Index vertex, int fades = 0) {
    auto& left = strokes.list[vertex].refractory_left;
    left = std::max(left, fades + static_cast<int>(std::lround(model.rates.refractory_period)));
  }
  void mark_busy(Index vertex) { busy[parts.of_vertex[vertex]] = true; }
  void count_event(graph::EventType type) { ++done[static_cast<std::size_t>(type)]; }
  void fade_out(Index vertex) { strokes.list[vertex].frames_left = fade_out_frames(); }
  [[nodiscard]] int fade_out_frames() const {
    int frames = 0;
    while (frames < static_cast<int>(model.vanishing.size()) &&
           model.vanishing[static_cast<std::size_t>(frames)] < 0.9)
      ++frames;
    return frames;
  }
};

void apply_deaths(OperatorFrame& scene) {
  const auto all = vertices_by_stroke(scene.parts);
  std::size_t least = scene.model.exemplars.empty() ? 0 : scene.graph.size();
  for (const auto& exemplar : scene.model.exemplars) least = std::min(least, exemplar.graph.size());
  const int fading = scene.fade_out_frames();
  for (std::size_t s = 0; s < all.size(); ++s) {
    int age = 0;
    for (const Index v : all[s]) age = std::max(age, scene.strokes.list[v].age);
    // The refractory period of newborn strokes is part of the death rate by age.
    const bool refractory = std::ranges::any_of(all[s], [&](Index v) { return scene.is_refractory(v); });
    if (refractory && age >= scene.model.rates.refractory_period) continue;
    const double rate = scene.model.rates.death_by_size[size_class(all[s].size())] *
                        scene.model.rates.death.at(stroke_middle(scene.graph, all[s])) *
                        scene.modifier_after(scene.model.rates.modifiers.death, age + fading + 1);
    // The frames in which it fades are part of its life. Strokes smaller than all exemplars are removed.
    const double sooner = rate / std::max(0.05, 1 - rate * fading);
    if (!scene.draw_removal(all[s][0], all[s].size() < least ? 1 : sooner)) continue;
    scene.mark_busy(all[s][0]);
    scene.count_event(EventType::death);
    for (const Index v : all[s]) scene.fade_out(v);
  }
}

// Patches of a curve from `from` on, away from `behind`, up to `most` and without its end; whether that was
// reached, and is a free one.
struct CurveRun {
  std::vector<Index> patches;
  bool ended = false, free = false;
};
CurveRun run_along(const graph::AttributeGraph& graph, Index behind, Index from, std::size_t most) {
  CurveRun result;
  while (result.patches.size() < most && graph.degree(from) == 2) {
    result.patches.push_back(from);
    const auto sides = graph.neighbours(from);
    const Index next = sides[0] == behind ? sides[1] : sides[0];
    behind = from, from = next;
  }
  result.ended = graph.degree(from) != 2;
  result.free = graph.degree(from) == 1;
  return result;
}

// Fades out up to `wide` patches of the run, at least one, and leaves a piece at a free end.
void fade_out_gap(OperatorFrame& scene, const CurveRun& arm, std::size_t wide) {
  const std::size_t kept = arm.free ? kPiece - 1 : 0, there = arm.patches.size();
  const std::size_t most = there > kept ? there - kept : 1;
  const std::size_t gone = std::min({wide, most, there});
  for (std::size_t i = 0; i < gone; ++i) scene.fade_out(arm.patches[i]);
  for (std::size_t i = gone; i < std::min(there, gone + kPiece); ++i)
    scene.start_refractory_period(arm.patches[i], scene.fade_out_frames());
}

std::size_t patches_of(double gap) {
  return static_cast<std::size_t>(std::max(1.0, std::round(gap / spacing) - 1));
}

void apply_splits(OperatorFrame& scene, const OperatorSites& found) {
  const auto wide = patches_of(scene.model.rates.split_gap);
  for (const Index v : found.split_sites) {
    if (scene.is_refractory(v) ||
        !scene.draw_removal(v, scene.model.rates.split * scene.separation_modifier(v)))
      continue;
    scene.mark_busy(v);
    scene.count_event(EventType::split);
    scene.strokes.separations.push_back({scene.graph.patch(v).position, scene.fade_out_end()});
    scene.fade_out(v);
    const auto sides = scene.graph.neighbours(v);
    for (const Index side : sides) scene.start_refractory_period(side, scene.fade_out_frames());
    if (wide > 1) fade_out_gap(scene, run_along(scene.graph, v, sides[1], wide / 2 + kPiece), wide / 2);
    if (wide > 2) fade_out_gap(scene, run_along(scene.graph, v, sides[0], wide / 2 + kPiece), (wide - 1) / 2);
  }
}

void apply_disconnects(OperatorFrame& scene, const OperatorSites& found) {
  const auto wide = patches_of(scene.model.rates.disconnect_gap);
  for (const auto& [hub, first] : found.disconnect_sites) {
    if (scene.is_refractory(hub) || scene.is_refractory(first)) continue;
    if (!scene.draw_removal(hub, scene.model.rates.disconnect * scene.separation_modifier(hub))) continue;
    scene.mark_busy(hub);
    scene.start_refractory_period(hub, scene.fade_out_frames());
    scene.count_event(EventType::disconnect);
    scene.strokes.separations.push_back({scene.graph.patch(hub).position, scene.fade_out_end()});
    const CurveRun arm = run_along(scene.graph, hub, first, 2 * wide + kPiece);
    // A bridge is removed as a whole where it is not much longer than usual; one without patches takes its
    // far end.
    if (arm.patches.empty())
      scene.fade_out(first);
    else
      fade_out_gap(scene, arm,
                   arm.ended && !arm.free && arm.patches.size() <= 2 * wide ? arm.patches.size() : wide);
  }
}

// Patch at `place`, a share u of the way from one patch to another.
SimulatedPatch interpolate_patch(const SimulatedPatch& a, const SimulatedPatch& b, double u, Point place,
                                 Point direction) {
  const auto mix = [&](double p, double q) { return p + u * (q - p); };
  const auto mix_points = [&](Point p, Point q) { return p + (q - p) * u; };
  SimulatedPatch result;
  result.rest = a.rest;
  const Point along{std::cos(a.rest.theta), std::sin(a.rest.theta)};
  // Left and right are those of the end where the bridge starts.
  const double sense = graph::dot(direction, along) < 0 ? -1 : 1;
  result.rest.theta = std::atan2(sense * direction.y, sense * direction.x);
  result.rest.width = mix(a.rest.width, b.rest.width);
  result.rest.blur = mix(a.rest.blur, b.rest.blur);
  result.rest.contrast = mix(a.rest.contrast, b.rest.contrast);
  for (std::size_t c = 0; c < 3; ++c) {
    const auto levels = [&](float p, float q) { return static_cast<float>(mix(double(p), double(q))); };
    result.rest.left[c] = levels(a.rest.left[c], b.rest.left[c]);
    result.rest.middle[c] = levels(a.rest.middle[c], b.rest.middle[c]);
    result.rest.right[c] = levels(a.rest.right[c], b.rest.right[c]);
  }
  result.share = mix(a.share, b.share);
  result.carried = mix_points(a.carried, b.carried);
  result.offset = mix_points(a.offset, b.offset);
  result.offset_before = mix_points(a.offset_before, b.offset_before);
  result.gain = mix(a.gain, b.gain), result.gain_before = mix(a.gain_before, b.gain_before);
  result.rest.position = place - result.offset * result.share;
  return result;
}

// Curve from one patch to another, u from 0 to 1, that continues the strokes that end at `a` and at `b`:
// Hermite's cubic.
class BridgeCurve {
 public:
  BridgeCurve(const graph::AttributeGraph& graph, Index a, Index b)
      : from_(graph.patch(a).position), to_(graph.patch(b).position) {
    leave_ = end_tangent(graph, a, to_ - from_);
    arrive_ = end_tangent(graph, b, from_ - to_) * -1;
  }
  [[nodiscard]] Point at(double u) const {
    const double v = 1 - u;
    return from_ * (v * v * (1 + 2 * u)) + leave_ * (v * v * u) + to_ * (u * u * (3 - 2 * u)) -
           arrive_ * (u * u * v);
  }
  [[nodiscard]] Point direction(double u) const {
    return at(std::min(1.0, u + 0.05)) - at(std::max(0.0, u - 0.05));
  }

 private:
  // Tangent at an end, as long as the chord; the chord itself where the stroke does not end, or would have to
  // turn back.
  static Point end_tangent(const graph::AttributeGraph& graph, Index end, Point chord) {
    if (graph.degree(end) != 1) return chord;
    const Point out = end_direction(graph, end);
    const double length = graph::norm(out);
    if (length <= 0 || graph::dot(out, chord) <= 0) return chord;
    return out * (graph::norm(chord) / length);
  }
  Point from_, to_, leave_, arrive_;
};

void add_bridge(OperatorFrame& scene, Index a, Index b) {
  SimulatedStrokes& p = scene.strokes;
  const SimulatedPatch from = p.list[a], to = p.list[b];
  const int patches = std::max(
      0, static_cast<int>(std::lround(graph::distance(from.position(), to.position()) / spacing)) - 1);
  const BridgeCurve curve(scene.graph, a, b);
  Index last = a;
  for (int i = 1; i <= patches; ++i) {
    const double u = i / (patches + 1.0);
    const Index next = p.add(interpolate_patch(from, to, u, rounded(curve.at(u)), curve.direction(u)));
    scene.start_refractory_period(next);
    p.edges.emplace_back(last, next);
    last = next;
  }
  p.edges.emplace_back(last, b);
  scene.start_refractory_period(a);
  scene.start_refractory_period(b);
}

void apply_unions(OperatorFrame& scene, const std::vector<OperatorSites::Pair>& pairs, double rate,
                  EventType type) {
  for (const auto& pair : pairs) {
    const auto& [a, b] = pair;
    if (scene.is_refractory(a) || scene.is_refractory(b)) continue;
    const double bent = type == EventType::connect ? scene.turn_modifier(pair) : 1;
    if (!scene.draw_addition(a, rate * bent * scene.union_modifier(a, b)) ||
        scene.busy[scene.parts.of_vertex[b]])
      continue;
    scene.mark_busy(a);
    scene.mark_busy(b);
    scene.count_event(type);
    const Point middle = (scene.graph.patch(a).position + scene.graph.patch(b).position) * 0.5;
    scene.strokes.unions.push_back({middle, scene.frame});
    add_bridge(scene, a, b);
  }
}

// Number of patches around each cell over the usual number, 1/2 to 2.
CellMap relative_density(const graph::AttributeGraph& graph, const CellMap& usual) {
  CellMap now = usual;
  std::ranges::fill(now.values, 0.0);
  for (const auto& vertex : graph.vertices()) ++now.values[now.index(vertex.patch.position)];
  now.values = spread_over_cells(now, crowd_reach);
  double mean = 0;
  for (const double value : usual.values) mean += value / static_cast<double>(usual.values.size());
  for (std::size_t c = 0; c < now.values.size(); ++c)
    now.values[c] =
        mean > 0 ? std::clamp((now.values[c] + 0.1 * mean) / (usual.values[c] + 0.1 * mean), 0.5, 2.0) : 1;
  return now;
}

// Probability of each exemplar to be born: its size's share, times the birth map at its place over the number
// of exemplars around there.
std::vector<double> birth_weights(const OperatorFrame& scene) {
  const auto& model = scene.model;
  std::array<double, kSizeClasses> counts{};
  for (const auto& exemplar : model.exemplars) ++counts[size_class(exemplar.graph.size())];
  CellMap seen = model.density;
  std::ranges::fill(seen.values, 0.0);
  for (const auto& exemplar : model.exemplars) {
    const auto size = size_class(exemplar.graph.size());
    seen.values[seen.index(exemplar.place)] += model.rates.birth_by_size[size] / counts[size];
  }
  seen.values = spread_over_cells(seen, 1);
  std::vector<double> weights;
  std::array<double, kSizeClasses> sums{};
  for (const auto& exemplar : model.exemplars) {
    weights.push_back((model.rates.birth.at(exemplar.place) + 1e-12) / (seen.at(exemplar.place) + 1e-9));
    sums[size_class(exemplar.graph.size())] += weights.back();
  }
  for (std::size_t i = 0; i < weights.size(); ++i) {
    const auto size = size_class(model.exemplars[i].graph.size());
    weights[i] *= model.rates.birth_by_size[size] / sums[size];
  }
  return weights;
}

int poisson(double mean, core::Rng& rng) {
  const double limit = std::exp(-mean);
  int count = 0;
  for (double product = rng.uniform(); product > limit && count < 1000; product *= rng.uniform()) ++count;
  return count;
}

// Clearance of a stroke at a place, 0…1, mean over its patches. For each patch: the least distance to another
// stroke, over the distance observed with the exemplar or the hard core, whichever is larger.
double relative_clearance(const OperatorFrame& scene, const Exemplar& exemplar, Point place) {
  const auto& stroke = exemplar.graph;
  const auto& hard_core = scene.model.hard_core;
  const double asked = std::clamp(exemplar.clearance, 1.0, most_clearance);
  const double enough = std::max(asked, largest_hard_core_distance(hard_core));
  std::vector<double> least(stroke.size(), 1.0);
  Point low{std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity()},
      high{-std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};
  std::vector<Point> placed;
  for (const auto& vertex : stroke.vertices()) {
    const Point p = vertex.patch.position + place;
    placed.push_back(p);
    low = {std::min(low.x, p.x), std::min(low.y, p.y)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y)};
  }
  for (const auto& other : scene.graph.vertices()) {
    const Point q = other.patch.position;
    if (q.x < low.x - enough || q.y < low.y - enough || q.x > high.x + enough || q.y > high.y + enough)
      continue;
    for (std::uint32_t v = 0; v < stroke.size(); ++v) {
      // Farther than `enough` apart nothing is lost; most pairs are, and this is where balancing spends its
      // time.
      const Point apart = placed[v] - q;
      if (std::abs(apart.x) >= enough || std::abs(apart.y) >= enough) continue;
      const double need = std::max(asked, hard_core_distance(hard_core, stroke.patch(v), other.patch));
      least[v] = std::min(least[v], graph::distance(placed[v], q) / need);
    }
  }
  return std::accumulate(least.begin(), least.end(), 0.0) / static_cast<double>(least.size());
}

// An exemplar and a place near its own, with at least its observed clearance, or the best of some tries.
struct BirthSite {
  const Exemplar* exemplar = nullptr;
  Point place;
};
BirthSite choose_birth_site(OperatorFrame& scene, const std::vector<double>& weights) {
  BirthSite best;
  double most_free = -1;
  // Strokes that hardly move are born again at their old places.
  const double usual = stationary_deviation(scene.model.displacement);
  for (int tries = 0; tries < 20 && most_free < 1; ++tries) {
    const Exemplar& exemplar = scene.model.exemplars[scene.rng.categorical(weights)];
    const double jitter = std::min(largest_jitter, usual * scene.model.displacement_scale.at(exemplar.place));
    const Point place = rounded(exemplar.place + Point{scene.rng.normal(), scene.rng.normal()} * jitter);
    const double crowded = scene.density.at(place);
    if (best.exemplar && scene.rng.uniform() * crowded * crowded > 1) continue;
    const double free = relative_clearance(scene, exemplar, place);
    if (free > most_free) best = {&exemplar, place}, most_free = free;
  }
  return best;
}

void apply_births(OperatorFrame& scene, std::uint64_t seed) {
  const auto& model = scene.model;
  if (model.exemplars.empty()) return;
  double births = 0, usual = 0, crowded = 0;
  for (std::size_t c = 0; c < model.density.values.size(); ++c) {
    births += model.rates.birth.values[c] * model.rates.birth.cell * model.rates.birth.cell;
    usual += model.density.values[c];
    crowded += model.density.values[c] * scene.density.values[c];
  }
  // With fewer strokes than usual there are more births.
  if (crowded > 0) births *= usual * usual / (crowded * crowded);
  if (births <= 0) return;
  const auto weights = birth_weights(scene);
  for (int left = poisson(births, scene.rng); left > 0; --left) {
    const BirthSite site = choose_birth_site(scene, weights);
    scene.count_event(EventType::birth);
    const auto first = static_cast<Index>(scene.strokes.list.size());
    add_stationary(scene.strokes, site.exemplar->graph, site.place, 0, model, seed);
    for (Index v = first; v < scene.strokes.list.size(); ++v) scene.start_refractory_period(v);
  }
}

}  // namespace

std::array<int, 6> apply_operators(SimulatedStrokes& strokes, const MotionModel& model, std::uint64_t seed,
                                   std::uint32_t frame) {
  const auto graph_now = stroke_graph(strokes);
  auto parts = graph::components(graph_now);
  CellMap density = relative_density(graph_now, model.density);
  // Shifted like the keys of the noise, so that no key is used twice.
  const core::Rng rng(seed, {frame, 0, static_cast<std::uint32_t>(Purpose::operators) << 1U});
  OperatorFrame scene{
      strokes, model, rng, graph_now, std::move(parts), static_cast<double>(frame), std::move(density),
      {},      {}};
  scene.busy.resize(scene.parts.count);
  for (Index v = 0; v < scene.graph.size(); ++v)
    if (strokes.list[v].frames_left >= 0) scene.mark_busy(v);
  const OperatorSites found = find_sites(scene.graph, scene.parts, model.rates.reach);
  apply_deaths(scene);
  apply_splits(scene, found);
  apply_disconnects(scene, found);
  apply_unions(scene, found.merge_sites, model.rates.merge, EventType::merge);
  apply_unions(scene, found.connect_sites, model.rates.connect, EventType::connect);
  apply_births(scene, seed);
  const auto forgotten = [&](const PastEvent& one) {
    return elapsed_class((scene.frame - one.frame) * model.rates.modifiers.pace) == kElapsedClasses - 1;
  };
  std::erase_if(strokes.unions, forgotten);
  std::erase_if(strokes.separations, forgotten);
  return scene.done;
}

}  // namespace emberfold::mcmc::detail
