// SPDX-License-Identifier: Apache-2.0
#include "mcmc/simulation/operators.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <span>

#include "mcmc/learning/drift.hpp"
#include "mcmc/learning/hard_core.hpp"
#include "mcmc/learning/operator_rates.hpp"
#include "mcmc/learning/operator_sites.hpp"

namespace emberfold::mcmc::detail {

namespace {

using graph::EventType;
using graph::Patch;
using graph::Point;
using Index = std::uint32_t;

constexpr double crowd_reach = 2;      // cells
constexpr double spacing = 5;          // px between the patches of a bridge
constexpr double most_astray = 4;      // px, SD: how far from where it was seen an exemplar is born
constexpr double most_clearance = 40;  // px: strokes farther apart do not keep each other away

// A frame's strokes while operators are drawn for them.
struct Scene {
  Particles& particles;
  const MotionModel& model;
  core::Rng rng;
  graph::AttributeGraph graph;
  graph::Components parts;
  double frame;                  ///< the one that is made
  CellMap crowd;                 ///< patches around each cell, over what is usual there
  std::vector<bool> busy;        ///< strokes that have changed, or of which something fades
  std::array<int, 6> done = {};  ///< how many of each operator

  // What takes patches away happens more often where it is crowded ...
  bool strike(Index vertex, double rate) {
    return rng.uniform() < rate * crowd.at(graph.patch(vertex).position) && !busy[parts.of_vertex[vertex]];
  }
  // ... and what brings some, more often where it is bare.
  bool bring(Index vertex, double rate) {
    return rng.uniform() * crowd.at(graph.patch(vertex).position) < rate && !busy[parts.of_vertex[vertex]];
  }
  [[nodiscard]] double parting(Index vertex) const {
    const Point place = graph.patch(vertex).position;
    return model.rates.parting.at(place) *
           after(model.rates.circumstances.parting, since(particles.unions, place, gone()));
  }
  [[nodiscard]] double uniting(Index a, Index b) const {
    const Point from = graph.patch(a).position, to = graph.patch(b).position;
    return after(model.rates.circumstances.uniting, since(particles.partings, from, frame)) *
           model.rates.circumstances.bridging[gap_class(graph::distance(from, to))];
  }
  // Of an end and a patch of another stroke that it does not continue.
  [[nodiscard]] double turning(const Sites::Pair& pair) const {
    return model.rates.circumstances.turning[turn_class(turn_towards(graph, pair))];
  }
  [[nodiscard]] double after(const std::array<double, kSince>& multiples, double frames) const {
    return multiples[since_class(frames * model.rates.circumstances.pace)];
  }
  // The frame in which what begins to fade now is no longer there.
  [[nodiscard]] double gone() const { return frame + fading() + 1; }
  [[nodiscard]] bool held(Index vertex) const { return particles.list[vertex].held > 0; }
  // Nothing happens there for a while, once what fades is gone.
  void hold(Index vertex, int fades = 0) {
    auto& left = particles.list[vertex].held;
    left = std::max(left, fades + static_cast<int>(std::lround(model.rates.hold)));
  }
  void take(Index vertex) { busy[parts.of_vertex[vertex]] = true; }
  void count(graph::EventType type) { ++done[static_cast<std::size_t>(type)]; }
  void fade(Index vertex) { particles.list[vertex].leaving = fading(); }
  [[nodiscard]] int fading() const {
    int frames = 0;
    while (frames < static_cast<int>(model.vanishing.size()) &&
           model.vanishing[static_cast<std::size_t>(frames)] < 0.9)
      ++frames;
    return frames;
  }
};

void die(Scene& scene) {
  const auto all = strokes(scene.parts);
  std::size_t least = scene.model.exemplars.empty() ? 0 : scene.graph.size();
  for (const auto& exemplar : scene.model.exemplars) least = std::min(least, exemplar.graph.size());
  const int fading = scene.fading();
  for (std::size_t s = 0; s < all.size(); ++s) {
    int age = 0;
    for (const Index v : all[s]) age = std::max(age, scene.particles.list[v].age);
    // The hold of the newly born is in the chance that strokes of their age have.
    const bool held = std::ranges::any_of(all[s], [&](Index v) { return scene.held(v); });
    if (held && age >= scene.model.rates.hold) continue;
    const double rate = scene.model.rates.death_by_size[size_class(all[s].size())] *
                        scene.model.rates.death.at(middle(scene.graph, all[s])) *
                        scene.after(scene.model.rates.circumstances.death, age + fading + 1);
    // The frames in which it fades are part of its life. What is smaller than any stroke that was seen is
    // none.
    const double sooner = rate / std::max(0.05, 1 - rate * fading);
    if (!scene.strike(all[s][0], all[s].size() < least ? 1 : sooner)) continue;
    scene.take(all[s][0]);
    scene.count(EventType::death);
    for (const Index v : all[s]) scene.fade(v);
  }
}

// The patches of a curve from `from` on, away from `behind`, up to `most` and not its end; whether that was
// reached, and is a free one.
struct Run {
  std::vector<Index> patches;
  bool ended = false, free = false;
};
Run run(const graph::AttributeGraph& graph, Index behind, Index from, std::size_t most) {
  Run result;
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

// Lets up to `wide` patches of the run go, at least one, and leaves a piece to a free end.
void open_gap(Scene& scene, const Run& arm, std::size_t wide) {
  const std::size_t kept = arm.free ? kPiece - 1 : 0, there = arm.patches.size();
  const std::size_t most = there > kept ? there - kept : 1;
  const std::size_t gone = std::min({wide, most, there});
  for (std::size_t i = 0; i < gone; ++i) scene.fade(arm.patches[i]);
  for (std::size_t i = gone; i < std::min(there, gone + kPiece); ++i)
    scene.hold(arm.patches[i], scene.fading());
}

std::size_t patches_of(double gap) {
  return static_cast<std::size_t>(std::max(1.0, std::round(gap / spacing) - 1));
}

void split(Scene& scene, const Sites& found) {
  const auto wide = patches_of(scene.model.rates.split_gap);
  for (const Index v : found.inner) {
    if (scene.held(v) || !scene.strike(v, scene.model.rates.split * scene.parting(v))) continue;
    scene.take(v);
    scene.count(EventType::split);
    scene.particles.partings.push_back({scene.graph.patch(v).position, scene.gone()});
    scene.fade(v);
    const auto sides = scene.graph.neighbours(v);
    for (const Index side : sides) scene.hold(side, scene.fading());
    if (wide > 1) open_gap(scene, run(scene.graph, v, sides[1], wide / 2 + kPiece), wide / 2);
    if (wide > 2) open_gap(scene, run(scene.graph, v, sides[0], wide / 2 + kPiece), (wide - 1) / 2);
  }
}

void come_apart(Scene& scene, const Sites& found) {
  const auto wide = patches_of(scene.model.rates.disconnect_gap);
  for (const auto& [hub, first] : found.arms) {
    if (scene.held(hub) || scene.held(first)) continue;
    if (!scene.strike(hub, scene.model.rates.disconnect * scene.parting(hub))) continue;
    scene.take(hub);
    scene.hold(hub, scene.fading());
    scene.count(EventType::disconnect);
    scene.particles.partings.push_back({scene.graph.patch(hub).position, scene.gone()});
    const Run arm = run(scene.graph, hub, first, 2 * wide + kPiece);
    // A bridge goes as a whole where it is not much longer than usual; one without patches takes its far end.
    if (arm.patches.empty())
      scene.fade(first);
    else
      open_gap(scene, arm,
               arm.ended && !arm.free && arm.patches.size() <= 2 * wide ? arm.patches.size() : wide);
  }
}

// u of the way from one to the other, now at `place`.
Particle between(const Particle& a, const Particle& b, double u, Point place, Point direction) {
  const auto mix = [&](double p, double q) { return p + u * (q - p); };
  const auto mix_points = [&](Point p, Point q) { return p + (q - p) * u; };
  Particle result;
  result.rest = a.rest;
  const Point along{std::cos(a.rest.theta), std::sin(a.rest.theta)};
  // Left and right are those of the end it sets out from.
  const double sense = graph::dot(direction, along) < 0 ? -1 : 1;
  result.rest.theta = std::atan2(sense * direction.y, sense * direction.x);
  result.rest.width = mix(a.rest.width, b.rest.width);
  result.rest.blur = mix(a.rest.blur, b.rest.blur);
  result.rest.contrast = mix(a.rest.contrast, b.rest.contrast);
  result.rest.hollow = mix(a.rest.hollow, b.rest.hollow);
  for (std::size_t c = 0; c < 3; ++c) {
    const auto levels = [&](float p, float q) { return static_cast<float>(mix(double(p), double(q))); };
    result.rest.left[c] = levels(a.rest.left[c], b.rest.left[c]);
    result.rest.middle[c] = levels(a.rest.middle[c], b.rest.middle[c]);
    result.rest.right[c] = levels(a.rest.right[c], b.rest.right[c]);
    const auto inmost = [c](const graph::Patch& p) { return p.hollow > 0 ? p.between[c] : p.middle[c]; };
    if (result.rest.hollow > 0) result.rest.between[c] = levels(inmost(a.rest), inmost(b.rest));
  }
  result.share = mix(a.share, b.share);
  result.offset = mix_points(a.offset, b.offset);
  result.offset_before = mix_points(a.offset_before, b.offset_before);
  result.gain = mix(a.gain, b.gain), result.gain_before = mix(a.gain_before, b.gain_before);
  result.rest.position = place - result.offset * result.share;
  return result;
}

// The way from one patch to another, u from 0 to 1, that goes on as the stroke ends at `a`, and at `b` where
// that is an end: Hermite's cubic.
class Way {
 public:
  Way(const graph::AttributeGraph& graph, Index a, Index b)
      : from_(graph.patch(a).position), to_(graph.patch(b).position) {
    leave_ = set_out(graph, a, to_ - from_);
    arrive_ = set_out(graph, b, from_ - to_) * -1;
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
  // As long as the chord; the chord itself where the stroke does not end, or would have to turn back.
  static Point set_out(const graph::AttributeGraph& graph, Index end, Point chord) {
    if (graph.degree(end) != 1) return chord;
    const Point out = outwards(graph, end);
    const double length = graph::norm(out);
    if (length <= 0 || graph::dot(out, chord) <= 0) return chord;
    return out * (graph::norm(chord) / length);
  }
  Point from_, to_, leave_, arrive_;
};

void bridge(Scene& scene, Index a, Index b) {
  Particles& p = scene.particles;
  const Particle from = p.list[a], to = p.list[b];
  const int patches = std::max(
      0, static_cast<int>(std::lround(graph::distance(from.position(), to.position()) / spacing)) - 1);
  const Way way(scene.graph, a, b);
  Index last = a;
  for (int i = 1; i <= patches; ++i) {
    const double u = i / (patches + 1.0);
    const Index next = p.add(between(from, to, u, way.at(u), way.direction(u)));
    scene.hold(next);
    p.edges.emplace_back(last, next);
    last = next;
  }
  p.edges.emplace_back(last, b);
  scene.hold(a);
  scene.hold(b);
}

void unite(Scene& scene, const std::vector<Sites::Pair>& pairs, double rate, EventType type) {
  for (const auto& pair : pairs) {
    const auto& [a, b] = pair;
    if (scene.held(a) || scene.held(b)) continue;
    const double bent = type == EventType::connect ? scene.turning(pair) : 1;
    if (!scene.bring(a, rate * bent * scene.uniting(a, b)) || scene.busy[scene.parts.of_vertex[b]]) continue;
    scene.take(a);
    scene.take(b);
    scene.count(type);
    const Point middle = (scene.graph.patch(a).position + scene.graph.patch(b).position) * 0.5;
    scene.particles.unions.push_back({middle, scene.frame});
    bridge(scene, a, b);
  }
}

// How many patches lie around each cell, over the usual number; 1/2 to 2.
CellMap crowding(const graph::AttributeGraph& graph, const CellMap& usual) {
  CellMap now = usual;
  std::ranges::fill(now.values, 0.0);
  for (const auto& vertex : graph.vertices()) ++now.values[now.index(vertex.patch.position)];
  now.values = spread(now, crowd_reach);
  double mean = 0;
  for (const double value : usual.values) mean += value / static_cast<double>(usual.values.size());
  for (std::size_t c = 0; c < now.values.size(); ++c)
    now.values[c] =
        mean > 0 ? std::clamp((now.values[c] + 0.1 * mean) / (usual.values[c] + 0.1 * mean), 0.5, 2.0) : 1;
  return now;
}

// How likely each exemplar is to be born: by its size, and where it was seen by the birth map, over how many
// were seen around there.
std::vector<double> birth_weights(const Scene& scene) {
  const auto& model = scene.model;
  std::array<double, kSizes> counts{};
  for (const auto& exemplar : model.exemplars) ++counts[size_class(exemplar.graph.size())];
  CellMap seen = model.density;
  std::ranges::fill(seen.values, 0.0);
  for (const auto& exemplar : model.exemplars) {
    const auto size = size_class(exemplar.graph.size());
    seen.values[seen.index(exemplar.place)] += model.rates.birth_by_size[size] / counts[size];
  }
  seen.values = spread(seen, 1);
  std::vector<double> weights;
  std::array<double, kSizes> sums{};
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

// How free a stroke would lie at a place, 0…1: of its distance to each other stroke, over what it had to its
// nearest when it was seen, or what strokes keep anyway, the least; the mean over its patches.
double freedom(const Scene& scene, const Exemplar& exemplar, Point place) {
  const auto& stroke = exemplar.graph;
  const auto& exclusion = scene.model.exclusion;
  const double asked = std::clamp(exemplar.clearance, 1.0, most_clearance);
  const double enough = std::max(asked, most_kept_apart(exclusion));
  std::vector<double> least(stroke.size(), 1.0);
  Point low{std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity()},
      high{-std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};
  for (const auto& vertex : stroke.vertices()) {
    const Point p = vertex.patch.position + place;
    low = {std::min(low.x, p.x), std::min(low.y, p.y)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y)};
  }
  for (const auto& other : scene.graph.vertices()) {
    const Point q = other.patch.position;
    if (q.x < low.x - enough || q.y < low.y - enough || q.x > high.x + enough || q.y > high.y + enough)
      continue;
    for (std::uint32_t v = 0; v < stroke.size(); ++v) {
      const Patch& patch = stroke.patch(v);
      const double need = std::max(asked, kept_apart(exclusion, patch, other.patch));
      least[v] = std::min(least[v], graph::distance(patch.position + place, q) / need);
    }
  }
  return std::accumulate(least.begin(), least.end(), 0.0) / static_cast<double>(least.size());
}

// An exemplar and a place about where it was seen: as much by itself as it was there, or as nearly so as some
// tries allow.
struct Cradle {
  const Exemplar* exemplar = nullptr;
  Point place;
};
Cradle find_cradle(Scene& scene, const std::vector<double>& weights) {
  Cradle best;
  double most_free = -1;
  // What hardly moves comes again where it was.
  const double usual = stationary_deviation(scene.model.sway);
  for (int tries = 0; tries < 20 && most_free < 1; ++tries) {
    const Exemplar& exemplar = scene.model.exemplars[scene.rng.categorical(weights)];
    const double astray = std::min(most_astray, usual * scene.model.sway_share.at(exemplar.place));
    const Point place = exemplar.place + Point{scene.rng.normal(), scene.rng.normal()} * astray;
    const double crowded = scene.crowd.at(place);
    if (best.exemplar && scene.rng.uniform() * crowded * crowded > 1) continue;
    const double free = freedom(scene, exemplar, place);
    if (free > most_free) best = {&exemplar, place}, most_free = free;
  }
  return best;
}

void give_birth(Scene& scene, std::uint64_t seed) {
  const auto& model = scene.model;
  if (model.exemplars.empty()) return;
  double births = 0, usual = 0, crowded = 0;
  for (std::size_t c = 0; c < model.density.values.size(); ++c) {
    births += model.rates.birth.values[c] * model.rates.birth.cell * model.rates.birth.cell;
    usual += model.density.values[c];
    crowded += model.density.values[c] * scene.crowd.values[c];
  }
  // Fewer than usual are there: more are born.
  if (crowded > 0) births *= usual * usual / (crowded * crowded);
  if (births <= 0) return;
  const auto weights = birth_weights(scene);
  for (int left = poisson(births, scene.rng); left > 0; --left) {
    const Cradle cradle = find_cradle(scene, weights);
    scene.count(EventType::birth);
    const auto first = static_cast<Index>(scene.particles.list.size());
    add_settled(scene.particles, cradle.exemplar->graph, cradle.place, 0, model, seed);
    // It lies there as it sways.
    const auto fresh = std::span(scene.particles.list).subspan(first);
    Point astray;
    for (const auto& particle : fresh) astray = astray + particle.offset * particle.share;
    astray = astray * (1 / static_cast<double>(fresh.size()));
    for (auto& particle : fresh) particle.rest.position = particle.rest.position - astray;
    for (Index v = first; v < scene.particles.list.size(); ++v) scene.hold(v);
  }
}

}  // namespace

std::array<int, 6> operate(Particles& particles, const MotionModel& model, std::uint64_t seed,
                           std::uint32_t frame) {
  auto shown = shape(particles);
  auto parts = graph::components(shown);
  CellMap crowd = crowding(shown, model.density);
  // Shifted as the keys of the noise are, and so none of theirs.
  const core::Rng rng(seed, {frame, 0, static_cast<std::uint32_t>(Purpose::operators) << 1U});
  Scene scene{particles,        model, rng, std::move(shown), std::move(parts), static_cast<double>(frame),
              std::move(crowd), {},    {}};
  scene.busy.resize(scene.parts.count);
  for (Index v = 0; v < scene.graph.size(); ++v)
    if (particles.list[v].leaving >= 0) scene.take(v);
  const Sites found = sites(scene.graph, scene.parts, model.rates.reach);
  die(scene);
  split(scene, found);
  come_apart(scene, found);
  unite(scene, found.facing, model.rates.merge, EventType::merge);
  unite(scene, found.beside, model.rates.connect, EventType::connect);
  give_birth(scene, seed);
  const auto forgotten = [&](const Happening& one) {
    return since_class((scene.frame - one.frame) * model.rates.circumstances.pace) == kSince - 1;
  };
  std::erase_if(particles.unions, forgotten);
  std::erase_if(particles.partings, forgotten);
  return scene.done;
}

}  // namespace emberfold::mcmc::detail
