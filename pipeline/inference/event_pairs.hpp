// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "graph/events/events.hpp"
#include "mcmc/inference/joint_changes.hpp"

namespace emberfold::pipeline {

/// Finds pairs of events that happen both or neither: what comes and goes again at once in one place.
/// A stroke that is born and dies within two frames, a union and a separation of neighbouring frames; 6 px
/// apart at most. Each event is in one pair at most, the nearest in time first. O(events · events of a
/// frame).
std::vector<mcmc::ChangePair> brief_pairs(std::span<const graph::Event> events);

/// Finds pairs of events that tell one change in two ways: a stroke has died, or was taken up by another; it
/// is new, or has come off another. Within two frames and 20 px. O(events · events of a frame).
std::vector<mcmc::ChangePair> rival_pairs(std::span<const graph::Event> events);

}  // namespace emberfold::pipeline
