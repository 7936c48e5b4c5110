// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

namespace emberfold::mcmc {

/// Holds how well the draws of one number were mixed, from one or more chains of equal length.
/// Source: Vehtari, Gelman, Simpson, Carpenter & Bürkner 2021, "Rank-normalization, folding, and
/// localization: an improved R-hat for assessing convergence of MCMC". Each chain is split into halves,
/// without the middle draw of an odd number; so the drift of a single chain is noticed, too. NaN stands for
/// numbers that cannot be computed: all where a draw is not finite; all but mean and deviation for fewer than
/// 4 draws in a chain; R-hat and the sizes where all draws are equal (then the error is 0).
struct Diagnosis {
  double mean = 0, deviation = 0;  ///< of all draws; SD with the divisor N − 1
  double error = 0;     ///< Monte Carlo standard error of the mean: deviation / √(size for the mean)
  double rhat = 0;      ///< the larger one of R-hat of the ranks, and of the ranks folded about the
                        ///< median where these vary; infinite where each half is a constant of its own
  double bulk_ess = 0;  ///< effective sample size of the ranks
  double tail_ess = 0;  ///< the smaller one of the sizes for the indicators of the 5 % and the 95 % quantile;
                        ///< one that is constant, as in a series of zeros and ones, is left out
};

/// Computes the diagnosis of `chains[c][i]`, draw i of chain c. All NaN without chains or draws.
/// Throws core::InputError where the lengths differ. O(N log N), and N times the number of correlated lags.
Diagnosis diagnose(std::span<const std::vector<double>> chains);

/// Returns the number of independent draws that would estimate the mean as precisely.
/// Sums the autocorrelations over pairs of lags as long as they are positive, made monotone (Geyer 1992). At
/// most N log₁₀ N, since draws that alternate are worth more than independent ones. The chains are split; the
/// draws are not ranked, so it also holds for indicators of events. NaN as in Diagnosis.
double effective_size(std::span<const std::vector<double>> chains);

}  // namespace emberfold::mcmc
