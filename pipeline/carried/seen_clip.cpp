// SPDX-License-Identifier: Apache-2.0
#include "pipeline/carried/seen_clip.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <map>
#include <utility>

#include "core/error.hpp"
#include "graph/matching/match.hpp"
#include "graph/matching/time_reversal.hpp"

namespace emberfold::pipeline {

namespace {

constexpr std::size_t kShortestLife = 4;  // frames
constexpr int kStillFrames = 20;
constexpr double kStillRange = 3;  // px: the tremor of a camera

std::vector<StrokeLife> born_strokes(const graph::MotionGraph& strokes,
                                     const std::vector<std::vector<graph::TracedEvent>>& events) {
  std::map<graph::SubgraphId, std::size_t> number;
  std::vector<StrokeLife> lives;
  for (std::size_t t = 1; t < strokes.sketch.frames.size(); ++t) {
    for (const auto& [event, frame, path] : events[t])
      if (event.type == graph::EventType::birth) {
        number.emplace(event.after.at(0), lives.size());
        lives.push_back({static_cast<int>(t), {}});
      }
    const auto vertices = strokes.sketch.frames[t].vertices();
    for (std::uint32_t v = 0; v < vertices.size(); ++v) {
      const auto found = number.find(vertices[v].subgraph);
      if (found == number.end()) continue;
      auto& life = lives[found->second];
      life.patches.resize(t - static_cast<std::size_t>(life.first) + 1);
      life.patches.back().push_back(v);
    }
  }
  std::erase_if(lives, [](const StrokeLife& life) { return life.patches.size() < kShortestLife; });
  return lives;
}

/// Returns the place of an index in an ascending list; its size where it has none.
std::size_t place_in(const std::vector<std::uint32_t>& list, std::uint32_t index) {
  const auto found = std::ranges::lower_bound(list, index);
  return found != list.end() && *found == index ? static_cast<std::size_t>(found - list.begin())
                                                : list.size();
}

/// Displacement of a patch over time across its curve; along it patches slide although nothing moves.
struct Track {
  graph::Point last;
  double across = 0, least = 0, most = 0;  // px
  int frames = 0;

