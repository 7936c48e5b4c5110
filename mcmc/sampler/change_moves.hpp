// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "mcmc/sampler/change_field.hpp"

namespace emberfold::mcmc::detail {

/// The seven kinds of moves (Wang & Zhu 2004, sec. 4): the six changes, in the order of graph::EventType, and
/// the switching of what continues what.
inline constexpr std::array<std::string_view, 7> kMoveNames = {"birth",   "death",      "split", "merge",
                                                               "connect", "disconnect", "switch"};

/// A move turns some changes, and whether a gap is bridged, into their opposites. Done twice it does nothing,
/// so the ratio of its proposals is 1.
struct ChangeMove {
  std::size_t kind = 0;                ///< of kMoveNames
  std::vector<std::uint32_t> changes;  ///< at most two
  std::optional<std::uint32_t> gap;
  std::vector<std::uint32_t> strands;  ///< of these, each once
};

/// Lists the moves of the open changes: each by itself; the beginning of a stroke with an end of it, which
/// puts in or takes out a stroke, a gap or a bridge over an interval; a gap, by itself or with what ends or
/// begins there. Beginnings and ends are paired that are joined by at most kMostStrands strands; of each,
/// those with the fewest between come first, and kMostPairs are taken. Reversing time gives the same moves.
/// O(changes · strands).
std::vector<ChangeMove> change_moves(const ChangeField& field, const std::vector<bool>& open);
inline constexpr std::size_t kMostStrands = 12, kMostPairs = 6;

}  // namespace emberfold::mcmc::detail
