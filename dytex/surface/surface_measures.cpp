// SPDX-License-Identifier: Apache-2.0
#include "dytex/surface/surface_measures.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include <opencv2/core.hpp>

#include "core/math/bilinear.hpp"
#include "core/parallel.hpp"
#include "dytex/quilting/quilt_measures.hpp"
#include "dytex/quilting/render.hpp"
#include "dytex/surface/edge_crossing.hpp"

namespace emberfold::dytex {

namespace {

/// A point on a glued edge: the texels next to it, and its two places in the texture.
struct BorderPlace {
  cv::Point inside, beyond;
  cv::Point2d here, there;
};

std::vector<BorderPlace> border_places(const SurfaceLayout& layout) {
  std::vector<BorderPlace> places;
  for (const auto& [a, b] : layout.glued) {
    const detail::EdgeCrossing crossing(layout, a, b);
    const double length = crossing.here().length();
    const int count = std::max(1, static_cast<int>(std::ceil(length)));
    for (int i = 0; i < count; ++i) {
      const double along = length * (i + 0.5) / count;
      BorderPlace place{detail::nearest_texel(crossing.here().texel({along, -0.5})),
                        detail::nearest_texel(crossing.over({along, 0.5})), crossing.here().texel({along, 0}),
                        crossing.over({along, 0})};
      if (layout.chart_at(place.inside) == detail::chart_of_side(layout, a) &&
          layout.chart_at(place.beyond) == detail::chart_of_side(layout, b))
        places.push_back(place);
    }
  }
  return places;
}

struct StepSum {
  double sum = 0;
  std::int64_t count = 0;
  void add(double step) { sum += step, ++count; }
  void add(const StepSum& more) { sum += more.sum, count += more.count; }
  [[nodiscard]] double mean() const { return count > 0 ? sum / static_cast<double>(count) : 0; }
};

struct SurfaceStepSums {
  StepSum seam, other, border, gap;
  void add(const SurfaceStepSums& more) {
    seam.add(more.seam), other.add(more.other), border.add(more.border), gap.add(more.gap);
  }
};

const float* levels_at(const cv::Mat& levels, const cv::Point& texel) {
  return levels.ptr<float>(texel.y) + static_cast<std::ptrdiff_t>(texel.x) * levels.channels();
}

double texel_step(const cv::Mat& levels, const cv::Point& a, const cv::Point& b) {
  const float *p = levels_at(levels, a), *q = levels_at(levels, b);
  double sum = 0;
  for (int c = 0; c < levels.channels(); ++c) sum += std::abs(double{p[c]} - double{q[c]});
  return sum / levels.channels();
}

double looked_up(const cv::Mat& levels, const cv::Point2d& at, int channel) {
  const core::BilinearPlace place(at.x, at.y, levels.size());
  return place.between(place.top, place.bottom, [&](int y, int x) {
    return double{levels_at(levels, {x, y})[channel]};
  });
}

SurfaceStepSums steps_of_frame(const SurfaceLayout& layout, const std::vector<std::int32_t>& blocks,
                               const std::vector<BorderPlace>& borders, const cv::Mat& levels) {
  SurfaceStepSums steps;
  for (int y = 0; y < layout.size.height; ++y)
    for (int x = 0; x < layout.size.width; ++x)
      for (const cv::Point step : {cv::Point(1, 0), cv::Point(0, 1)}) {
        const cv::Point at(x, y), next = at + step;
        if (layout.chart_at(at) < 0 || layout.chart_at(at) != layout.chart_at(next)) continue;
        const bool same = blocks[layout.index(at)] == blocks[layout.index(next)];
        (same ? steps.other : steps.seam).add(texel_step(levels, at, next));
      }
  for (const auto& place : borders) {
    steps.border.add(texel_step(levels, place.inside, place.beyond));
    double gap = 0;
    for (int c = 0; c < levels.channels(); ++c)
      gap += std::abs(looked_up(levels, place.here, c) - looked_up(levels, place.there, c));
    steps.gap.add(gap / levels.channels());
  }
  return steps;
}

}  // namespace

double SurfaceMeasures::seam_ratio() const {
  return seam_share > 0 && other_step > 0 ? seam_step / other_step : 1;
}

double SurfaceMeasures::border_ratio() const {
  return border_places > 0 && other_step > 0 ? border_step / other_step : 1;
}

SurfaceMeasures measure_surface(const SurfaceLayout& layout, const SurfaceQuilt& quilt,
                                std::span<const Trajectories* const> sources, int frames) {
  const auto borders = border_places(layout);
  const auto& info = sources.front()->info();
  const int length = sources.front()->frames(), looked = std::min(length, frames);
  std::vector<SurfaceStepSums> steps(static_cast<std::size_t>(looked));
  core::parallel_for(steps.size(), {}, [&](std::size_t i) {
    const auto t = looked == 1 ? 0 : static_cast<std::int64_t>(i) * (length - 1) / (looked - 1);
    const cv::Mat levels = core::to_levels(render_quilt(quilt.map, sources, {}, t, 1).front(), info);
    steps[i] = steps_of_frame(layout, quilt.blocks, borders, levels);
  });
  SurfaceStepSums all;
  for (const auto& one : steps) all.add(one);
  SurfaceMeasures measures;
  const auto pairs = static_cast<double>(all.seam.count + all.other.count);
  measures.seam_share = pairs > 0 ? static_cast<double>(all.seam.count) / pairs : 0;
  measures.seam_step = all.seam.mean();
  measures.other_step = all.other.mean();
  measures.border_step = all.border.mean();
  measures.border_gap = all.gap.mean();
  measures.border_places = static_cast<std::int64_t>(borders.size());
  measures.source_share = shown_share(quilt.map, sources);
  return measures;
}

}  // namespace emberfold::dytex