  void add(const graph::Patch& patch) {
    const graph::Point step = patch.position - last;
    if (frames++ > 0) across += step.y * std::cos(patch.theta) - step.x * std::sin(patch.theta);
    last = patch.position;
    least = std::min(least, across), most = std::max(most, across);
  }
  [[nodiscard]] bool is_still(int of) const {
    return frames >= std::min(kStillFrames, of / 2) && most - least < kStillRange;
  }
};

}  // namespace

SeenClip::SeenClip(std::vector<cv::Mat> frames, graph::MotionGraph strokes)
    : frames_(std::move(frames)), strokes_(std::move(strokes)), events_(frames_.size()) {
  if (frames_.size() < 2) throw core::InputError("a footage of one frame has no motion to play");
  if (strokes_.sketch.frames.size() != frames_.size())
    throw core::InputError("the strokes are of " + std::to_string(strokes_.sketch.frames.size()) +
                           " frames, the footage of " + std::to_string(frames_.size()));
  for (auto& event : graph::trace_stroke_events(strokes_))
    events_[static_cast<std::size_t>(event.event.frame)].push_back(std::move(event));
  lives_ = born_strokes(strokes_, events_);
  for (const auto& graph : strokes_.sketch.frames) {
    std::vector<graph::Point> places;
    for (const auto& vertex : graph.vertices()) places.push_back(vertex.patch.position);
    places_.emplace_back(std::move(places), kNear);
  }
  find_still();
}

void SeenClip::find_still() {
  std::vector<Track> tracks;
  std::vector<std::vector<std::size_t>> track_of(frames_.size());
  for (int t = 0; t < size(); ++t) {
    auto& now = track_of[static_cast<std::size_t>(t)];
    const auto from = t > 0 ? continued(t - 1, t) : std::vector<int>(graph(t).size(), -1);
    for (std::uint32_t v = 0; v < from.size(); ++v) {
      now.push_back(from[v] < 0
                        ? tracks.size()
                        : track_of[static_cast<std::size_t>(t) - 1][static_cast<std::size_t>(from[v])]);
      if (from[v] < 0) tracks.emplace_back();
      tracks[now.back()].add(graph(t).patch(v));
    }
  }
  for (const auto& now : track_of) {
    auto& still = still_.emplace_back();
    for (const auto track : now) still.push_back(tracks[track].is_still(size()));
  }
}

const std::uint8_t* SeenClip::pixel(int t, graph::Point place) const {
  const cv::Mat& shown = frame(t);
  const int x = std::clamp(static_cast<int>(std::lround(place.x)), 0, shown.cols - 1);
  const int y = std::clamp(static_cast<int>(std::lround(place.y)), 0, shown.rows - 1);
  return shown.ptr<std::uint8_t>(y) + static_cast<std::ptrdiff_t>(x) * shown.channels();
}

void StrokeAgain::go_to(const SeenClip& clip, int next_frame, const std::vector<std::uint32_t>& next_patches,
                        std::uint32_t& next_id) {
  std::vector<std::uint32_t> next_ids;
  std::vector<char> taken(ids.size());
  const auto from = frame >= 0 ? clip.continued(frame, next_frame) : std::vector<int>{};
  for (const auto v : next_patches) {
    const auto old =
        from.empty() || from[v] < 0 ? patches.size() : place_in(patches, static_cast<std::uint32_t>(from[v]));
    const bool goes_on = old < patches.size() && taken[old] == 0;
    if (goes_on) taken[old] = 1;
    next_ids.push_back(goes_on ? ids[old] : next_id++);
  }
  frame = next_frame, patches = next_patches, ids = std::move(next_ids);
}

void StrokeAgain::add_to(std::vector<graph::Vertex>& vertices, std::vector<graph::Edge>& edges,
                         const SeenClip& clip, graph::Point offset) const {
  const auto& graph = clip.graph(frame);
  for (std::size_t i = 0; i < patches.size(); ++i) {
    auto vertex = graph.vertices()[patches[i]];
    vertex.id = {ids[i]}, vertex.subgraph = {}, vertex.curve = {};
    vertex.patch.position = vertex.patch.position + offset;
    vertices.push_back(vertex);
    for (const auto w : graph.neighbours(patches[i]))
      if (const auto at = place_in(patches, w); patches[i] < w && at < patches.size())
        edges.push_back({{ids[i]}, {ids[at]}});
  }
}

std::shared_ptr<const SeenClip> played_clip(std::vector<cv::Mat> frames, graph::MotionGraph strokes,
                                            bool reverse) {
  if (reverse) {
    std::ranges::reverse(frames);
    strokes = graph::reverse_time(strokes);
  }
  return std::make_shared<const SeenClip>(std::move(frames), std::move(strokes));
}

std::vector<int> SeenClip::continued(int from, int to) const {
  const auto &before = graph(from), &after = graph(to);
  std::vector<int> found(after.size(), -1);
  if (from == to)
    for (std::size_t v = 0; v < found.size(); ++v) found[v] = static_cast<int>(v);
  const auto take = [&](graph::VertexId old, graph::VertexId now) {
    auto& of = found[after.index_of(now)];
    if (of < 0) of = static_cast<int>(before.index_of(old));
  };
  if (to == from + 1)
    for (const auto& link : strokes_.links[static_cast<std::size_t>(to)]) take(link.before, link.after);
  else if (to == from - 1)
    for (const auto& link : strokes_.links[static_cast<std::size_t>(from)]) take(link.after, link.before);
  else if (to != from)
    for (const auto& link : graph::match_frames(before, after, {}, {})) take(link.before, link.after);
  return found;
}

}  // namespace emberfold::pipeline
