// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "core/context.hpp"
#include "dytex/quilting/block_courses.hpp"
#include "dytex/quilting/quilt.hpp"

/// Seams as surfaces in x, y and t. Inner header of quilting.
namespace emberfold::dytex::detail {

/// Moves the seams between placed blocks so that their cost (SeamExpansion) falls: block after block takes by
/// a minimum cut the best pixels, first the same at all times, within 16 px around its place; then in halves
/// of the time, quarters and so on down to four frames, each time only within 4 px of its current pixels. The
/// same result at any thread count.
void move_seams(BlockCourses& courses, std::span<const QuiltSource> sources, const core::Context& context);

}  // namespace emberfold::dytex::detail
