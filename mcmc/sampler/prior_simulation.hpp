// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/rng.hpp"
#include "mcmc/sampler/density.hpp"

namespace emberfold::mcmc {

/// Draws graphs and links from the sampler's density without its evidence, frame by frame.
/// All drawn patches are on; there are no other candidates. The maps are even inside the frame. Nothing
/// begins outside it (log_birth is −∞); patches there have grown or continued. Without drift. Gates must be
/// so wide, and lists so long, that they cut nothing off. Throws core::InputError for fewer than one frame.
HiddenGraph simulate_prior(const SamplerParameters& theta, int width, int height, int frames,
                           const Gates& gates, core::Rng& rng);

}  // namespace emberfold::mcmc
