// SPDX-License-Identifier: Apache-2.0
#include "mcmc/learning/event_history.hpp"

#include <algorithm>
#include <limits>

#include "graph/events/event_family.hpp"

namespace emberfold::mcmc::detail {

double EventHistory::age(graph::SubgraphId stroke, double frame) const {
  const auto found = born.find(stroke);
  return found == born.end() ? std::numeric_limits<double>::infinity() : frame - found->second;
}

void EventHistory::forget(double frame) {
  const auto long_ago = [frame](const PastEvent& one) {
    return elapsed_class(frame - one.frame) == kElapsedClasses - 1;
  };
  std::erase_if(unions, long_ago);
  std::erase_if(separations, long_ago);
}

void EventHistory::note(const graph::Event& event) {
  const double frame = event.frame;
  if (event.type == graph::EventType::birth) born[event.after.at(0)] = frame;
  if (graph::detail::is_union(event.type)) unions.push_back({event.position, frame});
  if (graph::detail::is_separation(event.type)) separations.push_back({event.position, frame});
  // A stroke is as old as the oldest stroke that it came from.
  double began = std::numeric_limits<double>::infinity();
  for (const auto stroke : event.before) {
    const auto found = born.find(stroke);
    if (found == born.end()) return;
    began = std::min(began, found->second);
  }
  for (const auto stroke : event.after) born.try_emplace(stroke, began);
}

}  // namespace emberfold::mcmc::detail
