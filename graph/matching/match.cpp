// SPDX-License-Identifier: Apache-2.0
#include "graph/matching/match.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>

#include "core/error.hpp"
#include "graph/matching/assignment.hpp"
#include "graph/matching/curve_alignment.hpp"
#include "graph/matching/curve_features.hpp"
#include "graph/matching/flicker_removal.hpp"
#include "graph/matching/frame_links.hpp"
#include "graph/matching/point_grid.hpp"

namespace emberfold::graph {

void MatchOptions::validate() const {
  const std::array<std::pair<const char*, double>, 8> fields = {{{"max_motion", max_motion},
                                                                 {"sigma_across", sigma_across},
                                                                 {"sigma_along", sigma_along},
                                                                 {"sigma_angle", sigma_angle},
                                                                 {"sigma_contrast", sigma_contrast},
                                                                 {"sigma_count", sigma_count},
                                                                 {"sigma_shape", sigma_shape},
                                                                 {"sigma_degree", sigma_degree}}};
  for (const auto& [name, value] : fields) {
    if (!(value > 0) || !std::isfinite(value)) {
      throw core::InputError("match: " + std::string(name) + " is " + std::to_string(value) +
                             ", allowed is a finite number above 0");
    }
  }
  if (flicker < 0 || flicker > 100) {
    throw core::InputError("match: flicker is " + std::to_string(flicker) + ", allowed is 0…100 frames");
  }
}

namespace {

using detail::IndexLinks;

constexpr double kGate = 4.5;  // a link may cost as much as three SD of one attribute
constexpr double kReach = 12;  // px along a curve over which patches move alike
constexpr std::uint32_t kNone = ~std::uint32_t{0};

/// What of a graph's patches is looked at again and again.
struct Looks {
  std::vector<Point> place, direction;
  std::vector<double> log_contrast;

  explicit Looks(const AttributeGraph& graph) {
    for (const Vertex& vertex : graph.vertices()) {
      const Patch& patch = vertex.patch;
      place.push_back(patch.position);
      direction.push_back({std::cos(patch.theta), std::sin(patch.theta)});
      log_contrast.push_back(std::log(1 + std::abs(patch.contrast)));
    }
  }
};

/// Both frames, and where the patches of the first are expected in the second.
struct Frames {
  const AttributeGraph &before, &after;
  std::vector<Curve> curves_before, curves_after;
  Looks looks_before, looks_after;
  std::vector<detail::CurveFeatures> features_after;
  std::vector<Point> first_expected, expected;  ///< from the past alone, and by what was seen since

  Frames(const AttributeGraph& a, const AttributeGraph& b, std::span<const Point> velocity)
      : before(a),
        after(b),
        curves_before(curves(a)),
        curves_after(curves(b)),
        looks_before(a),
        looks_after(b),
        first_expected(looks_before.place) {
    for (const Curve& curve : curves_after) {
      features_after.push_back(detail::features(after, looks_after.place, curve));
    }
    for (std::size_t i = 0; i < velocity.size(); ++i) first_expected[i] = first_expected[i] + velocity[i];
    expected = first_expected;
  }

