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

// Size of the largest connected piece without a seam.
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

struct Steps {
  double seam = 0, other = 0;
  std::int64_t seams = 0, others = 0;

  void add(bool at_seam, double size) {
    (at_seam ? seam : other) += size;
    ++(at_seam ? seams : others);
  }
  void add(const Steps& more) {
    seam += more.seam, other += more.other;
    seams += more.seams, others += more.others;
  }
  [[nodiscard]] double mean_seam() const { return seams > 0 ? seam / static_cast<double>(seams) : 0; }
  [[nodiscard]] double mean_other() const { return others > 0 ? other / static_cast<double>(others) : 0; }
  [[nodiscard]] double seam_share() const {
    return seams > 0 ? static_cast<double>(seams) / static_cast<double>(seams + others) : 0;
  }
};

double step_between(const float* p, const float* q, int channels) {
  double sum = 0;
  for (int c = 0; c < channels; ++c) sum += std::abs(static_cast<double>(p[c]) - static_cast<double>(q[c]));
  return sum / channels;
}

const float* at_pixel(const cv::Mat& levels, int x, int y) {
  return levels.ptr<float>(y) + static_cast<std::ptrdiff_t>(x) * levels.channels();
}

// Measures steps between neighbours in a frame; `still`: the map at that frame.
Steps steps_in_space(const QuiltMap& still, const cv::Mat& levels) {
  Steps steps;
  for (int y = 0; y < still.size.height; ++y)
    for (int x = 0; x < still.size.width; ++x)
      for (const cv::Point step : {cv::Point(1, 0), cv::Point(0, 1)}) {
        const cv::Point next(x + step.x, y + step.y);
        if (next.x >= still.size.width || next.y >= still.size.height) continue;
        steps.add(!continues(still.at(x, y), still.at(next.x, next.y), step),
                  step_between(at_pixel(levels, x, y), at_pixel(levels, next.x, next.y), levels.channels()));
      }
  return steps;
}

// Measures steps from a frame to the next.
Steps steps_in_time(const QuiltMap& now, const QuiltMap& next, const cv::Mat& levels, const cv::Mat& after) {
  Steps steps;
  for (int y = 0; y < now.size.height; ++y)
    for (int x = 0; x < now.size.width; ++x)
      steps.add(!(now.at(x, y) == next.at(x, y)),
                step_between(at_pixel(levels, x, y), at_pixel(after, x, y), levels.channels()));
  return steps;
}

double ratio(double share, double seam, double other) {
  return share > 0 && other > 0 ? seam / other : 1;
}

}  // namespace

double shown_share(const QuiltMap& map, std::span<const Trajectories* const> sources) {
  std::vector<std::vector<bool>> used;
  std::size_t all = 0, shown = 0;
  for (const auto* source : sources) {
    used.emplace_back(source->pixels(), false);
    all += source->pixels();
  }
  const auto show = [&](const SourcePixel& p) {
    const auto s = static_cast<std::size_t>(p.source);
    const auto at = static_cast<std::size_t>(p.y) * static_cast<std::size_t>(sources[s]->info().width) +
                    static_cast<std::size_t>(p.x);
    if (!used[s][at]) ++shown;
    used[s][at] = true;
  };
  for (const auto& p : map.pixels) show(p);
  for (const auto& change : map.changes) show(change.from);
  return static_cast<double>(shown) / static_cast<double>(all);
}

double QuiltMeasures::seam_ratio() const {
  return ratio(seam_share, seam_step, other_step);
}

double QuiltMeasures::change_ratio() const {
  return ratio(change_share, change_step, course_step);
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
  const int length = sources.front()->frames(), looked = std::min(length, frames);
  measures.largest_piece =
      static_cast<double>(largest_piece(still_at(map, length / 2))) / static_cast<double>(map.pixels.size());
  measures.source_share = shown_share(map, sources);
  std::vector<Steps> space(static_cast<std::size_t>(looked)), time(space.size());
  core::parallel_for(space.size(), {}, [&](std::size_t i) {
    const int t =
        looked == 1 ? 0 : static_cast<int>(static_cast<std::int64_t>(i) * (length - 1) / (looked - 1));
    const auto& info = sources.front()->info();
    const auto drawn = render_quilt(map, sources, {}, t, t + 1 < length ? 2 : 1);
    const QuiltMap now = still_at(map, t);
    const cv::Mat levels = core::to_levels(drawn[0], info);
    space[i] = steps_in_space(now, levels);
    if (!map.is_still() && drawn.size() > 1)
      time[i] = steps_in_time(now, still_at(map, t + 1), levels, core::to_levels(drawn[1], info));
  });
  Steps in_space, in_time;
  for (const auto& one : space) in_space.add(one);
  for (const auto& one : time) in_time.add(one);
  measures.seam_step = in_space.mean_seam();
  measures.other_step = in_space.mean_other();
  measures.seam_share = in_space.seam_share();
  measures.change_step = in_time.mean_seam();
  measures.course_step = in_time.mean_other();
  measures.change_share = in_time.seam_share();
  return measures;
}

}  // namespace emberfold::dytex
