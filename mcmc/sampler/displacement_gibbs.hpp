// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "mcmc/sampler/choices.hpp"
#include "mcmc/sampler/density.hpp"

namespace emberfold::mcmc {

/// The courses of patches: nodes that follow each other, each going on as the next alone. Every node that is
/// on lies in exactly one; ordered by first node. O(nodes).
std::vector<std::vector<Index>> find_paths(const HiddenGraph& g);

/// The Gaussian that the displacements along one path have given everything else: its mean, and the lower Cholesky
/// factor of its precision, which is banded: row i holds L(i, i−2), L(i, i−1), L(i, i).
struct DisplacementGaussian {
  std::vector<double> mean;
  std::vector<std::array<double, 3>> factor;
};
/// `path`: one of find_paths(g). Exact: the density is Gaussian in the displacements (a block of Rue & Held 2005,
/// §2.4).
DisplacementGaussian displacement_given_rest(const HiddenGraph& g, const Density& density, const std::vector<Index>& path);

/// Draws the displacements along a path anew, given everything else.
void draw_displacements(HiddenGraph& g, const Density& density, const std::vector<Index>& path, ChoiceSource& draws);

}  // namespace emberfold::mcmc
