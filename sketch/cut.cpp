// SPDX-License-Identifier: Apache-2.0
#include "sketch/cut.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <set>
#include <utility>

#include "sketch/profile.hpp"

namespace emberfold::sketch {

using graph::Edge;
using graph::Patch;
using graph::PatchType;
using graph::Point;
using graph::Vertex;
using graph::VertexId;

namespace {

// A patch to be, on its curve.
struct Station {
  std::size_t chain = 0;
  double s = 0;  // arc length
};

struct Sample {
  Point position;
  double theta;
  double spread;
};

struct Ruler {
  const Chain& chain;
  std::vector<double> s;
  [[nodiscard]] double length() const {
    return chain.closed
               ? s.back() + graph::distance(chain.points.back().position, chain.points.front().position)
               : s.back();
  }
};

// Place, direction and spread at an arc length; the direction over ±3 points, the spread over ±5 points,
// steadies both.
Sample sample(const Ruler& ruler, const ScaleSpace& space, double at) {
  const std::size_t n = ruler.chain.points.size();
  const auto above = std::lower_bound(ruler.s.begin(), ruler.s.end(), at);
  const std::size_t hi = std::min(static_cast<std::size_t>(above - ruler.s.begin()), n - 1),
                    lo = hi > 0 ? hi - 1 : 0;
  const double gap = ruler.s[hi] - ruler.s[lo];
  const double f = gap > 0 ? std::clamp((at - ruler.s[lo]) / gap, 0.0, 1.0) : 0.0;
  const Point a = ruler.chain.points[lo].position, b = ruler.chain.points[hi].position;
  const std::size_t nearest = f < 0.5 ? lo : hi;
  const Point u = direction(ruler.chain, nearest);
  double log_sigma = 0;
  const std::size_t first = nearest > 5 ? nearest - 5 : 0, last = std::min(nearest + 5, n - 1);
  for (std::size_t i = first; i <= last; ++i)
    log_sigma += std::log(space[static_cast<std::size_t>(ruler.chain.points[i].level)].sigma);
  return {a + (b - a) * f, std::atan2(u.y, u.x), std::exp(log_sigma / static_cast<double>(last - first + 1))};
}

class Cutter {
 public:
  Cutter(const Network& network, const ScaleSpace& space, const cv::Mat& levels, double spacing)
      : network_(network), space_(space), levels_(levels), spacing_(spacing) {
    for (const Chain& chain : network.chains) rulers_.push_back({chain, arc_lengths(chain)});
  }

  graph::AttributeGraph run() {
    stops_.resize(network_.chains.size());
    for (const auto& meeting : network_.meetings) place_meeting(meeting);
    for (std::size_t c = 0; c < rulers_.size(); ++c) cut(c);
    name_by_degree();
    std::vector<Edge> edges;
    std::vector<bool> joined(vertices_.size(), false);
    for (const auto& [a, b] : edges_) {
      edges.push_back({VertexId{a}, VertexId{b}});
      joined[a] = joined[b] = true;
    }
    // What shrank to one patch when its ends met nearly the same place shows nothing of its own.
    std::erase_if(vertices_, [&](const Vertex& v) { return !joined[v.id.value]; });
    return {std::move(vertices_), std::move(edges)};
  }

 private:
  std::uint32_t add(const Station& station) {
    const Chain& chain = network_.chains[station.chain];
    const Sample at = sample(rulers_[station.chain], space_, station.s);
    const auto id = static_cast<std::uint32_t>(vertices_.size());
    vertices_.push_back(
        {VertexId{id}, {}, fitter_.fit(levels_, at.position, at.theta, chain.kind, at.spread, spacing_)});
    return id;
  }

  void connect(std::uint32_t a, std::uint32_t b) {
    if (a != b) edges_.insert({std::min(a, b), std::max(a, b)});
  }

