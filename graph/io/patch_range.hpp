// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "graph/patch.hpp"

namespace emberfold::graph::detail {

/// Says what of a patch is out of range, empty where nothing is. Readers and writers agree on it:
/// coordinates, theta and lengths within ±1e6, so that they can be turned into whole pixels safely; no
/// negative width or blur; costs and gains within ±1e9 nats.
std::string range_error(const Patch& patch);

}  // namespace emberfold::graph::detail
