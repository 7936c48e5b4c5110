// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace emberfold::mcmc {

/// Holds the numbers of two changes that bear on each other.
struct ChangePair {
  std::size_t a = 0, b = 0;
};

/// Returns the probabilities of changes, given what is known about pairs of them.
///
/// The changes are independent with the `probabilities`, but those of a pair of `together` happen both or
/// neither, and both of a pair of `exclusive` have only kBothExclusive times their weight. Marginals of that
/// law come from self-avoiding walks over the exclusive pairs (Weitz 2006, "Counting independent sets up to
/// the tree threshold"): exactly where few exclude each other; where very many do, walks end after a number
/// of branches, and what is left there is taken as excluding each other. Changes of odds under 1/1000 exclude
/// nothing. Throws core::InputError for a probability outside 0…1, a number out of range, and a change that
/// is in two pairs of `together`. O(changes).
std::vector<double> joint_probabilities(std::span<const double> probabilities,
                                        std::span<const ChangePair> together,
                                        std::span<const ChangePair> exclusive);

inline constexpr double kBothExclusive = 0.05;

}  // namespace emberfold::mcmc