  /// The mean of the undirected orientations of a vertex before and one after.
  [[nodiscard]] Point along(std::uint32_t i, std::uint32_t j) const {
    const Point a = looks_before.direction[i], b = looks_after.direction[j];
    const double cosine = dot(a, b);
    return (cosine < 0 ? a - b : a + b) * (1 / std::sqrt(2 + 2 * std::abs(cosine)));
  }
};

double square(double x) {
  return x * x;
}

/// What a link gains: kGate less half the squared distances in SDs. `wide`: how many times sigma_across the
/// motion is known to.
double gain(const Frames& frames, std::uint32_t i, std::uint32_t j, const MatchOptions& options,
            double wide) {
  const Point along = frames.along(i, j), apart = frames.looks_after.place[j] - frames.expected[i];
  const double across = apart.y * along.x - apart.x * along.y;
  const double place =
      square(across / (options.sigma_across * wide)) + square(dot(apart, along) / options.sigma_along);
  const double contrast = frames.looks_after.log_contrast[j] - frames.looks_before.log_contrast[i];
  const double left = kGate - 0.5 * (place + square(contrast / options.sigma_contrast));
  if (left <= 0) return left;
  const double cosine = std::abs(dot(frames.looks_before.direction[i], frames.looks_after.direction[j]));
  return left - 0.5 * square(std::acos(std::min(1.0, cosine)) / options.sigma_angle);
}

std::vector<Candidate> candidates(const Frames& frames, const detail::Near& near, const MatchOptions& options,
                                  double wide) {
  std::vector<Candidate> result;
  for (std::uint32_t i = 0; i < frames.before.size(); ++i) {
    const std::size_t start = result.size();
    for (const std::uint32_t j : near.around(frames.expected[i])) {
      const Point apart = frames.looks_after.place[j] - frames.first_expected[i];
      if (dot(apart, apart) > square(options.max_motion)) continue;
      if (!same_kind(frames.before.patch(i), frames.after.patch(j))) continue;
      const double gains = gain(frames, i, j, options, wide);
      if (gains > 0) result.push_back({i, j, gains});
    }
    // Where patches lie on top of each other there is no telling them apart, nor need to try.
    constexpr std::ptrdiff_t kMost = 32;
    const auto first = result.begin() + static_cast<std::ptrdiff_t>(start);
    if (result.end() - first > kMost) {
      std::partial_sort(first, first + kMost, result.end(), [](const Candidate& p, const Candidate& q) {
        return p.gain != q.gain ? p.gain > q.gain : p.column < q.column;
      });
      result.erase(first + kMost, result.end());
    }
  }
  return result;
}

IndexLinks align(const Frames& frames, detail::Aligner& aligner, const std::vector<Candidate>& candidates,
                 const MatchOptions& options) {
  std::vector<detail::CurveFeatures> features_before;
  for (const Curve& curve : frames.curves_before) {
    features_before.push_back(detail::features(frames.before, frames.expected, curve));
  }
  return aligner.align(candidates, [&](std::uint32_t a, std::uint32_t b) {
    return detail::likeness(features_before[a], frames.features_after[b], options);
  });
}

/// Where the links show the patches to be, their motion smoothed along the curves: around each vertex the one
/// shift that explains best how far its neighbours moved across their curve. What moves along a curve hardly
/// shows: there the motion stays near what was expected.
std::vector<Point> fitted(const Frames& frames, const IndexLinks& links) {
  constexpr double kAlong = 0.05, kPrior = 0.3;
  const auto& at = frames.expected;
  std::vector<std::uint32_t> partner(frames.before.size(), kNone);
  for (const auto& [i, j] : links) partner[i] = j;
  std::vector<Point> sum(frames.before.size());
  std::vector<double> times(frames.before.size(), 0);
  for (const Curve& curve : frames.curves_before) {
    std::vector<double> arc(curve.size(), 0);
    for (std::size_t k = 1; k < curve.size(); ++k)
      arc[k] = arc[k - 1] + distance(at[curve[k - 1]], at[curve[k]]);
    std::size_t first = 0;
    for (std::size_t k = 0; k < curve.size(); ++k) {
      while (arc[k] - arc[first] > 3 * kReach) ++first;
      double xx = kPrior, xy = 0, yy = kPrior, bx = 0, by = 0;
      for (std::size_t m = first; m < curve.size() && arc[m] - arc[k] <= 3 * kReach; ++m) {
        const std::uint32_t i = curve[m], j = partner[i];
        if (j == kNone) continue;
        const double steps = (arc[m] - arc[k]) / kReach, weight = std::exp(-0.5 * steps * steps);
        const Point along = frames.along(i, j), normal{-along.y, along.x};
        const Point apart = frames.looks_after.place[j] - at[i];
        const double across = weight * dot(apart, normal), rest = weight * kAlong * dot(apart, along);
        xx += weight * (normal.x * normal.x + kAlong * along.x * along.x);
        xy += weight * (normal.x * normal.y + kAlong * along.x * along.y);
        yy += weight * (normal.y * normal.y + kAlong * along.y * along.y);
        bx += across * normal.x + rest * along.x;
        by += across * normal.y + rest * along.y;
      }
      const double determinant = xx * yy - xy * xy;
      const std::uint32_t i = curve[k];
      sum[i] = sum[i] + Point{(yy * bx - xy * by) / determinant, (xx * by - xy * bx) / determinant};
      times[i] += 1;
    }
  }
  std::vector<Point> result = at;
  for (std::size_t i = 0; i < result.size(); ++i) result[i] = result[i] + sum[i] * (1 / times[i]);
  return result;
}

/// Links what the aligned curves left over, at the most gain in all.
IndexLinks with_rest(const Frames& frames, IndexLinks links, const std::vector<Candidate>& candidates) {
  std::vector<bool> used_before(frames.before.size(), false), used_after(frames.after.size(), false);
  for (const auto& [i, j] : links) used_before[i] = used_after[j] = true;
  std::vector<Candidate> rest;
  for (const Candidate& c : candidates) {
    if (!used_before[c.row] && !used_after[c.column]) rest.push_back(c);
  }
  const IndexLinks more = assign(rest);
  links.insert(links.end(), more.begin(), more.end());
  std::sort(links.begin(), links.end());
  return links;
}

std::vector<Link> named(const AttributeGraph& before, const AttributeGraph& after, const IndexLinks& links) {
  std::vector<Link> all;
  for (const auto& [i, j] : links) all.push_back({before.vertices()[i].id, after.vertices()[j].id});
  return all;
}

/// The links and the motion of the patches before that they show.
struct Linked {
  std::vector<Link> links;
  std::vector<Point> motion;
};

Linked link_frames(const AttributeGraph& before, const AttributeGraph& after, std::span<const Point> velocity,
                   const MatchOptions& options) {
  Frames frames(before, after, velocity);
  const detail::Near near(frames.looks_after.place, options.max_motion);
  detail::Aligner aligner(frames.curves_before, frames.curves_after, before.size(), after.size());
  // The first passes only find how everything moves.
  for (const double wide : {2.5, 1.5}) {
    frames.expected =
        fitted(frames, align(frames, aligner, candidates(frames, near, options, wide), options));
  }
  const auto found = candidates(frames, near, options, 1);
  const IndexLinks links = with_rest(frames, align(frames, aligner, found, options), found);
  Linked result;
  result.links = supported_links(before, after, named(before, after, links));
  result.motion = fitted(frames, links);
  for (std::size_t i = 0; i < before.size(); ++i)
    result.motion[i] = result.motion[i] - before.patch(i).position;
  return result;
}

/// The motion of each patch after: that of its predecessor, or of the nearest ones along the graph that have
/// one.
std::vector<Point> carried_motion(const AttributeGraph& before, const AttributeGraph& after,
                                  const Linked& linked) {
  std::vector<Point> motion(after.size());
  std::vector<std::uint32_t> ring;
  std::vector<bool> known(after.size(), false);
  for (const Link& link : linked.links) {
    const auto j = static_cast<std::uint32_t>(after.index_of(link.after));
    motion[j] = linked.motion[before.index_of(link.before)];
    known[j] = true;
    ring.push_back(j);
  }
  while (!ring.empty()) {
    std::vector<std::uint32_t> next;
    for (const std::uint32_t j : ring) {
      for (const std::uint32_t w : after.neighbours(j)) {
        if (!known[w]) next.push_back(w);
      }
    }
    std::sort(next.begin(), next.end());
    next.erase(std::unique(next.begin(), next.end()), next.end());
    for (const std::uint32_t w : next) {
      Point sum;
      double count = 0;
      for (const std::uint32_t j : after.neighbours(w)) {
        if (known[j]) sum = sum + motion[j], count += 1;
      }
      motion[w] = sum * (1 / count);
    }
    for (const std::uint32_t w : next) known[w] = true;
    ring = std::move(next);
  }
  return motion;
}

}  // namespace

std::vector<Link> supported_links(const AttributeGraph& before, const AttributeGraph& after,
                                  std::vector<Link> links) {
  const Components parts_before = components(before), parts_after = components(after);
  std::vector<std::uint32_t> size_before(parts_before.count, 0), size_after(parts_after.count, 0);
  for (const std::uint32_t part : parts_before.of_vertex) ++size_before[part];
  for (const std::uint32_t part : parts_after.of_vertex) ++size_after[part];
  const detail::Gap gap = detail::gap(before, after, links);
  const auto pairs = detail::component_pairs(before, after, parts_before, parts_after, gap);
  const auto holds = [&](std::uint32_t a, std::uint32_t b) {
    const auto pair =
        std::lower_bound(pairs.begin(), pairs.end(), std::pair(a, b),
                         [](const auto& p, const auto& key) { return std::pair(p.before, p.after) < key; });
    const std::uint32_t smaller = std::min(size_before[a], size_after[b]);
    if (smaller <= 3) return 2 * pair->links >= smaller;
    return pair->links >= 6 || (pair->links >= 2 && 3 * pair->links >= smaller);
  };
  std::vector<Link> result;
  for (std::size_t k = 0; k < links.size(); ++k) {
    const auto& [i, j] = gap.links[k];
    if (holds(parts_before.of_vertex[i], parts_after.of_vertex[j])) result.push_back(links[k]);
  }
  return result;
}

std::vector<Link> match_frames(const AttributeGraph& before, const AttributeGraph& after,
                               std::span<const Point> velocity, const MatchOptions& options) {
  options.validate();
  if (!velocity.empty() && velocity.size() != before.size()) {
    throw core::InputError("match: " + std::to_string(velocity.size()) + " velocities for " +
                           std::to_string(before.size()) + " vertices");
  }
  const auto finite = [](Point v) { return std::isfinite(v.x) && std::isfinite(v.y); };
  if (!std::all_of(velocity.begin(), velocity.end(), finite)) {
    throw core::InputError("match: a velocity is not finite");
  }
  return link_frames(before, after, velocity, options).links;
}

namespace {

MotionGraph match_once(SketchSequence sketch, const MatchOptions& options, const core::Context& context,
                       double share_before, double share_after) {
  MotionGraph motion;
  const auto& frames = sketch.frames;
  std::vector<Point> velocity;
  for (std::size_t t = 0; t < frames.size(); ++t) {
    context.check();
    context.report("match", std::lerp(share_before, share_after,
                                      static_cast<double>(t) / static_cast<double>(frames.size())));
    motion.links.emplace_back();
    if (t == 0) continue;
    Linked linked = link_frames(frames[t - 1], frames[t], velocity, options);
    velocity = carried_motion(frames[t - 1], frames[t], linked);
    motion.links.back() = std::move(linked.links);
  }
  motion.sketch = std::move(sketch);
  return identify(std::move(motion));
}

}  // namespace

MotionGraph match(SketchSequence sketch, const MatchOptions& options, const core::Context& context) {
  options.validate();
  constexpr int kRounds = 2;  // mending one flicker shows the next
  const int rounds = options.flicker > 0 ? kRounds : 0;
  MotionGraph motion;
  for (int round = 0; round <= rounds; ++round) {
    if (round > 0) sketch = steady(motion, options.flicker);
    motion = match_once(std::move(sketch), options, context, static_cast<double>(round) / (rounds + 1),
                        (round + 1.0) / (rounds + 1));
  }
  context.report("match", 1);
  return motion;
}

}  // namespace emberfold::graph
