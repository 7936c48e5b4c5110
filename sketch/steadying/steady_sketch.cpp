// SPDX-License-Identifier: Apache-2.0
#include "sketch/steadying/steady_sketch.hpp"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "core/clip.hpp"
#include "core/math/fast_round.hpp"
#include "graph/matching/coincidence.hpp"
#include "sketch/detection/colour.hpp"
#include "sketch/patches/patch_types.hpp"
#include "sketch/refinement/coding_length.hpp"
#include "sketch/refinement/refine.hpp"

namespace emberfold::sketch {

using graph::AttributeGraph;
using graph::Patch;

namespace {

constexpr double kOfContrast = 0.25;  // difference of the images at which a vote counts e^{−1/2}
constexpr std::size_t kRun = 2;       // patches in a row that go or come

/// The votes of the neighbouring frames.
class Votes {
 public:
  Votes(std::span<const CarriedSketch> neighbours, double noise) : noise_(noise) {
    for (const CarriedSketch& neighbour : neighbours) {
      differences_.push_back(neighbour.difference);
      drawn_.emplace_back(neighbour.graph);
    }
  }

  /// Returns by how many more neighbours have a patch like this than have none.
  [[nodiscard]] double count(const Patch& patch) const {
    double sum = 0;
    for (std::size_t i = 0; i < drawn_.size(); ++i)
      sum += (drawn_[i].find(patch) ? 1 : -1) * weight(differences_[i], patch);
    return sum;
  }

 private:
  [[nodiscard]] double weight(const cv::Mat1f& difference, const Patch& patch) const {
    const int x = std::clamp(core::fast_round(patch.position.x), 0, difference.cols - 1),
              y = std::clamp(core::fast_round(patch.position.y), 0, difference.rows - 1);
    const double d = double{difference(y, x)}, more = std::max(0.0, d * d - 2 * noise_ * noise_),
                 usual = kOfContrast * std::abs(patch.contrast);
    return std::exp(-0.5 * more / std::max(usual * usual, 1e-9));
  }

  double noise_;
  std::vector<cv::Mat1f> differences_;
  std::vector<graph::CoincidenceIndex> drawn_;
};

/// Calls use(first, last) for each run of at least kRun patches of a curve for which `is_in` holds.
template <class IsIn, class Use>
void visit_runs(const graph::Curve& curve, const IsIn& is_in, const Use& use) {
  for (std::size_t i = 0; i < curve.size();) {
    std::size_t end = i;
    while (end < curve.size() && is_in(curve[end])) ++end;
    if (end - i >= kRun) use(i, end);
    i = end + 1;
  }
}

/// Drops the runs that the votes speak against, and curves of nothing else.
AttributeGraph without_outvoted(const AttributeGraph& own, const Votes& votes) {
  std::vector<char> outvoted(own.size(), 0), gone(own.size(), 0);
  for (std::size_t v = 0; v < own.size(); ++v) outvoted[v] = 1 + votes.count(own.patch(v)) < 0 ? 1 : 0;
  const auto is_out = [&](auto v) { return outvoted[v] != 0; };
  for (const graph::Curve& curve : graph::curves(own)) {
    if (std::ranges::all_of(curve, is_out))
      for (const auto v : curve) gone[v] = 1;
    visit_runs(curve, is_out, [&](std::size_t first, std::size_t last) {
      for (std::size_t i = first; i < last; ++i) gone[curve[i]] = 1;
    });
  }
  std::vector<graph::Vertex> vertices;
  std::vector<graph::Edge> edges;
  for (std::size_t v = 0; v < own.size(); ++v)
    if (gone[v] == 0) vertices.push_back(own.vertices()[v]);
  const auto stays = [&](graph::VertexId id) { return gone[own.index_of(id)] == 0; };
  std::ranges::copy_if(own.edges(), std::back_inserter(edges),
                       [&](const graph::Edge& e) { return stays(e.a) && stays(e.b); });
  return name_patch_types(std::move(vertices), std::move(edges));
}

/// Collects the runs that most neighbours have and this frame lacks.
AttributeGraph missing_strokes(const AttributeGraph& own, std::span<const CarriedSketch> neighbours,
                               const Votes& votes) {
  const graph::CoincidenceIndex drawn(own);
  std::vector<graph::Vertex> vertices;
  std::vector<graph::Edge> edges;
  for (const CarriedSketch& neighbour : neighbours) {
    const std::size_t before = vertices.size();
    const auto is_missing = [&](auto v) {
      const Patch& patch = neighbour.graph.patch(v);
      const auto known = std::span(vertices).first(before);
      return !drawn.find(patch) && std::ranges::none_of(known, [&](const auto& other) {
        return graph::coincidence(patch, other.patch).has_value();
      }) && votes.count(patch) - 1 > 0;
    };
    for (const graph::Curve& curve : graph::curves(neighbour.graph))
      visit_runs(curve, is_missing, [&](std::size_t first, std::size_t last) {
        for (std::size_t i = first; i < last; ++i) {
          const graph::VertexId id{static_cast<std::uint32_t>(vertices.size() + 1)};
          vertices.push_back({id, {}, neighbour.graph.patch(curve[i])});
          if (i > first) edges.push_back({graph::VertexId{id.value - 1}, id});
        }
      });
  }
  return {std::move(vertices), std::move(edges)};
}

/// Patches that were added along a curve have its evidence.
AttributeGraph with_evidence(const AttributeGraph& graph) {
  std::vector<graph::Vertex> vertices(graph.vertices().begin(), graph.vertices().end());
  for (const graph::Curve& curve : graph::curves(graph)) {
    double most = 0;
    for (const auto v : curve) most = std::max(most, graph.patch(v).evidence);
    for (const auto v : curve)
      if (graph.patch(v).evidence <= 0) vertices[v].patch.evidence = most;
  }
  return {std::move(vertices), {graph.edges().begin(), graph.edges().end()}};
}

}  // namespace

AttributeGraph steady_sketch(const cv::Mat& levels, const AttributeGraph& own,
                             std::span<const CarriedSketch> neighbours, const ExtractOptions& options) {
  if (neighbours.empty()) return own;
  const cv::Mat1f luma = core::luma(levels);
  const Votes votes(neighbours, estimate_noise(luma));
  const AttributeGraph offered = missing_strokes(own, neighbours, votes);
  AttributeGraph kept = without_outvoted(own, votes);
  if (offered.empty()) return kept;
  std::vector<CodingContext> axes{prepare_coding(luma, kColourAxes[0])};
  if (options.colour && levels.channels() == 3)
    for (cv::Mat1f& colour : compute_opponent_colours(levels))
      axes.push_back(prepare_coding(std::move(colour), kColourAxes[axes.size()]));
  return with_evidence(without_outvoted(refine(kept, levels, axes, {options.spacing, &offered}), votes));
}

}  // namespace emberfold::sketch
