// SPDX-License-Identifier: Apache-2.0
#include "sketch/patches/patch_placement.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <optional>
#include <set>
#include <utility>

#include "sketch/detection/colour.hpp"
#include "sketch/patches/patch_types.hpp"
#include "sketch/patches/profile.hpp"

namespace emberfold::sketch {

using graph::Edge;
using graph::Patch;
using graph::Point;
using graph::Vertex;
using graph::VertexId;

namespace {

// A patch to be, on its curve.
struct Station {
  std::size_t chain = 0;
  double s = 0;  // arc length
};

struct Ruler {
  const Chain& chain;
  std::vector<double> s;
  int channel = 0;
  [[nodiscard]] double length() const {
    return chain.closed
               ? s.back() + graph::distance(chain.points.back().position, chain.points.front().position)
               : s.back();
  }
};

double wrapped(const Ruler& ruler, double at) {
  if (!ruler.chain.closed) return at;
  const double length = ruler.length();
  return at - length * std::floor(at / length);
}

// The points around a place on the curve, by index; a closed curve goes on at its other end.
template <class Visit>
void visit_around(const Ruler& ruler, double at, double reach, Visit visit) {
  const double length = ruler.length();
  const auto from = [&](double s) {
    return static_cast<std::size_t>(std::lower_bound(ruler.s.begin(), ruler.s.end(), s) - ruler.s.begin());
  };
  const auto range = [&](double low, double high, double shift) {
    for (std::size_t i = from(low); i < ruler.s.size() && ruler.s[i] <= high; ++i)
      visit(i, ruler.s[i] + shift - at);
  };
  if (ruler.chain.closed && at - reach < 0) range(length + at - reach, length, -length);
  range(at - reach, at + reach, 0);
  if (ruler.chain.closed && at + reach > length) range(0, at + reach - length, length);
}

// A parabola through the points of a curve about a place: steadier than the points, and still bent as they
// are.
struct Bow {
  Point origin, slope, bend;  // origin + slope·t + bend·t²
  double off = 0;             // px, RMS distance of the points
  [[nodiscard]] Point at(double t) const { return origin + slope * t + bend * (t * t); }
  [[nodiscard]] Point along(double t) const {
    const Point v = slope + bend * (2 * t);
    const double length = std::sqrt(graph::dot(v, v));
    return length > 1e-9 ? v * (1 / length) : Point{1, 0};
  }
};

std::optional<Bow> bow(const Ruler& ruler, double at, double reach) {
  double m[5] = {};
  Point y[3];
  double before = 0, after = 0;
  const auto& points = ruler.chain.points;
  visit_around(ruler, at, reach, [&](std::size_t i, double t) {
    double power = 1;
    for (int k = 0; k < 5; ++k, power *= t) {
      m[k] += power;
      if (k < 3) y[k] = y[k] + points[i].position * power;
    }
    before = std::min(before, t);
    after = std::max(after, t);
  });
  if (m[0] < 3) return std::nullopt;
  Bow b;
  // At an end a parabola would swing: a straight line must do.
  const bool straight = std::min(-before, after) < 0.5 * reach || m[0] < 6;
  if (straight) {
    const double det = m[0] * m[2] - m[1] * m[1];
    if (det < 1e-6) return std::nullopt;
    b.origin = (y[0] * m[2] - y[1] * m[1]) * (1 / det);
    b.slope = (y[1] * m[0] - y[0] * m[1]) * (1 / det);
  } else {
    const double c00 = m[2] * m[4] - m[3] * m[3], c01 = m[2] * m[3] - m[1] * m[4],
                 c02 = m[1] * m[3] - m[2] * m[2], c11 = m[0] * m[4] - m[2] * m[2],
                 c12 = m[1] * m[2] - m[0] * m[3], c22 = m[0] * m[2] - m[1] * m[1];
    const double det = m[0] * c00 + m[1] * c01 + m[2] * c02;
    if (std::abs(det) < 1e-6) return std::nullopt;
    b.origin = (y[0] * c00 + y[1] * c01 + y[2] * c02) * (1 / det);
    b.slope = (y[0] * c01 + y[1] * c11 + y[2] * c12) * (1 / det);
    b.bend = (y[0] * c02 + y[1] * c12 + y[2] * c22) * (1 / det);
  }
  double squares = 0;
  visit_around(ruler, at, reach, [&](std::size_t i, double t) {
    const Point d = points[i].position - b.at(t);
    squares += graph::dot(d, d);
  });
  b.off = std::sqrt(squares / m[0]);
  return b;
}

// Place and direction of the points, without smoothing.
Bow chord(const Ruler& ruler, double at) {
  const std::size_t n = ruler.chain.points.size();
  const auto above = std::lower_bound(ruler.s.begin(), ruler.s.end(), at);
  const std::size_t hi = std::min(static_cast<std::size_t>(above - ruler.s.begin()), n - 1),
                    lo = hi > 0 ? hi - 1 : 0;
  const double gap = ruler.s[hi] - ruler.s[lo];
  const double f = gap > 0 ? std::clamp((at - ruler.s[lo]) / gap, 0.0, 1.0) : 0.0;
  const Point a = ruler.chain.points[lo].position, b = ruler.chain.points[hi].position;
  return {a + (b - a) * f, tangent(ruler.chain, f < 0.5 ? lo : hi), {}, 0};
}

constexpr double kBowReach = 10, kMostOff = 0.3;  // px

Bow shape_at(const Ruler& ruler, double at) {
  for (const double reach : {kBowReach, 6.0, 3.0})
    if (const auto b = bow(ruler, at, reach); b && b->off <= kMostOff) return *b;
  return chord(ruler, at);
}

// SD of the profile about a place, from the points' scales; `logarithms`: of the scales.
double spread_at(const Ruler& ruler, const std::vector<double>& logarithms, double at) {
  double log_sigma = 0, count = 0;
  for (double reach = 6; count == 0; reach *= 2)
    visit_around(ruler, at, reach, [&](std::size_t i, double) {
      log_sigma += logarithms[static_cast<std::size_t>(ruler.chain.points[i].level)];
      count += 1;
    });
  return std::exp(log_sigma / count);
}

constexpr double kRibReach = 1.8;  // in spacings

class Cutter {
 public:
  Cutter(const CurveNetwork& network, const ScaleSpace& space, const cv::Mat& levels, double spacing,
         double noise)
      : network_(network), levels_(levels), spacing_(spacing), noise_(noise) {
    for (const ScaleLevel& level : space) logarithms_.push_back(std::log(level.sigma));
    for (const Chain& chain : network.chains)
      rulers_.push_back({chain, arc_lengths(chain), space[median_level(chain.points, space)].channel});
  }

