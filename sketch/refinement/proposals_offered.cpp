// SPDX-License-Identifier: Apache-2.0
// Strokes are created where they are offered.
#include <cmath>
#include <optional>

#include "sketch/refinement/proposals.hpp"

namespace emberfold::sketch {

using graph::Patch;
using graph::Point;

namespace {

constexpr std::size_t kLeast = 3;  // patches of a stroke

/// Patches of an offered curve, all moved across by `aside`; none for those that are not visible.
std::vector<std::optional<Patch>> seen_beside(ProposalBuilder& editor, const graph::AttributeGraph& offered,
                                              const graph::Curve& curve, double aside) {
  std::vector<std::optional<Patch>> seen;
  for (const auto v : curve) {
    const Patch& patch = offered.patch(v);
    const Point normal{-std::sin(patch.theta), std::cos(patch.theta)};
    auto found = editor.fit_like(patch, patch.position + normal * aside, patch.theta, patch.contrast);
    if (found && editor.overlaps(*found, {})) found.reset();
    if (found) found->evidence = patch.evidence;
    seen.push_back(found);
  }
  return seen;
}

double total_gain(const std::vector<std::optional<Patch>>& patches) {
  double nats = 0;
  for (const auto& patch : patches)
    if (patch) nats += patch->gain;
  return nats;
}

/// Each run of patches that show is a stroke.
void propose_runs(ProposalBuilder& editor, const std::vector<std::optional<Patch>>& patches) {
  for (std::size_t i = 0; i < patches.size();) {
    std::size_t end = i;
    while (end < patches.size() && patches[end]) ++end;
    GraphEdit edit;
    for (std::size_t k = i; k < end; ++k) {
      const Slot slot = editor.draft().slots() + static_cast<Slot>(k - i);
      edit.add_patches.emplace_back(slot, *patches[k]);
      if (k > i) edit.add_edges.push_back(make_edge(slot - 1, slot));
    }
    if (end - i >= kLeast) editor.propose(std::move(edit), {});
    i = end + 1;
  }
}

}  // namespace

void propose_offered(ProposalBuilder& editor, const graph::AttributeGraph& offered) {
  for (const graph::Curve& curve : graph::curves(offered)) {
    if (curve.size() < kLeast) continue;
    std::vector<std::optional<Patch>> best;
    for (const double aside : {0.0, -2.0, 2.0, -4.0, 4.0}) {
      auto seen = seen_beside(editor, offered, curve, aside);
      if (best.empty() || total_gain(seen) > total_gain(best)) best = std::move(seen);
    }
    propose_runs(editor, best);
  }
}

}  // namespace emberfold::sketch
