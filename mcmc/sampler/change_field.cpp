// SPDX-License-Identifier: Apache-2.0
#include "mcmc/sampler/change_field.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "core/error.hpp"

namespace emberfold::mcmc {

void ChangeField::validate() const {
  using graph::EventType;
  const auto is = [&](std::uint32_t change, EventType type) {
    return change < changes.size() && changes[change].type == type;
  };
  const auto exists = [&](std::uint32_t strand) { return strand < strands.size(); };
  for (std::size_t k = 0; k < changes.size(); ++k) {
    const Change& change = changes[k];
    const std::size_t before = change.before.size(), after = change.after.size();
    const bool fits = change.type == EventType::birth   ? before == 0 && after == 1
                      : change.type == EventType::death ? before == 1 && after == 0
                                                        : before + after == 3 && before > 0 && after > 0;
    if (!fits || std::isnan(change.log_odds) || !std::ranges::all_of(change.before, exists) ||
        !std::ranges::all_of(change.after, exists))
      throw core::InputError("change " + std::to_string(k) + " is of " + std::to_string(before) +
                             " strands before and " + std::to_string(after) +
                             " after it, or names one that is not there, or its log odds are no number");
  }
  for (const Gap& gap : gaps)
    if (!is(gap.death, EventType::death) || !is(gap.birth, EventType::birth))
      throw core::InputError("a gap is not between a death and a birth");
}

}  // namespace emberfold::mcmc
