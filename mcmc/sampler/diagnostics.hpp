// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

namespace emberfold::mcmc {

/// What the draws of one number, of one or more chains of the same length, tell of how well they were mixed
/// (Vehtari, Gelman, Simpson, Carpenter & Bürkner 2021, "Rank-normalization, folding, and localization: an
/// improved R-hat for assessing convergence of MCMC"). Each chain is taken as its two halves, of an odd
/// number of draws without the middle one; so a single chain that drifts is noticed, too.
///
/// What cannot be told is NaN: all of it where a draw is not finite, all but mean and deviation where there
/// are fewer than 4 draws in a chain, R-hat and the sizes where all draws are equal (then the error is 0).
struct Diagnosis {
  double mean = 0, deviation = 0;  ///< of all draws; SD with the divisor N − 1
  double error = 0;     ///< Monte Carlo standard error of the mean: deviation / √(size for the mean)
  double rhat = 0;      ///< the larger one of R-hat of the ranks, and of the ranks folded about the
                        ///< median where these vary; infinite where each half is a constant of its own
  double bulk_ess = 0;  ///< effective sample size of the ranks
  double tail_ess = 0;  ///< the smaller one of the sizes for the indicators of the 5 % and the 95 % quantile;
                        ///< one that is constant, as in a series of zeros and ones, is left out
};

/// `chains[c][i]`: draw i of chain c. No chains, or chains of no draws, have nothing that can be told.
/// InputError where the lengths differ. O(N log N), and N times the draws that are correlated.
Diagnosis diagnose(std::span<const std::vector<double>> chains);

/// How many independent draws would tell the mean as well, by the sum of the autocorrelations over pairs of
/// lags as long as they are positive, made monotone (Geyer 1992); at most N log₁₀ N, for draws that alternate
/// tell more. The chains split, the draws as they are: what holds for indicators of events. NaN as above.
double effective_size(std::span<const std::vector<double>> chains);

}  // namespace emberfold::mcmc
