// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/rng.hpp"
#include "mcmc/sampler/density.hpp"

namespace emberfold::mcmc {

/// Draws graphs and links from the sampler's density without its evidence, frame after frame: what is drawn
/// is on, and there are no other candidates. The maps are even, and none beyond the frame: what lies there
/// has grown or gone on, none begins (log_birth is −∞). The drift is none. Gates should be so wide, and lists
/// so long, that they cut nothing off. InputError for fewer than one frame.
HiddenGraph simulate_prior(const SamplerParameters& theta, int width, int height, int frames, const Gates& gates,
                         core::Rng& rng);

}  // namespace emberfold::mcmc
