// SPDX-License-Identifier: Apache-2.0
#include "graph/matching/match.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>

#include "core/error.hpp"
#include "core/parallel.hpp"
#include "core/text/check_range.hpp"
#include "graph/matching/assignment.hpp"
#include "graph/matching/chosen_links.hpp"
#include "graph/matching/curve_alignment.hpp"
#include "graph/matching/curve_features.hpp"
#include "graph/matching/flicker_removal.hpp"
#include "graph/matching/frame_links.hpp"
#include "graph/matching/point_grid.hpp"

namespace emberfold::graph {

void MatchOptions::validate() const {
  core::check_fields("MatchOptions", *this);
}

namespace {

using detail::IndexLinks;

constexpr double kGate = 4.5;             // nats: cost of 3 SDs in one attribute; a link may cost no more
constexpr double kSdAcross = 2;           // px: spread of a patch about its expected place, across its curve
constexpr double kSdAlong = 5;            // px: along it, by up to the patches' spacing
constexpr double kSdAngle = 0.35;         // rad: spread of a patch's orientation
constexpr double kSdContrast = 0.5;       // spread of the logarithm of a patch's contrast
constexpr double kReach = 12;             // px along a curve: SD of the window in which motion is smooth
constexpr double kWindow = 3 * kReach;    // px: end of that window
constexpr double kAlongWeight = 0.05;     // of motion along a curve, which hardly shows, against across it
constexpr double kPriorWeight = 0.3;      // patches: weight of the expected motion
constexpr std::array kWide = {2.5, 1.5};  // factors on kSdAcross in the passes that only find the motion
constexpr std::ptrdiff_t kCandidates = 32;  // at most for one patch: more lie on top of each other
constexpr int kFlickerRounds = 2;           // repairing one flicker reveals another
// A pair of components is linked by at least
constexpr std::uint32_t kSmall = 3;           // vertices: half of them in a smaller component up to this size
constexpr std::uint32_t kAlwaysEnough = 6;    // links in a larger one, or
constexpr std::uint32_t kLeastLinks = 2;      // links that are
constexpr std::uint32_t kShareOfSmaller = 3;  // one in so many of its vertices
constexpr std::uint32_t kNone = ~std::uint32_t{0};

/// The attributes of all patches of a graph that link gains are computed from.
struct PatchFeatures {
  std::vector<Point> place, direction;
  std::vector<double> log_contrast;

  explicit PatchFeatures(const AttributeGraph& graph) {
    for (const Vertex& vertex : graph.vertices()) {
      const Patch& patch = vertex.patch;
      place.push_back(patch.position);
      direction.push_back({std::cos(patch.theta), std::sin(patch.theta)});
      log_contrast.push_back(std::log(1 + std::abs(patch.contrast)));
    }
  }
};

/// Two frames, and the positions at which the patches of the first are expected in the second.
struct FramePair {
  const AttributeGraph &before, &after;
  std::vector<Curve> curves_before, curves_after;
  PatchFeatures patches_before, patches_after;
  std::vector<detail::CurveFeatures> features_after;
  std::vector<Point> first_expected, expected;  ///< from the past alone; updated by the passes

  FramePair(const AttributeGraph& a, const AttributeGraph& b, std::span<const Point> velocity)
      : before(a),
        after(b),
        curves_before(curves(a)),
        curves_after(curves(b)),
        patches_before(a),
        patches_after(b),
        first_expected(patches_before.place) {
    for (const Curve& curve : curves_after) {
      features_after.push_back(detail::compute_features(after, patches_after.place, curve));
    }
    for (std::size_t i = 0; i < velocity.size(); ++i) first_expected[i] = first_expected[i] + velocity[i];
    expected = first_expected;
  }

