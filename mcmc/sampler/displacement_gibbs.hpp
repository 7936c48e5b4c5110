// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "mcmc/sampler/choices.hpp"
#include "mcmc/sampler/density.hpp"

namespace emberfold::mcmc {

/// Finds the paths of patches: maximal runs of nodes each of which alone continues the one before.
/// Every node that is on lies in exactly one path. Ordered by first node. O(nodes).
std::vector<std::vector<Index>> find_paths(const HiddenGraph& g);

/// Holds the Gaussian law of the displacements along one path given everything else.
/// `factor` is the lower Cholesky factor of the precision. It is banded: row i holds L(i, i−2), L(i, i−1),
/// L(i, i).
struct DisplacementGaussian {
  std::vector<double> mean;
  std::vector<std::array<double, 3>> factor;
};
/// Computes the law of the displacements along `path`, one of find_paths(g).
/// It is exact, as the density is Gaussian in the displacements (a block of Rue & Held 2005, §2.4).
DisplacementGaussian displacement_given_rest(const HiddenGraph& g, const Density& density,
                                             const std::vector<Index>& path);

/// Draws the displacements along a path from their law given everything else.
void draw_displacements(HiddenGraph& g, const Density& density, const std::vector<Index>& path,
                        ChoiceSource& draws);

}  // namespace emberfold::mcmc
