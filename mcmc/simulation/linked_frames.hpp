// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "graph/motion_graph.hpp"

namespace emberfold::mcmc::detail {

/// Collects successive graphs as a motion graph.
/// Vertices that keep their ids are linked; the motion graph numbers them anew.
struct LinkedFrames {
  graph::MotionGraph motion;
  graph::AttributeGraph last;  ///< with its own ids

  /// Adds the next frame.
  void append(graph::AttributeGraph next);
};

}  // namespace emberfold::mcmc::detail
