// SPDX-License-Identifier: Apache-2.0
#include "pipeline/figures/figure_regions.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <opencv2/imgproc.hpp>

#include "core/clip/frame_stream.hpp"
#include "pipeline/figures/left_squares.hpp"

namespace emberfold::pipeline {

namespace {

constexpr int kLeastArea = 12;  // px²: about a disc as wide as the smoothing
constexpr int kSeenBorder = 2;  // px
constexpr int kConnectivity = 8;
constexpr int kAround = 8;                         // px about a region that it has to explain
constexpr double kSharpEdge = 1.4, kSoftEdge = 3;  // px, SD

/// The regions of one frame and polarity.
struct FrameRegions {
  std::vector<FigureRegion> regions;
  std::vector<std::size_t> of_component;  // counted within the frame
};

/// Adds how well each region explains the frame about it.
void explain_regions(const cv::Mat1i& number, const cv::Mat1b& label, const cv::Mat1f& level, double noise,
                     std::vector<FigureRegion>& regions) {
  static const cv::Mat near =
      cv::getStructuringElement(cv::MORPH_ELLIPSE, {2 * kAround + 1, 2 * kAround + 1});
  const auto with_edge = [&](double sd) {
    cv::Mat1f image;
    label.convertTo(image, CV_32F);
    cv::GaussianBlur(image, image, {0, 0}, sd, sd, cv::BORDER_REPLICATE);
    return image;
  };
  const cv::Mat1f sharp = with_edge(kSharpEdge), soft = with_edge(kSoftEdge);
  for (std::size_t i = 0; i < regions.size(); ++i) {
    FigureRegion& region = regions[i];
    const cv::Rect box = cv::Rect(region.box.tl() - cv::Point(kAround, kAround),
                                  region.box.br() + cv::Point(kAround, kAround)) &
                         cv::Rect({0, 0}, label.size());
    cv::Mat1b about = cv::Mat(number(box) == static_cast<int>(i) + 1);
    cv::dilate(about, about, near);
    const double floor = cv::countNonZero(about) * noise * noise + 1e-9;
    const LeftSquares left = left_squares(level(box), {sharp(box), soft(box)}, about);
    region.plane = left.by_plane + floor;
    region.sharp = left.by_figures[0] + floor, region.soft = left.by_figures[1] + floor;
  }
}

/// Measures how wide the regions are; `number`: of the region of each pixel, plus 1.
void measure_widths(const cv::Mat1i& number, const cv::Mat1b& label, std::vector<FigureRegion>& regions) {
  constexpr double kInside = (kWideDisc + 1) / 2;  // depth of a disc's centre
  cv::Mat1f depth, to_centre;
  cv::distanceTransform(label, depth, cv::DIST_L2, cv::DIST_MASK_PRECISE);
  cv::distanceTransform(cv::Mat(depth < kInside), to_centre, cv::DIST_L2, cv::DIST_MASK_PRECISE);
  for (int y = 0; y < label.rows; ++y)
    for (int x = 0; x < label.cols; ++x) {
      if (number(y, x) == 0) continue;
      FigureRegion& region = regions[static_cast<std::size_t>(number(y, x) - 1)];
      region.thickness = std::max(region.thickness, 2. * depth(y, x) - 1);
      if (to_centre(y, x) < kInside) ++region.wide;
    }
}

/// Counts the turns of the regions' outlines: a quarter at each corner of their pixels (Gray 1971).
void measure_turning(const cv::Mat1i& number, std::vector<FigureRegion>& regions) {
  for (int y = 0; y + 1 < number.rows; ++y)
    for (int x = 0; x + 1 < number.cols; ++x) {
      const std::array of = {number(y, x), number(y, x + 1), number(y + 1, x + 1), number(y + 1, x)};
      if (of[0] == of[1] && of[1] == of[2] && of[2] == of[3]) continue;
      const int n = *std::ranges::max_element(of);
      const auto inside = std::ranges::count(of, n);
      double& turning = regions[static_cast<std::size_t>(n - 1)].turning;
      if (inside != 2)
        turning += inside == 1 ? 0.25 : -0.25;
      else if (of[0] == of[2])  // two corners where pixels touch
        turning -= 0.5;
    }
}

FrameRegions find_regions(const cv::Mat1b& label, std::size_t frame, const cv::Mat1f& level,
                          const cv::Mat1b& inner, double noise) {
  FrameRegions found;
  cv::Mat1i number;
  cv::Mat stats, centres;
  const int components =
      cv::connectedComponentsWithStats(label, number, stats, centres, kConnectivity, CV_32S);
  for (int i = 1; i < components; ++i) {
    const int* s = stats.ptr<int>(i);
    found.of_component.push_back(s[cv::CC_STAT_AREA] < kLeastArea ? kNoRegion : found.regions.size());
    if (s[cv::CC_STAT_AREA] < kLeastArea) continue;
    FigureRegion region;
    region.frame = frame, region.area = s[cv::CC_STAT_AREA];
    region.centre = {centres.at<double>(i, 0), centres.at<double>(i, 1)};
    region.box = {s[cv::CC_STAT_LEFT], s[cv::CC_STAT_TOP], s[cv::CC_STAT_WIDTH], s[cv::CC_STAT_HEIGHT]};
    found.regions.push_back(region);
  }
  cv::Mat1b core;
  cv::erode(label, core, cv::Mat(), {-1, -1}, 1, cv::BORDER_CONSTANT, 1);
  for (int y = 0; y < label.rows; ++y)
    for (int x = 0; x < label.cols; ++x) {
      int& n = number(y, x);
      if (n == 0) continue;
      const std::size_t index = found.of_component[static_cast<std::size_t>(n - 1)];
      n = index == kNoRegion ? 0 : static_cast<int>(index) + 1;
      if (n == 0) continue;
      FigureRegion& region = found.regions[index];
      if (inner(y, x) == 0)
        region.border += 1. / kSeenBorder;
      else if (core(y, x) == 0)
        ++region.rim;
    }
  measure_turning(number, found.regions);
  measure_widths(number, label, found.regions);
  explain_regions(number, label, level, noise, found.regions);
  return found;
}

/// Labels and regions of a frame.
struct FrameLabels {
  cv::Mat1b labels;
  std::array<FrameRegions, kFigurePolarities.size()> of;
};

FrameLabels label_frame(const cv::Mat1f& level, std::size_t frame, const FigureGround& ground) {
  FrameLabels out;
  out.labels = cv::Mat1b(level.size(), std::uint8_t{0});
  const cv::Mat1b inner = inner_part(ground, frame);
  for (std::size_t p = 0; p < kFigurePolarities.size(); ++p) {
    const cv::Mat1f amplitude = figure_amplitude(ground, frame, p, level);
    for (std::size_t k = 0; k < kFigureThresholds.size(); ++k) {
      const cv::Mat1b label = cv::Mat((amplitude > kFigureThresholds[k]) / 255);
      out.labels |= label * label_bit(p, k);
      if (k == 0) out.of[p] = find_regions(label, frame, level, inner, ground.noise);
    }
  }
  return out;
}

}  // namespace

cv::Mat1b inner_part(const FigureGround& ground, std::size_t frame) {
  const cv::Mat1b seen =
      ground.masks.empty() ? cv::Mat1b(ground.view.size, std::uint8_t{1}) : ground.masks[frame];
  cv::Mat1b inner;
  cv::erode(seen, inner, cv::Mat(), {-1, -1}, kSeenBorder, cv::BORDER_CONSTANT, 0);
  return inner;
}

FigureRegions find_figure_regions(core::FrameSource& source, const FigureGround& ground,
                                  const core::Context& context) {
  FigureRegions all;
  const core::ClipInfo info = source.info();
  const auto label = [&](int t, const cv::Mat& frame) {
    return label_frame(figure_level(frame, info, ground.view), static_cast<std::size_t>(t), ground);
  };
  core::stream_frames(source, "figures", info.frames, context, label, [&](int, FrameLabels frame) {
    all.labels.emplace_back(kept_image(frame.labels, context.memory(), all.blocks));
    for (std::size_t p = 0; p < all.of.size(); ++p) {
      FrameRegions& found = frame.of[p];
      for (std::size_t& index : found.of_component)
        if (index != kNoRegion) index += all.of[p].regions.size();
      all.of[p].of_component.push_back(std::move(found.of_component));
      std::ranges::move(found.regions, std::back_inserter(all.of[p].regions));
    }
  });
  return all;
}

cv::Mat1i region_numbers(const FigureRegions& all, std::size_t polarity, std::size_t frame) {
  cv::Mat1i numbers;
  cv::connectedComponents(cv::Mat((all.labels[frame] & label_bit(polarity, 0)) != 0), numbers, kConnectivity,
                          CV_32S);
  const PolarityRegions& of = all.of[polarity];
  std::vector<int> number_of{0};
  for (const std::size_t index : of.of_component[frame])
    number_of.push_back(index == kNoRegion || of.regions[index].is_removed ? 0 : static_cast<int>(index) + 1);
  for (int& n : numbers) n = number_of[static_cast<std::size_t>(n)];
  return numbers;
}

}  // namespace emberfold::pipeline
