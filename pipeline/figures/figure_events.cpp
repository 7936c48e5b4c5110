// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>
#include <utility>

#include "pipeline/figures/figure_changes.hpp"

namespace emberfold::pipeline {

namespace {

constexpr double kSameReach = 15, kSameFrames = 6;  // px, or three widths; frames

using WeighedReading = std::vector<FigureEvent>;

double reach_of(double width) {
  return std::max(kSameReach, 3 * width);
}

/// Joins the changes that several thresholds of a polarity see.
WeighedReading joined(const std::array<WeighedReading, kFigureThresholds.size()>& of) {
  WeighedReading events;
  std::array<std::vector<char>, kFigureThresholds.size()> used;
  for (std::size_t k = 0; k < of.size(); ++k) used[k].assign(of[k].size(), 0);
  for (std::size_t k = 0; k < of.size(); ++k)
    for (std::size_t i = 0; i < of[k].size(); ++i) {
      if (used[k][i] != 0) continue;
      FigureEvent event = of[k][i];
      for (std::size_t q = k + 1; q < of.size(); ++q) {
        double nearest = std::numeric_limits<double>::max();
        std::size_t same = of[q].size();
        for (std::size_t j = 0; j < of[q].size(); ++j) {
          const FigureChange &one = event.change, &other = of[q][j].change;
          const double apart = cv::norm(one.at - other.at),
                       late = std::abs(double(one.frame) - double(other.frame));
          if (used[q][j] != 0 || one.type != other.type || apart >= reach_of(one.width) || late > kSameFrames)
            continue;
          if (apart + 3 * late < nearest) nearest = apart + 3 * late, same = j;
        }
        if (same == of[q].size()) continue;
        used[q][same] = 1;
        event.probability += of[q][same].probability;
      }
      event.probability /= double(of.size());
      events.push_back(event);
    }
  return events;
}

}  // namespace

std::vector<FigureEvent> weigh_figure_changes(const FigureRegions& all, const FigureGround& ground,
                                              const core::Context& context) {
  std::vector<FigureEvent> events;
  for (std::size_t p = 0; p < kFigurePolarities.size(); ++p) {
    std::array<WeighedReading, kFigureThresholds.size()> of;
    for (std::size_t k = 0; k < of.size(); ++k)
      for (const FigureChange& change : find_figure_changes(all, reading_index(p, k), ground, context))
        of[k].push_back({change, reading_index(p, k), 1});
    std::ranges::move(joined(of), std::back_inserter(events));
  }
  return events;
}

}  // namespace emberfold::pipeline
