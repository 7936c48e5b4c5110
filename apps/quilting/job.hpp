// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "apps/cli/command.hpp"
#include "apps/quilting/request.hpp"

namespace emberfold::apps {

/// Runs `emberfold quilt`: reads clips, finds or reads a map, renders, writes.
void run_quilt(QuiltRequest& request, Session& session);

}  // namespace emberfold::apps
