// SPDX-License-Identifier: Apache-2.0
#include "mcmc/simulation/linked_frames.hpp"

#include <utility>

namespace emberfold::mcmc::detail {

void LinkedFrames::append(graph::AttributeGraph next) {
  motion.sketch.append(next);
  std::vector<graph::Link> links;
  if (const auto& frames = motion.sketch.frames; frames.size() > 1)
    for (std::size_t i = 0; i < last.size(); ++i)
      if (const auto j = next.index_of(last.vertices()[i].id); j < next.size())
        links.push_back({frames.end()[-2].vertices()[i].id, frames.back().vertices()[j].id});
  motion.links.push_back(std::move(links));
  last = std::move(next);
}

}  // namespace emberfold::mcmc::detail
