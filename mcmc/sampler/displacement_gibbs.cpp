// SPDX-License-Identifier: Apache-2.0
#include "mcmc/sampler/displacement_gibbs.hpp"

#include <algorithm>
#include <cmath>

namespace emberfold::mcmc {

namespace {

/// A residual that is linear in the displacements, and its variance.
struct Residual {
  struct Term {
    Index node;
    double factor;
  };
  double rest = 0, variance = 1;
  std::array<Term, kMostEdges + 3> terms;
  std::size_t count = 0;

  void add(Index node, double factor) { terms[count++] = {node, factor}; }
};

/// Residuals of w's displacement (Density::log_displacement), linear in the displacements: motion and
/// measurement.
std::array<Residual, 2> residuals(const HiddenGraph& g, const SamplerParameters& theta, Index w,
                                  double stationary) {
  std::array<Residual, 2> result;
  Residual &on = result[0], &seen = result[1];
  const Node& node = g[w];
  on.add(w, 1);
  on.variance = stationary;
  seen.variance = 0;
  if (node.prev.empty()) return result;
  const Autoregression& m = theta.displacement;
  const Index v = parent(g, w);
  const Node& past = g[v];
  const double same = sense(past, node);
  if (past.prev.size() == 1) {
    const Index before = past.prev[0];
    const bool coupled = !past.edges.empty();
    on.add(v, -same * (m.a1 - (coupled ? m.coupling : 0)));
    on.add(before, -same * m.a2 * sense(g[before], past));
    if (coupled && m.coupling != 0)
      for (const Index u : past.edges)
        on.add(u, -same * m.coupling * sense(past, g[u]) / static_cast<double>(past.edges.size()));
    on.variance = m.noise * m.noise;
  } else {
    const double lag_one = m.a1 / (1 - m.a2);
    on.add(v, -same * lag_one);
    on.variance = stationary * (1 - lag_one * lag_one);
  }
  const double sd = theta.across * (past.next.size() > 1 ? theta.split_spread : 1);
  seen.variance = sd * sd;
  seen.rest = g.offset(v, w).across;
  seen.add(w, -same);
  seen.add(v, 1);
  return result;
}

/// Nodes whose residuals depend on a path's displacements.
std::vector<Index> touched(const HiddenGraph& g, const std::vector<Index>& path, bool coupled) {
  std::vector<Index> list(path);
  for (const Index c : g[path.back()].next) {
    list.push_back(c);
    list.insert(list.end(), g[c].next.begin(), g[c].next.end());
  }
  if (coupled)
    for (const Index i : path)
      for (const Index u : g[i].edges) list.insert(list.end(), g[u].next.begin(), g[u].next.end());
  // A path's last node but one is the grandparent of the nodes that continue its last.
  std::ranges::sort(list);
  list.erase(std::unique(list.begin(), list.end()), list.end());
  return list;
}

}  // namespace

std::vector<std::vector<Index>> find_paths(const HiddenGraph& g) {
  std::vector<std::vector<Index>> result;
  for (Index i = 0; i < g.size(); ++i) {
    if (!g[i].active) continue;
    if (!g[i].prev.empty() && outcome(g, parent(g, i)) == Outcome::survival) continue;
    std::vector<Index> path{i};
    for (Index v = i; outcome(g, v) == Outcome::survival;) path.push_back(v = g[v].next[0]);
    result.push_back(std::move(path));
  }
  return result;
}

DisplacementGaussian displacement_given_rest(const HiddenGraph& g, const Density& density,
                                             const std::vector<Index>& path) {
  const SamplerParameters& theta = density.theta();
  const std::size_t n = path.size();
  const int first = g[path[0]].frame;
  const auto at = [&](Index i) {
    const int k = g[i].frame - first;
    return k >= 0 && k < static_cast<int>(n) && path[static_cast<std::size_t>(k)] == i ? k : -1;
  };
  const double sd = density.stationary_sd();
  DisplacementGaussian result;
  auto& band = result.factor;  // of the precision, then of its factor
  band.assign(n, {0, 0, 0});
  std::vector<double> shift(n, 0);
  for (const Index w : touched(g, path, theta.displacement.coupling != 0)) {
    for (const Residual& r : residuals(g, theta, w, sd * sd)) {
      if (r.variance <= 0) continue;
      double rest = r.rest;
      std::array<std::pair<std::size_t, double>, kMostEdges + 3> mine;
      std::size_t count = 0;
      for (std::size_t k = 0; k < r.count; ++k) {
        const auto [node, factor] = r.terms[k];
        if (const int place = at(node); place >= 0)
          mine[count++] = {static_cast<std::size_t>(place), factor};
        else
          rest += factor * g[node].displacement;
      }
      for (std::size_t a = 0; a < count; ++a) {
        shift[mine[a].first] -= mine[a].second * rest / r.variance;
        for (std::size_t b = 0; b < count; ++b)
          if (mine[b].first <= mine[a].first)
            band[mine[a].first][2 - (mine[a].first - mine[b].first)] +=
                mine[a].second * mine[b].second / r.variance;
      }
    }
  }
  for (std::size_t i = 0; i < n; ++i) {
    auto& row = band[i];
    if (i >= 2) row[0] /= band[i - 2][2];
    if (i >= 1) row[1] = (row[1] - (i >= 2 ? row[0] * band[i - 1][1] : 0)) / band[i - 1][2];
    row[2] = std::sqrt(row[2] - row[0] * row[0] - row[1] * row[1]);
  }
  auto& x = result.mean;
  x = shift;
  for (std::size_t i = 0; i < n; ++i) {
    if (i >= 1) x[i] -= band[i][1] * x[i - 1];
    if (i >= 2) x[i] -= band[i][0] * x[i - 2];
    x[i] /= band[i][2];
  }
  for (std::size_t i = n; i-- > 0;) {
    if (i + 1 < n) x[i] -= band[i + 1][1] * x[i + 1];
    if (i + 2 < n) x[i] -= band[i + 2][0] * x[i + 2];
    x[i] /= band[i][2];
  }
  return result;
}

void draw_displacements(HiddenGraph& g, const Density& density, const std::vector<Index>& path,
                        ChoiceSource& draws) {
  const DisplacementGaussian given = displacement_given_rest(g, density, path);
  const auto& band = given.factor;
  const std::size_t n = path.size();
  std::vector<double> x(n);
  for (std::size_t i = n; i-- > 0;) {
    x[i] = draws.normal(0, 1);
    if (i + 1 < n) x[i] -= band[i + 1][1] * x[i + 1];
    if (i + 2 < n) x[i] -= band[i + 2][0] * x[i + 2];
    x[i] /= band[i][2];
  }
  for (std::size_t i = 0; i < n; ++i) g.set_displacement(path[i], given.mean[i] + x[i]);
}

}  // namespace emberfold::mcmc
