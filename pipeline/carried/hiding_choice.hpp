// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "core/rng.hpp"
#include "pipeline/carried/seen_clip.hpp"

namespace emberfold::pipeline {

/// Patches of a frame by their vertex indices.
using PatchSet = std::vector<std::uint32_t>;

/// Chooses the strokes of a clip to hide: of those allowed, the ones whose absence is least visible.
class HidingChoice {
 public:
  static constexpr int kTries = 24;  ///< maximum number of sets compared

  explicit HidingChoice(std::shared_ptr<const SeenClip> clip) : clip_(std::move(clip)) {}

  /// Decides whether a stroke born in frame t is hidden: the share 1 − `births` of all, and of successive
  /// births those that can be hidden best.
  [[nodiscard]] bool leaves_out(int t, const PatchSet& stroke, double births);
  /// Returns to the state before the first stroke.
  void forget() { owed_ = 0, misfits_.clear(); }
  /// Returns, of up to kTries sets of frame t, the one that can be hidden best; nothing without sets.
  [[nodiscard]] std::optional<PatchSet> least_visible(int t, std::vector<PatchSet> sets,
                                                      core::Rng& rng) const;

 private:
  [[nodiscard]] double misfit(int t, const PatchSet& patches) const;

  std::shared_ptr<const SeenClip> clip_;
  double owed_ = 0;              // births that are still to be left out
  std::vector<double> misfits_;  // misfits of hiding the most recent births
};

/// Returns patches of frame t.
std::vector<graph::Patch> patches_of(const SeenClip& clip, int t, const PatchSet& vertices);

}  // namespace emberfold::pipeline
