// SPDX-License-Identifier: Apache-2.0
#include "graph/events/believed_lives.hpp"

#include <algorithm>
#include <cstdlib>
#include <limits>

namespace emberfold::graph::detail {

namespace {

constexpr double kThing = 20;     // patches, about 100 px
constexpr double kBorder = 5;     // px: nearer to the picture's border, a stroke goes out through it
constexpr double kShortest = 12;  // px: the sketch draws no shorter strokes (sketch.min_length)
constexpr double kLeast = 0.1,
                 kMost = 0.6;       // probabilities beyond are taken as these: draws know of both ends
constexpr double kRounding = 1e-9;  // of a probability
constexpr double kStands = 0.2;     // px a frame: below, a stroke stands, and goes nowhere

std::map<SubgraphId, Life> lives_of(const SketchSequence& sketch) {
  struct Shape {
    std::size_t patches = 0;
    bool has_tip = false;
  };
  std::map<SubgraphId, Life> lives;
  for (std::size_t t = 0; t < sketch.frames.size(); ++t) {
    const AttributeGraph& graph = sketch.frames[t];
    std::map<SubgraphId, Shape> shapes;
    for (std::uint32_t v = 0; v < graph.size(); ++v) {
      Shape& shape = shapes[graph.vertices()[v].subgraph];
      ++shape.patches;
      shape.has_tip |= graph.degree(v) < 2;
    }
    for (const auto& [stroke, shape] : shapes) {
      Life& life = lives.try_emplace(stroke, Life{.first = t}).first->second;
      life.last = t;
      ++life.frames, life.patches += shape.patches;
      if (!shape.has_tip) ++life.closed;
    }
  }
  return lives;
}

/// The distances from the picture's border of a stroke's nearest and farthest patch, px.
struct Reach {
  double least = std::numeric_limits<double>::infinity(), most = 0;
};
Reach reach_of(const SketchSequence& sketch, SubgraphId stroke, std::size_t frame) {
  Reach reach;
  for (const Vertex& v : sketch.frames[frame].vertices()) {
    if (v.subgraph != stroke) continue;
    const double distance = distance_to_border(sketch, v.patch.position);
    reach.least = std::min(reach.least, distance), reach.most = std::max(reach.most, distance);
  }
  return reach;
}

/// Returns whether a stroke of a frame leaves through the picture's border: at the motion that it has had
/// since another frame (the one before or after), it would next be at the border, and reach less than `rest`
/// px into the picture.
bool passes_border(const SketchSequence& sketch, SubgraphId stroke, std::size_t frame, std::size_t other,
                   double rest) {
  const Reach now = reach_of(sketch, stroke, frame), was = reach_of(sketch, stroke, other);
  const double by = was.most - now.most;  // motion of its far end: the border cuts off the near one
  return by >= kStands && now.least - by < kBorder && now.most - by < rest;
}

/// Returns the likeliest event that names a stroke in a frame, before or after it; null if there is none.
Event* likeliest(std::vector<Event>& events, std::vector<SubgraphId> Event::*side, std::size_t frame,
                 SubgraphId stroke) {
  Event* found = nullptr;
  for (Event& event : events)
    if (static_cast<std::size_t>(event.frame) == frame && names(event.*side, stroke) &&
        (found == nullptr || event.probability > found->probability))
      found = &event;
  return found;
}

bool is_whole_stroke(EventType type) {
  return type == EventType::birth || type == EventType::death;
}

double odds(double probability) {
  const double p = std::clamp(probability, kLeast, kMost);
  return p / (1 - p);
}

}  // namespace

bool Life::is_thing() const {
  return 2 * closed > frames && static_cast<double>(patches) > kThing * static_cast<double>(frames);
}

double distance_to_border(const SketchSequence& sketch, Point place) {
  return std::min({place.x, place.y, sketch.width - 1 - place.x, sketch.height - 1 - place.y});
}

bool names(std::span<const SubgraphId> strokes, SubgraphId stroke) {
  return std::ranges::find(strokes, stroke) != strokes.end();
}

Believed believed_events(std::span<const Event> events, double least, std::size_t frames) {
  Believed believed(frames + 1);
  for (const Event& event : events)
    if (event.probability >= least) believed[static_cast<std::size_t>(event.frame)].push_back(&event);
  return believed;
}

std::map<SubgraphId, Life> believed_lives(const MotionGraph& motion, const Believed& believed,
                                          std::span<const int> cuts) {
  const std::size_t frames = motion.sketch.frames.size();
  // Strokes begin and end at such a frame because the picture does.
  const auto is_cut = [&](std::size_t frame) {
    return frame == 0 || frame == frames ||
           std::ranges::any_of(cuts, [&](int cut) { return std::abs(static_cast<int>(frame) - cut) <= 1; });
  };
  const auto is_named = [](const std::vector<const Event*>& events, auto side, SubgraphId stroke) {
    return std::ranges::any_of(events, [&](const Event* event) { return names(event->*side, stroke); });
  };
  auto lives = lives_of(motion.sketch);
  for (auto& [stroke, life] : lives) {
    const std::size_t next = life.first + (life.last > life.first),
                      previous = life.last - (life.last > life.first);
    life.begins = is_named(believed[life.first], &Event::after, stroke);
    life.ends = is_named(believed[life.last + 1], &Event::before, stroke);
    const double rest =
        life.closed > 0 ? kBorder : kShortest;  // the far side of a ring moves as it shrinks, too
    life.comes_in = is_cut(life.first) || passes_border(motion.sketch, stroke, life.first, next, rest);
    life.goes_out = is_cut(life.last + 1) || passes_border(motion.sketch, stroke, life.last, previous, rest);
  }
  return lives;
}

bool settle_open_ends(const std::map<SubgraphId, Life>& lives, std::vector<Event>& events) {
  bool changed = false;
  for (const auto& [stroke, life] : lives) {
    if (life.begins == life.ends || life.comes_in || life.goes_out) continue;
    Event* const first = likeliest(events, &Event::after, life.first, stroke);
    Event* const last = likeliest(events, &Event::before, life.last + 1, stroke);
    Event* const believed = life.begins ? first : last;
    Event* const open = life.begins ? last : first;
    const double both = odds(believed->probability) * odds(open == nullptr ? 0 : open->probability);
    const double probability = both / (1 + both);
    if (open != nullptr && probability > kEven + kRounding) {
      changed |= open->probability < kEven;
      open->probability = std::max(open->probability, probability);
    } else if (!life.is_thing() && is_whole_stroke(believed->type) && believed->probability < 1) {
      changed |= believed->probability > probability;
      believed->probability = std::min({believed->probability, probability, kEven - kRounding});
    }
  }
  return changed;
}

}  // namespace emberfold::graph::detail
