// SPDX-License-Identifier: Apache-2.0
#include "graph/morphing/morph.hpp"

#include <algorithm>
#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <utility>

#include "core/error.hpp"
#include "core/text/check_range.hpp"
#include "graph/morphing/curve_pairs.hpp"

namespace emberfold::graph {

namespace {

using detail::CurvePairs;
using detail::SampledCurve;
using detail::StrokePath;

constexpr std::uint32_t kNowhere = ~std::uint32_t{0};

// A vertex between the ends of the path: where it comes from in the first graph and goes to in the second.
struct Actor {
  std::uint32_t from = kNowhere, to = kNowhere;
};

// The places that a curve's patches have among the actors, in order; a ring repeats its first.
using Cast = std::vector<std::uint32_t>;

struct Troupe {
  std::vector<Actor> actors;
  std::vector<Cast> moving, dying, being_born;
};

// Ends that lie at one vertex in both graphs are one actor.
class Casting {
 public:
  Cast cast(const StrokePath& path) {
    const auto &a = path.from.vertices, &b = path.to.vertices;
    Cast result;
    for (std::size_t i = 0; i < a.size(); ++i)
      result.push_back(i == 0 || i + 1 == a.size() ? joined({a[i], b[i]}) : add({a[i], b[i]}));
    return result;
  }
  Cast cast(const SampledCurve& curve, bool dies) {
    Cast result;
    for (const std::uint32_t v : curve.vertices)
      result.push_back(joined(dies ? Actor{v} : Actor{kNowhere, v}));
    return result;
  }
  [[nodiscard]] std::vector<Actor> take() { return std::move(actors_); }

 private:
  std::uint32_t add(Actor actor) {
    actors_.push_back(actor);
    return static_cast<std::uint32_t>(actors_.size() - 1);
  }
  std::uint32_t joined(Actor actor) {
    const auto [at, is_new] = shared_.try_emplace({actor.from, actor.to}, 0);
    if (is_new) at->second = add(actor);
    return at->second;
  }

  std::vector<Actor> actors_;
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> shared_;
};

Troupe find_troupe(const CurvePairs& pairs) {
  Casting casting;
  Troupe result;
  for (const auto& path : pairs.paths) result.moving.push_back(casting.cast(path));
  for (const auto& curve : pairs.dying) result.dying.push_back(casting.cast(curve, true));
  for (const auto& curve : pairs.being_born) result.being_born.push_back(casting.cast(curve, false));
  result.actors = casting.take();
  return result;
}

// A frame between the ends.
struct Scene {
  AttributeGraph graph;
  std::vector<float> opacity;
  std::vector<std::uint32_t> vertex;  // of each actor; kNowhere: not there
};

class SceneBuilder {
 public:
  explicit SceneBuilder(std::size_t actors) : vertex_(actors, kNowhere) {}

  void add(const Cast& cast, std::span<const Patch> patches, float opacity) {
    for (std::size_t i = 0; i < patches.size(); ++i) {
      std::uint32_t& v = vertex_[cast[i]];
      if (v == kNowhere) {
        v = static_cast<std::uint32_t>(vertices_.size());
        vertices_.push_back({VertexId{v}, {}, patches[i]});
        opacity_.push_back(opacity);
      }
    }
    for (std::size_t i = 1; i < cast.size(); ++i) {
      const auto [low, high] = std::minmax(vertex_[cast[i - 1]], vertex_[cast[i]]);
      edges_.push_back({VertexId{low}, VertexId{high}});
    }
  }

  [[nodiscard]] Scene build() {
    std::ranges::sort(edges_);
    edges_.erase(std::unique(edges_.begin(), edges_.end()), edges_.end());
    return {{std::move(vertices_), std::move(edges_)}, std::move(opacity_), std::move(vertex_)};
  }

