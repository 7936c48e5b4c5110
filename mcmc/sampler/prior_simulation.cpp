// SPDX-License-Identifier: Apache-2.0
#include "mcmc/sampler/prior_simulation.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include "core/error.hpp"

namespace emberfold::mcmc {

namespace {

using graph::Patch;
using graph::Point;
using std::numbers::pi;

int poisson(core::Rng& rng, double mean) {
  // Knuth's product of uniforms; means here are small.
  int n = 0;
  for (double left = mean; left > 0; left -= 500) {
    const double floor = std::exp(-std::min(left, 500.0));
    for (double product = rng.uniform(); product > floor; product *= rng.uniform()) ++n;
  }
  return n;
}

// Factor of a spread: kOutlierScale for errors of the sketch, else 1.
double draw_outlier_scale(core::Rng& rng) {
  return rng.uniform() < kOutlierShare ? kOutlierScale : 1;
}

double draw_turned(core::Rng& rng, double theta, double sd) {
  double turn = 0;
  do turn = sd * rng.normal();
  while (std::abs(turn) > pi / 2);
  return std::remainder(theta + turn + (rng.below(2) == 1 ? pi : 0), 2 * pi);
}

Patch make_patch(Point at, double theta, double log_contrast, Kind kind) {
  Patch patch;
  patch.position = at;
  patch.theta = theta;
  patch.width = kind == Kind::step ? 0 : 2;
  patch.contrast = (kind == Kind::dark ? -1 : 1) * std::expm1(log_contrast);
  return patch;
}

class PriorSimulator {
 public:
  PriorSimulator(const SamplerParameters& theta, HiddenGraph& g, core::Rng& rng)
      : theta_(theta), density_(theta), g_(g), rng_(rng) {}

  void frame(int t) {
    if (t > 0) go_on(t - 1);
    join_survivors(t);
    add_births(t);
  }

 private:
  /// Patch born in a frame, before its index is known.
  struct Birth {
    Patch patch;
    Index from = kNone;                    ///< a node that goes on
    std::size_t parent = ~std::size_t{0};  ///< or one of the births before
  };

  Index activate_new(int t, const Patch& patch) {
    const Index i = g_.add_candidate(t, patch);
    const Point p = patch.position;
    if (!(p.x >= 0 && p.y >= 0 && p.x <= g_.width() && p.y <= g_.height()))
      g_.set_map_values(i, -std::numeric_limits<double>::infinity(), kPlaces / 2,
                        {});  // it can only have grown
    g_.activate(i);
    return i;
  }
  std::vector<Index> in_order(int t) const {
    std::vector<Index> list(g_.active(t).begin(), g_.active(t).end());
    std::ranges::sort(list, [&](Index a, Index b) { return g_.precedes(a, b); });
    return list;
  }

  void go_on(int t) {
    // Outcomes in order; a merge waits until its target has been continued.
    for (const Index v : in_order(t)) {
      const std::size_t targets = merge_targets(g_, v);
      auto chances = theta_.outcome[outcome_context_of(g_, v)];
      if (targets == 0) chances[3] = 0;
      const auto what = static_cast<Outcome>(rng_.categorical(chances));
      if (what == Outcome::death) continue;
      if (what == Outcome::merge) {
        std::vector<Index> into;
        for (const Index host : g_.hosts(v))
          if (g_.continues(host)) into.push_back(host);
        const Index u = into[rng_.below(static_cast<std::uint32_t>(into.size()))];
        link(v, g_[u].next[0]);
        continue;
      }
      int parts = 1;
      if (what == Outcome::split) do
          for (parts = 2; rng_.uniform() < theta_.split_more;) ++parts;
        while (parts > static_cast<int>(kMostLinks));
      for (int k = 0; k < parts; ++k) successor(v, parts > 1);
    }
  }

  void successor(Index v, bool split) {
    const Node past = g_[v];
    const double wider = split ? theta_.split_spread : 1;
    // The displacement is along the normal, which a turn by π may reverse.
    const double theta = draw_turned(rng_, past.patch.theta, draw_outlier_scale(rng_) * theta_.turn);
    Patch patch = make_patch(
        {}, theta, past.log_contrast + draw_outlier_scale(rng_) * theta_.flicker * rng_.normal(), past.kind);
    const Point tangent{std::cos(theta), std::sin(theta)};
    const double same = graph::dot(tangent, past.tangent) < 0 ? -1 : 1;
    const auto displacement = density_.displacement_given_past(g_, v, same);
    const double d = displacement.mean + std::sqrt(displacement.variance) * rng_.normal();
    const double across = same * d - past.displacement + theta_.across * wider * rng_.normal();
    const double along = theta_.along * wider * rng_.normal();
    patch.position = past.patch.position + past.drift + past.normal() * across + past.tangent * along;
    const Index w = activate_new(past.frame + 1, patch);
    g_.set_displacement(w, d);
    link(v, w);
  }