  graph::AttributeGraph run() {
    stops_.resize(network_.chains.size());
    for (const auto& meeting : network_.meetings) place_meeting(meeting);
    met_ = static_cast<std::uint32_t>(vertices_.size());
    for (std::size_t c = 0; c < rulers_.size(); ++c) place_along(c);
    std::vector<Edge> edges;
    std::vector<bool> joined(vertices_.size(), false);
    for (const auto& [a, b] : edges_) {
      edges.push_back({VertexId{a}, VertexId{b}});
      joined[a] = joined[b] = true;
    }
    // A curve whose ends met at nearly one place has shrunk to a single patch; drop it.
    std::erase_if(vertices_, [&](const Vertex& v) { return !joined[v.id.value]; });
    return name_patch_types(std::move(vertices_), std::move(edges));
  }

 private:
  // The patch at a station, `aside` px from the curve, free to move or not.
  [[nodiscard]] Patch fit(const Station& station, const Bow& shape, double aside, bool moves) const {
    const Ruler& ruler = rulers_[station.chain];
    const double at = wrapped(ruler, station.s), length = ruler.length();
    // Ribs along the curve as far as it goes, the nearer the more they count.
    const double reach = kRibReach * spacing_;
    std::vector<Rib> ribs;
    ribs.reserve(static_cast<std::size_t>(reach / 1.5) * 2 + 2);
    for (double t = -std::floor(reach / 1.5) * 1.5; t < reach; t += 1.5) {
      if (!ruler.chain.closed && (at + t < -0.5 || at + t > length + 0.5)) continue;
      const Point u = shape.along(t);
      const Point across{-u.y, u.x};
      ribs.push_back({shape.at(t) + across * aside, across, 1 - std::abs(t) / reach});
    }
    const Point u = shape.along(0), across{-u.y, u.x};
    const FitOptions options{spread_at(ruler, logarithms_, at), moves, noise_, colour_axis(ruler.channel)};
    return fit_patch(levels_, shape.at(0) + across * aside, std::atan2(u.y, u.x), ruler.chain.kind, ribs,
                     options);
  }

  // Sums the evidence of the points nearest to this patch.
  [[nodiscard]] double evidence_near(const Station& station) const {
    const Ruler& ruler = rulers_[station.chain];
    double nats = 0;
    visit_around(ruler, wrapped(ruler, station.s), 0.5 * spacing_,
                 [&](std::size_t i, double) { nats += ruler.chain.points[i].evidence; });
    return nats;
  }

