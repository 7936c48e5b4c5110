// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include "core/rng.hpp"
#include "graph/matching/time_reversal.hpp"
#include "mcmc/sampler/change_field.hpp"

namespace emberfold::test {

/// Makes a field in which something happens in every frame: strokes are born, die, part and join at random.
inline mcmc::ChangeField random_field(std::uint64_t seed, int changes, double spread = 2) {
  using graph::EventType;
  core::Rng rng(seed);
  mcmc::ChangeField field;
  std::vector<std::uint32_t> there;
  const auto begin = [&](int frame) {
    there.push_back(static_cast<std::uint32_t>(field.strands.size()));
    field.strands.push_back({frame, frame, frame == 0, false, 5, rng.uniform() < 0.1 ? 1U : 0U});
    return there.back();
  };
  const auto end = [&](int frame) {
    const auto at = there.begin() + rng.below(static_cast<std::uint32_t>(there.size()));
    const std::uint32_t strand = *at;
    field.strands[strand].last = frame - 1;
    there.erase(at);
    return strand;
  };
  begin(0), begin(0);
  for (int t = 1; t <= changes; ++t) {
    mcmc::Change change;
    change.frame = t, change.log_odds = spread * rng.normal();
    change.place = {rng.uniform(0, 300), rng.uniform(0, 200)};
    const auto kind = rng.below(4);
    if (kind == 0 || there.size() < 2) {
      change.type = EventType::birth, change.after = {begin(t)};
    } else if (kind == 1) {
      change.type = EventType::death, change.before = {end(t)};
    } else if (kind == 2) {
      change.type = EventType::split, change.before = {end(t)};
      const std::uint32_t first = begin(t);
      change.after = {first, begin(t)};
    } else {
      change.type = EventType::connect;
      const std::uint32_t first = end(t);
      change.before = {first, end(t)}, change.after = {begin(t)};
    }
    field.changes.push_back(std::move(change));
  }
  for (const std::uint32_t strand : there)
    field.strands[strand].last = changes, field.strands[strand].goes_out = rng.uniform() < 0.8;
  for (std::uint32_t a = 0; a < field.changes.size(); ++a)
    for (std::uint32_t b = a + 1; b < field.changes.size(); ++b)
      if (field.changes[a].type == EventType::death && field.changes[b].type == EventType::birth &&
          rng.uniform() < 0.6)
        field.gaps.push_back({a, b});
  return field;
}

/// Returns the field of the clip played backwards, which has so many frames.
inline mcmc::ChangeField reversed(mcmc::ChangeField field, int frames) {
  for (mcmc::Strand& strand : field.strands) {
    const int last = strand.last;
    strand.last = frames - 1 - strand.first, strand.first = frames - 1 - last;
    std::swap(strand.comes_in, strand.goes_out);
  }
  for (mcmc::Change& change : field.changes) {
    change.frame = frames - change.frame;
    std::swap(change.before, change.after);
    change.type = graph::reverse_time(change.type);
  }
  for (mcmc::Gap& gap : field.gaps) std::swap(gap.death, gap.birth);
  return field;
}

}  // namespace emberfold::test