  // The patch of a meeting lies on the curve that goes through, or where ends meet, in their middle.
  void place_meeting(const std::vector<Contact>& meeting) {
    const auto inner = std::find_if(meeting.begin(), meeting.end(), [&](const Contact& c) {
      return c.point != 0 && c.point + 1 != network_.chains[c.chain].points.size();
    });
    const Contact host = inner != meeting.end() ? *inner : meeting.front();
    const double s = rulers_[host.chain].s[host.point];
    // A patch of an earlier meeting close by serves this one too.
    for (const auto& [other_s, id] : stops_[host.chain])
      if (std::abs(other_s - s) < 0.5 * spacing_) return attach(meeting, id);
    const std::uint32_t id = add({host.chain, s});
    if (inner == meeting.end()) {
      Point middle;
      for (const Contact& c : meeting)
        middle = middle + network_.chains[c.chain].points[c.point].position *
                              (1.0 / static_cast<double>(meeting.size()));
      vertices_[id].patch.position = middle;
    }
    attach(meeting, id);
  }

  void attach(const std::vector<Contact>& meeting, std::uint32_t id) {
    for (const Contact& c : meeting) stops_[c.chain].emplace(rulers_[c.chain].s[c.point], id);
  }

  void cut(std::size_t c) {
    auto& stops = stops_[c];  // arc length → patch that is there already
    const Ruler& ruler = rulers_[c];
    const double length = ruler.length();
    if (ruler.chain.closed) {
      if (stops.empty()) stops.emplace(0.0, add({c, 0.0}));
      const auto [first_s, first_id] = *stops.begin();
      stops.emplace(first_s + length, first_id);
    } else {
      // A free end next to a stop is that stop's.
      if (stops.empty() || stops.begin()->first > 0.5 * spacing_) stops.emplace(0.0, add({c, 0.0}));
      if (length - stops.rbegin()->first > 0.5 * spacing_) stops.emplace(length, add({c, length}));
    }
    for (auto from = stops.begin(), to = std::next(from); to != stops.end(); ++from, ++to) {
      const double span = to->first - from->first;
      const int pieces =
          std::max(from->second == to->second ? 3 : 1, static_cast<int>(std::lround(span / spacing_)));
      std::uint32_t previous = from->second;
      for (int i = 1; i < pieces; ++i) {
        double s = from->first + span * i / pieces;
        if (ruler.chain.closed && s > ruler.s.back())
          s = std::min(s, length) - length >= 0 ? 0 : std::min(s, ruler.s.back());
        const std::uint32_t next = add({c, s});
        connect(previous, next);
        previous = next;
      }
      connect(previous, to->second);
    }
  }

  void name_by_degree() {
    std::vector<std::vector<Point>> arms(vertices_.size());
    for (const auto& [a, b] : edges_) {
      const Point way = vertices_[b].patch.position - vertices_[a].patch.position;
      const double length = std::max(graph::norm(way), 1e-9);
      arms[a].push_back(way * (1 / length));
      arms[b].push_back(way * (-1 / length));
    }
    for (std::size_t i = 0; i < vertices_.size(); ++i) {
      PatchType& type = vertices_[i].patch.type;
      double least = 1;  // cosine between the two arms that come nearest to a straight line
      for (std::size_t a = 0; a < arms[i].size(); ++a)
        for (std::size_t b = a + 1; b < arms[i].size(); ++b)
          least = std::min(least, graph::dot(arms[i][a], arms[i][b]));
      const bool straight = least < -0.866;
      switch (arms[i].size()) {
        case 0:
          break;
        case 1:
          type = PatchType::terminator;
          break;
        case 2:
          if (least > -0.5) type = PatchType::corner;
          break;
        case 3:
          type = straight ? PatchType::t_junction : PatchType::y_junction;
          break;
        default:
          type = PatchType::crossing;
      }
    }
  }

  const Network& network_;
  const ScaleSpace& space_;
  const cv::Mat& levels_;
  double spacing_;
  PatchFitter fitter_;
  std::vector<Ruler> rulers_;
  std::vector<std::map<double, std::uint32_t>> stops_;
  std::vector<Vertex> vertices_;
  std::set<std::pair<std::uint32_t, std::uint32_t>> edges_;
};

}  // namespace

graph::AttributeGraph cut_into_patches(const Network& network, const ScaleSpace& space, const cv::Mat& levels,
                                       double spacing) {
  return Cutter(network, space, levels, spacing).run();
}

}  // namespace emberfold::sketch
