// SPDX-License-Identifier: Apache-2.0
#include "graph/network/tip_growth.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "core/math/robust.hpp"
#include "graph/events/joints.hpp"
#include "graph/events/tip_links.hpp"
#include "graph/io/table_text.hpp"

namespace emberfold::graph {

namespace {

constexpr std::size_t kLongestPart = 200;  // frames; bounds the time
constexpr std::size_t kShortestPart = 3;   // frames: a tip that is missed for one jumps there and back
constexpr double kLeastNoise = 0.25;       // px, SD of a tip's place: no sketch is more exact
constexpr double kLeastWay = 3;            // px of a growth
constexpr double kErrors = 3;              // standard errors that a rate is at least
constexpr double kPartPenalty = 3;         // times ln(frames): slope, level and place of a cut

/// A tip's places, and how far it has gone out of its curve.
struct TipTrack {
  int first = 0;
  CurveId curve;
  std::vector<Point> places;
  std::vector<double> way;  ///< px, of the first 0
};

/// Returns the direction in which the curve of a tip ends.
Point direction_at(const AttributeGraph& graph, std::uint32_t tip) {
  std::vector<Point> points;
  double length = 0;
  for (const std::uint32_t v : detail::way_from_tip(graph, tip)) {
    if (!points.empty()) length += distance(points.back(), graph.patch(v).position);
    points.push_back(graph.patch(v).position);
    if (length > detail::kTipReach) break;
  }
  return detail::tip_direction(points);
}

std::vector<TipTrack> follow_tips(const MotionGraph& motion) {
  const auto& frames = motion.sketch.frames;
  std::vector<TipTrack> tracks;
  std::map<std::uint32_t, std::size_t> open;  // by tip of the frame before
  for (std::size_t t = 0; t < frames.size(); ++t) {
    const AttributeGraph& graph = frames[t];
    std::map<std::uint32_t, std::size_t> now;
    if (t > 0) {
      const auto clusters = detail::cluster_frames(frames[t - 1], graph, motion.links[t]);
      for (const auto& [i, j] : detail::link_tips(frames[t - 1], graph, motion.links[t], clusters)) {
        const std::size_t number = open.at(i);
        TipTrack& track = tracks[number];
        if (track.curve != graph.vertices()[j].curve) continue;  // the end of another curve is another tip
        const Point out = direction_at(frames[t - 1], i) + direction_at(graph, j);
        const double length = norm(out);
        const Point step = graph.patch(j).position - track.places.back();
        track.way.push_back(track.way.back() + (length > 0 ? dot(step, out) / length : 0));
        track.places.push_back(graph.patch(j).position);
        now.emplace(j, number);
      }
    }
    for (const std::uint32_t tip : detail::tips_of(graph)) {
      if (!now.emplace(tip, tracks.size()).second) continue;
      tracks.push_back({static_cast<int>(t), graph.vertices()[tip].curve, {graph.patch(tip).position}, {0}});
    }
    open = std::move(now);
  }
  return tracks;
}

/// Returns the SD of a tip's place, px: a second difference has six times its variance.
double place_noise(const std::vector<TipTrack>& tracks) {
  std::vector<double> differences;
  for (const TipTrack& track : tracks)
    for (std::size_t k = 2; k < track.way.size(); ++k)
      differences.push_back(std::abs(track.way[k] - 2 * track.way[k - 1] + track.way[k - 2]));
  if (differences.empty()) return kLeastNoise;
  return std::max(kLeastNoise, 1.4826 * core::median(differences) / std::sqrt(6.0));
}

/// Sums of a way, from which a straight line through any part of it follows.
class LineFits {
 public:
  explicit LineFits(const std::vector<double>& way) : x_{0}, xx_{0}, y_{0}, yy_{0}, xy_{0} {
    for (std::size_t k = 0; k < way.size(); ++k) {
      const auto x = static_cast<double>(k);
      x_.push_back(x_.back() + x), xx_.push_back(xx_.back() + x * x);
      y_.push_back(y_.back() + way[k]), yy_.push_back(yy_.back() + way[k] * way[k]);
      xy_.push_back(xy_.back() + x * way[k]);
    }
  }
  struct Fit {
    double slope = 0, spread = 0, residual = 0;  ///< spread: sum of squares of x about its mean
  };
  /// Fits the points first to last.
  [[nodiscard]] Fit fit(std::size_t first, std::size_t last) const {
    const auto n = static_cast<double>(last - first + 1);
    const auto sum = [&](const std::vector<double>& s) { return s[last + 1] - s[first]; };
    const double spread = sum(xx_) - sum(x_) * sum(x_) / n, cross = sum(xy_) - sum(x_) * sum(y_) / n;
    const double slope = spread > 0 ? cross / spread : 0;
    return {slope, spread, std::max(0.0, sum(yy_) - sum(y_) * sum(y_) / n - slope * cross)};
  }

