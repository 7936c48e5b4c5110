// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "mcmc/sampler/choices.hpp"
#include "mcmc/sampler/density.hpp"

namespace emberfold::mcmc {

/// The courses of patches: nodes that follow each other, each going on as the next alone. Every node that is
/// on lies in exactly one; ordered by first node. O(nodes).
std::vector<std::vector<Index>> courses(const HiddenGraph& g);

/// The Gaussian that the sways along one course have given everything else: its mean, and the lower Cholesky
/// factor of its precision, which is banded: row i holds L(i, i−2), L(i, i−1), L(i, i).
struct SwayGaussian {
  std::vector<double> mean;
  std::vector<std::array<double, 3>> factor;
};
/// `course`: one of courses(g). Exact: the density is Gaussian in the sways (a block of Rue & Held 2005,
/// §2.4).
SwayGaussian sway_given_rest(const HiddenGraph& g, const Density& density, const std::vector<Index>& course);

/// Draws the sways along a course anew, given everything else.
void draw_sways(HiddenGraph& g, const Density& density, const std::vector<Index>& course, Draws& draws);

}  // namespace emberfold::mcmc
