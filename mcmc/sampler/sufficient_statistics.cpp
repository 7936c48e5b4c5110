// SPDX-License-Identifier: Apache-2.0
#include "mcmc/sampler/sufficient_statistics.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <type_traits>

#include <Eigen/Cholesky>
#include <Eigen/Core>

namespace emberfold::mcmc {

namespace {

using graph::Point;

void add_outcome(const HiddenGraph& g, Index v, SufficientStatistics& t) {
  const std::size_t c = outcome_context_of(g, v);
  const Outcome what = outcome(g, v);
  t.outcome[c][static_cast<std::size_t>(what)] += 1;
  t.exposed[c] += std::exp2(0.5 * (static_cast<double>(g[v].place) - kPlaces / 2));
  if (merge_targets(g, v) == 0) t.no_target[c] += 1;
  if (what == Outcome::split) t.splits += 1, t.more_parts += static_cast<double>(g[v].next.size()) - 2;
}

void add_displacement(const HiddenGraph& g, Index w, SufficientStatistics& t) {
  const Index v = parent(g, w);
  const Node &node = g[w], &past = g[v];
  if (past.prev.size() != 1) return;
  const Node& before = g[past.prev[0]];
  const double y = sense(past, node) * node.displacement;
  const std::array z = {past.displacement, sense(before, past) * before.displacement,
                        neighbour_displacement(g, v) - past.displacement};
  std::size_t k = 0;
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j <= i; ++j) t.displacement_zz[k++] += z[i] * z[j];
  for (std::size_t i = 0; i < 3; ++i) t.displacement_zy[i] += z[i] * y;
  t.displacement_yy += y * y;
  t.displacement_count += 1;
}

// Expected square at the narrower spread: an outlier counts 1 / kOutlierScale² (kOutlierShare).
double narrow_square(double x, double sd) {
  const double wide = Density::outlier_probability(x / sd);
  return x * x * (1 - wide + wide / (kOutlierScale * kOutlierScale));
}

void add_survival(const HiddenGraph& g, Index w, const SamplerParameters& theta, SufficientStatistics& t) {
  const Index v = parent(g, w);
  const double wider = g[v].next.size() > 1 ? theta.split_spread : 1;
  const TransitionOffset& offset = g.offset(v, w);
  const double across = (offset.across - (offset.sense * g[w].displacement - g[v].displacement)) / wider;
  const double along = offset.along / wider;
  t.survival += 1;
  t.across2 += across * across, t.along2 += along * along;
  t.turn2 += narrow_square(offset.turn, theta.turn);
  t.flicker2 += narrow_square(offset.flicker, theta.flicker);
}

void add_grown(const Node& from, const Node& w, double share, const SamplerParameters& theta,
               SufficientStatistics& t) {
  const Point apart = w.patch.position - from.patch.position;
  const double along = std::abs(graph::dot(apart, from.tangent)), side = graph::dot(apart, from.normal());
  const double bend = turn_between(from, w), contrast = w.log_contrast - from.log_contrast;
  // Counts as grown along the curve if near its usual step, side and bend, else as a branch.
  const double z = (along - theta.step) / theta.step_sd, u = side / theta.side_sd, b = bend / theta.bend_sd;
  const bool on_curve = z * z + u * u + b * b < 14;
  (on_curve ? t.grown_along_curve : t.grown_elsewhere) += share;
  if (on_curve) {
    t.step += share * along, t.step2 += share * along * along;
    t.side2 += share * side * side, t.bend2 += share * bend * bend;
  }
  t.grown_contrast2 += share * contrast * contrast;
  if (from.kind != w.kind) t.other_kind += share;
}

void add_new(const HiddenGraph& g, Index w, const Density& density, SufficientStatistics& t) {
  const Node& node = g[w];
  const std::size_t epoch = node.frame == 0 ? 0 : 1;
  const auto origins = density.origins(g, w);
  t.begun[epoch] += origins.begun;
  t.contrast += origins.begun * node.log_contrast;
  t.contrast2 += origins.begun * node.log_contrast * node.log_contrast;
  t.kinds[static_cast<std::size_t>(node.kind)] += origins.begun;
  for (const NeighbourCandidate& near : g.neighbours(w)) {
    const Node& other = g[near.node];
    if (!other.active || (other.prev.empty() && !g.precedes(near.node, w))) continue;
    auto& close = t.close[epoch][near.closeness];
    const std::size_t k = origins.from.find(near.node);
    if (k == origins.from.size()) {
      close.exposure += 1;
      continue;
    }
    const double share = origins.shares[k];
    close.joined += 1 - share, close.exposure += 1 - share;
    (epoch == 0 ? t.first_grown : t.grown[parent_class(g, near.node)]) += share;
    add_grown(other, node, share, density.theta(), t);
  }
}

void add_pairs(const HiddenGraph& g, Index a, SufficientStatistics& t) {
  if (g[a].prev.empty()) return;
  for (const NeighbourCandidate& near : g.neighbours(a)) {
    if (near.node < a || !g[near.node].active || g[near.node].prev.empty()) continue;
    auto& pair = t.join[static_cast<std::size_t>(previous_adjacency(g, a, near.node))][near.closeness];
    pair.exposure += 1;
    pair.joined += g[a].edges.has(near.node) ? 1 : 0;
  }
}

double chance(double events, double exposure, double prior, double weight) {
  return std::clamp((events + weight * prior) / (exposure + weight), 1e-6, 1 - 1e-6);
}
/// SD from a sum of squares and `weight` more at the prior's SD.
double spread(double squares, double count, double prior, double weight) {
  return std::sqrt((squares + weight * prior * prior) / (count + weight));
}

void learn_outcomes(const SufficientStatistics& t, const SamplerParameters& prior, double weight,
                    SamplerParameters& theta) {
  for (std::size_t c = 0; c < kOutcomeContexts; ++c) {
    const auto& n = t.outcome[c];
    // Occasions without a patch to merge into: merges count as often as they would have happened.
    const double virtual_merges = t.no_target[c] * prior.outcome[c][3] / (1 - prior.outcome[c][3]);
    const double died = chance(n[0], t.exposed[c] + virtual_merges, prior.outcome[c][0], weight);
    const double stayed = n[1] + n[2] + n[3] + virtual_merges, alive = 1 - prior.outcome[c][0];
    const double split = chance(n[2], stayed, prior.outcome[c][2] / alive, weight);
    const double merge = chance(n[3] + virtual_merges, stayed, prior.outcome[c][3] / alive, weight);
    theta.outcome[c] = {died, (1 - died) * (1 - split - merge), (1 - died) * split, (1 - died) * merge};
  }
  theta.split_more = chance(t.more_parts, t.splits + t.more_parts, prior.split_more, weight);
}

void learn_edges(const SufficientStatistics& t, const SamplerParameters& prior, double weight,
                 SamplerParameters& theta) {
  for (std::size_t k = 0; k < kCloseness; ++k) {
    for (std::size_t w = 0; w < 3; ++w)
      theta.join[w][k] = chance(t.join[w][k].joined, t.join[w][k].exposure, prior.join[w][k], weight);
    for (std::size_t e = 0; e < 2; ++e)
      theta.close[e][k] = chance(t.close[e][k].joined, t.close[e][k].exposure, prior.close[e][k], weight);
  }
}

void learn_births(const SufficientStatistics& t, const SamplerParameters& prior, double area, double weight,
                  SamplerParameters& theta) {
  const auto rate = [&](double n, double exposure, double usual) {
    return (n + weight * usual) / (exposure + weight);
  };
  theta.birth[0] = (t.begun[0] + 0.5) / (area + 0.5 / prior.birth[0]);
  theta.birth[1] = (t.begun[1] + 0.5) / (area * t.later_frames + 0.5 / prior.birth[1]);
  for (std::size_t k = 0; k < kParentClasses; ++k) {
    const double exposure = t.parents[k] * (k == 3 ? 0.5 : 1);
    theta.growth[k] = rate(t.grown[k], exposure, prior.growth[k]);
  }
  theta.first_growth = rate(t.first_grown, t.first_parents / 2, prior.first_growth);
  const double begun = t.begun[0] + t.begun[1];
  const double mean = (t.contrast + weight * prior.new_contrast) / (begun + weight);
  theta.new_contrast = mean;
  theta.new_contrast_sd = spread(std::max(0.0, t.contrast2 - 2 * mean * t.contrast + begun * mean * mean),
                                 begun, prior.new_contrast_sd, weight);
  double kinds = 0;
  for (std::size_t k = 0; k < 3; ++k) kinds += theta.kinds[k] = t.kinds[k] + weight * prior.kinds[k];
  for (double& p : theta.kinds) p = std::clamp(p / kinds, 1e-3, 1 - 2e-3);
  const double sum = theta.kinds[0] + theta.kinds[1] + theta.kinds[2];
  for (double& p : theta.kinds) p /= sum;
}

void learn_growth(const SufficientStatistics& t, const SamplerParameters& prior, double weight,
                  SamplerParameters& theta) {
  const double n = t.grown_along_curve, all = n + t.grown_elsewhere;
  theta.branch = std::clamp(chance(t.grown_elsewhere, all, prior.branch, weight), 0.01, 0.5);
  theta.step = (t.step + weight * prior.step) / (n + weight);
  theta.step_sd = spread(std::max(0.0, t.step2 - 2 * theta.step * t.step + n * theta.step * theta.step), n,
                         prior.step_sd, weight);
  theta.side_sd = spread(t.side2, n, prior.side_sd, weight);
  theta.bend_sd = spread(t.bend2, n, prior.bend_sd, weight);
  theta.grown_contrast_sd = spread(t.grown_contrast2, all, prior.grown_contrast_sd, weight);
  theta.other_kind = std::clamp(chance(t.other_kind, all, prior.other_kind, weight), 1e-4, 0.5);
}

Autoregression learn_displacement(const SufficientStatistics& t, const Autoregression& prior, double weight) {
  if (t.displacement_count < 10) return prior;
  Eigen::Matrix3d zz;
  std::size_t k = 0;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j <= i; ++j) zz(i, j) = zz(j, i) = t.displacement_zz[k++];
  const Eigen::Vector3d zy(t.displacement_zy[0], t.displacement_zy[1], t.displacement_zy[2]);
  const Eigen::Vector3d mean(prior.a1, prior.a2, prior.coupling);
  const double ridge = weight * zz.trace() / 3 / t.displacement_count;
  const Eigen::Matrix3d sum = zz + ridge * Eigen::Matrix3d::Identity();
  Eigen::Vector3d a = sum.ldlt().solve(zy + ridge * mean);
  if (!(a[2] >= 0 && a[2] < 0.5)) {  // the coupling is no push apart
    a[2] = a[2] < 0 ? 0 : 0.5;
    const Eigen::Vector2d rest =
        sum.topLeftCorner<2, 2>().ldlt().solve((zy + ridge * mean).head<2>() - a[2] * sum.block<2, 1>(0, 2));
    a[0] = rest[0], a[1] = rest[1];
  }
  Autoregression displacement = prior;
  displacement.a1 = a[0], displacement.a2 = a[1], displacement.coupling = a[2];
  const double squares = t.displacement_yy - 2 * a.dot(zy) + a.dot(zz * a);
  displacement.noise = spread(std::max(squares, 0.0), t.displacement_count, prior.noise, weight);
  for (double radius = spectral_radius(displacement); radius > 0.995;
       radius = spectral_radius(displacement)) {
    const double scale = 0.9949 / radius;
    displacement.a1 *= scale, displacement.a2 *= scale * scale, displacement.coupling *= scale;
  }
  return displacement;
}

}  // namespace