  void link(Index v, Index w) {
    if (g_[v].next.full() || g_[w].prev.full()) return;
    g_.allow_link(v, w);
    g_.link(v, w);
  }

  void join_survivors(int t) {
    const auto all = in_order(t);
    for (const Index a : all)
      for (const NeighbourCandidate& b : g_.neighbours(a)) {
        if (b.node < a || !g_[b.node].active) continue;
        const auto& chance = theta_.join[static_cast<std::size_t>(previous_adjacency(g_, a, b.node))];
        if (rng_.uniform() < chance[b.closeness] && g_.can_add_edge(a, b.node)) g_.add_edge(a, b.node);
      }
  }

  Patch draw_grown(const Node& from) {
    Kind what = from.kind;
    if (rng_.uniform() < theta_.other_kind)
      what = static_cast<Kind>((static_cast<std::uint32_t>(what) + 1 + rng_.below(2)) % 3);
    const double contrast = from.log_contrast + theta_.grown_contrast_sd * rng_.normal();
    if (rng_.uniform() < theta_.branch) {
      const double r = theta_.branch_reach * std::sqrt(rng_.uniform()), a = rng_.uniform(-pi, pi);
      return make_patch(from.patch.position + Point{r * std::cos(a), r * std::sin(a)}, rng_.uniform(-pi, pi),
                        contrast, what);
    }
    const double along = (rng_.below(2) == 1 ? 1 : -1) * theta_.step + theta_.step_sd * rng_.normal();
    const double side = theta_.side_sd * rng_.normal();
    return make_patch(from.patch.position + from.tangent * along + from.normal() * side,
                      draw_turned(rng_, from.patch.theta, theta_.bend_sd), contrast, what);
  }

  void grow(const Node& from, double mean, bool onwards, const Birth& as, std::vector<Birth>& births) {
    for (int n = poisson(rng_, mean); n > 0; --n) {
      Birth birth = as;
      birth.patch = draw_grown(from);
      const Point p = birth.patch.position;
      if (onwards && !(0.8 * p.x + 0.6 * p.y > from.order)) continue;
      births.push_back(birth);
    }
  }

  void add_births(int t) {
    std::vector<Birth> births;
    const double mean = theta_.birth[t == 0 ? 0 : 1] * g_.width() * g_.height();
    for (int n = poisson(rng_, mean); n > 0; --n) {
      const Point at{rng_.uniform(0, g_.width()), rng_.uniform(0, g_.height())};
      const double contrast = theta_.new_contrast + theta_.new_contrast_sd * rng_.normal();
      const auto what = static_cast<Kind>(rng_.categorical(theta_.kinds));
      births.push_back({make_patch(at, rng_.uniform(-pi, pi), contrast, what), kNone, ~std::size_t{0}});
    }
    for (const Index u : in_order(t))
      grow(g_[u], theta_.growth[parent_class(g_, u)], false, {{}, u, ~std::size_t{0}}, births);
    const double again = t == 0 ? theta_.first_growth : theta_.growth[3];
    std::vector<Index> born;
    for (std::size_t k = 0; k < births.size(); ++k) {
      if (births.size() > 100000)
        throw core::InputError("forward: growth does not end; its rate is too high");
      born.push_back(activate_new(t, births[k].patch));
      g_.set_displacement(born.back(), density_.stationary_sd() * rng_.normal());
      grow(g_[born.back()], again, true, {{}, kNone, k}, births);
    }
    for (std::size_t k = 0; k < births.size(); ++k) {
      const Index from = births[k].from != kNone               ? births[k].from
                         : births[k].parent != ~std::size_t{0} ? born[births[k].parent]
                                                               : kNone;
      if (from != kNone && g_.can_add_edge(born[k], from)) g_.add_edge(born[k], from);
    }
    const auto& close = theta_.close[t == 0 ? 0 : 1];
    for (const Index w : born)
      for (const NeighbourCandidate& near : g_.neighbours(w)) {
        const bool earlier = !g_[near.node].prev.empty() || g_.precedes(near.node, w);
        if (earlier && rng_.uniform() < close[near.closeness] && g_.can_add_edge(w, near.node))
          g_.add_edge(w, near.node);
      }
  }

  const SamplerParameters& theta_;
  Density density_;
  HiddenGraph& g_;
  core::Rng& rng_;
};

}  // namespace

HiddenGraph simulate_prior(const SamplerParameters& theta, int width, int height, int frames,
                           const Gates& gates, core::Rng& rng) {
  if (frames < 1)
    throw core::InputError("forward: " + std::to_string(frames) + " frames, allowed is 1 or more");
  validate(theta);
  HiddenGraph g(width, height, frames, gates);
  PriorSimulator simulator(theta, g, rng);
  for (int t = 0; t < frames; ++t) simulator.frame(t);
  return g;
}

}  // namespace emberfold::mcmc
