// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <map>
#include <string>
#include <vector>

#include "dytex/distributed/learn_distributed.hpp"
#include "dytex/distributed/stripes.hpp"
#include "dytex/distributed/together.hpp"
#include "dytex/learning/fitted_spectra.hpp"
#include "dytex/learning/gram.hpp"

namespace emberfold::dytex::detail {

/// The input of all steps of learn_distributed().
struct DistributedJob {
  Communicator& ranks;
  const Stripes& stripes;
  FrameRounds& rounds;
  StripeKeeper& keeper;
  const LearnOptions& options;
  const RowSink& rows;
  const core::Context& context;

  [[nodiscard]] std::size_t first_stripe() const { return stripes.first_of(ranks.rank()); }
  [[nodiscard]] std::size_t end_stripe() const { return stripes.first_of(ranks.rank() + 1); }
  [[nodiscard]] bool is_root() const { return ranks.rank() == 0; }
};

/// A rank's means of each of its stripes, by stripe.
using StripeMeans = std::map<std::size_t, Eigen::VectorXd>;
using StripeRows = std::map<std::size_t, Eigen::MatrixXf>;

/// Work that earlier runs have done, the same on all ranks.
struct Progress {
  std::int64_t frames = 0, blocks = 0, ended = 0;
};
Progress load_progress(const DistributedJob& job);
/// Saves progress once all that the ranks wrote is on the disk.
void save_progress(const DistributedJob& job, Progress progress);

/// Returns a stripe's values of `frames` frames that are stored one after the other.
FrameValues stripe_values(const DistributedJob& job, std::size_t stripe, const std::byte* values,
                          std::size_t frames);
/// Returns the means of a stripe's values, and adds their Gram matrices over all stripes (rank 0 has the
/// sum).
StripeMeans stripe_means(const DistributedJob& job, std::size_t frames,
                         const std::function<FrameValues(std::size_t)>& values);
Eigen::MatrixXd gram_of_stripes(const DistributedJob& job, std::size_t frames,
                                const std::function<FrameValues(std::size_t)>& values);

/// Makes C's columns orthonormal, gives its rows to the sink and the mean to rank 0's texture.
void finish_model(const DistributedJob& job, StripeRows C, const StripeMeans& means, LearnResult& learned);

/// Learns at once or by blocks; see learn_distributed().
DistributedResult learn_at_once(const DistributedJob& job, std::size_t most_frames);
DistributedResult learn_by_blocks(const DistributedJob& job, std::size_t block);

}  // namespace emberfold::dytex::detail
