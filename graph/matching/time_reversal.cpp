// SPDX-License-Identifier: Apache-2.0
#include "graph/matching/time_reversal.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <utility>

namespace emberfold::graph {

SketchSequence reverse_time(const SketchSequence& sketch) {
  SketchSequence result;
  result.width = sketch.width, result.height = sketch.height, result.fps = sketch.fps;
  for (auto frame = sketch.frames.rbegin(); frame != sketch.frames.rend(); ++frame) result.append(*frame);
  return result;
}

MotionGraph reverse_time(const MotionGraph& motion) {
  validate(motion);
  MotionGraph result;
  result.sketch = reverse_time(motion.sketch);
  const auto &old = motion.sketch.frames, &now = result.sketch.frames;
  const auto reverse_links = [&](const std::vector<std::vector<Link>>& lists) {
    std::vector<std::vector<Link>> reversed(now.size());
    for (std::size_t t = 1; t < now.size(); ++t) {
      const std::size_t there = old.size() - t;  // the later frame of these links in the old order
      for (const Link& link : lists[there]) {
        const std::size_t i = old[there].index_of(link.after), j = old[there - 1].index_of(link.before);
        reversed[t].push_back({now[t - 1].vertices()[i].id, now[t].vertices()[j].id});
      }
      std::sort(reversed[t].begin(), reversed[t].end());
    }
    return reversed;
  };
  result.links = reverse_links(motion.links);
  if (!motion.skipped.empty()) result.skipped = reverse_links(motion.skipped);
  return identify(std::move(result));
}

EventType reverse_time(EventType type) {
  using enum EventType;
  constexpr std::array kReversed = {death, birth, merge, split, disconnect, connect};
  return kReversed[static_cast<std::size_t>(type)];
}

std::vector<Event> reverse_time(std::vector<Event> events, int frames) {
  for (Event& event : events) {
    event.frame = frames - event.frame;
    event.type = reverse_time(event.type);
    std::swap(event.before, event.after);
  }
  sort_events(events);
  return events;
}

}  // namespace emberfold::graph
