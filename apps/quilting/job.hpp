// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "apps/cli/command.hpp"
#include "apps/quilting/request.hpp"

namespace emberfold::apps {

/// All of `emberfold quilt`: reads, quilts or takes a map, renders, and writes what was asked for.
void run_quilt(QuiltRequest& request, Session& session);

}  // namespace emberfold::apps
