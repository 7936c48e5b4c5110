// SPDX-License-Identifier: Apache-2.0
#include "sketch/detection/weak_curves.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

#include "core/math/bilinear.hpp"
#include "core/math/fast_round.hpp"
#include "sketch/detection/contrast_gaps.hpp"
#include "sketch/detection/crease_map.hpp"
#include "sketch/detection/half_resolution.hpp"
#include "sketch/detection/oriented_response.hpp"

namespace emberfold::sketch {

using graph::Point;

namespace {

// The search is for what is smooth over 1.7 px and more: at half the resolution. Lengths below are in its
// pixels but where they are said to be of the frame.
constexpr double kPixel = 2;                      // px of the frame
constexpr double kAlong = 4 / kPixel;             // SD of the averaging along a line
constexpr int kFirstOctave = 1, kLastOctave = 3;  // half octaves, of lines
constexpr int kStepOctave = 1;
// SD by which the gradients of texture exceed second derivatives: shading has them everywhere.
constexpr double kStepsMore = 2.5;

// A level, its response, and the level's number.
struct OrientedLevel {
  const ScaleLevel& level;
  const OrientedResponse& response;
  int number;
};

// The mean of the level along a way through a place, bilinear between pixels.
double mean_along(const OrientedLevel& of, std::size_t way, Point at) {
  const OrientedResponse& r = of.response;
  const cv::Mat1f& smooth = of.level.smooth;
  const int width = smooth.cols - 2, height = smooth.rows - 2, reach = r.reach;
  const int column = static_cast<int>(std::floor(at.x)), row = static_cast<int>(std::floor(at.y));
  const auto fx = static_cast<float>(at.x - column), fy = static_cast<float>(at.y - row);
  const auto mean = [&](const auto& level) {
    const auto between = [&](int u, int v) {
      return (1 - fy) * ((1 - fx) * level(u, v) + fx * level(u + 1, v)) +
             fy * ((1 - fx) * level(u, v + 1) + fx * level(u + 1, v + 1));
    };
    float sum = r.weights[0] * between(column, row);
    for (std::size_t i = 0; i < r.taps[way].size(); ++i) {
      const cv::Point tap = r.taps[way][i];
      sum += r.weights[i + 1] * (between(column - tap.x, row - tap.y) + between(column + tap.x, row + tap.y));
    }
    return double{sum};
  };
  if (column >= reach && row >= reach && column + 1 + reach < width && row + 1 + reach < height)
    return mean([&](int u, int v) { return smooth(v + 1, u + 1); });
  return mean([&](int u, int v) {
    return smooth(std::clamp(v, 0, height - 1) + 1, std::clamp(u, 0, width - 1) + 1);
  });
}

// The response less what the two sides of the line differ, where the slope across nearly vanishes; else 0.
// Both sides of a second derivative's filter lie about √3 σ off the line and have 0.242/σ² of its weight
// each. Beside a line the greatest response of the other sign lies 0.87 of the profile's SD from where the
// slope would vanish.
double response_of_both_sides(const OrientedLevel& of, std::size_t way, Point place, Point normal,
                              double response) {
  constexpr double kSide = 1.73, kOfSide = 0.242, kOfDifference = 0.65, kSlope = 0.4,
                   kLeastSlope = 0.3 / kPixel;
  const double sigma = of.level.sigma;
  const auto mean = [&](double away) { return mean_along(of, way, place + normal * away); };
  if (0.5 * std::abs(mean(1) - mean(-1)) > (kSlope * sigma + kLeastSlope) * response) return 0;
  const double difference = std::abs(mean(kSide * sigma) - mean(-kSide * sigma));
  return response - kOfDifference * kOfSide / (sigma * sigma) * difference;
}

// Least responses of a point.
struct PointLimits {
  double ground, response;  // SD of the usual, and how many of it
};

// Contrast counts no more than this many SD above the usual: a short line of great contrast is not a long
// one.
constexpr double kMostCounted = 12;

// Returns where along the normal of pixel (x, y) the response is greatest, if that is within the pixel.
std::optional<double> find_greatest(const cv::Mat1f& response, int x, int y, Point n) {
  constexpr float kNearly = 0.9F;  // the greatest may lie between pixels
  const int dx = core::fast_round(n.x), dy = core::fast_round(n.y);
  if (x > 0 && y > 0 && x + 1 < response.cols && y + 1 < response.rows &&
      std::max(response(y + dy, x + dx), response(y - dy, x - dx)) * kNearly > response(y, x))
    return std::nullopt;
  const auto at = [&](double t) { return core::sample_bilinear(response, x + t * n.x, y + t * n.y); };
  const double ahead = at(1), behind = at(-1), bend = 2 * double{response(y, x)} - (ahead + behind);
  if (bend <= 0) return std::nullopt;
  const double t = 0.5 * (ahead - behind) / bend;
  if (std::abs(t * n.x) > kPixelReach || std::abs(t * n.y) > kPixelReach) return std::nullopt;
  return t;
}

// Puts the line through a pixel into the map, if the response is greatest there across the line.
void put_line(CreaseMapBuilder& map, const OrientedLevel& of, const cv::Mat1f& response,
              const cv::Mat1b& ways, int x, int y, PointLimits limits) {
  const double here = double{response(y, x)}, sigma = of.level.sigma, normalise = sigma * std::sqrt(sigma);
  if (!map.beats(x, y, here * normalise)) return;
  const auto way = std::size_t{ways(y, x)};
  const Point u = of.response.ways[way], n{-u.y, u.x};
  if (!lies_inside(map.size(), {x + sigma * n.x, y + sigma * n.y}) ||
      !lies_inside(map.size(), {x - sigma * n.x, y - sigma * n.y}))
    return;
  const auto t = find_greatest(response, x, y, n);
  if (!t) return;
  const Point place{x + *t * n.x, y + *t * n.y};
  const double z = response_of_both_sides(of, way, place, n, here) / limits.ground;
  if (z < limits.response) return;
  map.put(x, y,
          {place, 0, z, here * normalise, here * line_contrast(sigma), of.number,
           point_evidence(std::min(z, kUsualResponse + kMostCounted), kPixel * std::max(kAlong, sigma))},
          n);
}

// Puts the step through a pixel into the map, likewise. `n`: towards its brighter side.
void put_step(CreaseMapBuilder& map, const OrientedLevel& of, const cv::Mat1f& response, Point n, int x,
              int y, PointLimits limits) {
  constexpr double kFar = 2.5, kSmooth = 2;  // σ: a slope that goes on so far is shading
  const double here = double{response(y, x)}, sigma = of.level.sigma;
  const auto t = find_greatest(response, x, y, n);
  if (!t) return;
  const auto at = [&](double away) {
    return core::sample_bilinear(response, x + away * n.x, y + away * n.y);
  };
  // Mirrored at the frame's border, a slope bends there: its inner side is looked at.
  const auto whole = [&](double way) {
    const double reach = (kFar + kSmooth) * sigma + 1;
    return lies_inside(map.size(), {x + way * reach * n.x, y + way * reach * n.y});
  };
  const bool ahead = whole(1), behind = whole(-1);
  const double far_ahead = at(ahead || !behind ? kFar * sigma : -kFar * sigma),
               far_behind = at(behind || !ahead ? -kFar * sigma : kFar * sigma);
  const double rise = here - 0.5 * (far_ahead + far_behind), z = rise / limits.ground;
  if (z < limits.response) return;
  map.put(x, y,
          {{x + *t * n.x, y + *t * n.y},
           0,
           z,
           rise * std::sqrt(sigma),
           rise * step_contrast(sigma),
           of.number,
           point_evidence(std::min(z - kStepsMore, kUsualResponse + kMostCounted),
                          kPixel * std::max(kAlong, sigma))},
          n);
}

// visit(x, y, SD of the ground there) for every pixel.
template <class Visit>
void visit_pixels(const OrientedResponse& response, Visit visit) {
  std::vector<float> ground;
  for (int y = 0; y < response.negative.rows; ++y) {
    response.ground_row(y, ground);
    for (int x = 0; x < response.negative.cols; ++x) visit(x, y, double{ground[static_cast<std::size_t>(x)]});
  }
}

bool shows_lines(const ScaleLevel& level) {
  return level.channel == 0 && level.octave >= kFirstOctave && level.octave <= kLastOctave;
}

bool shows_steps(const ScaleLevel& level) {
  return level.channel == 0 && level.octave == kStepOctave;
}

// The halved frame that is searched, and what is usual in it, or in that of which it is a part.
struct WeakSearch {
  const ScaleSpace& space;
  double noise;
  const std::vector<double>& usual;

