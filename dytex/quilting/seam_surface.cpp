// SPDX-License-Identifier: Apache-2.0
#include "dytex/quilting/seam_surface.hpp"

#include <algorithm>
#include <vector>

#include "core/parallel.hpp"
#include "dytex/quilting/course_values.hpp"
#include "dytex/quilting/seam_expansion.hpp"

namespace emberfold::dytex::detail {

namespace {

constexpr int kMargin = 16;      // px around a block that it may take
constexpr int kBand = 4;         // px that a seam may move at each halving of the spans of time
constexpr int kStillSweeps = 2;  // more gain little
constexpr int kLeastSpan = 4;    // frames

/// A pass over all blocks.
struct Sweep {
  int spans = 1, band = 0;
};

std::vector<Sweep> plan_sweeps(int frames) {
  std::vector<Sweep> sweeps(kStillSweeps);
  for (int spans = 2; spans <= frames / kLeastSpan; spans *= 2) sweeps.push_back({spans, kBand});
  return sweeps;
}

// Returns spans of nearly equal length; doubling their number subdivides them.
SpanBegins span_begins(int frames, int spans) {
  SpanBegins begins;
  for (int q = 0; q < spans; ++q)
    begins.push_back(static_cast<int>(static_cast<long long>(q) * frames / spans));
  return begins;
}

cv::Rect window_of(const BlockCourses& courses, const cv::Rect& place) {
  const cv::Rect wide(place.x - kMargin, place.y - kMargin, place.width + 2 * kMargin,
                      place.height + 2 * kMargin);
  if (!courses.wraps()) return wide & cv::Rect({}, courses.size());
  return {wide.x, wide.y, std::min(wide.width, courses.size().width),
          std::min(wide.height, courses.size().height)};
}

// Returns groups of blocks whose windows share no pixel, so that threads may move those of a group at once.
// On a torus blocks are processed one by one.
std::vector<std::vector<std::int32_t>> groups_apart(const BlockCourses& courses) {
  std::vector<std::vector<std::int32_t>> groups;
  std::vector<std::vector<cv::Rect>> taken;
  const auto& placed = courses.placed();
  for (std::size_t k = 0; k < placed.size(); ++k) {
    const cv::Rect window = window_of(courses, placed[k].place);
    if (window.empty()) continue;
    const auto meets = [&](const cv::Rect& other) { return !(other & window).empty(); };
    std::size_t g = courses.wraps() ? groups.size() : 0;
    while (g < groups.size() && std::ranges::any_of(taken[g], meets)) ++g;
    if (g == groups.size()) groups.emplace_back(), taken.emplace_back();
    groups[g].push_back(static_cast<std::int32_t>(k));
    taken[g].push_back(window);
  }
  return groups;
}

}  // namespace

void move_seams(BlockCourses& courses, std::span<const QuiltSource> sources, const core::Context& context) {
  const CourseValues values(sources);
  const auto groups = groups_apart(courses);
  const auto sweeps = plan_sweeps(values.frames());
  const double steps = static_cast<double>(sweeps.size()) * static_cast<double>(courses.placed().size());
  double done = 0;
  for (const Sweep& sweep : sweeps) {
    const auto begins = span_begins(values.frames(), sweep.spans);
    for (const auto& group : groups) {
      context.check();
      context.report("seams", done / steps);
      core::parallel_for(group.size(), context, [&](std::size_t i) {
        const auto& block = courses.placed()[static_cast<std::size_t>(group[i])];
        SeamExpansion move(courses, values, {window_of(courses, block.place), sweep.band}, group[i], begins);
        if (!move.is_needed()) return;
        move.solve();
        move.write(courses);
      });
      done += static_cast<double>(group.size());
    }
  }
}

}  // namespace emberfold::dytex::detail
