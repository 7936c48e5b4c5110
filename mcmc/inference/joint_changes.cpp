// SPDX-License-Identifier: Apache-2.0
#include "mcmc/inference/joint_changes.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "core/error.hpp"

namespace emberfold::mcmc {

namespace {

constexpr double kSurest = 1e-12;     // distance of a probability from 0 and 1: odds stay finite
constexpr double kNegligible = 1e-3;  // odds
constexpr double kBranches = 4096;    // of the walks from one change

/// Changes that happen together are one node; its odds are theirs, multiplied.
struct Node {
  double odds = 1;
  std::vector<std::size_t> excludes = {};
};

struct Field {
  std::vector<Node> nodes;
  std::vector<std::size_t> node_of;  // by change
};

void check(std::span<const double> probabilities, std::span<const ChangePair> pairs) {
  for (const double p : probabilities)
    if (!(p >= 0 && p <= 1))
      throw core::InputError("joint changes: a probability is " + std::to_string(p) + ", allowed is 0…1");
  for (const ChangePair& pair : pairs)
    if (pair.a >= probabilities.size() || pair.b >= probabilities.size() || pair.a == pair.b)
      throw core::InputError("joint changes: a pair of " + std::to_string(pair.a) + " and " +
                             std::to_string(pair.b) + " of " + std::to_string(probabilities.size()) +
                             " changes");
}

Field make_field(std::span<const double> probabilities, std::span<const ChangePair> together,
                 std::span<const ChangePair> exclusive) {
  constexpr auto kAlone = static_cast<std::size_t>(-1);
  std::vector<std::size_t> partner(probabilities.size(), kAlone);
  for (const ChangePair& pair : together) {
    if (partner[pair.a] != kAlone || partner[pair.b] != kAlone)
      throw core::InputError("joint changes: change " +
                             std::to_string(partner[pair.a] != kAlone ? pair.a : pair.b) +
                             " happens together with two others, allowed is one");
    partner[pair.a] = pair.b, partner[pair.b] = pair.a;
  }
  Field field;
  field.node_of.resize(probabilities.size());
  for (std::size_t k = 0; k < probabilities.size(); ++k) {
    const bool is_second = partner[k] != kAlone && partner[k] < k;
    field.node_of[k] = is_second ? field.node_of[partner[k]] : field.nodes.size();
    if (!is_second) field.nodes.emplace_back();
    const double p = std::clamp(probabilities[k], kSurest, 1 - kSurest);
    field.nodes[field.node_of[k]].odds *= p / (1 - p);
  }
  for (const ChangePair& pair : exclusive) {
    const std::size_t a = field.node_of[pair.a], b = field.node_of[pair.b];
    if (a == b || std::min(field.nodes[a].odds, field.nodes[b].odds) < kNegligible) continue;
    field.nodes[a].excludes.push_back(b), field.nodes[b].excludes.push_back(a);
  }
  for (Node& node : field.nodes) {
    std::ranges::sort(node.excludes);
    node.excludes.erase(std::unique(node.excludes.begin(), node.excludes.end()), node.excludes.end());
  }
  return field;
}

bool is_on(const std::vector<std::size_t>& walk, std::size_t node) {
  return std::ranges::find(walk, node) != walk.end();
}

/// Returns by how much odds fall that exclude something of these odds.
double excluded_share(double odds) {
  return (1 + kBothExclusive * odds) / (1 + odds);
}

/// Returns the odds of a node in the graph without the nodes of `walk`, which led to it.
/// The node is taken apart into one for each that it excludes: of the earlier of these the odds count as if
/// it happened, of the later ones as if not. Where the branches are used up, its rivals count as rivals of
/// each other.
double odds_beyond(Field& field, std::vector<std::size_t>& walk, std::size_t at, double branches) {
  const auto& excludes = field.nodes[at].excludes;
  double odds = field.nodes[at].odds;
  if (branches < 1) {
    double sum = 0;
    for (const std::size_t next : excludes)
      if (!is_on(walk, next)) sum += field.nodes[next].odds;
    return odds * excluded_share(sum);
  }
  walk.push_back(at);
  std::vector<std::pair<std::size_t, double>> before;  // odds of those that are done
  for (const std::size_t next : excludes) {
    if (is_on(walk, next)) continue;
    odds *= excluded_share(odds_beyond(field, walk, next, branches / static_cast<double>(excludes.size())));
    before.emplace_back(next, field.nodes[next].odds);
    field.nodes[next].odds *= kBothExclusive;
  }
  for (const auto& [node, own] : before) field.nodes[node].odds = own;
  walk.pop_back();
  return odds;
}

}  // namespace

std::vector<double> joint_probabilities(std::span<const double> probabilities,
                                        std::span<const ChangePair> together,
                                        std::span<const ChangePair> exclusive) {
  check(probabilities, together);
  check(probabilities, exclusive);
  Field field = make_field(probabilities, together, exclusive);
  std::vector<double> of_node;
  std::vector<std::size_t> walk;
  for (std::size_t k = 0; k < field.nodes.size(); ++k) {
    const double odds = odds_beyond(field, walk, k, kBranches);
    of_node.push_back(odds / (1 + odds));
  }
  std::vector<double> result;
  for (std::size_t k = 0; k < probabilities.size(); ++k) result.push_back(of_node[field.node_of[k]]);
  return result;
}

}  // namespace emberfold::mcmc
