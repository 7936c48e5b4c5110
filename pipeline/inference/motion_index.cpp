// SPDX-License-Identifier: Apache-2.0
#include "pipeline/inference/motion_index.hpp"

namespace emberfold::pipeline {

namespace {

constexpr std::uint32_t kNone = ~std::uint32_t{0};

}  // namespace

MotionIndex::Frame MotionIndex::index(std::size_t t) const {
  const auto& graphs = motion_.sketch.frames;
  Frame frame{std::vector(graphs[t].size(), kNone), std::vector(graphs[t].size(), kNone),
              graph::CoincidenceIndex(graphs[t])};
  const auto link = [](std::vector<std::uint32_t>& with, std::size_t from, std::size_t to) {
    if (with[from] == kNone) with[from] = static_cast<std::uint32_t>(to);
  };
  if (t > 0)
    for (const graph::Link& l : motion_.links[t])
      link(frame.previous, graphs[t].index_of(l.after), graphs[t - 1].index_of(l.before));
  if (t + 1 < graphs.size())
    for (const graph::Link& l : motion_.links[t + 1])
      link(frame.next, graphs[t].index_of(l.before), graphs[t + 1].index_of(l.after));
  return frame;
}

void MotionIndex::hold(int first, int end) {
  for (; first_ < first && !frames_.empty(); ++first_) frames_.pop_front();
  if (frames_.empty()) first_ = first;
  while (first_ + static_cast<int>(frames_.size()) < end)
    frames_.push_back(index(static_cast<std::size_t>(first_) + frames_.size()));
}

std::optional<std::uint32_t> MotionIndex::linked(int frame, std::uint32_t vertex, int step) const {
  const Frame& at = held(frame);
  const std::uint32_t found = step > 0 ? at.next[vertex] : at.previous[vertex];
  return found == kNone ? std::nullopt : std::optional(found);
}

}  // namespace emberfold::pipeline
