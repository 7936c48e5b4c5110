// SPDX-License-Identifier: Apache-2.0
#include "sketch/candidates/section_choice.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <numeric>

namespace emberfold::sketch {

std::vector<char> choose_sections(std::span<const double> gain, double end_cost, bool closed) {
  std::vector<char> chosen(gain.size(), 0);
  if (gain.empty()) return chosen;
  const double border = closed ? 0 : end_cost;
  std::vector<std::array<char, 2>> before(gain.size());  // the best state before a section that is off, on
  double off = 0, on = gain[0] - border;
  for (std::size_t i = 1; i < gain.size(); ++i) {
    before[i] = {static_cast<char>(on - end_cost > off), static_cast<char>(on > off - end_cost)};
    const double next_off = std::max(off, on - end_cost);
    on = std::max(on, off - end_cost) + gain[i];
    off = next_off;
  }
  char state = static_cast<char>(on - border > off);
  for (std::size_t i = gain.size(); i-- > 0;) {
    chosen[i] = state;
    state = before[i][static_cast<std::size_t>(state)];
  }
  // A ring has no ends, but a place to be described as they have.
  const bool whole = closed && std::ranges::find(chosen, 0) == chosen.end();
  if (whole && std::accumulate(gain.begin(), gain.end(), -2 * end_cost) <= 0) chosen.assign(gain.size(), 0);
  return chosen;
}

}  // namespace emberfold::sketch
