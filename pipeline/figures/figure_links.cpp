// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include <boost/pending/disjoint_sets.hpp>

#include "core/parallel.hpp"
#include "pipeline/figures/figure_regions.hpp"

namespace emberfold::pipeline {

namespace {

constexpr double kLeastShare = 0.15;     // of the smaller region's area that overlaps
constexpr std::size_t kLeastFrames = 3;  // that a region lasts
constexpr double kLeastSteps = 0.5;      // of an outline
// A figure is wider than a line, or no longer than wide.
constexpr double kLeastThickness = 12, kSmallThickness = 6;  // px
constexpr double kLongest = 2.5;                             // squares of its thickness
constexpr double kLeastNats = 0.4;       // a pixel, that two levels explain more than a plane does
constexpr double kLeastFigure = 1. / 6;  // of a region, in a figure of threshold 0

using Link = std::pair<std::size_t, std::size_t>;  // a region, one of the next frame
using Weights = std::map<Link, double>;            // pixels that overlap

/// Adds half of the pixels of a frame's regions that move into regions of a neighbouring one.
void count_overlap(const cv::Mat1i& numbers, const cv::Mat1i& there, const FigureMotion& motion,
                   bool forwards, Weights& overlap) {
  for (int y = 0; y < numbers.rows; ++y)
    for (int x = 0; x < numbers.cols; ++x) {
      if (numbers(y, x) == 0) continue;
      const cv::Point at = moved(motion, numbers.size(), x, y);
      if (at.x < 0 || at.y < 0 || at.x >= there.cols || at.y >= there.rows || there(at) == 0) continue;
      const auto a = static_cast<std::size_t>(numbers(y, x) - 1), b = static_cast<std::size_t>(there(at) - 1);
      overlap[forwards ? Link{a, b} : Link{b, a}] += 0.5;
    }
}

Weights links_between(const FigureRegions& all, std::size_t r, std::size_t t, const FigureGround& ground) {
  const FigureReading& reading = all.readings[r];
  const cv::Mat1i before = region_numbers(all, r, t), after = region_numbers(all, r, t + 1);
  Weights overlap, links;
  count_overlap(before, after, ground.to[t], true, overlap);
  count_overlap(after, before, ground.from[t + 1], false, overlap);
  for (const auto& [link, pixels] : overlap)
    if (pixels >= kLeastShare * std::min(reading.regions[link.first].area, reading.regions[link.second].area))
      links.emplace(link, pixels);
  return links;
}

class LinkedReading {
 public:
  explicit LinkedReading(std::vector<FigureRegion>& regions) : regions_(regions) {}

  /// Adds the links of a gap. Of links with others at both ends, the weakest go: stars are left.
  void add(const Weights& links) {
    std::vector<std::pair<double, Link>> weakest;
    for (const auto& [link, weight] : links) {
      regions_[link.first].next.push_back(link.second);
      regions_[link.second].before.push_back(link.first);
      weakest.emplace_back(weight, link);
    }
    std::ranges::sort(weakest);
    for (const auto& [weight, link] : weakest)
      if (regions_[link.first].next.size() > 1 && regions_[link.second].before.size() > 1) cut(link);
  }

  /// Removes chains of regions whose outlines are mostly no steps.
  void remove_without_steps() {
    std::vector<std::size_t> gone;
    for (std::size_t i = 0; i < regions_.size(); ++i) {
      if (!begins_chain(i)) continue;
      const auto chain = chain_from(i);
      int rim = 0, steps = 0;
      for (const std::size_t j : chain) rim += regions_[j].rim, steps += regions_[j].steps;
      if (steps < kLeastSteps * rim) gone.insert(gone.end(), chain.begin(), chain.end());
    }
    for (const std::size_t i : gone) remove(i);
  }

  /// Removes short chains with a free end inside the clip. Returns whether there were any.
  bool remove_brief(std::size_t frames) {
    bool any = false;
    for (std::size_t i = 0; i < regions_.size(); ++i) {
      if (!begins_chain(i)) continue;
      const auto chain = chain_from(i);
      if (chain.size() >= kLeastFrames || !is_brief(chain, frames)) continue;
      for (const std::size_t j : chain) remove(j);
      any = true;
    }
    return any;
  }

  /// Returns one region of those that links join, directly or not, for each region.
  [[nodiscard]] std::vector<std::size_t> families() const {
    std::vector<std::size_t> rank(regions_.size()), parent(regions_.size());
    boost::disjoint_sets sets(rank.data(), parent.data());
    for (std::size_t i = 0; i < regions_.size(); ++i) sets.make_set(i);
    for (std::size_t i = 0; i < regions_.size(); ++i)
      for (const std::size_t j : regions_[i].next) sets.union_set(i, j);
    std::vector<std::size_t> family;
    for (std::size_t i = 0; i < regions_.size(); ++i) family.push_back(sets.find_set(i));
    return family;
  }

