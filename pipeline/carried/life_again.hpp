// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "core/rng.hpp"
#include "mcmc/model/rate_maps.hpp"
#include "pipeline/carried/seen_clip.hpp"

namespace emberfold::pipeline {

/// A stroke of a clip that is to be repeated.
struct LifeAgain {
  const StrokeLife* life = nullptr;  ///< of SeenClip::lives()
  graph::Point offset;               ///< px, from where it lived
};

/// Finds a stroke of another time that fits where and when it is to be born.
/// Candidates are some lives near their own places or, with `births`, at places drawn from that map; chosen
/// is the one whose surroundings look most like those of frame t there, with no stroke at its place. Nothing
/// where the clip has no such life.
std::optional<LifeAgain> find_life_again(const SeenClip& clip, int t,
                                         const std::optional<mcmc::CellMap>& births, core::Rng& rng);

}  // namespace emberfold::pipeline
