// SPDX-License-Identifier: Apache-2.0
#include "mcmc/sampler/ratio_check.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <utility>

namespace emberfold::mcmc {

namespace {

/// Enumerates all outcomes of a move's draws.
class EveryDraw final : public ChoiceSource {
 public:
  std::size_t below(std::size_t count) override {
    return branch(std::vector<double>(count, 1 / static_cast<double>(count)));
  }
  std::size_t pick(std::span<const double> weights) override {
    return branch({weights.begin(), weights.end()});
  }
  double normal(double mean, double sd) override {
    chance_ /= sd * std::sqrt(2 * std::numbers::pi);
    return mean;
  }
  /// Returns the probability, or density, of the draws since begin().
  [[nodiscard]] double chance() const { return chance_; }
  void begin() { chance_ = 1, at_ = 0; }
  /// Advances to the next outcome; false after the last.
  bool advance() {
    while (!ways_.empty() && ways_.back().first + 1 == ways_.back().second) ways_.pop_back();
    if (ways_.empty()) return false;
    ++ways_.back().first;
    return true;
  }

 private:
  std::size_t branch(const std::vector<double>& weights) {
    if (at_ == ways_.size()) ways_.emplace_back(0, weights.size());
    const std::size_t taken = ways_[at_++].first;
    chance_ *= weights[taken];
    return taken;
  }
  std::vector<std::pair<std::size_t, std::size_t>> ways_;  ///< taken, of how many
  std::size_t at_ = 0;
  double chance_ = 1;
};

/// All of a state that can change, in a fixed order.
using Key = std::vector<std::uint64_t>;
Key key(const HiddenGraph& g) {
  Key key;
  for (Index i = 0; i < g.size(); ++i) {
    if (!g[i].active) continue;
    key.push_back(i);
    std::vector<Index> ties(g[i].edges.begin(), g[i].edges.end());
    ties.insert(ties.end(), g[i].next.begin(), g[i].next.end());
    std::ranges::sort(ties);
    for (const Index j : ties) key.push_back((std::uint64_t{i} + 1) << 32U | j);
  }
  return key;
}

struct Reached {
  double chance = 0;            ///< of all draws that lead there
  std::vector<double> claimed;  ///< ratios, of each
  std::vector<double> chances;
};

struct States {
  std::vector<HiddenGraph> list;
  std::vector<double> density;
  std::map<Key, std::size_t> known;

  std::size_t add(const HiddenGraph& g, const Density& density_of) {
    const auto [at, isNew] = known.emplace(key(g), list.size());
    if (isNew) {
      list.push_back(g);
      density.push_back(density_of.total(g));
    }
    return at->second;
  }
};

/// States that the move reaches from this one, with their probabilities.
std::map<std::size_t, Reached> follow(States& states, std::size_t from, const Density& density,
                                      const CheckedMove& move, int frame, RatioReport& report) {
  std::map<std::size_t, Reached> reached;
  HiddenGraph g = states.list[from];
  const std::uint64_t hash = g.hash();
  FactorCache cache;
  cache.resize(g.size());
  StateChange change(g, density, cache);
  EveryDraw draws;
  do {
    draws.begin();
    if (const auto ratio = move(change, draws, frame)) {
      const double gain = change.gain();
      if (std::isfinite(gain)) {
        const std::size_t to = states.add(g, density);
        report.worst_gain =
            std::max(report.worst_gain, std::abs(gain - (states.density[to] - states.density[from])));
        Reached& there = reached[to];
        there.chance += draws.chance();
        there.claimed.push_back(gain + *ratio);
        there.chances.push_back(draws.chance());
      }
    }
    change.rollback();
    report.restored = report.restored && g.hash() == hash;
  } while (draws.advance());
  return reached;
}

using Kernel = std::vector<std::map<std::size_t, Reached>>;

/// π of each state, summing to 1.
std::vector<double> normalised(const std::vector<double>& log_density) {
  const double most = *std::ranges::max_element(log_density);
  std::vector<double> pi;
  double sum = 0;
  for (const double l : log_density) pi.push_back(std::exp(l - most)), sum += pi.back();
  for (double& p : pi) p /= sum;
  return pi;
}

void compare(const States& states, const std::vector<double>& pi, const Kernel& kernel, RatioReport& report) {
  // Draws with a density have no probability: the kernel is checked as a flow, scaled by the drawn density.
  const auto flow = [&](std::size_t x, const Reached& to) {
    double sum = 0;
    for (std::size_t k = 0; k < to.claimed.size(); ++k)
      sum += to.chances[k] * std::min(1.0, std::exp(to.claimed[k]));
    return pi[x] * sum;
  };
  for (std::size_t x = 0; x < kernel.size(); ++x)
    for (const auto& [y, there] : kernel[x]) {
      if (y == x) continue;
      ++report.transitions;
      const auto back = kernel[y].find(x);
      if (back == kernel[y].end()) {
        report.worst_ratio = report.worst_balance = std::numeric_limits<double>::infinity();
        continue;
      }
      const double enumerated =
          states.density[y] - states.density[x] + std::log(back->second.chance) - std::log(there.chance);
      for (const double claimed : there.claimed)
        report.worst_ratio = std::max(report.worst_ratio, std::abs(claimed - enumerated));
      report.worst_balance = std::max(report.worst_balance, std::abs(flow(x, there) - flow(y, back->second)));
    }
}

std::size_t count_classes(const std::vector<std::vector<std::size_t>>& to) {
  // All moves have a way back, or worst_ratio is infinite, so reachability gives the classes.
  std::vector<bool> seen(to.size(), false);
  std::size_t classes = 0;
  for (std::size_t x = 0; x < to.size(); ++x) {
    if (seen[x]) continue;
    ++classes;
    std::vector<std::size_t> open{x};
    seen[x] = true;
    while (!open.empty()) {
      const std::size_t at = open.back();
      open.pop_back();
      for (const std::size_t y : to[at])
        if (!seen[y]) seen[y] = true, open.push_back(y);
    }
  }
  return classes;
}

}  // namespace

RatioReport check_ratios(const HiddenGraph& start, const Density& density,
                         const std::vector<CheckedMove>& moves, std::size_t most) {
  RatioReport report;
  States states;
  states.add(start, density);
  std::vector<Kernel> kernels(moves.size() * static_cast<std::size_t>(start.frames()));
  std::vector<std::vector<std::size_t>> to;
  for (std::size_t x = 0; x < states.list.size(); ++x) {
    if (x == most) {
      report.complete = false;
      break;
    }
    to.emplace_back();
    std::size_t k = 0;
    for (const auto& move : moves)
      for (int frame = 0; frame < start.frames(); ++frame, ++k) {
        kernels[k].push_back(follow(states, x, density, move, frame, report));
        for (const auto& [y, there] : kernels[k].back()) to[x].push_back(y);
      }
  }
  report.states = to.size();
  if (!report.complete) return report;
  const auto pi = normalised(states.density);
  for (const Kernel& kernel : kernels) compare(states, pi, kernel, report);
  report.classes = count_classes(to);
  return report;
}

}  // namespace emberfold::mcmc