 private:
  void cut(Link link) {
    std::erase(regions_[link.first].next, link.second);
    std::erase(regions_[link.second].before, link.first);
  }
  void remove(std::size_t i) {
    for (const std::size_t b : std::vector(regions_[i].before)) cut({b, i});
    for (const std::size_t b : std::vector(regions_[i].next)) cut({i, b});
    regions_[i].is_removed = true;
  }
  [[nodiscard]] bool begins_chain(std::size_t i) const {
    const FigureRegion& region = regions_[i];
    return !region.is_removed && (region.before.size() != 1 || regions_[region.before[0]].next.size() != 1);
  }
  /// The chain of single links that begins at region i.
  [[nodiscard]] std::vector<std::size_t> chain_from(std::size_t i) const {
    std::vector chain{i};
    while (regions_[chain.back()].next.size() == 1 &&
           regions_[regions_[chain.back()].next[0]].before.size() == 1)
      chain.push_back(regions_[chain.back()].next[0]);
    return chain;
  }
  /// A chain at the clip's first or last frame may go on outside: it is brief only if one frame long.
  [[nodiscard]] bool is_brief(const std::vector<std::size_t>& chain, std::size_t frames) const {
    const FigureRegion &first = regions_[chain.front()], &last = regions_[chain.back()];
    const bool at_first = first.frame == 0, at_last = last.frame + 1 == frames;
    const bool appears = first.before.empty() && !at_first, vanishes = last.next.empty() && !at_last;
    if (!at_first && !at_last) return appears || vanishes;
    return chain.size() < 2 && ((appears && at_last) || (vanishes && at_first));
  }

  std::vector<FigureRegion>& regions_;
};

/// Says which regions of threshold 0 are figures.
void find_figures(std::vector<FigureRegion>& regions) {
  const auto family = LinkedReading(regions).families();
  std::vector<double> thickness(regions.size(), 0), length(regions.size(), 0), plane(regions.size(), 0),
      figure(regions.size(), 0);
  for (std::size_t i = 0; i < regions.size(); ++i) {
    const FigureRegion& region = regions[i];
    if (region.is_removed) continue;
    plane[family[i]] += region.plane, figure[family[i]] += region.figure;
    thickness[family[i]] = std::max(thickness[family[i]], region.thickness);
    length[family[i]] = std::max(length[family[i]], region.area / (region.thickness * region.thickness));
  }
  for (std::size_t i = 0; i < regions.size(); ++i) {
    const double thick = thickness[family[i]];
    const double nats = 0.5 * std::log((plane[family[i]] + 1e-9) / (figure[family[i]] + 1e-9));
    regions[i].is_figure =
        !regions[i].is_removed && nats >= kLeastNats &&
        (thick >= kLeastThickness || (thick >= kSmallThickness && length[family[i]] < kLongest));
  }
}

/// Calls figures the regions of reading r that the figures of reading `of` share.
void share_figures(FigureRegions& all, std::size_t of, std::size_t r) {
  std::vector<int> inside(all.readings[r].regions.size(), 0);
  for (std::size_t t = 0; t < all.labels.size(); ++t) {
    const cv::Mat1i figures = region_numbers(all, of, t), numbers = region_numbers(all, r, t);
    for (int y = 0; y < numbers.rows; ++y)
      for (int x = 0; x < numbers.cols; ++x)
        if (numbers(y, x) != 0 && figures(y, x) != 0 &&
            all.readings[of].regions[static_cast<std::size_t>(figures(y, x) - 1)].is_figure)
          ++inside[static_cast<std::size_t>(numbers(y, x) - 1)];
  }
  for (std::size_t i = 0; i < inside.size(); ++i) {
    FigureRegion& region = all.readings[r].regions[i];
    region.is_figure = !region.is_removed && inside[i] > kLeastFigure * region.area;
  }
}

}  // namespace

void link_figure_regions(FigureRegions& all, const FigureGround& ground, const core::Context& context) {
  const std::size_t frames = all.labels.size();
  std::vector<std::array<Weights, kFigureReadings>> links(frames - 1);
  core::parallel_for(links.size(), context, [&](std::size_t t) {
    for (std::size_t r = 0; r < kFigureReadings; ++r) links[t][r] = links_between(all, r, t, ground);
  });
  for (std::size_t r = 0; r < kFigureReadings; ++r) {
    LinkedReading linked(all.readings[r].regions);
    for (const auto& gap : links) linked.add(gap[r]);
    linked.remove_without_steps();
    while (linked.remove_brief(frames)) context.check();
    const std::size_t of = r - r % kFigureThresholds.size();
    if (r == of)
      find_figures(all.readings[r].regions);
    else
      share_figures(all, of, r);
  }
}

}  // namespace emberfold::pipeline
