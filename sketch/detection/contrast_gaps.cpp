// SPDX-License-Identifier: Apache-2.0
#include "sketch/detection/contrast_gaps.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

#include "core/math/bilinear.hpp"
#include "core/math/robust.hpp"

namespace emberfold::sketch {

using graph::Point;

namespace {

constexpr double kAround = 20;  // px along the curve: range in which the usual contrast is measured

// ---- at the curve's own scale ----

std::vector<double> own_responses(const Chain& chain, const ScaleLevel& level) {
  std::vector<double> response(chain.points.size());
  for (std::size_t i = 0; i < response.size(); ++i) {
    const Point u = tangent(chain, i);
    if (chain.kind == CreaseKind::step) {
      const Point p = chain.points[i].position, across = Point{-u.y, u.x} * level.sigma;
      response[i] = std::abs(level.value_at(p + across) - level.value_at(p - across));
    } else {
      const double second = level.hessian_at(chain.points[i].position).along({-u.y, u.x});
      response[i] = chain.kind == CreaseKind::ridge ? -second : second;
    }
  }
  return response;
}

// A dip of less than 3 px inside a curve is noise, not a gap: blur alone would fill it.
void bridge_short_dips(std::vector<bool>& keep, const std::vector<double>& s) {
  const std::size_t n = keep.size();
  for (std::size_t i = 1; i < n; ++i) {
    if (keep[i] || !keep[i - 1]) continue;
    std::size_t end = i;
    while (end < n && !keep[end]) ++end;
    if (end < n && s[end] - s[i - 1] < 3)
      for (std::size_t j = i; j < end; ++j) keep[j] = true;
    i = end;
  }
}

std::vector<bool> unfaded(const Chain& chain, const ScaleLevel& level, const std::vector<double>& s,
                          double share) {
  const std::size_t n = chain.points.size();
  const std::vector<double> response = own_responses(chain, level);
  // Six in ten of the points around lie below what is usual: as many must not ask for more than there is.
  std::vector<double> asked(n);
  for (std::size_t i = 0; i < n; ++i) asked[i] = share * response[i];
  std::vector<bool> keep(n);
  for (std::size_t i = 0, from = 0, to = 0; i < n; ++i) {
    while (s[i] - s[from] > kAround) ++from;
    while (to < n && s[to] - s[i] <= kAround) ++to;
    std::size_t met = 0;
    for (std::size_t j = from; j < to; ++j) met += asked[j] <= response[i] ? 1 : 0;
    keep[i] = met > static_cast<std::size_t>(0.6 * static_cast<double>(to - from));
  }
  bridge_short_dips(keep, s);
  return keep;
}

// ---- in the frame itself ----

/// Along a curve, more being more of it: what shows in its middle, and how far that is beyond its sides.
struct Showing {
  std::vector<double> middle, contrast;
  double error = 0;  // grey levels, SD of a contrast
};

double level_at(const cv::Mat1f& frame, Point p) {
  return core::sample_bilinear(frame, p.x, p.y);
}

// SD of a contrast from point to point through noise and texture.
double roughness(const std::vector<double>& values) {
  std::vector<double> bends;
  for (std::size_t i = 1; i + 1 < values.size(); ++i)
    bends.push_back(std::abs(values[i - 1] - 2 * values[i] + values[i + 1]));
  if (bends.empty()) return 0;
  return core::kMadToSd * core::median(std::move(bends)) / std::sqrt(6.0);
}

Showing showing(const Chain& chain, const cv::Mat1f& frame, double sigma, double noise) {
  constexpr double kNoise = 0.6;  // of the pixels', in a contrast
  const std::size_t n = chain.points.size();
  const double sign = chain.kind == CreaseKind::valley ? -1 : 1;
  Showing shows{std::vector<double>(n), std::vector<double>(n)};
  for (std::size_t i = 0; i < n; ++i) {
    const Point p = chain.points[i].position, u = tangent(chain, i), across{-u.y, u.x};
    const auto both = [&](double d) {
      return std::pair(level_at(frame, p + across * (d * sigma)), level_at(frame, p - across * (d * sigma)));
    };
    const auto sum = [&](double d) {
      const auto [right, left] = both(d);
      return right + left;
    };
    if (chain.kind == CreaseKind::step) {
      const auto [right, left] = both(1);
      const auto [more_right, more_left] = both(1.5);
      shows.contrast[i] = 0.5 * std::abs((right - left) + (more_right - more_left));
    } else {  // weights: a Gaussian of SD sigma
      shows.middle[i] =
          sign * (level_at(frame, p) + 0.8825 * sum(0.5) + 0.6065 * sum(1)) / (1 + 2 * (0.8825 + 0.6065));
      shows.contrast[i] = shows.middle[i] - sign * 0.25 * (sum(2) + sum(2.5));
    }
  }
  shows.error = std::max(kNoise * noise, roughness(shows.contrast));
  return shows;
}

// 70 % quantile of [first, last): beside a gap, some of the points still belong to it.
double typical_contrast(const std::vector<double>& values, std::size_t first, std::size_t last,
                        std::vector<double>& scratch) {
  const auto from = values.begin();
  scratch.assign(from + static_cast<std::ptrdiff_t>(first), from + static_cast<std::ptrdiff_t>(last));
  return core::order_statistic(scratch, 7 * scratch.size() / 10);
}

/// Part of a curve about a place in which the usual contrast is measured.
struct Around {
  std::size_t from, at, to;  // of points
};

// Contrast below which points lie in a gap about `around.at`; 0 where there is no gap.
double gap_level(const Showing& shows, CreaseKind kind, const std::vector<double>& contrast, Around around,
                 double error, double share, std::vector<double>& scratch) {
  // For its fainter side too it is a gap, not a step down, nor a contrast that varies by a fifth in noise.
  constexpr double kVaries = 0.8, kSure = 4;  // SD
  constexpr double kFalls = 0.9;              // of what is missed, by which the middle falls at least
  const auto [from, at, to] = around;
  const auto place = [&](std::size_t i) { return shows.contrast.begin() + static_cast<std::ptrdiff_t>(i); };
  if (contrast[at] > share * *std::max_element(place(from), place(to))) return 0;
  const double before = typical_contrast(shows.contrast, from, at, scratch),
               after = typical_contrast(shows.contrast, at + 1, to, scratch);
  if (!(before > 0) || !(after > 0)) return 0;
  const double both = std::sqrt(before * after), here = contrast[at];
  if (here > share * both - error || here > kVaries * std::min(before, after) - kSure * error) return 0;
  const double level = 0.5 * (typical_contrast(shows.middle, from, at, scratch) +
                              typical_contrast(shows.middle, at + 1, to, scratch));
  if (kind != CreaseKind::step && level - shows.middle[at] < kFalls * (1 - share) * both) return 0;
  return share * both;
}

// Points that lie in narrow gaps: at single points, where noise allows that, and evened along the curve.
std::vector<bool> in_gaps(const Chain& chain, const cv::Mat1f& frame, double sigma,
                          const std::vector<double>& s, const ContrastGapLimits& limits) {
  constexpr double kLeastSide = 6;  // px: shorter pieces would not stay
  const std::size_t n = chain.points.size();
  std::vector<bool> gap(n, false);
  if (s.back() < 2 * kLeastSide) return gap;
  const Showing shows = showing(chain, frame, sigma, limits.noise);
  std::vector<double> evened = shows.contrast, scratch;
  for (std::size_t i = 1; i + 1 < n; ++i)
    evened[i] = 0.5 * shows.contrast[i] + 0.25 * (shows.contrast[i - 1] + shows.contrast[i + 1]);
  const auto search = [&](const std::vector<double>& contrast, double error) {
    for (std::size_t i = 1, from = 0, to = 0; i + 1 < n; ++i) {
      while (s[i] - s[from] > kAround) ++from;
      while (to < n && s[to] - s[i] <= kAround) ++to;
      if (s[i] < kLeastSide || s.back() - s[i] < kLeastSide) continue;
      if (contrast[i] > contrast[i - 1] || contrast[i] >= contrast[i + 1]) continue;
      const double level =
          gap_level(shows, chain.kind, contrast, {from, i, to}, error, limits.share, scratch);
      if (level <= 0) continue;
      gap[i] = true;
      for (std::size_t j = i; j-- > 0 && contrast[j] < level;) gap[j] = true;
      for (std::size_t j = i + 1; j < n && contrast[j] < level; ++j) gap[j] = true;
    }
  };
  search(shows.contrast, shows.error);
  search(evened, std::sqrt(0.375) * shows.error);
  return gap;
}

// ---- both ----

/// The pieces that stay; `number`: of the last gap.
void split_chain(const Chain& chain, const std::vector<double>& s, const std::vector<bool>& keep,
                 const std::vector<bool>& gap, int& number, std::vector<Chain>& pieces) {
  constexpr double kLeastBetween = 6;  // px
  const std::size_t n = chain.points.size();
  bool behind_gap = false;  // since the last piece
  for (std::size_t i = 0; i < n;) {
    const bool stays = keep[i] && !gap[i];
    behind_gap = behind_gap || gap[i];
    if (!stays) {
      ++i;
      continue;
    }
    std::size_t end = i;
    while (end < n && keep[end] && !gap[end]) ++end;
    const bool between = behind_gap && end < n && gap[end];
    if (end - i >= 2 && !(between && s[end - 1] - s[i] < kLeastBetween)) {
      Chain piece{chain.kind,
                  {chain.points.begin() + static_cast<std::ptrdiff_t>(i),
                   chain.points.begin() + static_cast<std::ptrdiff_t>(end)},
                  false};
      if (behind_gap) piece.gap[0] = ++number;
      pieces.push_back(std::move(piece));
      behind_gap = false;
    }
    i = end;
  }
}

// ---- between two curves ----

// Ends that lie at no gap yet.
std::vector<CurveEnd> open_ends(const std::vector<Chain>& chains) {
  std::vector<CurveEnd> ends = free_ends(chains);
  std::erase_if(ends, [&](const CurveEnd& end) { return chains[end.chain].gap.at(end.back ? 1 : 0) > 0; });
  return ends;
}

// The points of a curve from one of its ends on, as far as what is usual is measured.
std::vector<CreasePoint> points_from(const Chain& chain, bool back, std::size_t most) {
  const auto count = static_cast<std::ptrdiff_t>(std::min(most, chain.points.size()));
  if (back) return {chain.points.rbegin(), chain.points.rbegin() + count};
  return {chain.points.begin(), chain.points.begin() + count};
}

// Returns the numbers of points of either curve in a gap on the way from one end to another; nothing
// where there is no gap.
std::optional<std::array<std::size_t, 2>> points_in_gap(const std::vector<Chain>& chains,
                                                        const CurveEnd& from, const CurveEnd& to,
                                                        const ScaleSpace& space,
                                                        const ContrastGapLimits& limits) {
  constexpr std::size_t kMost = 20;
  const std::size_t most =
      from.chain == to.chain ? std::min(kMost, chains[from.chain].points.size() / 2) : kMost;
  Chain way{chains[from.chain].kind, points_from(chains[from.chain], from.back, most), false};
  std::ranges::reverse(way.points);
  const std::size_t first = way.points.size();
  const Point step = to.position - from.position;
  const int steps = static_cast<int>(std::ceil(graph::norm(step)));
  for (int k = 1; k < steps; ++k) {
    CreasePoint point = way.points[first - 1];
    point.position = from.position + step * (1.0 * k / steps);
    way.points.push_back(point);
  }
  const std::size_t last = way.points.size();  // the other end
  const auto behind = points_from(chains[to.chain], to.back, most);
  way.points.insert(way.points.end(), behind.begin(), behind.end());
  const ScaleLevel& own = space[median_level(way.points, space)];
  const std::vector<bool> gap = in_gaps(way, own.frame, own.sigma, arc_lengths(way), limits);
  std::size_t begin = first - 1, end = last;  // of the gap that has points between the ends, or at one
  while (begin <= last && !gap[begin]) ++begin;
  if (begin > last) return std::nullopt;
  while (!gap[end]) --end;
  while (begin > 0 && gap[begin - 1]) --begin;
  while (end + 1 < gap.size() && gap[end + 1]) ++end;
  return std::array{begin < first ? first - begin : 0, end >= last ? end + 1 - last : 0};
}

void trim_end(Chain& chain, bool back, std::size_t count) {
  const auto n = static_cast<std::ptrdiff_t>(std::min(count, chain.points.size() - 2));
  if (back)
    chain.points.erase(chain.points.end() - n, chain.points.end());
  else
    chain.points.erase(chain.points.begin(), chain.points.begin() + n);
}

}  // namespace

int last_gap(const std::vector<Chain>& chains) {
  int last = 0;
  for (const Chain& chain : chains) last = std::max({last, chain.gap[0], chain.gap[1]});
  return last;
}

std::vector<Chain> cut_at_contrast_gaps(const std::vector<Chain>& chains, const ScaleSpace& space,
                                        const ContrastGapLimits& limits) {
  std::vector<Chain> pieces;
  int number = limits.numbered;
  for (const Chain& chain : chains) {
    const std::size_t own = median_level(chain.points, space);
    const std::vector<double> s = arc_lengths(chain);
    const std::vector<bool> keep = unfaded(chain, space[own], s, limits.share);
    const std::vector<bool> gap = in_gaps(chain, space[own].frame, space[own].sigma, s, limits);
    if (std::all_of(keep.begin(), keep.end(), [](bool k) { return k; }) &&
        std::none_of(gap.begin(), gap.end(), [](bool g) { return g; })) {
      pieces.push_back(chain);
      continue;
    }
    const std::size_t first = pieces.size();
    split_chain(chain, s, keep, gap, number, pieces);
    for (std::size_t k = first + 1; k < pieces.size(); ++k) pieces[k - 1].gap[1] = pieces[k].gap[0];
  }
  return pieces;
}

bool shows_gap(const Chain& chain, std::size_t first, std::size_t last, const cv::Mat1f& frame, double sigma,
               const ContrastGapLimits& limits) {
  const std::vector<bool> gap = in_gaps(chain, frame, sigma, arc_lengths(chain), limits);
  const auto at = [&](std::size_t i) { return gap.begin() + static_cast<std::ptrdiff_t>(i); };
  return std::find(at(first), at(last + 1), true) != at(last + 1);
}

std::vector<Chain> part_ends_at_gaps(std::vector<Chain> chains, const ScaleSpace& space,
                                     const ContrastGapLimits& limits) {
  constexpr double kFarthest = 12, kFacing = 0.7, kNear = 5;  // px; cos 45°; px
  struct Pair {
    double apart;
    std::size_t from, to;
  };
  const std::vector<CurveEnd> ends = open_ends(chains);
  std::vector<Pair> pairs;
  for (std::size_t i = 0; i < ends.size(); ++i)
    for (std::size_t j = i + 1; j < ends.size(); ++j) {
      const Point way = ends[j].position - ends[i].position;
      const double apart = graph::norm(way);
      if (apart > kFarthest || chains[ends[i].chain].kind != chains[ends[j].chain].kind) continue;
      const double least = apart > kNear ? kFacing * apart : 0;
      if (graph::dot(ends[i].outward, way) < least || graph::dot(ends[j].outward, way) > -least) continue;
      pairs.push_back({apart, i, j});
    }
  std::ranges::stable_sort(pairs, {}, &Pair::apart);
  std::vector<bool> is_done(ends.size(), false);
  int number = std::max(limits.numbered, last_gap(chains));
  for (const Pair& pair : pairs) {
    if (is_done[pair.from] || is_done[pair.to]) continue;
    is_done[pair.from] = is_done[pair.to] = true;
    const CurveEnd &from = ends[pair.from], &to = ends[pair.to];
    const auto gap = points_in_gap(chains, from, to, space, limits);
    if (!gap) continue;
    trim_end(chains[from.chain], from.back, (*gap)[0]);
    trim_end(chains[to.chain], to.back, (*gap)[1]);
    chains[from.chain].gap.at(from.back ? 1 : 0) = chains[to.chain].gap.at(to.back ? 1 : 0) = ++number;
  }
  return chains;
}

}  // namespace emberfold::sketch
