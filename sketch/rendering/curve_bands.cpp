// SPDX-License-Identifier: Apache-2.0
#include "sketch/rendering/curve_bands.hpp"

#include <array>
#include <sstream>

#include "core/error.hpp"

namespace emberfold::sketch {

namespace {

constexpr double kEnd = 1;           // px behind a stroke's last patch
constexpr double kAlone = 2.5;       // px to each end of a patch without edges
constexpr double kMostTurn = 0.64;   // cos 50°, from a patch's direction to an edge's
constexpr double kLongestBend = 40;  // px: longer edges are straight

graph::Point direction(double theta) {
  return {std::cos(theta), std::sin(theta)};
}

/// Part of a patch in an edge that runs in direction `along`.
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

/// True if the curve goes straight on through this vertex: two edges, to both sides of its direction.
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

Band alone(const graph::AttributeGraph& graph, std::size_t vertex) {
  const graph::Patch& patch = graph.patch(vertex);
  Band band;
  band.along = direction(patch.theta);
  band.origin = patch.position - band.along * kAlone;
  band.length = 2 * kAlone;
  band.a = band.b = {vertex, false, 0, profile_reach(patch), false};
  return band;
}

}  // namespace

std::vector<Band> make_bands(const graph::AttributeGraph& graph, bool cores) {
  std::vector<Band> all;
  all.reserve(graph.size() + graph.edges().size());
  std::vector<char> through(graph.size());
  for (std::size_t i = 0; i < graph.size(); ++i) {
    through[i] = goes_through(graph, i) ? 1 : 0;
    if (graph.degree(i) == 0 && !graph::is_anchor(graph.patch(i))) all.push_back(alone(graph, i));
  }
  for (std::size_t i = 0; i < graph.size(); ++i)
    for (const std::size_t j : graph.neighbours(i)) {
      if (j < i) continue;
      const graph::Patch &a = graph.patch(i), &b = graph.patch(j);
      if (joins_outlines(a, b)) continue;
      const graph::Point step = b.position - a.position;
      Band band;
      band.origin = a.position;
      band.length = graph::norm(step);
      if (!std::isfinite(band.length)) continue;
      if (band.length < 1e-6) {
        all.push_back(alone(graph, i));
        continue;
      }
      band.along = step * (1 / band.length);
      const Part of_a = part(a, band.along, band.length), of_b = part(b, band.along, band.length);
      const bool use_a = of_a.in_line || !of_b.in_line, use_b = of_b.in_line || !of_a.in_line;
      const auto end = [&](bool own, std::size_t vertex, const Part& of_it, std::size_t other,
                           const Part& of_other) {
        const std::size_t shown = own ? vertex : other;
        return BandEnd{shown, own ? of_it.backwards : of_other.backwards, of_it.slope,
                       profile_reach(graph.patch(shown)), graph.degree(vertex) > 1 && through[vertex] == 0};
      };
      band.a = end(use_a, i, of_a, j, of_b);
      band.b = end(use_b, j, of_b, i, of_a);
      band.before = graph.degree(i) == 1 ? kEnd : 0;
      band.after = graph.degree(j) == 1 ? kEnd : 0;
      all.push_back(band);
    }
  if (cores)
    for (Band& band : all)
      for (double* reach : {&band.a.reach, &band.b.reach}) *reach *= kCore;
  return all;
}

void check_frame(cv::Size size, int channels) {
  if (size.width >= 1 && size.height >= 1 && (channels == 1 || channels == 3)) return;
  std::ostringstream message;
  message << "render: a frame of " << size.width << " × " << size.height << " with " << channels
          << " channels; allowed are at least 1 × 1 and 1 or 3 channels";
  throw core::InputError(message.str());
}

}  // namespace emberfold::sketch