  [[nodiscard]] OrientedResponse response(std::size_t level, Derivative order) const {
    const std::size_t at = level + (order == Derivative::first ? space.size() : 0);
    return compute_oriented_response(space[level], order, kAlong, noise, usual.empty() ? 0 : usual[at]);
  }
};

CreaseLines find_line_points(const WeakSearch& frame, const WeakCurveLimits& limits) {
  const ScaleSpace& space = frame.space;
  CreaseMapBuilder ridges(space, CreaseKind::ridge), valleys(space, CreaseKind::valley);
  for (std::size_t k = 0; k < space.size(); ++k) {
    const ScaleLevel& level = space[k];
    if (!shows_lines(level)) continue;
    const OrientedResponse r = frame.response(k, Derivative::second);
    const OrientedLevel of{level, r, static_cast<int>(k)};
    const double contrast = limits.contrast / line_contrast(level.sigma);
    visit_pixels(r, [&](int x, int y, double ground) {
      const double least = std::max(limits.response * ground, contrast);
      const PointLimits at{ground, limits.response};
      if (double{r.negative(y, x)} >= least) put_line(ridges, of, r.negative, r.negative_way, x, y, at);
      if (double{r.positive(y, x)} >= least) put_line(valleys, of, r.positive, r.positive_way, x, y, at);
    });
  }
  return {ridges.finish(), valleys.finish()};
}

CreaseMap find_step_points(const WeakSearch& frame, const WeakCurveLimits& limits) {
  const ScaleSpace& space = frame.space;
  CreaseMapBuilder steps(space, CreaseKind::step);
  for (std::size_t k = 0; k < space.size(); ++k) {
    const ScaleLevel& level = space[k];
    if (!shows_steps(level)) continue;
    const OrientedResponse r = frame.response(k, Derivative::first);
    const OrientedLevel of{level, r, static_cast<int>(k)};
    const double response = limits.response + kStepsMore,
                 contrast = 2 * limits.contrast / step_contrast(level.sigma);
    visit_pixels(r, [&](int x, int y, double ground) {
      const double least = std::max(response * ground, contrast);
      const auto normal = [&](const cv::Mat1b& ways, double sign) {
        const Point u = r.ways[ways(y, x)];
        return Point{-sign * u.y, sign * u.x};
      };
      const PointLimits at{ground, response};
      if (double{r.negative(y, x)} >= least)
        put_step(steps, of, r.negative, normal(r.negative_way, -1), x, y, at);
      if (double{r.positive(y, x)} >= least)
        put_step(steps, of, r.positive, normal(r.positive_way, 1), x, y, at);
    });
  }
  return steps.finish();
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
    if (i < gone.size() && gone[i] == 0) {
      if (i == 0) piece.gap[0] = chain.gap[0];
      piece.points.push_back(chain.points[i]);
    } else if (!piece.points.empty()) {
      if (i == gone.size()) piece.gap[1] = chain.gap[1];
      to.push_back(std::exchange(piece, Chain{chain.kind, {}, false}));
    }
  }
}

}  // namespace