  std::uint32_t add(const Station& station, bool moves) {
    const auto id = static_cast<std::uint32_t>(vertices_.size());
    const Ruler& ruler = rulers_[station.chain];
    shapes_.push_back(shape_at(ruler, wrapped(ruler, station.s)));
    vertices_.push_back({VertexId{id}, {}, fit(station, shapes_.back(), 0, moves)});
    vertices_.back().patch.evidence = evidence_near(station);
    stations_.push_back(station);
    return id;
  }

  // Distance by which a patch moved to the right of its curve.
  [[nodiscard]] double normal_offset(std::uint32_t id) const {
    const Patch& patch = vertices_[id].patch;
    const Point off = patch.position - shapes_[id].at(0);
    return graph::dot(off, {-std::sin(patch.theta), std::cos(patch.theta)});
  }

  // The sides of a curve shift its crease evenly along the curve. A patch that moved differently from its
  // neighbours is fitted again at their offset.
  void settle(const std::vector<std::uint32_t>& ids, bool closed) {
    constexpr std::ptrdiff_t kAround = 3;  // patches to each side
    constexpr double kOtherwise = 0.15;    // px
    const auto n = static_cast<std::ptrdiff_t>(ids.size());
    if (n < 3) return;
    std::vector<double> offset, around;
    for (const std::uint32_t id : ids) offset.push_back(normal_offset(id));
    for (std::ptrdiff_t i = 0; i < n; ++i) {
      around.clear();
      for (std::ptrdiff_t j = i - kAround; j <= i + kAround; ++j)
        if (closed || (j >= 0 && j < n))
          around.push_back(offset[static_cast<std::size_t>(((j % n) + n) % n)]);
      std::sort(around.begin(), around.end());
      const double usual = 0.5 * (around[around.size() / 2] + around[(around.size() - 1) / 2]);
      const std::uint32_t id = ids[static_cast<std::size_t>(i)];
      if (std::abs(usual - offset[static_cast<std::size_t>(i)]) > kOtherwise)
        vertices_[id].patch = fit(stations_[id], shapes_[id], usual, false),
        vertices_[id].patch.evidence = evidence_near(stations_[id]);
    }
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
    const std::uint32_t id = add({host.chain, s}, false);
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

  void place_along(std::size_t c) {
    auto& stops = stops_[c];  // arc length → patch that is there already
    const Ruler& ruler = rulers_[c];
    const double length = ruler.length();
    if (ruler.chain.closed) {
      if (stops.empty()) stops.emplace(0.0, add({c, 0.0}, true));
      const auto [first_s, first_id] = *stops.begin();
      stops.emplace(first_s + length, first_id);
    } else {
      // A free end next to a stop is that stop's.
      if (stops.empty() || stops.begin()->first > 0.5 * spacing_) stops.emplace(0.0, add({c, 0.0}, true));
      if (length - stops.rbegin()->first > 0.5 * spacing_) stops.emplace(length, add({c, length}, true));
    }
    std::vector<std::uint32_t> ids;  // of the patches that may move, in order
    const auto free = [&](std::uint32_t id) { return id >= met_ && stations_[id].chain == c; };
    if (free(stops.begin()->second)) ids.push_back(stops.begin()->second);
    for (auto from = stops.begin(), to = std::next(from); to != stops.end(); ++from, ++to) {
      const double span = to->first - from->first;
      const int pieces =
          std::max(from->second == to->second ? 3 : 1, static_cast<int>(std::lround(span / spacing_)));
      std::uint32_t previous = from->second;
      for (int i = 1; i < pieces; ++i) {
        const double s = from->first + span * i / pieces;
        const std::uint32_t next = add({c, s}, true);
        ids.push_back(next);
        connect(previous, next);
        previous = next;
      }
      connect(previous, to->second);
      if (free(to->second) && (ids.empty() || to->second != ids.front())) ids.push_back(to->second);
    }
    settle(ids, ruler.chain.closed);
  }

  const CurveNetwork& network_;
  const cv::Mat& levels_;
  double spacing_;
  double noise_;
  std::vector<double> logarithms_;  // of the scales
  std::vector<Ruler> rulers_;
  std::vector<std::map<double, std::uint32_t>> stops_;
  std::vector<Vertex> vertices_;
  std::vector<Station> stations_;  // of the vertices
  std::vector<Bow> shapes_;        // of the curves there
  std::uint32_t met_ = 0;          // vertices before it are those of meetings
  std::set<std::pair<std::uint32_t, std::uint32_t>> edges_;
};

}  // namespace

graph::AttributeGraph place_patches(const CurveNetwork& network, const ScaleSpace& space,
                                    const cv::Mat& levels, double spacing, double noise) {
  return Cutter(network, space, levels, spacing, noise).run();
}

}  // namespace emberfold::sketch
