// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>

#include <Eigen/Core>

#include "core/context.hpp"
#include "dytex/distributed/communicator.hpp"
#include "dytex/distributed/frame_rounds.hpp"
#include "dytex/distributed/stripe_keeper.hpp"
#include "dytex/learn.hpp"

namespace emberfold::dytex {

/// Receives the rows of C as they are made, so that no rank holds all of them.
struct RowSink {
  std::function<void(Eigen::Index)> begin;  ///< of n columns; on rank 0, before any row
  /// The rows from `first` on; on the owner of their stripe.
  std::function<void(std::size_t first, const Eigen::MatrixXf& rows)> put;
};

struct DistributedResult {
  LearnResult learned;      ///< on rank 0; `texture.C` has n columns and no rows, `mean` is whole
  std::size_t frames = 0;   ///< τ
  std::size_t block = 0;    ///< frames decomposed at a time; 0: all at once
  std::size_t resumed = 0;  ///< frames that an earlier run had done
  std::size_t decoded = 0;  ///< frames, by this rank
};

/// Learns the model of learn() from a clip that many ranks share: each frame is decoded by one rank, which
/// sends its stripes of values to the ranks that own them. All ranks call it with the same arguments but for
/// `clip.source`.
///
/// With `block` 0 and up to 10 000 frames all stripes are kept (`keeper`), their Gram matrices are added
/// along a fixed tree, rank 0 decomposes the sum, and each rank makes the rows of C of its stripes: the model
/// of learn(), up to the rounding of sums. Else blocks of `block` frames (1024 where it is 0) are decomposed
/// separately and merged (Iwen, Ong 2016; the mean's part as Ross, Lim, Lin, Yang 2008): with U₁ S₁, U₂ S₂,
/// means μ₁, μ₂ and frames τ₁, τ₂ the directions of both are those of
///   [U₁ S₁, U₂ S₂, (μ₂ − μ₁) √(τ₁ τ₂ / (τ₁ + τ₂))],
/// found from its Gram matrix, of which the max(2n, n + 50) strongest are kept. Singular values after them
/// are set equal, with the residual variance. A frame is then kept until its block is done.
///
/// The same bytes at any number of ranks and threads, and where `keeper` holds a part of the work. Channels
/// are joint. Throws InputError, wrapped in FailedTogether as all others, where an option needs all frames at
/// once, or a block does not fit in `options.memory` on a rank.
DistributedResult learn_distributed(Communicator& ranks, const SharedClip& clip, const LearnOptions& options,
                                    std::size_t block, StripeKeeper& keeper, const RowSink& rows,
                                    const core::Context& context);

}  // namespace emberfold::dytex
