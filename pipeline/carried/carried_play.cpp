// SPDX-License-Identifier: Apache-2.0
#include "pipeline/carried/carried_play.hpp"

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include "core/error.hpp"
#include "core/math/robust.hpp"
#include "graph/events/event_family.hpp"
#include "graph/matching/time_reversal.hpp"
#include "mcmc/learning/stroke_places.hpp"
#include "pipeline/carried/life_again.hpp"
#include "pipeline/footage/motion_scale.hpp"

namespace emberfold::pipeline {

namespace {

using graph::EventType;
using graph::Point;
using Index = std::uint32_t;

constexpr std::uint32_t kStream = 0x63617272;  // of the random stream
constexpr int kFade = 4;                       // moments over which edited strokes appear and vanish
constexpr double kFit = 64;          // grey levels by which its pixels are fitted to their new surroundings
constexpr double kWholeFit = 255;    // the same for pixels that hide a stroke
constexpr double kBorder = 6;        // px over which a stroke blends into the frame
constexpr int kLeastHeld = 8;        // moments for which a hiding place is kept, even if strokes reach it
constexpr double kFarthest = 32;     // px that the wind displaces a stroke, about
constexpr std::size_t kFromEnd = 4;  // patches between a split and a free end

std::size_t index(EventType type) {
  return static_cast<std::size_t>(type);
}

double mean_width(const graph::AttributeGraph& graph, const std::vector<Index>& stroke) {
  double sum = 0;
  for (const auto v : stroke) sum += graph.patch(v).width + 2 * graph.patch(v).blur;
  return sum / static_cast<double>(stroke.size());
}

/// Returns the patches that a walk along edges reaches from `from` within `distance` px, not through
/// `not_through`.
std::vector<Index> patches_within(const graph::AttributeGraph& graph, Index from, Index not_through,
                                  double distance) {
  std::vector<std::pair<Index, double>> open{{from, 0.0}};
  std::set<Index> found{from};
  while (!open.empty()) {
    const auto [v, way] = open.back();
    open.pop_back();
    for (const Index w : graph.neighbours(v)) {
      const double further = way + graph::distance(graph.patch(v).position, graph.patch(w).position);
      if (w == not_through || further > distance || graph.degree(w) > 2 || !found.insert(w).second) continue;
      open.emplace_back(w, further);
    }
  }
  return {found.begin(), found.end()};
}

/// Returns whether no free end and no junction is within kFromEnd patches of a curve's inner patch.
bool is_inside(const graph::AttributeGraph& graph, Index vertex) {
  if (graph.degree(vertex) != 2) return false;
  for (const Index side : graph.neighbours(vertex)) {
    Index behind = vertex, at = side;
    for (std::size_t i = 1; i < kFromEnd; ++i) {
      if (graph.degree(at) != 2) return false;
      const auto sides = graph.neighbours(at);
      behind = std::exchange(at, sides[0] == behind ? sides[1] : sides[0]);
    }
  }
  return true;
}

}  // namespace

std::string edit_not_carried(const mcmc::MotionEdit& edit) {
  const auto rate = [&](EventType type) { return edit.rates[index(type)]; };
  if (edit.intensity != 1) return "intensity";
  if (edit.flicker != 1) return "flicker";
  if (edit.contrast != 1) return "contrast";
  if (rate(EventType::death) < 1) return "deaths below 1";
  if (rate(EventType::split) < 1) return "splits below 1";
  if (rate(EventType::disconnect) < 1) return "disconnects below 1";
  if (rate(EventType::merge) > 1) return "merges above 1";
  if (rate(EventType::connect) > 1) return "connects above 1";
  return {};
}

CarriedPlay::CarriedPlay(std::shared_ptr<const SeenClip> clip, const mcmc::MotionEdit& edit,
                         std::array<double, 2> gaps, std::uint64_t seed, std::optional<int> loop)
    : clip_(std::move(clip)), choice_(clip_), edit_(edit), gaps_(gaps), seed_(seed), loop_(loop) {
  edit.validate();
  if (const auto what = edit_not_carried(edit); !what.empty())
    throw core::InputError("the method edit cannot show another " + what);
  moves_ = moving_pixels(clip_->frames());
  if (edit.strokes == mcmc::StrokeChoice::all) return;
  std::vector<double> widths;
  for (int t = 0; t < clip_->size(); ++t)
    for (const auto& vertex : clip_->graph(t).vertices())
      widths.push_back(vertex.patch.width + 2 * vertex.patch.blur);
  if (!widths.empty()) usual_width_ = core::median(widths);
}

/// Returns what hides a new patch: the hiding of the nearest known patch of its stroke, unless that has its
/// full number of patches.
int CarriedPlay::inherited_hiding(const graph::AttributeGraph& graph, const std::vector<Index>& known,
                                  const std::vector<Followed>& now, Index vertex) const {
  const auto nearest = std::ranges::min(known, {}, [&](Index w) {
    return graph::distance(graph.patch(vertex).position, graph.patch(w).position);
  });
  const int number = now[nearest].hiding;
  if (number < 0) return number;
  const auto most = hidings_.at(number).most;
  const auto hidden = std::ranges::count(now, number, &Followed::hiding);
  return most > 0 && static_cast<std::size_t>(hidden) >= most ? -1 : number;
}

/// Follows the patches into the frame; new patches of a stroke copy the nearest one that continues another.
CarriedPlay::Played CarriedPlay::follow(int frame) {
  Played played;
  played.first = frame_ < 0;
  const auto& graph = clip_->graph(frame);
  std::vector<Followed> now(graph.size());
  const auto from = played.first ? std::vector<int>(graph.size(), -1) : clip_->continued(frame_, frame);
  std::set<std::uint32_t> taken;
  for (std::size_t v = 0; v < now.size(); ++v) {
    if (from[v] >= 0) now[v] = now_[static_cast<std::size_t>(from[v])];
    if (from[v] < 0 || !taken.insert(now[v].id).second) now[v].id = next_id_++;
  }
  for (auto& stroke : mcmc::vertices_by_stroke(graph::components(graph))) {
    std::vector<Index> known;
    std::ranges::copy_if(stroke, std::back_inserter(known), [&](Index v) { return from[v] >= 0; });
    if (known.empty()) {
      played.fresh.push_back(std::move(stroke));
      continue;
    }
    for (const Index v : stroke)
      if (from[v] < 0) now[v].hiding = inherited_hiding(graph, known, now, v);
  }
  if (!played.first && std::abs(frame - frame_) == 1) played.step = frame - frame_;
  now_ = std::move(now);
  return played;
}

/// Chooses what hides patches of the frame: anew where strokes have come there, and only now and then where
/// strokes always are.
void CarriedPlay::choose_place(Hiding& hiding, const std::vector<Index>& vertices) {
  const bool first = hiding.begin == moment_;
  if (!first && !hiding.free && moment_ - hiding.chosen < kLeastHeld) return;
  const auto patches = patches_of(*clip_, frame_, vertices);
  if (!first && !shows_strokes(*clip_, frame_, patches, hiding.place)) return;
  hiding.place = find_hidden_place(*clip_, frame_, patches);
  hiding.chosen = moment_;
  hiding.free = !shows_strokes(*clip_, frame_, patches, hiding.place);
}

/// Hides patches of the frame from now on, and returns the number of the hiding.
int CarriedPlay::hide(const std::vector<Index>& vertices, bool sudden) {
  for (const Index v : vertices) now_[v].hiding = next_hiding_;
  Hiding hiding;
  hiding.begin = moment_, hiding.sudden = sudden;
  hidings_[next_hiding_] = hiding;
  return next_hiding_++;
}

/// Hides these patches and none else of their stroke.
void CarriedPlay::hide_gap(const std::vector<Index>& vertices, bool sudden) {
  hidings_[hide(vertices, sudden)].most = vertices.size();
}

/// Returns whether the clip moves at half of the patches or more, and these do not stand still.
bool CarriedPlay::moves(const std::vector<Index>& vertices) const {
  const auto& graph = clip_->graph(frame_);
  const auto moving = std::ranges::count_if(vertices, [&](Index v) {
    const auto p = graph.patch(v).position;
    const int x = std::clamp(static_cast<int>(std::lround(p.x)), 0, moves_.cols - 1);
    return !clip_->stands_still(frame_, v) &&
           moves_(std::clamp(static_cast<int>(std::lround(p.y)), 0, moves_.rows - 1), x) != 0;
  });
  return 2 * moving >= static_cast<std::ptrdiff_t>(vertices.size());
}

void CarriedPlay::let_drift(const std::vector<Index>& vertices, core::Rng& rng) {
  const double farthest = kFarthest * rng.uniform(0.6, 1.4);
  if (!moves(vertices)) return;
  hidings_[hide(vertices, true)].drift =
      std::max(2 * kFade, static_cast<int>(std::lround(farthest / graph::norm(edit_.wind))));
}

/// Begins the strokes that appear in this moment.
void CarriedPlay::begin_strokes(const Played& played, core::Rng& rng, CarriedMoment& moment) {
  const double births = edit_.rates[index(EventType::birth)];
  for (const auto& stroke : played.fresh) {
    const bool born = played.step != 0;
    if (born) {
      const int more = rng.count(edit_.birth_map ? births : std::max(0.0, births - 1));
      for (int i = 0; i < more; ++i) moment.operators[index(EventType::birth)] += bear_again(rng) ? 1 : 0;
    }
    const bool wrong = edit_.strokes != mcmc::StrokeChoice::all &&
                       (mean_width(clip_->graph(frame_), stroke) >= usual_width_) !=
                           (edit_.strokes == mcmc::StrokeChoice::coarse);
    const bool elsewhere = born && edit_.birth_map.has_value();
    if (wrong || elsewhere || (!played.first && choice_.leaves_out(frame_, stroke, births))) {
      hide(stroke, true);
      continue;
    }
    if (!born) continue;
    ++moment.operators[index(EventType::birth)];
    if (edit_.wind != Point{}) let_drift(stroke, rng);
  }
}

/// Returns whether a patch is shown, at its own place.
bool CarriedPlay::is_whole(Index vertex) const {
  return now_[vertex].hiding < 0;
}

bool CarriedPlay::end_stroke(core::Rng& rng) {
  auto strokes = mcmc::vertices_by_stroke(graph::components(clip_->graph(frame_)));
  std::erase_if(strokes, [&](const auto& stroke) {
    return !moves(stroke) || !std::ranges::all_of(stroke, [&](Index v) { return is_whole(v); });
  });
  const auto found = choice_.least_visible(frame_, std::move(strokes), rng);
  if (found) hide(*found, false);
  return found.has_value();
}

/// Opens a gap in a curve, or between a junction and one of its arms.
bool CarriedPlay::open_gap(core::Rng& rng, bool at_junction) {
  const auto& graph = clip_->graph(frame_);
  std::vector<std::pair<Index, Index>> sites;  // where it opens, and the vertex that it does not pass
  for (Index v = 0; v < graph.size(); ++v) {
    const auto sides = graph.neighbours(v);
    if (!moves({v}) || !is_whole(v) || !std::ranges::all_of(sides, [&](Index w) { return is_whole(w); }))
      continue;
    if (!at_junction && is_inside(graph, v)) sites.emplace_back(v, v);
    if (at_junction && graph.degree(v) > 2)
      for (const Index w : sides)
        if (graph.degree(w) == 2) sites.emplace_back(w, v);
  }
  const double wide = at_junction ? gaps_[1] : gaps_[0] / 2;
  std::vector<std::vector<Index>> gaps;
  for (int i = 0; i < HidingChoice::kTries && !sites.empty(); ++i) {
    std::swap(sites[rng.below(static_cast<std::uint32_t>(sites.size()))], sites.back());
    gaps.push_back(patches_within(graph, sites.back().first, sites.back().second, wide));
    std::erase_if(gaps.back(), [&](Index v) { return !is_whole(v); });
    sites.pop_back();
  }
  const auto gap = choice_.least_visible(frame_, std::move(gaps), rng);
  if (gap) hide_gap(*gap, false);
  return gap.has_value();
}

/// Repeats a stroke of another time.
bool CarriedPlay::bear_again(core::Rng& rng) {
  const auto found = find_life_again(*clip_, frame_, edit_.birth_map, rng);
  if (found) again_.push_back({found->life, moment_, found->offset, {}});
  return found.has_value();
}

/// Changes strokes in this moment, as in the clip or additionally.
void CarriedPlay::change_strokes(const Played& played, core::Rng& rng, CarriedMoment& moment) {
  if (played.step == 0) return;
  const auto& events = clip_->events(std::max(frame_, frame_ - played.step));
  const auto& graph = clip_->graph(frame_);
  for (const auto& [event, path_frame, path] : events) {
    const auto type = played.step > 0 ? event.type : graph::reverse_time(event.type);
    if (type == EventType::birth) continue;
    const double rate = edit_.rates[index(type)];
    auto& count = moment.operators[index(type)];
    if (graph::detail::is_union(type) && rng.uniform() >= rate) {
      std::vector<Index> gap;
      for (const auto id : path)
        if (const auto v = graph.index_of(id); v < graph.size() && is_whole(static_cast<Index>(v)))
          gap.push_back(static_cast<Index>(v));
      if (!gap.empty()) hide_gap(gap, true);
      continue;
    }
    ++count;
    if (graph::detail::is_union(type)) continue;
    const int more = rng.count(std::max(0.0, rate - 1));
    for (int i = 0; i < more; ++i) {
      const bool done =
          type == EventType::death ? end_stroke(rng) : open_gap(rng, type == EventType::disconnect);
      count += done ? 1 : 0;
    }
  }
}

Point CarriedPlay::drifted(const Hiding& hiding) const {
  return edit_.wind * static_cast<double>((moment_ - hiding.begin) % hiding.drift);
}

/// Draws the frame's own strokes: those that are visible, what hides the others, and those that drift.
void CarriedPlay::draw_frame_strokes(CarriedMoment& moment, std::vector<graph::Vertex>& vertices,
                                     std::vector<graph::Edge>& edges) {
  const auto& graph = clip_->graph(frame_);
  std::map<int, std::vector<Index>> hidden;
  for (Index v = 0; v < graph.size(); ++v) {
    auto vertex = graph.vertices()[v];
    vertex.id = {now_[v].id}, vertex.subgraph = {}, vertex.curve = {};
    const auto found = hidings_.find(now_[v].hiding);
    if (found != hidings_.end()) hidden[found->first].push_back(v);
    if (found != hidings_.end() && found->second.drift < 0) continue;
    if (found != hidings_.end()) vertex.patch.position = vertex.patch.position + drifted(found->second);
    vertices.push_back(vertex);
    for (const Index w : graph.neighbours(v)) {
      const auto other = hidings_.find(now_[w].hiding);
      if (v < w && (other == hidings_.end() || other->second.drift >= 0))
        edges.push_back({{now_[v].id}, {now_[w].id}});
    }
  }
  std::erase_if(hidings_, [&](const auto& one) { return !hidden.contains(one.first); });
  std::vector<CarriedStroke> drifting;
  for (const auto& [number, patches] : hidden) {
    auto& hiding = hidings_.at(number);
    choose_place(hiding, patches);
    const int age = moment_ - hiding.begin;
    CarriedStroke cover{hiding.place.frame(frame_, clip_->size()),
                        hiding.sudden ? 1 : std::min(1.0, (age + 1.0) / kFade),
                        kWholeFit,
                        kHidingFeather,
                        {},
                        true};
    CarriedStroke moved{frame_, 1, kFit, kBorder, {}};
    for (const Index v : patches) {
      const auto& patch = graph.patch(v);
      cover.patches.push_back(
          {patch.position, patch.position + hiding.place.beside, patch.theta, 0, carried_reach(patch)});
      if (hiding.drift >= 0)
        moved.patches.push_back(
            {patch.position + drifted(hiding), patch.position, patch.theta, 0, carried_reach(patch)});
    }
    if (hiding.drift >= 0) {
      const int of_way = age % hiding.drift;
      moved.opacity = std::min({1.0, (of_way + 1.0) / kFade, double(hiding.drift - of_way) / kFade});
      drifting.push_back(std::move(moved));
    }
    moment.strokes.push_back(std::move(cover));
  }
  std::ranges::move(drifting, std::back_inserter(moment.strokes));
}

/// Draws the repeated strokes.
void CarriedPlay::draw_again(CarriedMoment& moment, std::vector<graph::Vertex>& vertices,
                             std::vector<graph::Edge>& edges) {
  const auto age_of = [&](const Again& one) { return static_cast<std::size_t>(moment_ - one.begin); };
  const auto gone =
      std::erase_if(again_, [&](const Again& one) { return age_of(one) >= one.life->patches.size(); });
  moment.operators[index(EventType::death)] += static_cast<int>(gone);
  for (auto& one : again_) {
    const std::size_t age = age_of(one), left = one.life->patches.size() - age;
    const int t = one.life->first + static_cast<int>(age);
    one.shown.go_to(*clip_, t, one.life->patches[age], next_id_);
    one.shown.add_to(vertices, edges, *clip_, one.offset);
    CarriedStroke stroke{
        t, std::min({1.0, (double(age) + 1) / kFade, double(left) / kFade}), kFit, kBorder, {}};
    for (const Index v : one.shown.patches) {
      const auto& patch = clip_->graph(t).patch(v);
      stroke.patches.push_back(
          {patch.position + one.offset, patch.position, patch.theta, 0, carried_reach(patch)});
    }
    moment.strokes.push_back(std::move(stroke));
  }
}

CarriedMoment CarriedPlay::next(int frame) {
  ++moment_;
  const int place = loop_ ? moment_ % *loop_ : moment_;
  if (place == 0) choice_.forget();
  core::Rng rng(seed_, {kStream, static_cast<std::uint32_t>(place), 0});
  const auto played = follow(frame);
  frame_ = frame;
  CarriedMoment moment;
  begin_strokes(played, rng, moment);
  change_strokes(played, rng, moment);
  std::vector<graph::Vertex> vertices;
  std::vector<graph::Edge> edges;
  draw_frame_strokes(moment, vertices, edges);
  draw_again(moment, vertices, edges);
  moment.graph = {std::move(vertices), std::move(edges)};
  return moment;
}

}  // namespace emberfold::pipeline
