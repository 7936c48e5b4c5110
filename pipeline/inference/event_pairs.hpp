// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "graph/events/events.hpp"
#include "mcmc/inference/joint_changes.hpp"

namespace emberfold::pipeline {

/// Finds pairs of events of which both happened or neither: something appears and disappears in one place.
/// A stroke that is born and dies within two frames, or a union and a separation in neighbouring frames; at
/// most 6 px apart. Each event is in at most one pair, the nearest in time first. O(events · events of a
/// frame).
std::vector<mcmc::ChangePair> brief_pairs(std::span<const graph::Event> events);

/// Finds pairs of events that describe one change in two ways: a stroke has died, or merged into another; it
/// is new, or has separated from another. Within two frames and 20 px. O(events · events of a frame).
std::vector<mcmc::ChangePair> rival_pairs(std::span<const graph::Event> events);

}  // namespace emberfold::pipeline