  /// Returns the mean of the undirected orientations of a vertex before and one after.
  [[nodiscard]] Point along(std::uint32_t i, std::uint32_t j) const {
    const Point a = patches_before.direction[i], b = patches_after.direction[j];
    const double cosine = dot(a, b);
    return (cosine < 0 ? a - b : a + b) * (1 / std::sqrt(2 + 2 * std::abs(cosine)));
  }
};

double square(double x) {
  return x * x;
}

/// Returns the gain of a link: kGate less half the squared distances in SDs. `wide`: factor on kSdAcross.
double link_gain(const FramePair& frames, std::uint32_t i, std::uint32_t j, double wide) {
  const Point along = frames.along(i, j), apart = frames.patches_after.place[j] - frames.expected[i];
  const double across = apart.y * along.x - apart.x * along.y;
  const double place = square(across / (kSdAcross * wide)) + square(dot(apart, along) / kSdAlong);
  const double contrast = frames.patches_after.log_contrast[j] - frames.patches_before.log_contrast[i];
  const double left = kGate - 0.5 * (place + square(contrast / kSdContrast));
  if (left <= 0) return left;
  const double cosine = std::abs(dot(frames.patches_before.direction[i], frames.patches_after.direction[j]));
  return left - 0.5 * square(std::acos(std::min(1.0, cosine)) / kSdAngle);
}

std::vector<Candidate> find_candidates(const FramePair& frames, const detail::PointGrid& near,
                                       const MatchOptions& options, double wide) {
  std::vector<Candidate> result;
  for (std::uint32_t i = 0; i < frames.before.size(); ++i) {
    const std::size_t start = result.size();
    for (const std::uint32_t j : near.find_near(frames.expected[i])) {
      const Point apart = frames.patches_after.place[j] - frames.first_expected[i];
      if (dot(apart, apart) > square(options.max_motion)) continue;
      if (!same_kind(frames.before.patch(i), frames.after.patch(j))) continue;
      const double gains = link_gain(frames, i, j, wide);
      if (gains > 0) result.push_back({i, j, gains});
    }
    const auto first = result.begin() + static_cast<std::ptrdiff_t>(start);
    if (result.end() - first > kCandidates) {
      std::partial_sort(first, first + kCandidates, result.end(), [](const Candidate& p, const Candidate& q) {
        return p.gain != q.gain ? p.gain > q.gain : p.column < q.column;
      });
      result.erase(first + kCandidates, result.end());
    }
  }
  return result;
}

IndexLinks align_curves(const FramePair& frames, detail::Aligner& aligner,
                        const std::vector<Candidate>& candidates) {
  std::vector<detail::CurveFeatures> features_before;
  for (const Curve& curve : frames.curves_before) {
    features_before.push_back(detail::compute_features(frames.before, frames.expected, curve));
  }
  return aligner.align(candidates, [&](std::uint32_t a, std::uint32_t b) {
    return detail::similarity(features_before[a], frames.features_after[b]);
  });
}

/// Estimates where the linked patches are, their motion smoothed along the curves.
/// At each vertex, weighted least squares give the shift that best explains how far its neighbours moved
/// across their curve. Along the curve the weight is small, so the motion stays near the expected one.
std::vector<Point> fit_motion(const FramePair& frames, const IndexLinks& links) {
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
      while (arc[k] - arc[first] > kWindow) ++first;
      double xx = kPriorWeight, xy = 0, yy = kPriorWeight, bx = 0, by = 0;
      for (std::size_t m = first; m < curve.size() && arc[m] - arc[k] <= kWindow; ++m) {
        const std::uint32_t i = curve[m], j = partner[i];
        if (j == kNone) continue;
        const double steps = (arc[m] - arc[k]) / kReach, weight = std::exp(-0.5 * steps * steps);
        const Point along = frames.along(i, j), normal{-along.y, along.x};
        const Point apart = frames.patches_after.place[j] - at[i];
        const double across = weight * dot(apart, normal), rest = weight * kAlongWeight * dot(apart, along);
        xx += weight * (normal.x * normal.x + kAlongWeight * along.x * along.x);
        xy += weight * (normal.x * normal.y + kAlongWeight * along.x * along.y);
        yy += weight * (normal.y * normal.y + kAlongWeight * along.y * along.y);
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

/// Links the points that the aligned curves left unlinked, at the greatest total gain.
IndexLinks assign_rest(const FramePair& frames, IndexLinks links, const std::vector<Candidate>& candidates) {
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

std::vector<Link> name_links(const AttributeGraph& before, const AttributeGraph& after,
                             const IndexLinks& links) {
  std::vector<Link> all;
  for (const auto& [i, j] : links) all.push_back({before.vertices()[i].id, after.vertices()[j].id});
  return all;
}

/// The links between two frames, and the motion of the patches before, px.
struct LinkedPair {
  std::vector<Link> links;
  std::vector<Point> motion;
};

LinkedPair link_frames(const AttributeGraph& before, const AttributeGraph& after,
                       std::span<const Point> velocity, const MatchOptions& options) {
  FramePair frames(before, after, velocity);
  const detail::PointGrid near(frames.patches_after.place, options.max_motion);
  detail::Aligner aligner(frames.curves_before, frames.curves_after, before.size(), after.size());
  for (const double wide : kWide) {
    frames.expected =
        fit_motion(frames, align_curves(frames, aligner, find_candidates(frames, near, options, wide)));
  }
  const auto found = find_candidates(frames, near, options, 1);
  const IndexLinks links = assign_rest(frames, align_curves(frames, aligner, found), found);
  LinkedPair result;
  result.links = supported_links(before, after, name_links(before, after, links));
  result.motion = fit_motion(frames, links);
  for (std::size_t i = 0; i < before.size(); ++i)
    result.motion[i] = result.motion[i] - before.patch(i).position;
  return result;
}

/// Returns the motion of each patch after: that of its predecessor, or the mean over the nearest patches
/// along the graph that have one.
std::vector<Point> carry_motion(const AttributeGraph& before, const AttributeGraph& after,
                                const LinkedPair& linked) {
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
  for (const std::uint32_t part : parts_before.of_vertex)
    if (part != Components::kNone) ++size_before[part];
  for (const std::uint32_t part : parts_after.of_vertex)
    if (part != Components::kNone) ++size_after[part];
  const detail::FrameLinks found = detail::index_links(before, after, links);
  const auto pairs = detail::component_pairs(before, after, parts_before, parts_after, found);
  const auto holds = [&](std::uint32_t a, std::uint32_t b) {
    const auto pair =
        std::lower_bound(pairs.begin(), pairs.end(), std::pair(a, b),
                         [](const auto& p, const auto& key) { return std::pair(p.before, p.after) < key; });
    const std::uint32_t smaller = std::min(size_before[a], size_after[b]);
    if (smaller <= kSmall) return 2 * pair->links >= smaller;
    return pair->links >= kAlwaysEnough ||
           (pair->links >= kLeastLinks && kShareOfSmaller * pair->links >= smaller);
  };
  std::vector<Link> result;
  for (std::size_t k = 0; k < links.size(); ++k) {
    const auto& [i, j] = found.links[k];
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
  std::vector<Point> of_strokes;
  for (std::size_t i = 0; i < velocity.size(); ++i)
    if (!is_anchor(before.patch(i))) of_strokes.push_back(velocity[i]);
  return link_frames(without_anchors(before), without_anchors(after), of_strokes, options).links;
}

namespace {

using ClipLinks = std::vector<std::vector<Link>>;  // by frame, with the one before

/// Links every frame to its neighbour, in the order of time or against it: where the match is in doubt, the
/// motion that patches had decides.
ClipLinks link_clip(const std::vector<AttributeGraph>& frames, bool backwards, const MatchOptions& options,
                    const core::Context& context) {
  ClipLinks links(frames.size());
  std::vector<Point> velocity;
  for (std::size_t k = 1; k < frames.size(); ++k) {
    context.check();
    const std::size_t t = backwards ? frames.size() - k : k;
    const AttributeGraph& from = frames[backwards ? t : t - 1];
    const AttributeGraph& to = frames[backwards ? t - 1 : t];
    LinkedPair linked = link_frames(from, to, velocity, options);
    velocity = carry_motion(from, to, linked);
    links[t] = std::move(linked.links);
    if (!backwards) continue;
    for (Link& link : links[t]) std::swap(link.before, link.after);
    std::ranges::sort(links[t]);
  }
  return links;
}

MotionGraph match_once(SketchSequence sketch, const MatchOptions& options, const core::Context& context) {
  std::array<ClipLinks, 2> both;
  core::parallel_for(both.size(), context,
                     [&](std::size_t k) { both[k] = link_clip(sketch.frames, k == 1, options, context); });
  MotionGraph motion;
  motion.links.resize(sketch.frames.size());
  core::parallel_for(sketch.frames.size(), context, [&](std::size_t t) {
    if (t > 0)
      motion.links[t] = detail::choose_links(sketch.frames[t - 1], sketch.frames[t], both[0][t], both[1][t]);
  });
  motion.sketch = std::move(sketch);
  return identify(std::move(motion));
}

}  // namespace

MotionGraph match(SketchSequence sketch, const MatchOptions& options, const core::Context& context) {
  options.validate();
  for (AttributeGraph& frame : sketch.frames) frame = without_anchors(frame);
  const int rounds = options.flicker > 0 ? kFlickerRounds : 0;
  context.report("match", 0);
  MotionGraph motion = match_once(std::move(sketch), options, context);
  for (int round = 1; round <= rounds; ++round) {
    context.report("match", static_cast<double>(round) / (rounds + 1));
    motion = match_once(remove_flicker(motion, options.flicker), options, context);
  }
  context.report("match", 1);
  return motion;
}

}  // namespace emberfold::graph
