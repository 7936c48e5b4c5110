// SPDX-License-Identifier: Apache-2.0
#include "mcmc/sampler/prior.hpp"

#include <algorithm>

namespace emberfold::mcmc {

Theta widened(Theta theta) {
  constexpr double kLook = 3, kGrowth = 10, kLeastAcross = 1;
  theta.turn = std::min(0.5, kLook * theta.turn);
  theta.flicker *= kLook;
  theta.across = std::max(theta.across, kLeastAcross);
  theta.step_sd *= kGrowth, theta.side_sd *= kGrowth;
  theta.bend_sd = std::min(1.0, kGrowth * theta.bend_sd);
  theta.grown_contrast_sd *= kGrowth;
  return theta;
}

Theta prior_for(const graph::MotionGraph& start, const MotionModel& learned) {
  double patches = 0;
  for (const auto& frame : start.sketch.frames) patches += static_cast<double>(frame.size());
  patches /= static_cast<double>(std::max<std::size_t>(1, start.sketch.frames.size()));
  Theta prior = usual_theta(patches, double(start.sketch.width) * start.sketch.height);
  Autoregression sway = learned.sway;
  sway.noise = std::max(0.02, sway.noise), sway.range = sway.measurement = 0, sway.coupling = 0;
  if (spectral_radius(sway) <= 0.995) prior.sway = sway;
  return prior;
}

}  // namespace emberfold::mcmc
