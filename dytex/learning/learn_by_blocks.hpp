// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

#include "core/clip.hpp"
#include "core/context.hpp"
#include "dytex/learn.hpp"

namespace emberfold::dytex {

/// Returns whether a clip is known to have more frames than learn() takes.
bool needs_blocks(const core::ClipInfo& info);

/// Learns the model of learn() from a clip of any length, which is read once. Blocks of `block` frames are
/// decomposed separately and merged (Iwen, Ong 2016; the mean's part as Ross, Lim, Lin, Yang 2008): with
/// U₁ S₁, U₂ S₂, means μ₁, μ₂ and frames τ₁, τ₂ the directions of both are those of
///   M = [U₁ S₁, U₂ S₂, (μ₂ − μ₁) √(τ₁ τ₂ / (τ₁ + τ₂))],
/// found from MᵀM, of which the max(2n, n + 50) strongest are kept, 200 where `energy` is given. Singular
/// values after them are set equal, with the residual variance.
///
/// `block` 0: 1024 frames, or the fewer that `options.memory` holds; a note reports how many. A block of
/// frames and three matrices U S are in memory. The same bytes at any thread count. Throws InputError where
/// there are fewer than 2 frames, where an option needs all frames at once (`order`, separate channels),
/// where a block does not fit in `options.memory`, or a value is not finite. O(m τ block), and for each block
/// O((m + τ) k²).
LearnResult learn_by_blocks(core::FrameSource& source, const LearnOptions& options, std::size_t block,
                            const core::Context& context = {});

}  // namespace emberfold::dytex
