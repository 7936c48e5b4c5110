// SPDX-License-Identifier: Apache-2.0
#include "sketch/detection/weak_lines.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "core/math/bilinear.hpp"
#include "core/math/fast_round.hpp"
#include "sketch/detection/crease_map.hpp"
#include "sketch/detection/oriented_response.hpp"

namespace emberfold::sketch {

using graph::Point;

namespace {

constexpr double kAlong = 4;                      // px: SD of the averaging along a line
constexpr int kFirstOctave = 1, kLastOctave = 3;  // half octaves

// A level, its response, and the level's number.
struct OrientedLevel {
  const ScaleLevel& level;
  const OrientedResponse& response;
  int number;
};

// The mean of the level along a way, `away` px beside pixel (x, y).
double mean_beside(const OrientedLevel& of, std::size_t way, int x, int y, Point away) {
  const OrientedResponse& r = of.response;
  const cv::Mat1f& smooth = of.level.smooth;
  const int width = smooth.cols - 2, height = smooth.rows - 2, reach = r.reach;
  const int column = core::fast_round(x + away.x), row = core::fast_round(y + away.y);
  const auto mean = [&](const auto& at) {
    float sum = r.weights[0] * at(column, row);
    for (std::size_t i = 0; i < r.taps[way].size(); ++i) {
      const cv::Point tap = r.taps[way][i];
      sum += r.weights[i + 1] * (at(column - tap.x, row - tap.y) + at(column + tap.x, row + tap.y));
    }
    return double{sum};
  };
  if (column >= reach && row >= reach && column + reach < width && row + reach < height)
    return mean([&](int u, int v) { return smooth(v + 1, u + 1); });
  return mean([&](int u, int v) {
    return smooth(std::clamp(v, 0, height - 1) + 1, std::clamp(u, 0, width - 1) + 1);
  });
}

// The response less what the two sides of the line differ, where the slope across nearly vanishes; else 0.
// Both sides of a second derivative's filter lie about √3 σ off the line and have 0.242/σ² of its weight
// each. Beside a line the greatest response of the other sign lies 0.87 of the profile's SD from where the
// slope would vanish.
double response_of_both_sides(const OrientedLevel& of, std::size_t way, int x, int y, Point normal,
                              double response) {
  constexpr double kSide = 1.73, kOfSide = 0.242, kOfDifference = 0.7, kSlope = 0.4, kLeastSlope = 0.3;  // px
  const double sigma = of.level.sigma;
  const auto mean = [&](double away) { return mean_beside(of, way, x, y, normal * away); };
  if (0.5 * std::abs(mean(1) - mean(-1)) > (kSlope * sigma + kLeastSlope) * response) return 0;
  const double difference = std::abs(mean(kSide * sigma) - mean(-kSide * sigma));
  return response - kOfDifference * kOfSide / (sigma * sigma) * difference;
}

// Puts the line through a pixel into the map, if the response is greatest there across the line.
void put_point(CreaseMapBuilder& map, const OrientedLevel& of, const cv::Mat1f& response,
               const cv::Mat1b& ways, int x, int y, double ground, double least) {
  constexpr double kMostCounted = 4;  // SD above the usual: a short line of great contrast is not a long one
  const double here = double{response(y, x)}, sigma = of.level.sigma, normalise = sigma * std::sqrt(sigma);
  if (!map.beats(x, y, here * normalise)) return;
  const auto way = std::size_t{ways(y, x)};
  const Point u = of.response.ways[way], n{-u.y, u.x};
  if (!lies_inside(map.size(), {x + sigma * n.x, y + sigma * n.y}) ||
      !lies_inside(map.size(), {x - sigma * n.x, y - sigma * n.y}))
    return;
  constexpr float kNearly = 0.9F;  // the greatest may lie between pixels
  const int dx = core::fast_round(n.x), dy = core::fast_round(n.y);
  if (x > 0 && y > 0 && x + 1 < response.cols && y + 1 < response.rows &&
      std::max(response(y + dy, x + dx), response(y - dy, x - dx)) * kNearly > response(y, x))
    return;
  const auto at = [&](double t) { return core::sample_bilinear(response, x + t * n.x, y + t * n.y); };
  const double ahead = at(1), behind = at(-1), bend = 2 * here - (ahead + behind);
  if (bend <= 0) return;
  const double t = 0.5 * (ahead - behind) / bend;
  if (std::abs(t * n.x) > kPixelReach || std::abs(t * n.y) > kPixelReach) return;
  const double z = response_of_both_sides(of, way, x, y, n, here) / ground;
  if (z < least) return;
  map.put(x, y,
          {{x + t * n.x, y + t * n.y},
           0,
           z,
           here * normalise,
           here * line_contrast(sigma),
           of.number,
           point_evidence(std::min(z, kUsualResponse + kMostCounted), std::max(kAlong, sigma))},
          n);
}

CreaseLines find_points(const ScaleSpace& space, double noise, const WeakLineLimits& limits) {
  CreaseMapBuilder ridges(space, CreaseKind::ridge), valleys(space, CreaseKind::valley);
  std::vector<float> ground;
  for (std::size_t k = 0; k < space.size(); ++k) {
    const ScaleLevel& level = space[k];
    if (level.channel != 0 || level.octave < kFirstOctave || level.octave > kLastOctave) continue;
    const OrientedResponse response = compute_oriented_response(level, kAlong, noise);
    const OrientedLevel of{level, response, static_cast<int>(k)};
    const double contrast = limits.contrast / line_contrast(level.sigma);
    for (int y = 0; y < ridges.size().height; ++y) {
      response.ground_row(y, ground);
      for (int x = 0; x < ridges.size().width; ++x) {
        const double sd = double{ground[static_cast<std::size_t>(x)]},
                     least = std::max(limits.response * sd, contrast);
        if (double{response.ridge(y, x)} >= least)
          put_point(ridges, of, response.ridge, response.ridge_way, x, y, sd, limits.response);
        if (double{response.valley(y, x)} >= least)
          put_point(valleys, of, response.valley, response.valley_way, x, y, sd, limits.response);
      }
    }
  }
  return {ridges.finish(), valleys.finish()};
}

// Contrast of the curves of one kind at the pixels near them.
class Drawn {
 public:
  explicit Drawn(cv::Size frame) : contrast_(frame, 0.0F) {}

