// SPDX-License-Identifier: Apache-2.0
#include "graph/events/event_names.hpp"

#include <algorithm>
#include <map>
#include <optional>
#include <set>
#include <tuple>
#include <utility>

#include "graph/events/joints.hpp"

namespace emberfold::graph {

namespace {

constexpr int kBreak = 3;  // frames without a contact between two with it

/// Tells of a frame's vertices whether they lie near an end.
class EndsOf {
 public:
  explicit EndsOf(const MotionGraph& motion) : motion_(motion) {}
  bool near_end(std::size_t t, std::uint32_t vertex) {
    if (frame_ != t) {
      const AttributeGraph& graph = motion_.sketch.frames[t];
      detail::ShortestPaths paths(graph);
      near_end_ = detail::find_vertices_near_ends(graph, paths);
      frame_ = t;
    }
    return near_end_[vertex];
  }

 private:
  const MotionGraph& motion_;
  std::size_t frame_ = ~std::size_t{0};  ///< none yet
  std::vector<bool> near_end_;
};

/// Returns the partner of a vertex in the frame before (after); its index, if it has one.
std::optional<std::uint32_t> partner(const MotionGraph& motion, VertexId id, std::size_t frame, bool before) {
  const auto& links = motion.links[before ? frame : frame + 1];
  const auto at = std::ranges::find_if(
      links, [&](const Link& link) { return (before ? link.after : link.before) == id; });
  if (at == links.end()) return std::nullopt;
  const AttributeGraph& other = motion.sketch.frames[before ? frame - 1 : frame + 1];
  return static_cast<std::uint32_t>(other.index_of(before ? at->before : at->after));
}

Contact contact_of(const MotionGraph& motion, const TracedEvent& traced, EndsOf& ends) {
  const bool unites = traced.event.type == EventType::merge || traced.event.type == EventType::connect;
  const auto whole = static_cast<std::size_t>(traced.path_frame);
  int tips = 0;
  for (const VertexId id : {traced.path.front(), traced.path.back()}) {
    const auto other = partner(motion, id, whole, unites);
    if (other && ends.near_end(unites ? whole - 1 : whole + 1, *other)) ++tips;
  }
  return tips == 2 ? Contact::tip_tip : tips == 1 ? Contact::tip_side : Contact::side_side;
}

bool is_of_joint(const Event& event) {
  return event.type != EventType::birth && event.type != EventType::death;
}

auto key_of(const Event& event) {
  return std::tuple(event.frame, event.type, event.position.x, event.position.y);
}

/// Contact of two curves in one frame.
struct Meeting {
  Point position;
  bool crosses = false;
};

/// Returns whether a curve goes on to both sides of a vertex of it or next to it.
bool goes_through(const AttributeGraph& graph, std::uint32_t vertex, CurveId curve) {
  std::set<std::uint32_t> around{vertex};
  for (const std::uint32_t w : graph.neighbours(vertex)) around.insert(w);
  std::set<std::uint32_t> outside;
  for (const std::uint32_t v : around) {
    if (graph.vertices()[v].curve != curve && v != vertex) continue;
    for (const std::uint32_t w : graph.neighbours(v))
      if (graph.vertices()[w].curve == curve && !around.contains(w)) outside.insert(w);
  }
  return outside.size() >= 2;
}

std::map<std::pair<CurveId, CurveId>, Meeting> meetings_of(const AttributeGraph& graph) {
  std::map<std::pair<CurveId, CurveId>, Meeting> result;
  for (const Edge& edge : graph.edges()) {
    const auto i = static_cast<std::uint32_t>(graph.index_of(edge.a)),
               j = static_cast<std::uint32_t>(graph.index_of(edge.b));
    const CurveId a = graph.vertices()[i].curve, b = graph.vertices()[j].curve;
    if (a == b) continue;
    Meeting here{(graph.patch(i).position + graph.patch(j).position) * 0.5, false};
    for (const std::uint32_t v : {i, j})
      here.crosses = here.crosses || (goes_through(graph, v, a) && goes_through(graph, v, b));
    const auto [at, added] = result.try_emplace(std::minmax({a, b}), here);
    if (!added && here.crosses) at->second.crosses = true;
  }
  return result;
}

}  // namespace

std::string_view name(Contact contact) {
  switch (contact) {
    case Contact::tip_tip:
      return "tip_tip";
    case Contact::tip_side:
      return "tip_side";
    case Contact::side_side:
      return "side_side";
    default:
      return "";
  }
}

std::vector<Contact> event_contacts(const MotionGraph& motion, std::span<const Event> events) {
  EndsOf ends(motion);
  std::map<decltype(key_of(events[0])), Contact> known;
  for (const TracedEvent& traced : trace_stroke_events(motion))
    if (is_of_joint(traced.event)) known.emplace(key_of(traced.event), contact_of(motion, traced, ends));
  std::vector<Contact> result;
  for (const Event& event : events) {
    const auto at = known.find(key_of(event));
    result.push_back(at == known.end() ? Contact::none : at->second);
  }
  return result;
}

std::vector<CurveContact> curve_contacts(const MotionGraph& motion) {
  struct Open {
    CurveContact contact;
    int crossing = 0, frames = 0;
  };
  const int frames = static_cast<int>(motion.sketch.frames.size());
  std::map<std::pair<CurveId, CurveId>, Open> open;
  std::vector<CurveContact> result;
  const auto close = [&](const Open& ended) {
    result.push_back(ended.contact);
    result.back().crosses = 2 * ended.crossing > ended.frames;
    result.back().to_end = ended.contact.last + 1 == frames;
  };
  for (int t = 0; t < frames; ++t) {
    for (const auto& [pair, meeting] : meetings_of(motion.sketch.frames[static_cast<std::size_t>(t)])) {
      auto at = open.find(pair);
      if (at != open.end() && t - at->second.contact.last > kBreak + 1) {
        close(at->second);
        open.erase(at);
        at = open.end();
      }
      if (at == open.end())
        at = open.emplace(pair, Open{{pair.first, pair.second, t, t, false, meeting.position, t == 0, false}})
                 .first;
      at->second.contact.last = t;
      at->second.crossing += meeting.crosses ? 1 : 0;
      ++at->second.frames;
    }
  }
  for (const auto& [pair, last] : open) close(last);
  std::ranges::sort(result, {}, [](const CurveContact& c) { return std::tuple(c.first, c.a, c.b); });
  return result;
}

}  // namespace emberfold::graph
