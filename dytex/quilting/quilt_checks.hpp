// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "dytex/quilting/blocks.hpp"
#include "dytex/quilting/quilt.hpp"

/// Checks before and while blocks are laid. Inner header of quilting.
namespace emberfold::dytex::detail {

/// Throws InputError where sources, masks, guides and options do not fit together.
void check_sources(std::span<const QuiltSource> sources, const QuiltOptions& options, const QuiltRun& run);

/// Returns a block that an earlier run placed. Throws InputError unless it is one that this run could place.
QuiltChoice replayed(const QuiltChoice& placed, const QuiltBlock& block,
                     std::span<const QuiltSource> sources);

}  // namespace emberfold::dytex::detail