 private:
  std::vector<Vertex> vertices_;
  std::vector<Edge> edges_;
  std::vector<float> opacity_;
  std::vector<std::uint32_t> vertex_;
};

// Moves the points between a curve's ends with its ends, the more the nearer.
void bend_to_ends(std::vector<Patch>& patches, Point first_shift, Point last_shift) {
  const auto steps = static_cast<double>(patches.size() - 1);
  for (std::size_t i = 0; i < patches.size(); ++i) {
    const double share = static_cast<double>(i) / steps;
    patches[i].position = patches[i].position + first_shift * (1 - share) + last_shift * share;
  }
}

// The patches of all moving curves; ends that are one vertex lie at their mean.
std::vector<std::vector<Patch>> moving_patches(const CurvePairs& pairs, const Troupe& troupe, double share) {
  std::vector<std::vector<Patch>> all;
  std::map<std::uint32_t, std::pair<Point, int>> met;
  const auto meet = [&](std::uint32_t actor, Point at) {
    auto& [sum, count] = met[actor];
    sum = sum + at;
    ++count;
  };
  for (std::size_t k = 0; k < pairs.paths.size(); ++k) {
    all.push_back(pairs.paths[k].patches(share));
    if (pairs.paths[k].closed || all.back().size() < 2) continue;
    meet(troupe.moving[k].front(), all.back().front().position);
    meet(troupe.moving[k].back(), all.back().back().position);
  }
  const auto shift = [&](std::uint32_t actor, Point at) {
    const auto& [sum, count] = met.at(actor);
    return count > 1 ? sum * (1.0 / count) - at : Point{};
  };
  for (std::size_t k = 0; k < all.size(); ++k)
    if (!pairs.paths[k].closed && all[k].size() > 1)
      bend_to_ends(all[k], shift(troupe.moving[k].front(), all[k].front().position),
                   shift(troupe.moving[k].back(), all[k].back().position));
  return all;
}

Scene build_scene(const CurvePairs& pairs, const Troupe& troupe, double share) {
  SceneBuilder scene(troupe.actors.size());
  const auto moving = moving_patches(pairs, troupe, share);
  for (std::size_t k = 0; k < moving.size(); ++k) scene.add(troupe.moving[k], moving[k], 1);
  const auto fade = [&](const std::vector<SampledCurve>& curves, const std::vector<Cast>& casts,
                        double opacity) {
    for (std::size_t k = 0; opacity > 0 && k < curves.size(); ++k)
      scene.add(casts[k], curves[k].patches, static_cast<float>(opacity));
  };
  fade(pairs.dying, troupe.dying, 1 - 2 * share);
  fade(pairs.being_born, troupe.being_born, 2 * share - 1);
  return scene.build();
}

Scene end_scene(const AttributeGraph& graph, const Troupe& troupe, bool first) {
  Scene result{
      graph.with_curves(std::vector<CurveId>(graph.size())), std::vector<float>(graph.size(), 1), {}};
  for (const Actor& actor : troupe.actors) result.vertex.push_back(first ? actor.from : actor.to);
  return result;
}

void append(Morph& morph, Scene& before, Scene scene, std::size_t actors) {
  auto& sketch = morph.motion.sketch;
  auto& links = morph.motion.links;
  const bool is_first = sketch.frames.empty();
  sketch.append(scene.graph);
  auto& added = links.emplace_back();
  for (std::size_t i = 0; !is_first && i < actors; ++i) {
    if (before.vertex[i] == kNowhere || scene.vertex[i] == kNowhere) continue;
    const auto t = sketch.frames.size() - 1;
    added.push_back({sketch.frames[t - 1].vertices()[before.vertex[i]].id,
                     sketch.frames[t].vertices()[scene.vertex[i]].id});
  }
  std::ranges::sort(added);
  added.erase(std::unique(added.begin(), added.end()), added.end());
  morph.opacity.push_back(scene.opacity);
  before = std::move(scene);
}

void check_amount(const AttributeGraph& a, const AttributeGraph& b, int frames) {
  constexpr double kMost = 2e7;
  const double patches = static_cast<double>(a.size() + b.size()) * frames;
  if (patches > kMost)
    throw core::InputError("morph: " + std::to_string(frames) + " frames of " +
                           std::to_string(a.size() + b.size()) +
                           " patches are too many; allowed are 20 million patches in all frames");
}

void check_frame_size(int width, int height, double fps) {
  if (width < 1 || height < 1)
    throw core::InputError("morph: the size is " + std::to_string(width) + "x" + std::to_string(height) +
                           "; must be at least 1x1");
  core::check_positive("morph: fps", fps);
}

}  // namespace

void MorphOptions::validate() const {
  core::check_fields("MorphOptions", *this);
}

Morph morph(const AttributeGraph& from, const AttributeGraph& to, int width, int height, double fps,
            const MorphOptions& options, const core::Context& context) {
  options.validate();
  check_frame_size(width, height, fps);
  const AttributeGraph first = without_anchors(from), last = without_anchors(to);
  check_amount(first, last, options.frames);
  const auto pairs = detail::pair_curves(first, last, context);
  const Troupe troupe = find_troupe(pairs);
  Morph result;
  result.length = pairs.length;
  result.moved = pairs.paths.size(), result.died = pairs.dying.size();
  result.born = pairs.being_born.size();
  result.motion.sketch.width = width, result.motion.sketch.height = height, result.motion.sketch.fps = fps;
  Scene before;
  for (int t = 0; t < options.frames; ++t) {
    context.check();
    const double share = double(t) / (options.frames - 1);
    context.report("morph", share);
    append(result, before,
           t == 0                    ? end_scene(first, troupe, true)
           : t + 1 == options.frames ? end_scene(last, troupe, false)
                                     : build_scene(pairs, troupe, share),
           troupe.actors.size());
  }
  result.motion = identify(std::move(result.motion));
  return result;
}

}  // namespace emberfold::graph
