// SPDX-License-Identifier: Apache-2.0
#include "dytex/quilting/quilt_measures.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <utility>
#include <vector>

#include "core/parallel.hpp"
#include "dytex/quilting/render.hpp"

namespace emberfold::dytex {

namespace {

// Sizes of the connected pieces without a seam.
std::size_t largest_piece(const QuiltMap& map) {
  std::vector<std::size_t> parent(map.pixels.size()), count(map.pixels.size(), 1);
  std::iota(parent.begin(), parent.end(), std::size_t{0});
  const auto root = [&](std::size_t i) {
    while (parent[i] != i) i = parent[i] = parent[parent[i]];
    return i;
  };
  const auto width = static_cast<std::size_t>(map.size.width);
  const auto join = [&](std::size_t a, std::size_t b) {
    a = root(a), b = root(b);
    if (a == b) return;
    if (count[a] < count[b]) std::swap(a, b);
    parent[b] = a;
    count[a] += count[b];
  };
  for (std::size_t i = 0; i < map.pixels.size(); ++i) {
    if ((i + 1) % width != 0 && continues(map.pixels[i], map.pixels[i + 1], {1, 0})) join(i, i + 1);
    if (i + width < map.pixels.size() && continues(map.pixels[i], map.pixels[i + width], {0, 1}))
      join(i, i + width);
  }
  return count.empty() ? 0 : *std::max_element(count.begin(), count.end());
}

double source_share(const QuiltMap& map, std::span<const Trajectories* const> sources) {
  std::vector<std::vector<bool>> used;
  std::size_t all = 0, shown = 0;
  for (const auto* source : sources) {
    used.emplace_back(source->pixels(), false);
    all += source->pixels();
  }
  for (const auto& p : map.pixels) {
    const auto s = static_cast<std::size_t>(p.source);
    const auto at = static_cast<std::size_t>(p.y) * static_cast<std::size_t>(sources[s]->info().width) +
                    static_cast<std::size_t>(p.x);
    if (!used[s][at]) ++shown;
    used[s][at] = true;
  }
  return static_cast<double>(shown) / static_cast<double>(all);
}

struct Steps {
  double seam = 0, other = 0;
  std::int64_t seams = 0, others = 0;
};

double step_between(const cv::Mat& levels, cv::Point a, cv::Point b) {
  const int channels = levels.channels();
  const float *p = levels.ptr<float>(a.y) + a.x * channels, *q = levels.ptr<float>(b.y) + b.x * channels;
  double sum = 0;
  for (int c = 0; c < channels; ++c) sum += std::abs(static_cast<double>(p[c]) - static_cast<double>(q[c]));
  return sum / channels;
}

Steps steps_of(const QuiltMap& map, const cv::Mat& levels) {
  Steps steps;
  for (int y = 0; y < map.size.height; ++y)
    for (int x = 0; x < map.size.width; ++x)
      for (const cv::Point step : {cv::Point(1, 0), cv::Point(0, 1)}) {
        const cv::Point next(x + step.x, y + step.y);
        if (next.x >= map.size.width || next.y >= map.size.height) continue;
        const double size = step_between(levels, {x, y}, next);
        const bool whole = continues(map.at(x, y), map.at(next.x, next.y), step);
        (whole ? steps.other : steps.seam) += size;
        ++(whole ? steps.others : steps.seams);
      }
  return steps;
}

}  // namespace

double QuiltMeasures::seam_ratio() const {
  return seam_share > 0 && other_step > 0 ? seam_step / other_step : 1;
}

QuiltMeasures measure_quilt(const QuiltMap& map, std::span<const QuiltChoice> choices,
                            std::span<const Trajectories* const> sources, int frames) {
  QuiltMeasures measures;
  std::int64_t with_neighbour = 0, going_on = 0;
  for (const auto& choice : choices) {
    if (choice.column == 0 && choice.row == 0) continue;
    ++with_neighbour;
    if (choice.continues) ++going_on;
  }
  if (with_neighbour > 0)
    measures.verbatim_blocks = static_cast<double>(going_on) / static_cast<double>(with_neighbour);
  measures.largest_piece = static_cast<double>(largest_piece(map)) / static_cast<double>(map.pixels.size());
  measures.source_share = source_share(map, sources);
  const int length = sources.front()->frames(), looked = std::min(length, frames);
  std::vector<Steps> steps(static_cast<std::size_t>(looked));
  core::parallel_for(steps.size(), {}, [&](std::size_t i) {
    const auto t = looked == 1 ? 0 : static_cast<std::int64_t>(i) * (length - 1) / (looked - 1);
    const auto frame = render_quilt(map, sources, {}, t, 1).front();
    steps[i] = steps_of(map, core::to_levels(frame, sources.front()->info()));
  });
  Steps sum;
  for (const auto& one : steps) {
    sum.seam += one.seam, sum.other += one.other;
    sum.seams += one.seams, sum.others += one.others;
  }
  if (sum.seams > 0) measures.seam_step = sum.seam / static_cast<double>(sum.seams);
  if (sum.others > 0) measures.other_step = sum.other / static_cast<double>(sum.others);
  if (sum.seams + sum.others > 0)
    measures.seam_share = static_cast<double>(sum.seams) / static_cast<double>(sum.seams + sum.others);
  return measures;
}

}  // namespace emberfold::dytex