void add_samples(const ScaleSpace& space, const FramePart& part, bool steps, ResponseSamples& samples) {
  samples.resize(2 * space.size());
  const ScaleSpace half = HalfResolution(space.front().frame.size()).halved(space);
  const FramePart at = HalfResolution::halved(part);
  const auto add = [&](std::size_t level, Derivative order, std::vector<float>& to) {
    sample_across(compute_oriented_response(half[level], order, kAlong, 0).across, at, to);
  };
  for (std::size_t k = 0; k < half.size(); ++k) {
    if (shows_lines(half[k])) add(k, Derivative::second, samples[k]);
    if (steps && shows_steps(half[k])) add(k, Derivative::first, samples[half.size() + k]);
  }
}

std::vector<double> usual_responses(ResponseSamples samples) {
  std::vector<double> usual;
  for (std::vector<float>& values : samples)
    usual.push_back(values.empty() ? 0 : usual_response(std::move(values)));
  return usual;
}

std::vector<Chain> find_weak_curves(const std::vector<Chain>& strong, const ScaleSpace& space, double noise,
                                    const WeakCurveLimits& limits, const std::vector<double>& usual) {
  const cv::Size frame = space.front().frame.size();
  const HalfResolution halving(frame);
  const ScaleSpace half = halving.halved(space);
  const WeakSearch searched{half, noise, usual};
  constexpr double kSeed = 0.6;          // SD more where a curve begins
  constexpr double kLeastOfPiece = 1.5;  // nats
  constexpr double kLeastLength =
      6 * kPixel * kAlong;          // px of the frame: averaging makes short lines of blobs
  constexpr double kOfGap = 0.25;   // of the usual contrast: ragged curves often fall to half of it
  constexpr double kOfFlank = 1.3;  // more of a flank's contrast: lines with a flat core have such flanks
  Drawn ridges(frame), valleys(frame), all(frame);
  CreaseMap lines_drawn;
  const auto draw = [&](const std::vector<Chain>& chains) {
    for (const Chain& chain : chains) {
      if (chain.kind == CreaseKind::ridge) ridges.add(chain);
      if (chain.kind == CreaseKind::valley) valleys.add(chain);
      if (chain.kind != CreaseKind::step)
        for (const CreasePoint& p : chain.points) lines_drawn.points.push_back(halving.halved(p));
      all.add(chain);
    }
  };
  draw(strong);
  std::vector<Chain> found;
  const auto trace = [&](const CreaseMap& map, double begins, const Drawn& same, const Drawn& opposite) {
    std::vector<Chain> chains = trace_curves(map, half, {begins});
    for (Chain& chain : chains) chain = halving.to_frame(chain);
    chains = remove_hooks(std::move(chains));
    std::erase_if(chains, [&](const Chain& chain) {
      return evidence(chain) < limits.evidence || arc_lengths(chain).back() < kLeastLength;
    });
    // Averaging along a line closes its gaps.
    const int numbered = std::max(last_gap(strong), last_gap(found));
    for (const Chain& piece : cut_at_contrast_gaps(chains, space, {kOfGap, noise, numbered}))
      add_pieces(piece, same, opposite, found);
  };
  CreaseLines lines = find_line_points(searched, limits);
  for (CreaseMap* map : {&lines.ridges, &lines.valleys}) {
    thin_parallel_points(*map, half);
    const bool bright = map->kind == CreaseKind::ridge;
    trace(*map, limits.response + kSeed, bright ? ridges : valleys, bright ? valleys : ridges);
  }
  const auto erase_short = [&] {
    std::erase_if(found, [&](const Chain& piece) {
      return evidence(piece) < kLeastOfPiece || arc_lengths(piece).back() < limits.length;
    });
  };
  erase_short();
  if (!limits.steps) return found;
  draw(found);
  CreaseMap steps = find_step_points(searched, limits);
  remove_flanks(steps, lines_drawn, half, kOfFlank * limits.of_flank);
  thin_parallel_points(steps, half);
  trace(steps, limits.response + kStepsMore + kSeed, all, all);
  erase_short();
  return found;
}

}  // namespace emberfold::sketch