void SufficientStatistics::blend(const SufficientStatistics& other, double gamma) {
  static_assert(std::is_trivially_copyable_v<SufficientStatistics> &&
                sizeof(SufficientStatistics) % sizeof(double) == 0);
  // All members are doubles.
  std::array<double, sizeof(SufficientStatistics) / sizeof(double)> mine{}, theirs{};
  std::memcpy(mine.data(), this, sizeof(SufficientStatistics));
  std::memcpy(theirs.data(), &other, sizeof(SufficientStatistics));
  for (std::size_t i = 0; i < mine.size(); ++i) mine[i] += gamma * (theirs[i] - mine[i]);
  std::memcpy(static_cast<void*>(this), mine.data(), sizeof(SufficientStatistics));
}

SufficientStatistics sufficient_statistics(const HiddenGraph& g, const Density& density) {
  SufficientStatistics t;
  t.later_frames = g.frames() - 1;
  for (Index i = 0; i < g.size(); ++i) {
    if (!g[i].active) continue;
    if (g[i].frame + 1 < g.frames()) add_outcome(g, i, t);
    if (g[i].frame == 0) {
      t.first_parents += 1;
    } else {
      t.parents[parent_class(g, i)] += 1;
    }
    add_pairs(g, i, t);
    if (g[i].prev.empty()) {
      add_new(g, i, density, t);
    } else {
      add_survival(g, i, density.theta(), t);
      add_displacement(g, i, t);
    }
  }
  return t;
}

SamplerParameters most_likely_parameters(const SufficientStatistics& t, const SamplerParameters& prior,
                                         double area, double weight) {
  SamplerParameters theta = prior;
  learn_outcomes(t, prior, weight, theta);
  learn_edges(t, prior, weight, theta);
  learn_births(t, prior, area, weight, theta);
  learn_growth(t, prior, weight, theta);
  theta.across = spread(t.across2, t.survival, prior.across, weight);
  theta.along = spread(t.along2, t.survival, prior.along, weight);
  theta.turn = spread(t.turn2, t.survival, prior.turn, weight);
  theta.flicker = spread(t.flicker2, t.survival, prior.flicker, weight);
  theta.displacement = learn_displacement(t, prior.displacement, weight);
  return theta;
}

}  // namespace emberfold::mcmc
