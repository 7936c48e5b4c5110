// SPDX-License-Identifier: Apache-2.0
#include "sketch/tiling/tiles.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <tuple>
#include <utility>

#include <opencv2/core.hpp>

#include "sketch/patches/patch_types.hpp"

namespace emberfold::sketch {

namespace {

using graph::AttributeGraph;
using graph::Point;

constexpr double kAcross = 2.5;   // px between the ends of an edge that two tiles share, across it
constexpr double kMostApart = 1;  // rad between both

// Where part i of `parts` begins.
int part_start(int size, int parts, int i) {
  return static_cast<int>(static_cast<std::int64_t>(size) * i / parts);
}

int parts_of(int size, int most) {
  return (size + most - 1) / most;
}

// An edge that leaves its tile's core.
struct Stub {
  std::uint32_t vertex;  // that stays
  std::size_t tile;
  Point at, away;  // where it is, and the direction of the edge
};

// Two stubs of neighbouring tiles that may be one edge.
struct Pair {
  double cost;
  std::size_t a, b;
};

bool lies_in(const cv::Rect& core, const cv::Size& frame, Point p) {
  const int x = std::clamp(static_cast<int>(std::floor(p.x + 0.5)), 0, frame.width - 1),
            y = std::clamp(static_cast<int>(std::floor(p.y + 0.5)), 0, frame.height - 1);
  return core.contains({x, y});
}

Point turned_to(Point from, Point to) {
  const Point way = to - from;
  const double length = std::max(1e-9, std::sqrt(dot(way, way)));
  return way * (1 / length);
}

// Returns the misfit of two stubs; below 0 if they are not of one edge.
double misfit(const Stub& a, const Stub& b, double spacing) {
  if (dot(a.away, b.away) > -std::cos(kMostApart)) return -1;
  const Point off = b.at - a.at;
  const auto across = [&](Point u) { return std::abs(off.x * u.y - off.y * u.x); };
  const double aside = std::max(across(a.away), across(b.away)), length = std::sqrt(dot(off, off));
  // Patches may lie as close as the seam lets them, even a little past each other.
  if (aside > kAcross || length > 3 * spacing || dot(off, a.away) < -0.5 * spacing) return -1;
  return aside + 0.1 * length;
}

class Joining {
 public:
  Joining(const std::vector<Tile>& tiles, double spacing) : tiles_(tiles), spacing_(spacing) {
    for (const Tile& tile : tiles) {
      frame_.width = std::max(frame_.width, tile.core.br().x);
      frame_.height = std::max(frame_.height, tile.core.br().y);
    }
  }

  void add(std::size_t tile, const AttributeGraph& graph) {
    const Point origin{double(tiles_[tile].read.x), double(tiles_[tile].read.y)};
    std::vector<std::int64_t> id(graph.size(), -1);
    for (std::size_t i = 0; i < graph.size(); ++i) {
      graph::Vertex v = graph.vertices()[i];
      v.patch.position = v.patch.position + origin;
      if (!lies_in(tiles_[tile].core, frame_, v.patch.position)) continue;
      id[i] = static_cast<std::int64_t>(vertices_.size());
      v.id = {static_cast<std::uint32_t>(vertices_.size())};
      vertices_.push_back(v);
    }
    for (const graph::Edge& edge : graph.edges()) {
      const std::size_t a = graph.index_of(edge.a), b = graph.index_of(edge.b);
      const auto stub = [&](std::size_t stays, std::size_t goes) {
        const Point at = graph.patch(stays).position, to = graph.patch(goes).position;
        stubs_.push_back({static_cast<std::uint32_t>(id[stays]), tile, at + origin, turned_to(at, to)});
      };
      if (id[a] >= 0 && id[b] >= 0)
        edges_.push_back(
            {vertices_[static_cast<std::size_t>(id[a])].id, vertices_[static_cast<std::size_t>(id[b])].id});
      else if (id[a] >= 0)
        stub(a, b);
      else if (id[b] >= 0)
        stub(b, a);
    }
  }

  AttributeGraph finish() {
    std::vector<Pair> pairs = find_pairs();
    std::ranges::sort(pairs, {}, [](const Pair& p) { return std::tuple(p.cost, p.a, p.b); });
    std::vector<char> tied(stubs_.size(), 0);
    for (const Pair& pair : pairs) {
      if (tied[pair.a] != 0 || tied[pair.b] != 0) continue;
      tied[pair.a] = tied[pair.b] = 1;
      const graph::VertexId a{stubs_[pair.a].vertex}, b{stubs_[pair.b].vertex};
      edges_.push_back({std::min(a, b), std::max(a, b)});
    }
    std::ranges::sort(edges_);
    edges_.erase(std::unique(edges_.begin(), edges_.end()), edges_.end());
    return name_patch_types(std::move(vertices_), std::move(edges_));
  }

 private:
  // By rows of places, so that only stubs near each other are compared.
  std::vector<Pair> find_pairs() {
    std::ranges::sort(stubs_, {}, [](const Stub& s) { return std::tuple(s.at.y, s.at.x, s.vertex, s.tile); });
    std::vector<Pair> pairs;
    for (std::size_t a = 0; a < stubs_.size(); ++a)
      for (std::size_t b = a + 1; b < stubs_.size() && stubs_[b].at.y - stubs_[a].at.y <= 3 * spacing_; ++b) {
        if (stubs_[a].tile == stubs_[b].tile) continue;
        const double cost = misfit(stubs_[a], stubs_[b], spacing_);
        if (cost >= 0) pairs.push_back({cost, a, b});
      }
    return pairs;
  }

  const std::vector<Tile>& tiles_;
  double spacing_;
  cv::Size frame_{0, 0};
  std::vector<graph::Vertex> vertices_;
  std::vector<graph::Edge> edges_;
  std::vector<Stub> stubs_;
};

}  // namespace

std::vector<Tile> make_tiles(cv::Size frame, int side, int margin) {
  const int across = parts_of(frame.width, side), down = parts_of(frame.height, side);
  const cv::Rect whole(cv::Point(0, 0), frame);
  std::vector<Tile> tiles;
  for (int row = 0; row < down; ++row)
    for (int column = 0; column < across; ++column) {
      const int x = part_start(frame.width, across, column), y = part_start(frame.height, down, row);
      const cv::Rect core(x, y, part_start(frame.width, across, column + 1) - x,
                          part_start(frame.height, down, row + 1) - y);
      const cv::Rect wide(core.x - margin, core.y - margin, core.width + 2 * margin,
                          core.height + 2 * margin);
      tiles.push_back({core, wide & whole});
    }
  return tiles;
}

AttributeGraph join_tiles(const std::vector<Tile>& tiles, const std::vector<AttributeGraph>& sketches,
                          double spacing) {
  Joining joining(tiles, spacing);
  for (std::size_t i = 0; i < tiles.size(); ++i) joining.add(i, sketches[i]);
  return joining.finish();
}

}  // namespace emberfold::sketch
