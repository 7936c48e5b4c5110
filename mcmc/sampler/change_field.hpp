// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "graph/events/events.hpp"

namespace emberfold::mcmc {

/// A stroke between two changes of a matched graph.
struct Strand {
  int first = 0, last = 0;                  ///< frames
  bool comes_in = false, goes_out = false;  ///< with the clip, at a cut, or through the picture's border
  std::size_t patches = 0;                  ///< summed over its frames
  std::size_t closed = 0;                   ///< frames in which it has no tip
};

/// A change that was read from a matched graph, and may have happened or not.
struct Change {
  graph::EventType type = graph::EventType::birth;
  int frame = 0;  ///< the first one after it
  graph::Point place;
  double log_odds = 0;  ///< of the images, where the usual share of such changes is true
  /// The share of true changes near it counts; if false, the log odds are taken unchanged.
  bool has_rate = true;
  std::vector<std::uint32_t> before, after;  ///< strands that end and begin with it
};

/// A death and a birth that may be one stroke, which is not seen for some frames.
struct Gap {
  std::uint32_t death = 0, birth = 0;  ///< changes
};

/// All that may have happened in a clip.
struct ChangeField {
  std::vector<Strand> strands;
  std::vector<Change> changes;
  std::vector<Gap> gaps;

  /// Throws core::InputError for a number that is out of range, a birth or death of more or fewer than one
  /// strand, another change that is not of one strand and two, and a gap that is not of a death and a birth.
  void validate() const;
};

/// Which changes happened, and which gaps are bridged: a stroke continues across them.
struct ChangeState {
  std::vector<bool> happened, bridged;
  bool operator==(const ChangeState&) const = default;
};

}  // namespace emberfold::mcmc
