// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <utility>

#include "core/parallel.hpp"
#include "pipeline/figures/figure_families.hpp"
#include "pipeline/figures/figure_labelling.hpp"
#include "pipeline/figures/figure_regions.hpp"

namespace emberfold::pipeline {

namespace {

constexpr double kLeastNats = 0.7;     // a pixel, that two levels explain more than a plane does
constexpr double kCorrelated = 2;      // px of an outline that are one observation
constexpr double kChange = 15;         // nats
constexpr double kMostOfBorder = 0.3;  // of the frame; more has ground
constexpr double kHollow = -0.5;       // turns by absolute turns: outlines of ground are hollow
constexpr double kGround = -1e6;       // nats that ground gains: it is never a figure

using Link = std::pair<std::size_t, std::size_t>;  // a region, one of the next frame
using Links = std::set<Link>;

/// Returns what each pixel of a frame's regions moves into in a neighbouring frame (numbers as
/// region_numbers).
cv::Mat1i carried_to(const cv::Mat1i& numbers, const cv::Mat1i& there, const FigureMotion& motion) {
  cv::Mat1i to(numbers.size(), 0);
  for (int y = 0; y < numbers.rows; ++y)
    for (int x = 0; x < numbers.cols; ++x) {
      if (numbers(y, x) == 0) continue;
      const cv::Point at = moved(motion, numbers.size(), x, y);
      if (at.x >= 0 && at.y >= 0 && at.x < there.cols && at.y < there.rows) to(y, x) = there(at);
    }
  return to;
}

/// Returns the links of regions that overlap where the flow carries the ones onto the others.
Links links_between(const FigureRegions& all, std::size_t p, std::size_t t, const FigureGround& ground) {
  const cv::Mat1i before = region_numbers(all, p, t), after = region_numbers(all, p, t + 1);
  const cv::Mat1i onto_after = carried_to(before, after, ground.to[t]),
                  onto_before = carried_to(after, before, ground.from[t + 1]);
  const auto region = [](int number) { return static_cast<std::size_t>(number - 1); };
  Links links;
  for (int y = 0; y < before.rows; ++y)
    for (int x = 0; x < before.cols; ++x) {
      if (onto_after(y, x) != 0) links.emplace(region(before(y, x)), region(onto_after(y, x)));
      if (onto_before(y, x) != 0) links.emplace(region(onto_before(y, x)), region(after(y, x)));
    }
  return links;
}

/// The regions of a polarity, which links join into chains, splits and merges.
class LinkedRegions {
 public:
  LinkedRegions(std::vector<FigureRegion>& regions, std::size_t frames) : regions_(regions), frames_(frames) {
    double turns = 0, absolute = 0;
    for (const FigureRegion& region : regions) turns += region.turning, absolute += std::abs(region.turning);
    is_hollow_ = turns <= kHollow * absolute;
  }

  void add(const Links& links) {
    for (const Link& link : links) {
      regions_[link.first].next.push_back(link.second);
      regions_[link.second].before.push_back(link.first);
    }
  }

  /// Removes chains that do not explain the frames.
  void remove_unexplaining(cv::Size view) {
    Labelling of;
    of.change = kChange;
    std::vector<std::size_t> unit_of(regions_.size(), kNoRegion);
    for (std::size_t i = 0; i < regions_.size(); ++i) {
      if (!begins_chain(i)) continue;
      const auto chain = chain_from(i);
      for (const std::size_t j : chain) unit_of[j] = of.gain.size();
      of.gain.push_back(is_ground(chain, view) ? kGround : gain_of_chain(chain));
    }
    for (std::size_t i = 0; i < regions_.size(); ++i)
      for (const auto* parts : {&regions_[i].next, &regions_[i].before})
        if (parts->size() > 1) {
          of.stars.push_back({unit_of[i], {}});
          for (const std::size_t j : *parts) of.stars.back().parts.push_back(unit_of[j]);
        }
    const auto labels = best_labels(of);
    for (std::size_t i = 0; i < regions_.size(); ++i)
      if (unit_of[i] != kNoRegion && labels[unit_of[i]] == 0) remove(i);
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

  /// Returns whether a chain is what figures of the other polarity lie on: it has much of the frame's border,
  /// and this polarity's outlines are hollow.
  [[nodiscard]] bool is_ground(const std::vector<std::size_t>& chain, cv::Size view) const {
    if (!is_hollow_) return false;
    double border = 0;
    for (const std::size_t j : chain) border += regions_[j].border;
    return border >= kMostOfBorder * 2 * (view.width + view.height) * double(chain.size());
  }

  /// Returns the nats by which a chain explains the frames better than nothing does, less its free ends
  /// inside the clip.
  [[nodiscard]] double gain_of_chain(const std::vector<std::size_t>& chain) const {
    const FigureRegion &first = regions_[chain.front()], &last = regions_[chain.back()];
    double gain = 0;
    for (const std::size_t j : chain)
      gain += regions_[j].rim / kCorrelated * (regions_[j].gain() - kLeastNats);
    if (first.before.empty() && first.frame > 0 && first.border == 0) gain -= kChange;
    if (last.next.empty() && last.frame + 1 < frames_ && last.border == 0) gain -= kChange;
    return gain;
  }

  std::vector<FigureRegion>& regions_;
  std::size_t frames_;
  bool is_hollow_ = false;  ///< outlines of holes turn more than those of shapes
};

}  // namespace

void link_figure_regions(FigureRegions& all, const FigureGround& ground, const graph::SketchSequence& lines,
                         const core::Context& context) {
  const std::size_t frames = all.labels.size();
  std::vector<std::array<Links, kFigurePolarities.size()>> links(frames - 1);
  core::parallel_for(links.size(), context, [&](std::size_t t) {
    for (std::size_t p = 0; p < all.of.size(); ++p) links[t][p] = links_between(all, p, t, ground);
  });
  for (std::size_t p = 0; p < all.of.size(); ++p) {
    LinkedRegions linked(all.of[p].regions, frames);
    for (const auto& gap : links) linked.add(gap[p]);
    linked.remove_unexplaining(ground.view.size);
    context.check();
  }
  find_families(all, ground, lines);
}

}  // namespace emberfold::pipeline
