// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <vector>

#include "graph/events/events.hpp"
#include "mcmc/learning/rate_modifiers.hpp"

namespace emberfold::mcmc::detail {

/// Holds what happened in a clip before a frame, as far as rates depend on it.
struct EventHistory {
  std::vector<PastEvent> unions, separations;
  std::map<graph::SubgraphId, double> born;  ///< frame of a stroke's birth, where it was seen

  /// Returns the age of a stroke, frames; infinite where its birth was not seen.
  [[nodiscard]] double age(graph::SubgraphId stroke, double frame) const;
  /// Forgets what is too long ago to matter.
  void forget(double frame);
  /// Takes the next event.
  void note(const graph::Event& event);
};

}  // namespace emberfold::mcmc::detail
