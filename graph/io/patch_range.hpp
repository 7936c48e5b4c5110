// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "graph/patch.hpp"

namespace emberfold::graph::detail {

/// Describes the first field of a patch that is out of range; empty if none is.
/// Readers and writers share these ranges: coordinates, theta, lengths and levels within ±1e6, so that they
/// convert to whole pixels safely; width, blur and cost not negative; cost and gain within ±1e9 nats.
std::string describe_range_error(const Patch& patch);
/// Describes such a field of a patch in a frame of `width` × `height` px, of which an anchor is a pixel.
std::string describe_range_error(const Patch& patch, int width, int height);

}  // namespace emberfold::graph::detail
