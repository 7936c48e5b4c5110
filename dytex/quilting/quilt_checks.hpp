// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "dytex/quilting/quilt.hpp"

/// Checks before blocks are laid. Inner header of quilting.
namespace emberfold::dytex::detail {

/// Throws InputError where sources, masks, guides and options do not fit together.
void check_sources(std::span<const QuiltSource> sources, const QuiltOptions& options, const cv::Mat& guide);

}  // namespace emberfold::dytex::detail
