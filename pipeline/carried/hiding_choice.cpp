// SPDX-License-Identifier: Apache-2.0
#include "pipeline/carried/hiding_choice.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>

#include "pipeline/carried/hidden_place.hpp"

namespace emberfold::pipeline {

namespace {

constexpr double kMostOwed = 4;          // strokes still to be hidden at which the next one always is
constexpr std::size_t kRemembered = 32;  // newborn strokes that the next one is compared with

}  // namespace

std::vector<graph::Patch> patches_of(const SeenClip& clip, int t, const PatchSet& vertices) {
  std::vector<graph::Patch> patches;
  for (const auto v : vertices) patches.push_back(clip.graph(t).patch(v));
  return patches;
}

/// Returns the cost of hiding these patches, grey levels: the difference between what hides them and its
/// surroundings, and the difference between their two sides. The border between two things cannot be hidden.
double HidingChoice::misfit(int t, const PatchSet& vertices) const {
  const auto patches = patches_of(*clip_, t, vertices);
  double parted = 0;
  for (const auto& patch : patches)
    for (std::size_t c = 0; c < 3; ++c)
      parted += std::abs(double{patch.right[c]} - double{patch.left[c]}) / 3;
  return find_hidden_place(*clip_, t, patches).misfit + parted / static_cast<double>(patches.size());
}

bool HidingChoice::leaves_out(int t, const PatchSet& stroke, double births) {
  if (births >= 1) return false;
  const double own = misfit(t, stroke);
  const auto better = std::ranges::count_if(misfits_, [&](double other) { return other < own; });
  misfits_.push_back(own);
  if (misfits_.size() > kRemembered) misfits_.erase(misfits_.begin());
  owed_ += 1 - births;
  const bool is_hidden = static_cast<double>(better) < (1 - births) * static_cast<double>(misfits_.size());
  const bool now = owed_ >= kMostOwed || (owed_ > 0 && is_hidden);
  if (now) owed_ -= 1;
  return now;
}

std::optional<PatchSet> HidingChoice::least_visible(int t, std::vector<PatchSet> sets, core::Rng& rng) const {
  std::optional<PatchSet> best;
  double least = std::numeric_limits<double>::infinity();
  for (int i = 0; i < kTries && !sets.empty(); ++i) {
    std::swap(sets[rng.below(static_cast<std::uint32_t>(sets.size()))], sets.back());
    if (const double own = misfit(t, sets.back()); own < least) least = own, best = std::move(sets.back());
    sets.pop_back();
  }
  return best;
}

}  // namespace emberfold::pipeline
