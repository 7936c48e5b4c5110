// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "graph/motion_graph.hpp"

namespace emberfold::mcmc::detail {

/// Graphs one after another, whose vertices go on where they keep their ids, as a motion graph (which numbers
/// them anew).
struct LinkedFrames {
  graph::MotionGraph motion;
  graph::AttributeGraph last;  ///< as it was given

  void append(graph::AttributeGraph next);
};

}  // namespace emberfold::mcmc::detail
