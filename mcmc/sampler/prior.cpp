// SPDX-License-Identifier: Apache-2.0
#include "mcmc/sampler/prior.hpp"

#include <algorithm>

namespace emberfold::mcmc {

SamplerParameters widen_spreads(SamplerParameters theta) {
  constexpr double kLook = 3, kGrowth = 10, kLeastAcross = 1;
  theta.turn = std::min(0.5, kLook * theta.turn);
  theta.flicker *= kLook;
  theta.across = std::max(theta.across, kLeastAcross);
  theta.step_sd *= kGrowth, theta.side_sd *= kGrowth;
  theta.bend_sd = std::min(1.0, kGrowth * theta.bend_sd);
  theta.grown_contrast_sd *= kGrowth;
  return theta;
}

SamplerParameters prior_parameters(const graph::MotionGraph& start, const MotionModel& learned) {
  double patches = 0;
  for (const auto& frame : start.sketch.frames) patches += static_cast<double>(frame.size());
  patches /= static_cast<double>(std::max<std::size_t>(1, start.sketch.frames.size()));
  SamplerParameters prior = default_parameters(patches, double(start.sketch.width) * start.sketch.height);
  Autoregression displacement = learned.displacement;
  displacement.noise = std::max(0.02, displacement.noise), displacement.range = displacement.measurement = 0,
  displacement.coupling = 0;
  if (spectral_radius(displacement) <= 0.995) prior.displacement = displacement;
  return prior;
}

}  // namespace emberfold::mcmc