  void add(const Chain& chain) {
    constexpr int kBeside = 2;  // px
    for (const CreasePoint& p : chain.points) {
      const int x = core::fast_round(p.position.x), y = core::fast_round(p.position.y);
      for (int v = std::max(0, y - kBeside); v <= std::min(contrast_.rows - 1, y + kBeside); ++v)
        for (int u = std::max(0, x - kBeside); u <= std::min(contrast_.cols - 1, x + kBeside); ++u)
          contrast_(v, u) = std::max(contrast_(v, u), static_cast<float>(p.contrast));
    }
  }

  [[nodiscard]] double at(Point p) const {
    const int x = core::fast_round(p.x), y = core::fast_round(p.y);
    if (x < 0 || y < 0 || x >= contrast_.cols || y >= contrast_.rows) return 0;
    return double{contrast_(y, x)};
  }

 private:
  cv::Mat1f contrast_;
};

// True on a drawn curve, and where averaging along the line takes in one of more contrast.
bool is_explained(const CreasePoint& p, const Drawn& same, const Drawn& opposite) {
  constexpr double kSmear = 9, kStep = 1.5, kMore = 1.5;  // px, px, of the point's contrast
  if (same.at(p.position) > 0 || opposite.at(p.position) > 0) return true;
  const Point along{std::cos(p.theta), std::sin(p.theta)};
  for (double t = kStep; t <= kSmear; t += kStep)
    for (const double way : {t, -t})
      if (same.at(p.position + along * way) > kMore * p.contrast) return true;
  return false;
}

// Adds the pieces of a curve that nothing explains.
void add_pieces(const Chain& chain, const Drawn& same, const Drawn& opposite, std::vector<Chain>& to) {
  std::vector<char> gone;
  for (const CreasePoint& p : chain.points) gone.push_back(is_explained(p, same, opposite) ? 1 : 0);
  if (std::ranges::find(gone, 1) == gone.end()) {
    to.push_back(chain);
    return;
  }
  Chain piece{chain.kind, {}, false};
  for (std::size_t i = 0; i <= gone.size(); ++i) {
    if (i < gone.size() && gone[i] == 0)
      piece.points.push_back(chain.points[i]);
    else if (!piece.points.empty())
      to.push_back(std::exchange(piece, Chain{chain.kind, {}, false}));
  }
}

}  // namespace

std::vector<Chain> find_weak_lines(const std::vector<Chain>& strong, const ScaleSpace& space, double noise,
                                   const WeakLineLimits& limits) {
  constexpr double kSeed = 0.6;          // SD more where a curve begins
  constexpr double kLeastOfPiece = 1.5;  // nats
  const cv::Size frame = space.front().frame.size();
  Drawn ridges(frame), valleys(frame);
  for (const Chain& chain : strong) {
    if (chain.kind == CreaseKind::ridge) ridges.add(chain);
    if (chain.kind == CreaseKind::valley) valleys.add(chain);
  }
  CreaseLines lines = find_points(space, noise, limits);
  std::vector<Chain> found;
  for (CreaseMap* map : {&lines.ridges, &lines.valleys}) {
    thin_parallel_points(*map, space);
    const bool bright = map->kind == CreaseKind::ridge;
    for (const Chain& chain : remove_hooks(trace_curves(*map, space, {limits.response + kSeed})))
      if (evidence(chain) >= limits.evidence)
        add_pieces(chain, bright ? ridges : valleys, bright ? valleys : ridges, found);
  }
  std::erase_if(found, [&](const Chain& piece) {
    return evidence(piece) < kLeastOfPiece || arc_lengths(piece).back() < limits.length;
  });
  return found;
}

}  // namespace emberfold::sketch
