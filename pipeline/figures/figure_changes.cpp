// SPDX-License-Identifier: Apache-2.0
#include "pipeline/figures/figure_changes.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/parallel.hpp"

namespace emberfold::pipeline {

using graph::EventType;

namespace {

/// Returns where `part` meets the rest of the region `whole` of a neighbouring frame: both grow in it from
/// where they are carried to, and meet half way.
cv::Point2d contact(const FigureRegions& all, std::size_t polarity, std::size_t whole, std::size_t part,
                    const FigureGround& ground) {
  const auto& regions = all.of[polarity].regions;
  const FigureRegion &in = regions[whole], &of = regions[part];
  const FigureMotion& motion = of.frame > in.frame ? ground.to[in.frame] : ground.from[in.frame];
  const cv::Mat1i here = region_numbers(all, polarity, in.frame),
                  there = region_numbers(all, polarity, of.frame);
  const int number = static_cast<int>(whole) + 1;
  const cv::Rect frame({0, 0}, here.size());
  enum : std::uint8_t { kNobody, kPart, kRest };
  cv::Mat1b owner(here.size(), std::uint8_t{kNobody});
  std::vector<cv::Point> front, next;
  for (int y = in.box.y; y < in.box.br().y; ++y)
    for (int x = in.box.x; x < in.box.br().x; ++x) {
      if (here(y, x) != number) continue;
      const cv::Point2d to = moved(motion, here.size(), x, y);
      const cv::Point at(std::clamp(cvRound(to.x), 0, here.cols - 1),
                         std::clamp(cvRound(to.y), 0, here.rows - 1));
      if (there(at) == 0) continue;
      owner(y, x) = there(at) == static_cast<int>(part) + 1 ? kPart : kRest;
      front.emplace_back(x, y);
    }
  const auto for_neighbours = [&](cv::Point of_pixel, const auto& visit) {
    for (int dy = -1; dy <= 1; ++dy)
      for (int dx = -1; dx <= 1; ++dx)
        if (const cv::Point at(of_pixel.x + dx, of_pixel.y + dy); frame.contains(at) && here(at) == number)
          visit(at);
  };
  for (; !front.empty(); std::swap(front, next)) {
    next.clear();
    for (const cv::Point& pixel : front)
      for_neighbours(pixel, [&](cv::Point at) {
        if (owner(at) == kNobody) owner(at) = owner(pixel), next.push_back(at);
      });
  }
  cv::Point2d sum;
  int pairs = 0;
  for (int y = in.box.y; y < in.box.br().y; ++y)
    for (int x = in.box.x; x < in.box.br().x; ++x)
      if (owner(y, x) == kPart)
        for_neighbours({x, y}, [&](cv::Point at) {
          if (owner(at) == kRest) sum += cv::Point2d(x + at.x, y + at.y) / 2., ++pairs;
        });
  return pairs > 0 ? sum / double(pairs) : of.centre;
}

}  // namespace

std::vector<FigureChange> find_figure_changes(const FigureRegions& all, std::size_t polarity,
                                              const FigureGround& ground, const core::Context& context) {
  const auto& regions = all.of[polarity].regions;
  const std::size_t frames = all.labels.size();
  std::vector<FigureChange> changes;
  const auto largest = [&](const std::vector<std::size_t>& parts) {
    return *std::ranges::max_element(parts, {}, [&](std::size_t i) { return regions[i].area; });
  };
  for (std::size_t i = 0; i < regions.size(); ++i) {
    const FigureRegion& region = regions[i];
    if (!region.is_figure) continue;
    // The last remains of a figure are at one end of it.
    const auto centre_with = [&](const std::vector<std::size_t>& adjacent) {
      const bool is_larger = adjacent.size() == 1 && regions[adjacent[0]].area > region.area;
      return is_larger ? regions[adjacent[0]].centre : region.centre;
    };
    const bool can_end = region.border == 0;
    if (can_end && region.before.empty() && region.frame > 0)
      changes.push_back({region.frame, EventType::birth, centre_with(region.next), region.width(), i, i});
    if (can_end && region.next.empty() && region.frame + 1 < frames)
      changes.push_back(
          {region.frame + 1, EventType::death, centre_with(region.before), region.width(), i, i});
    for (const bool splits : {true, false}) {
      const auto& parts = splits ? region.next : region.before;
      if (parts.size() < 2) continue;
      for (const std::size_t part : parts)
        if (part != largest(parts))
          changes.push_back({splits ? region.frame + 1 : region.frame,
                             splits ? EventType::split : EventType::merge, regions[part].centre,
                             regions[part].width(), i, part});
    }
  }
  core::parallel_for(changes.size(), context, [&](std::size_t k) {
    FigureChange& change = changes[k];
    if (change.whole != change.part) change.at = contact(all, polarity, change.whole, change.part, ground);
  });
  return changes;
}

}  // namespace emberfold::pipeline
