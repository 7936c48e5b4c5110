// SPDX-License-Identifier: Apache-2.0
#include "sketch/render.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <sstream>
#include <vector>

#include <opencv2/core.hpp>

#include "core/error.hpp"
#include "sketch/blob.hpp"

namespace emberfold::sketch {

namespace {

constexpr double kLeastReach = 1.5, kMostReach = 12;  // px to each side
constexpr double kLeastBlur = 0.2;                    // px: below, a pixel does not show it
constexpr double kEnd = 1;                            // px behind a stroke's last patch
constexpr double kAlone = 2.5;                        // px to each end of a patch without edges
constexpr double kMostTurn = 0.64;                    // cos 50°, from a patch's direction to an edge's
constexpr double kSlack = 1e-3;                       // px: a pixel on the border of two bands is in both
constexpr double kLongestBend = 40;                   // px: longer edges are straight

using Colour = std::array<double, 3>;

/// What a band shows at one place of its curve, sides as seen along the curve.
struct Profile {
  Colour left{}, middle{}, right{};
  double half_width = 0, blur = 1, reach = kLeastReach;
};

Colour colour(const graph::Level& level, int channels) {
  const Colour c = {static_cast<double>(level[0]), static_cast<double>(level[1]),
                    static_cast<double>(level[2])};
  if (channels == 3) return c;
  return {0.114 * c[0] + 0.587 * c[1] + 0.299 * c[2], 0, 0};
}

Profile profile(const graph::Patch& patch, bool backwards, int channels) {
  Profile p;
  p.left = colour(backwards ? patch.right : patch.left, channels);
  p.middle = colour(patch.middle, channels);
  p.right = colour(backwards ? patch.left : patch.right, channels);
  p.half_width = std::max(patch.width, 0.0) / 2;
  p.blur = std::max(patch.blur, kLeastBlur);
  p.reach = std::clamp(p.half_width + 2 * p.blur, kLeastReach, kMostReach);
  return p;
}

double between(double a, double b, double s) {
  return a + s * (b - a);
}

/// A band: a curve from `origin` over `length` px in direction `along`, which rises to the right of it by a
/// cubic with the given slopes at its ends.
struct Band {
  graph::Point origin, along;
  double length = 0;
  double slope_a = 0, slope_b = 0;
  Profile a, b;
  double before = 0, after = 0;           // px by which it goes on straight behind its ends
  bool round_a = false, round_b = false;  // whether its end is rounded, to close the gap at a bend
};

/// Height and its derivatives over the chord.
struct Height {
  double value, slope, curvature;
};
Height height(const Band& band, double u) {
  const double c = std::clamp(u, 0.0, band.length), s = c / band.length;
  const double a = band.slope_a, b = band.slope_b;
  const double slope = a * (3 * s * s - 4 * s + 1) + b * (3 * s * s - 2 * s);
  const double value = band.length * s * (a * (s - 1) * (s - 1) + b * s * (s - 1)) + slope * (u - c);
  const bool inside = u == c;
  return {value, slope, inside ? (a * (6 * s - 4) + b * (6 * s - 2)) / band.length : 0};
}

/// Where a pixel lies with respect to a band: place along it, 0…1, and distance, positive to the right.
struct Foot {
  double s, distance;
  bool at_round_end;
};

std::optional<Foot> foot(const Band& band, double u0, double v0) {
  // Newton's method for the nearest point of the curve, from the one beneath.
  double u = u0;
  Height h = height(band, u);
  if (band.slope_a != 0 || band.slope_b != 0)
    for (int i = 0; i < 4; ++i) {
      const double gradient = (u - u0) + (h.value - v0) * h.slope;
      const double second = 1 + h.slope * h.slope + (h.value - v0) * h.curvature;
      const double step = gradient / std::max(second, 0.3);
      u -= step;
      h = height(band, u);
      if (std::abs(step) < 1e-4) break;
    }
  const double stretch = std::sqrt(1 + h.slope * h.slope);
  if (u >= -band.before - kSlack && u <= band.length + band.after + kSlack)
    return Foot{std::clamp(u / band.length, 0.0, 1.0), ((v0 - h.value) - (u0 - u) * h.slope) / stretch,
                false};
  const bool at_a = u < band.length / 2;
  if (!(at_a ? band.round_a : band.round_b)) return std::nullopt;
  const double slope = at_a ? band.slope_a : band.slope_b, du = at_a ? u0 : u0 - band.length;
  return Foot{at_a ? 0.0 : 1.0, std::copysign(std::hypot(du, v0), v0 - slope * du), true};
}

/// The whole numbers x in [0, count) with low ≤ slope·x + offset ≤ high, as a range that only shrinks.
struct Range {
  int first, last;
  void meet(double slope, double offset, double low, double high) {
    if (std::abs(slope) < 1e-12) {
      if (offset < low || offset > high) last = first - 1;
      return;
    }
    double from = (low - offset) / slope, to = (high - offset) / slope;
    if (from > to) std::swap(from, to);
    const double begin = first, end = last;
    if (from > end || to < begin) {
      last = first - 1;
      return;
    }
    first = static_cast<int>(std::ceil(std::max(from, begin)));
    last = static_cast<int>(std::floor(std::min(to, end)));
  }
};

/// paint(x, y, foot) for every pixel that the band covers.
template <class Paint>
void cover(const Band& band, cv::Size size, Paint paint) {
  const double reach = std::max(band.a.reach, band.b.reach);
  // The cubic stays below 4/27 of the length times the slopes; where it leans, so do its ends.
  const double side = reach + band.length * (std::abs(band.slope_a) + std::abs(band.slope_b)) * 4 / 27;
  const double lean_a = band.round_a ? 1 : std::min(std::abs(band.slope_a), 1.0);
  const double lean_b = band.round_b ? 1 : std::min(std::abs(band.slope_b), 1.0);
  const double low = -band.before - reach * lean_a - kSlack;
  const double high = band.length + band.after + reach * lean_b + kSlack;
  const graph::Point o = band.origin, t = band.along;
  const double tip = std::abs(t.x) * side;
  Range rows{0, size.height - 1};
  rows.meet(1, 0, o.y + std::min(low * t.y, high * t.y) - tip, o.y + std::max(low * t.y, high * t.y) + tip);
  for (int y = rows.first; y <= rows.last; ++y) {
    // Along and across the chord, u = (p − o)·t and v = (p − o)·n with n = (−t.y, t.x).
    const double dy = y - o.y;
    Range columns{0, size.width - 1};
    columns.meet(t.x, dy * t.y - o.x * t.x, low, high);
    columns.meet(-t.y, dy * t.x + o.x * t.y, -side, side);
    for (int x = columns.first; x <= columns.last; ++x) {
      const double dx = x - o.x;
      const auto at = foot(band, dx * t.x + dy * t.y, dy * t.x - dx * t.y);
      if (at && std::abs(at->distance) <= between(band.a.reach, band.b.reach, at->s)) paint(x, y, *at);
    }
  }
}

graph::Point direction(double theta) {
  return {std::cos(theta), std::sin(theta)};
}

/// How a patch takes part in an edge that runs in direction `along`.
struct Part {
  bool backwards, in_line;
  double slope;
};
Part part(const graph::Patch& patch, graph::Point along, double length) {
  graph::Point t = direction(patch.theta);
  const double cosine = graph::dot(t, along);
  const bool in_line = std::abs(cosine) >= kMostTurn;
  const double sine = along.x * t.y - along.y * t.x;
  return {cosine < 0, in_line, in_line && length <= kLongestBend ? sine / cosine : 0};
}

/// Whether the curve goes straight on through this vertex: two edges, to both sides of its direction.
bool goes_through(const graph::AttributeGraph& graph, std::size_t vertex) {
  const auto others = graph.neighbours(vertex);
  if (others.size() != 2) return false;
  std::array<Part, 2> parts{};
  for (std::size_t i = 0; i < 2; ++i) {
    const graph::Point step = graph.patch(others[i]).position - graph.patch(vertex).position;
    const double length = graph::norm(step);
    if (!(length > 0) || length > kLongestBend) return false;
    parts[i] = part(graph.patch(vertex), step * (1 / length), length);
  }
  return parts[0].in_line && parts[1].in_line && parts[0].backwards != parts[1].backwards;
}

Band alone(const graph::Patch& patch, int channels) {
  Band band;
  band.along = direction(patch.theta);
  band.origin = patch.position - band.along * kAlone;
  band.length = 2 * kAlone;
  band.a = band.b = profile(patch, false, channels);
  return band;
}

std::vector<Band> bands(const graph::AttributeGraph& graph, int channels) {
  std::vector<Band> all;
  all.reserve(graph.size() + graph.edges().size());
  std::vector<char> through(graph.size());
  for (std::size_t i = 0; i < graph.size(); ++i) {
    through[i] = goes_through(graph, i) ? 1 : 0;
    if (graph.degree(i) == 0 && graph.patch(i).type != graph::PatchType::blob)
      all.push_back(alone(graph.patch(i), channels));
  }
  for (std::size_t i = 0; i < graph.size(); ++i)
    for (const std::size_t j : graph.neighbours(i)) {
      if (j < i) continue;
      const graph::Patch &a = graph.patch(i), &b = graph.patch(j);
      const graph::Point step = b.position - a.position;
      Band band;
      band.origin = a.position;
      band.length = graph::norm(step);
      if (!std::isfinite(band.length)) continue;
      if (band.length < 1e-6) {
        all.push_back(alone(a, channels));
        continue;
      }
      band.along = step * (1 / band.length);
      const Part of_a = part(a, band.along, band.length), of_b = part(b, band.along, band.length);
      const bool use_a = of_a.in_line || !of_b.in_line, use_b = of_b.in_line || !of_a.in_line;
      band.a = use_a ? profile(a, of_a.backwards, channels) : profile(b, of_b.backwards, channels);
      band.b = use_b ? profile(b, of_b.backwards, channels) : profile(a, of_a.backwards, channels);
      band.slope_a = of_a.slope;
      band.slope_b = of_b.slope;
      band.before = graph.degree(i) == 1 ? kEnd : 0;
      band.after = graph.degree(j) == 1 ? kEnd : 0;
      band.round_a = graph.degree(i) > 1 && through[i] == 0;
      band.round_b = graph.degree(j) > 1 && through[j] == 0;
      all.push_back(band);
    }
  return all;
}

/// Φ: the share of a unit step, blurred, that is reached at `d` SD.
double blurred_step(double d) {
  return 0.5 * (1 + std::erf(d / std::numbers::sqrt2));
}

void add(const Band& band, const Foot& at, double weight, int channels, float* sum) {
  const double half_width = between(band.a.half_width, band.b.half_width, at.s);
  const double blur = between(band.a.blur, band.b.blur, at.s);
  const double enter = blurred_step((at.distance + half_width) / blur);
  const double leave = half_width > 0 ? blurred_step((at.distance - half_width) / blur) : enter;
  for (std::size_t c = 0; c < static_cast<std::size_t>(channels); ++c) {
    const double left = between(band.a.left[c], band.b.left[c], at.s);
    const double middle = between(band.a.middle[c], band.b.middle[c], at.s);
    const double right = between(band.a.right[c], band.b.right[c], at.s);
    sum[c] += static_cast<float>(weight * (left + enter * (middle - left) + leave * (right - middle)));
  }
}

/// The nearer to a band's middle, the more it counts; rounded ends count where nothing else does.
double weight(const Band& band, const Foot& at) {
  const double reach = between(band.a.reach, band.b.reach, at.s);
  const double inward = std::max(1 - std::abs(at.distance) / reach, 0.03);
  return inward * inward * inward * inward * (at.at_round_end ? 1e-12 : 1);
}

/// paint(patch, shape, x, y, dx, dy) for every pixel of every blob.
template <class Paint>
void cover_blobs(const graph::AttributeGraph& graph, cv::Size size, Paint paint) {
  for (std::size_t i = 0; i < graph.size(); ++i) {
    const graph::Patch& patch = graph.patch(i);
    if (graph.degree(i) != 0 || patch.type != graph::PatchType::blob) continue;
    const BlobShape shape(patch);
    const auto [px, py] = patch.position;
    Range rows{0, size.height - 1}, columns{0, size.width - 1};
    rows.meet(1, -py, -shape.reach() - kSlack, shape.reach() + kSlack);
    columns.meet(1, -px, -shape.reach() - kSlack, shape.reach() + kSlack);
    for (int y = rows.first; y <= rows.last; ++y)
      for (int x = columns.first; x <= columns.last; ++x)
        if (shape.holds(x - px, y - py)) paint(patch, shape, x, y);
  }
}

void add(const graph::Patch& blob, const BlobShape& shape, int x, int y, int channels, float* sum,
         float& weights) {
  const double dx = x - blob.position.x, dy = y - blob.position.y;
  const BlobShape::Shares shares = shape.at(dx, dy);
  const Colour left = colour(blob.left, channels), middle = colour(blob.middle, channels),
               right = colour(blob.right, channels);
  const double inward = std::max(1 - std::hypot(dx, dy) / shape.reach(), 0.03);
  const double weight = inward * inward * inward * inward;
  for (std::size_t c = 0; c < static_cast<std::size_t>(channels); ++c)
    sum[c] += static_cast<float>(
        weight * (shares.left * left[c] + shares.middle * middle[c] + shares.right * right[c]));
  weights += static_cast<float>(weight);
}

void check(cv::Size size, int channels) {
  if (size.width >= 1 && size.height >= 1 && (channels == 1 || channels == 3)) return;
  std::ostringstream message;
  message << "render: a frame of " << size.width << " × " << size.height << " with " << channels
          << " channels; allowed are at least 1 × 1 and 1 or 3 channels";
  throw core::InputError(message.str());
}

}  // namespace

double Sketchable::share() const {
  return mask.empty() ? 0 : static_cast<double>(cv::countNonZero(mask)) / static_cast<double>(mask.total());
}

Sketchable draw_fitted(const graph::AttributeGraph& graph, cv::Size size, int channels) {
  check(size, channels);
  Sketchable result{cv::Mat(size, CV_32FC(channels), cv::Scalar::all(0)),
                    cv::Mat(size, CV_8U, cv::Scalar(0))};
  cv::Mat weights(size, CV_32F, cv::Scalar(0));
  for (const Band& band : bands(graph, channels))
    cover(band, size, [&](int x, int y, const Foot& at) {
      const double w = weight(band, at);
      add(band, at, w, channels, result.levels.ptr<float>(y) + x * channels);
      weights.at<float>(y, x) += static_cast<float>(w);
      result.mask.at<std::uint8_t>(y, x) = 255;
    });
  cover_blobs(graph, size, [&](const graph::Patch& blob, const BlobShape& shape, int x, int y) {
    add(blob, shape, x, y, channels, result.levels.ptr<float>(y) + x * channels, weights.at<float>(y, x));
    result.mask.at<std::uint8_t>(y, x) = 255;
  });
  for (int y = 0; y < size.height; ++y) {
    float* levels = result.levels.ptr<float>(y);
    const float* sum = weights.ptr<float>(y);
    for (int x = 0; x < size.width; ++x)
      if (sum[x] > 0)
        for (int c = 0; c < channels; ++c) levels[x * channels + c] /= sum[x];
  }
  return result;
}

Sketchable draw_pixels(const graph::AttributeGraph& graph, const cv::Mat& levels) {
  check(levels.size(), levels.channels());
  if (levels.depth() != CV_32F)
    throw core::InputError("render: levels are " + cv::typeToString(levels.type()) +
                           "; allowed are CV_32FC1 and CV_32FC3");
  Sketchable result{cv::Mat(levels.size(), levels.type(), cv::Scalar::all(0)),
                    cv::Mat(levels.size(), CV_8U, cv::Scalar(0))};
  for (const Band& band : bands(graph, levels.channels()))
    cover(band, levels.size(), [&](int x, int y, const Foot&) { result.mask.at<std::uint8_t>(y, x) = 255; });
  cover_blobs(graph, levels.size(), [&](const graph::Patch&, const BlobShape&, int x, int y) {
    result.mask.at<std::uint8_t>(y, x) = 255;
  });
  levels.copyTo(result.levels, result.mask);
  return result;
}

}  // namespace emberfold::sketch
