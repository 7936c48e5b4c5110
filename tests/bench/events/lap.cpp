// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/events/lap.hpp"

#include <algorithm>
#include <limits>
#include <optional>
#include <span>

#include "graph/events/joints.hpp"
#include "graph/matching/assignment.hpp"

namespace emberfold::figures {

namespace {

using graph::Point;
constexpr double kAlternative = 1.05, kQuantile = 0.9, kSame = 6;  // px
constexpr std::size_t kNone = std::numeric_limits<std::size_t>::max();

/// A stroke in one frame.
struct Blob {
  Point middle, low, high;  // low, high: the box around its patches
  std::vector<Point> patches;
};
using Frames = std::vector<std::vector<Blob>>;

Frames blobs_of(const graph::SketchSequence& sketch) {
  Frames frames;
  for (const auto& graph : sketch.frames) {
    const auto parts = graph::components(graph);
    std::vector<Blob> blobs(parts.count);
    std::vector<std::uint32_t> member(parts.count);
    for (std::size_t i = 0; i < graph.size(); ++i) {
      blobs[parts.of_vertex[i]].patches.push_back(graph.patch(i).position);
      member[parts.of_vertex[i]] = static_cast<std::uint32_t>(i);
    }
    graph::detail::ShortestPaths paths(graph);
    for (std::size_t k = 0; k < blobs.size(); ++k) {
      Blob& blob = blobs[k];
      blob.middle = graph::detail::component_middle(graph, paths, member[k]);
      blob.low = blob.high = blob.patches.front();
      for (const Point p : blob.patches) {
        blob.low = {std::min(blob.low.x, p.x), std::min(blob.low.y, p.y)};
        blob.high = {std::max(blob.high.x, p.x), std::max(blob.high.y, p.y)};
      }
    }
    frames.push_back(std::move(blobs));
  }
  return frames;
}

/// Number of a's patches that lie at one of b's.
double inside(const Blob& a, const Blob& b) {
  if (a.low.x > b.high.x + kSame || b.low.x > a.high.x + kSame || a.low.y > b.high.y + kSame ||
      b.low.y > a.high.y + kSame)
    return 0;
  return static_cast<double>(std::ranges::count_if(a.patches, [&](Point p) {
    return std::ranges::any_of(b.patches, [&](Point q) { return graph::distance(p, q) <= kSame; });
  }));
}

double squared(Point a, Point b) {
  return graph::dot(a - b, a - b);
}

double link_cost(const Blob& a, const Blob& b, LapCost cost) {
  if (cost == LapCost::middles) return squared(a.middle, b.middle);
  const double both = (inside(a, b) + inside(b, a)) / 2;
  return 1 - both / (static_cast<double>(a.patches.size() + b.patches.size()) - both);
}

double branch_cost(const Blob& piece, const Blob& whole, LapCost cost) {
  if (cost == LapCost::middles) return squared(piece.middle, whole.middle);
  return 1 - inside(piece, whole) / static_cast<double>(piece.patches.size());
}

/// Half way between the nearest patches of two strokes.
Point between(const Blob& a, const Blob& b) {
  Point best;
  double least = std::numeric_limits<double>::max();
  for (const Point p : a.patches)
    for (const Point q : b.patches)
      if (const double d = squared(p, q); d < least) least = d, best = (p + q) * 0.5;
  return best;
}

double away(Point p, const Blob& blob) {
  double least = std::numeric_limits<double>::max();
  for (const Point q : blob.patches) least = std::min(least, graph::distance(p, q));
  return least;
}

/// Place where two strokes are one in the next frame: the middle of the part of `whole` that lies on neither,
/// on the shortest way from one to the other. Half way between them without such a part.
Point joint(const Blob& a, const Blob& b, const Blob& whole) {
  std::vector<std::pair<double, Point>> bridge;
  for (const Point p : whole.patches)
    if (const double to_a = away(p, a), to_b = away(p, b); to_a > kSame && to_b > kSame)
      bridge.emplace_back(to_a + to_b, p);
  if (bridge.empty()) return between(a, b);
  const double least = std::ranges::min_element(bridge, {}, [](const auto& p) { return p.first; })->first;
  Point sum;
  double count = 0;
  for (const auto& [length, p] : bridge)
    if (length <= least + kSame) sum = sum + p, ++count;
  return sum * (1 / count);
}

using Pairs = std::vector<std::pair<std::uint32_t, std::uint32_t>>;

/// The pairs of the assignment in which a row or column without a partner costs `alternative`.
struct Cost {
  std::uint32_t row, column;
  double cost;
};
Pairs solve(std::span<const Cost> costs, double alternative) {
  std::vector<graph::Candidate> candidates;
  for (const Cost& c : costs)
    if (const double gain = 2 * alternative - c.cost; gain > 0) candidates.push_back({c.row, c.column, gain});
  return graph::assign(candidates);
}

/// The course of one stroke without a gap: blob numbers of its frames.
struct Piece {
  std::size_t first = 0;
  std::vector<std::uint32_t> blobs;
  [[nodiscard]] std::size_t last() const { return first + blobs.size() - 1; }
};

struct Tracks {
  Frames frames;
  std::vector<Piece> pieces;
  std::vector<std::vector<std::size_t>> piece_of;  // by frame and blob
  [[nodiscard]] const Blob& at(const Piece& piece, std::size_t t) const {
    return frames[t][piece.blobs[t - piece.first]];
  }
};

Tracks link_frames(Frames frames, const LapOptions& options) {
  Tracks tracks{std::move(frames), {}, {}};
  for (std::size_t t = 0; t < tracks.frames.size(); ++t) {
    const auto& now = tracks.frames[t];
    tracks.piece_of.emplace_back(now.size(), kNone);
    if (t > 0) {
      const auto& before = tracks.frames[t - 1];
      std::vector<Cost> costs;
      for (std::uint32_t i = 0; i < before.size(); ++i)
        for (std::uint32_t j = 0; j < now.size(); ++j)
          if (const double c = link_cost(before[i], now[j], options.cost); c < options.link)
            costs.push_back({i, j, c});
      for (const auto& [i, j] : solve(costs, kAlternative * options.link)) {
        const std::size_t piece = tracks.piece_of[t - 1][i];
        tracks.piece_of[t][j] = piece;
        tracks.pieces[piece].blobs.push_back(j);
      }
    }
    for (std::uint32_t j = 0; j < now.size(); ++j) {
      if (tracks.piece_of[t][j] != kNone) continue;
      tracks.piece_of[t][j] = tracks.pieces.size();
      tracks.pieces.push_back({t, {j}});
    }
  }
  return tracks;
}

/// Rows of the second assignment are ends of pieces, then the pieces that go on and may be left by another;
/// columns are beginnings of pieces, then those that go on and may be joined.
std::vector<Cost> piece_costs(const Tracks& tracks, const LapOptions& options) {
  std::vector<Cost> costs;
  const auto count = static_cast<std::uint32_t>(tracks.pieces.size());
  std::vector<std::size_t> first_point{count};  // of each frame
  for (const auto& frame : tracks.frames) first_point.push_back(first_point.back() + frame.size());
  const auto index = [&](std::size_t t, std::size_t blob) {  // of a point that goes on
    return static_cast<std::uint32_t>(first_point[t] + blob);
  };
  for (std::uint32_t a = 0; a < count; ++a) {
    const Piece& piece = tracks.pieces[a];
    const std::size_t next = piece.last() + 1;
    for (std::uint32_t b = 0; b < count; ++b) {
      const Piece& other = tracks.pieces[b];
      if (other.first <= next || other.first > next + static_cast<std::size_t>(options.gap)) continue;
      const double c = link_cost(tracks.at(piece, piece.last()), tracks.at(other, other.first), options.cost);
      if (c < options.link) costs.push_back({a, b, c});
    }
    if (options.branch <= 0) continue;
    if (next < tracks.frames.size())  // its end joins another that goes on
      for (std::size_t j = 0; j < tracks.frames[next].size(); ++j) {
        if (tracks.pieces[tracks.piece_of[next][j]].first >= next) continue;
        const double c = branch_cost(tracks.at(piece, piece.last()), tracks.frames[next][j], options.cost);
        if (c < options.branch) costs.push_back({a, index(next, j), c});
      }
    if (piece.first > 0)  // its beginning comes from another that goes on
      for (std::size_t i = 0; i < tracks.frames[piece.first - 1].size(); ++i) {
        if (tracks.pieces[tracks.piece_of[piece.first - 1][i]].last() < piece.first) continue;
        const double c =
            branch_cost(tracks.at(piece, piece.first), tracks.frames[piece.first - 1][i], options.cost);
        if (c < options.branch) costs.push_back({index(piece.first - 1, i), a, c});
      }
  }
  return costs;
}

double quantile(std::vector<double> values, double share) {
  std::ranges::sort(values);
  return values[static_cast<std::size_t>(share * static_cast<double>(values.size() - 1))];
}

/// Begin and end of each piece after the second assignment: another piece (a gap closed), a continuing piece
/// (a branch), or nothing.
struct Ends {
  std::vector<bool> gap_before, gap_after;
  std::vector<std::size_t> parent, child;  // pieces that it parts from, or joins
};

Ends link_pieces(const Tracks& tracks, const LapOptions& options) {
  const std::size_t count = tracks.pieces.size();
  Ends ends{std::vector<bool>(count), std::vector<bool>(count), std::vector<std::size_t>(count, kNone),
            std::vector<std::size_t>(count, kNone)};
  std::vector<std::size_t> piece_of_point;
  for (const auto& frame : tracks.piece_of)
    piece_of_point.insert(piece_of_point.end(), frame.begin(), frame.end());
  const auto costs = piece_costs(tracks, options);
  if (costs.empty()) return ends;
  std::vector<double> values;
  for (const Cost& c : costs) values.push_back(c.cost);
  const double alternative = std::max(1e-9, kAlternative * quantile(std::move(values), kQuantile));
  for (const auto& [row, column] : solve(costs, alternative)) {
    if (row < count && column < count)
      ends.gap_after[row] = ends.gap_before[column] = true;
    else if (row < count)
      ends.child[row] = piece_of_point[column - count];
    else
      ends.parent[column] = piece_of_point[row - count];
  }
  return ends;
}

}  // namespace

std::vector<graph::Event> lap_strokes(const graph::SketchSequence& sketch, const LapOptions& options) {
  const Tracks tracks = link_frames(blobs_of(sketch), options);
  const Ends ends = link_pieces(tracks, options);
  std::vector<graph::Event> events;
  const auto add = [&](std::size_t t, graph::EventType type, Point place) {
    events.push_back({static_cast<int>(t), type, place, 1, {}, {}});
  };
  using enum graph::EventType;
  for (std::size_t a = 0; a < tracks.pieces.size(); ++a) {
    const Piece& piece = tracks.pieces[a];
    if (piece.blobs.size() < options.least) continue;
    const Blob& first = tracks.at(piece, piece.first);
    if (ends.parent[a] != kNone) {
      const Piece& parent = tracks.pieces[ends.parent[a]];
      add(piece.first, split,
          joint(first, tracks.at(parent, piece.first), tracks.at(parent, piece.first - 1)));
    } else if (piece.first > 0 && !ends.gap_before[a])
      add(piece.first, birth, first.middle);
    const Blob& last = tracks.at(piece, piece.last());
    if (ends.child[a] != kNone) {
      const Piece& child = tracks.pieces[ends.child[a]];
      add(piece.last() + 1, merge,
          joint(last, tracks.at(child, piece.last()), tracks.at(child, piece.last() + 1)));
    } else if (piece.last() + 1 < tracks.frames.size() && !ends.gap_after[a])
      add(piece.last() + 1, death, last.middle);
  }
  graph::sort_events(events);
  return events;
}

std::vector<graph::Event> lap_patches(graph::SketchSequence sketch, double distance) {
  graph::MotionGraph motion{std::move(sketch), {}};
  const double most = distance * distance;
  for (std::size_t t = 0; t < motion.sketch.frames.size(); ++t) {
    motion.links.emplace_back();
    if (t == 0) continue;
    const auto &before = motion.sketch.frames[t - 1], &after = motion.sketch.frames[t];
    std::vector<Cost> costs;
    for (std::uint32_t i = 0; i < before.size(); ++i)
      for (std::uint32_t j = 0; j < after.size(); ++j)
        if (const double c = squared(before.patch(i).position, after.patch(j).position); c < most)
          costs.push_back({i, j, c});
    for (const auto& [i, j] : solve(costs, kAlternative * most))
      motion.links[t].push_back({before.vertices()[i].id, after.vertices()[j].id});
  }
  return graph::stroke_events(graph::identify(std::move(motion)));
}

}  // namespace emberfold::figures
