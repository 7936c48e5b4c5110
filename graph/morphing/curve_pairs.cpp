// SPDX-License-Identifier: Apache-2.0
#include "graph/morphing/curve_pairs.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <utility>

#include "core/error.hpp"
#include "core/parallel.hpp"
#include "graph/matching/assignment.hpp"

namespace emberfold::graph::detail {

namespace {

constexpr std::size_t kMostCurves = 4000;

std::vector<SampledCurve> sample_all(const AttributeGraph& graph) {
  const auto found = curves(graph);
  if (found.size() > kMostCurves)
    throw core::InputError("morph: a graph has " + std::to_string(found.size()) + " curves; allowed is " +
                           std::to_string(kMostCurves) + " at most");
  std::vector<SampledCurve> result;
  for (const Curve& curve : found) result.push_back(sample_curve(graph, curve));
  return result;
}

// The squared length that a pair saves against fading both, times its weight.
std::vector<Candidate> find_candidates(const std::vector<SampledCurve>& a, const std::vector<SampledCurve>& b,
                                       const core::Context& context) {
  std::vector<std::vector<Candidate>> rows(a.size());
  core::parallel_for(a.size(), context, [&](std::size_t i) {
    for (std::size_t j = 0; j < b.size(); ++j) {
      const auto path = find_path(a[i], b[j]);
      if (!path) continue;
      const double saved = kFarthestMove * kFarthestMove - path->length * path->length;
      if (saved > 0)
        rows[i].push_back({static_cast<std::uint32_t>(i), static_cast<std::uint32_t>(j),
                           saved * (a[i].length + b[j].length) / 2});
    }
  });
  std::vector<Candidate> result;
  for (const auto& row : rows) result.insert(result.end(), row.begin(), row.end());
  return result;
}

}  // namespace

CurvePairs pair_curves(const AttributeGraph& from, const AttributeGraph& to, const core::Context& context) {
  const auto a = sample_all(from), b = sample_all(to);
  const auto chosen = assign(find_candidates(a, b, context));
  CurvePairs result;
  std::vector<bool> paired_a(a.size()), paired_b(b.size());
  double sum = 0, weight = 0;
  for (const auto& [i, j] : chosen) {
    paired_a[i] = paired_b[j] = true;
    result.paths.push_back(*find_path(a[i], b[j]));
    sum += (a[i].length + b[j].length) / 2 * result.paths.back().length * result.paths.back().length;
  }
  const auto take_rest = [&](const std::vector<SampledCurve>& all, const std::vector<bool>& paired,
                             std::vector<SampledCurve>& rest) {
    for (std::size_t i = 0; i < all.size(); ++i) {
      weight += all[i].length / 2;
      if (paired[i]) continue;
      sum += all[i].length / 2 * kFarthestMove * kFarthestMove;
      rest.push_back(all[i]);
    }
  };
  take_rest(a, paired_a, result.dying);
  take_rest(b, paired_b, result.being_born);
  result.length = weight > 0 ? std::sqrt(sum / weight) : 0;
  return result;
}

}  // namespace emberfold::graph::detail