 private:
  std::vector<double> x_, xx_, y_, yy_, xy_;
};

/// Returns the last points of the parts of the least cost. Neighbouring parts share a point.
std::vector<std::size_t> cut_way(const LineFits& fits, std::size_t count, double noise) {
  const double penalty = kPartPenalty * std::log(static_cast<double>(count));
  std::vector<double> cost(count, std::numeric_limits<double>::max());
  std::vector<std::size_t> from(count, 0);
  cost[0] = -penalty;
  const std::size_t shortest = std::min(kShortestPart, count - 1);
  for (std::size_t last = shortest; last < count; ++last) {
    for (std::size_t first = last > kLongestPart ? last - kLongestPart : 0; first + shortest <= last;
         ++first) {
      if (first > 0 && first < shortest) continue;  // no part ends there
      const double all = cost[first] + fits.fit(first, last).residual / (noise * noise) + penalty;
      if (all < cost[last]) cost[last] = all, from[last] = first;
    }
  }
  std::vector<std::size_t> ends;
  for (std::size_t at = count - 1; at > 0; at = from[at]) ends.push_back(at);
  std::ranges::reverse(ends);
  return ends;
}

/// Returns the running median of three; the ends stay.
std::vector<double> without_spikes(const std::vector<double>& way) {
  std::vector<double> result = way;
  for (std::size_t k = 1; k + 1 < way.size(); ++k)
    result[k] = std::clamp(way[k], std::min(way[k - 1], way[k + 1]), std::max(way[k - 1], way[k + 1]));
  return result;
}

}  // namespace

std::string_view name(TipPhase phase) {
  return phase == TipPhase::growth ? "growth" : phase == TipPhase::retraction ? "retraction" : "pause";
}

std::vector<TipMotion> tip_motions(const MotionGraph& motion) {
  constexpr std::size_t kLeastFrames = 3;
  const auto tracks = follow_tips(motion);
  const double noise = place_noise(tracks);
  std::vector<TipMotion> motions;
  std::uint32_t number = 0;
  for (const TipTrack& track : tracks) {
    if (track.way.size() < kLeastFrames) continue;
    ++number;
    const LineFits fits(without_spikes(track.way));
    std::size_t first = 0;
    for (const std::size_t last : cut_way(fits, track.way.size(), noise)) {
      const auto fit = fits.fit(first, last);
      TipMotion part{number,
                     track.curve,
                     TipPhase::pause,
                     track.first + static_cast<int>(first),
                     track.first + static_cast<int>(last),
                     track.places[first],
                     track.places[last],
                     fit.slope,
                     noise / std::sqrt(fit.spread)};
      const double way = std::abs(fit.slope) * static_cast<double>(last - first);
      if (way >= kLeastWay && std::abs(fit.slope) > kErrors * part.error)
        part.phase = fit.slope > 0 ? TipPhase::growth : TipPhase::retraction;
      motions.push_back(part);
      first = last;
    }
  }
  return motions;
}

void write_tips(std::ostream& out, const std::vector<TipMotion>& motions, const Units& units) {
  std::string text = "tip,curve,phase,first,last,x,y,x_end,y_end,length,rate,error";
  detail::end_head(text, units, ",first_s,last_s,rate_px_s", ",length_um", ",rate_um_s");
  for (const TipMotion& one : motions) {
    detail::TableLine line(text, units);
    line.add(one.tip), line.add(one.curve.value), line.add_name(name(one.phase));
    line.add(static_cast<std::uint32_t>(one.first)), line.add(static_cast<std::uint32_t>(one.last));
    const double length = one.rate * (one.last - one.first);
    line.add_place(one.begin), line.add_place(one.end);
    for (const double value : {length, one.rate, one.error}) line.add(value);
    const double step = units.step(one.first, one.last);
    line.add_time(one.first), line.add_time(one.last);
    if (units.seconds) line.add(one.rate / step);
    line.add_length_um(length);
    if (units.seconds && units.um) line.add(one.rate * *units.um / step);
    line.end();
  }
  detail::write_table(out, text);
}

}  // namespace emberfold::graph
