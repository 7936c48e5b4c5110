// SPDX-License-Identifier: Apache-2.0
#include "pipeline/figures/figure_families.hpp"

#include <algorithm>
#include <limits>
#include <vector>

#include <boost/pending/disjoint_sets.hpp>
#include <opencv2/imgproc.hpp>

namespace emberfold::pipeline {

namespace {

// A figure is wider than a line, somewhere and in most places, or no longer than wide.
constexpr double kLeastThickness = 12;  // px
constexpr double kLeastWide = 0.5;      // of a family's area
constexpr double kLongest = 2.5;        // squares of its thickness
// Lines that made scenes hold are drawn to .97 and more of their area, nearly binary networks to .58 to .69.
constexpr double kOnLine = 4;        // px from a drawn line
constexpr double kMostDrawn = 0.75;  // of a family's area
constexpr double kSharpEdges = 1.2;  // nats a pixel, of a family's outline
// Cells of a grid of lines are dark figures of .9 nats a pixel between bright lines of 2.7.
// An outline of stripes or folds is that of the light ones.
constexpr int kAlongside = 3;        // px from a figure's outline to a line's region, or a light figure's
constexpr double kLeastAlong = 0.3;  // of a family's outline

/// Sums over all regions that links join.
struct Family {
  double thickness = 0, length = 0, area = 0, wide = 0;
  double rim = 0;                   ///< pixels of outline
  double nats = 0, sharp_nats = 0;  ///< what they explain, and what they do as a sharp edge
  double drawn = 0;                 ///< pixels near drawn lines
  double outline = 0;               ///< pixels of outline away from the border
  double alongside = 0;             ///< of these, near lines that explain more, or light figures

  [[nodiscard]] double gain() const { return rim > 0 ? nats / rim : 0; }
  /// Returns whether it is wider than a line, somewhere and in most places, or no longer than wide.
  [[nodiscard]] bool is_wide() const {
    return thickness >= kLeastThickness ? wide >= kLeastWide * area
                                        : thickness >= kWideDisc && length < kLongest;
  }
  [[nodiscard]] bool is_undrawn() const {
    return sharp_nats >= kSharpEdges * std::max(1., rim) && drawn < kMostDrawn * area;
  }
  [[nodiscard]] bool is_ground() const { return alongside > kLeastAlong * outline; }
};

/// The families of one polarity.
struct Families {
  std::vector<std::size_t> of_region;  ///< the region that stands for the family of each
  std::vector<Family> of;              ///< by that region
};

/// Returns one region of those that links join, directly or not, for each region.
std::vector<std::size_t> joined_by_links(const std::vector<FigureRegion>& regions) {
  std::vector<std::size_t> rank(regions.size()), parent(regions.size());
  boost::disjoint_sets sets(rank.data(), parent.data());
  for (std::size_t i = 0; i < regions.size(); ++i) sets.make_set(i);
  for (std::size_t i = 0; i < regions.size(); ++i)
    for (const std::size_t j : regions[i].next) sets.union_set(i, j);
  std::vector<std::size_t> family;
  for (std::size_t i = 0; i < regions.size(); ++i) family.push_back(sets.find_set(i));
  return family;
}

Families gather_families(const std::vector<FigureRegion>& regions) {
  Families families{joined_by_links(regions), std::vector<Family>(regions.size())};
  for (std::size_t i = 0; i < regions.size(); ++i) {
    const FigureRegion& region = regions[i];
    if (region.is_removed) continue;
    Family& family = families.of[families.of_region[i]];
    family.thickness = std::max(family.thickness, region.thickness);
    family.length = std::max(family.length, region.area / (region.thickness * region.thickness));
    family.area += region.area, family.wide += region.wide;
    family.rim += region.rim;
    family.nats += region.rim * region.gain(), family.sharp_nats += region.rim * region.sharp_gain();
  }
  return families;
}

void count_drawn(const cv::Mat1i& numbers, const cv::Mat1f& from_lines, Families& families) {
  for (int y = 0; y < numbers.rows; ++y)
    for (int x = 0; x < numbers.cols; ++x)
      if (numbers(y, x) != 0 && from_lines(y, x) <= kOnLine)
        ++families.of[families.of_region[static_cast<std::size_t>(numbers(y, x) - 1)]].drawn;
}

/// Counts the pixels of outlines, and those of them near what has the right to the outline: lines of the
/// other polarity that explain more, and light figures.
void count_alongside(const cv::Mat1i& numbers, const cv::Mat1i& other_numbers,
                     const std::vector<FigureRegion>& other_regions, const Families& others,
                     const cv::Mat1b& inner, Families& families) {
  static const cv::Mat near =
      cv::getStructuringElement(cv::MORPH_ELLIPSE, {2 * kAlongside + 1, 2 * kAlongside + 1});
  cv::Mat1f explained(numbers.size(), 0.F);
  for (int y = 0; y < numbers.rows; ++y)
    for (int x = 0; x < numbers.cols; ++x) {
      if (other_numbers(y, x) == 0) continue;
      const auto i = static_cast<std::size_t>(other_numbers(y, x) - 1);
      const Family& other = others.of[others.of_region[i]];
      if (!other.is_wide())
        explained(y, x) = static_cast<float>(other.gain());
      else if (other_regions[i].is_figure)
        explained(y, x) = std::numeric_limits<float>::max();
    }
  cv::dilate(explained, explained, near);
  for (int y = 1; y + 1 < numbers.rows; ++y)
    for (int x = 1; x + 1 < numbers.cols; ++x) {
      const int n = numbers(y, x);
      if (n == 0 || inner(y, x) == 0 ||
          (numbers(y, x - 1) == n && numbers(y, x + 1) == n && numbers(y - 1, x) == n &&
           numbers(y + 1, x) == n))
        continue;
      Family& family = families.of[families.of_region[static_cast<std::size_t>(n - 1)]];
      ++family.outline;
      if (explained(y, x) > family.gain()) ++family.alongside;
    }
}

}  // namespace

void find_families(FigureRegions& all, const FigureGround& ground, const graph::SketchSequence& lines) {
  std::array<Families, kFigurePolarities.size()> families = {gather_families(all.of[0].regions),
                                                             gather_families(all.of[1].regions)};
  for (const std::size_t p : {1, 0}) {  // light first: no dark region is a figure yet
    const std::size_t other = 1 - p;
    auto& regions = all.of[p].regions;
    for (std::size_t t = 0; t < all.labels.size(); ++t) {
      const cv::Mat1i numbers = region_numbers(all, p, t), other_numbers = region_numbers(all, other, t);
      if (p == 1) {  // both at once: the distance is the same
        const cv::Mat1f from_lines = distance_from_edges(lines.frames[t], ground.view);
        count_drawn(numbers, from_lines, families[p]);
        count_drawn(other_numbers, from_lines, families[other]);
      }
      count_alongside(numbers, other_numbers, all.of[other].regions, families[other], inner_part(ground, t),
                      families[p]);
    }
    for (std::size_t i = 0; i < regions.size(); ++i) {
      const Family& family = families[p].of[families[p].of_region[i]];
      regions[i].is_figure =
          !regions[i].is_removed && (family.is_wide() || family.is_undrawn()) && !family.is_ground();
    }
  }
}

}  // namespace emberfold::pipeline
