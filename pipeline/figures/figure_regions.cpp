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

constexpr int kLeastArea = 12;   // px²: about a disc as wide as the smoothing
constexpr int kSeenBorder = 2;   // px
constexpr float kAcrossRim = 3;  // px, to either side of an outline
constexpr int kConnectivity = 8;
constexpr int kAround = 4;         // px about a region that it has to explain
constexpr double kSoftEdge = 1.4;  // px, SD

/// The regions of one frame and reading.
struct FrameRegions {
  std::vector<FigureRegion> regions;
  std::vector<std::size_t> of_component;  // counted within the frame
};

/// Adds the outlines of a frame's regions: their pixels, and how many of them are steps.
void measure_rims(const cv::Mat1b& label, const cv::Mat1i& number, const cv::Mat1f& level,
                  const cv::Mat1f& half, const cv::Mat1b& inner, int polarity,
                  std::vector<FigureRegion>& regions) {
  cv::Mat1b core;
  cv::erode(label, core, cv::Mat(), {-1, -1}, 1, cv::BORDER_CONSTANT, 1);
  cv::Mat1f soft, gx, gy;
  label.convertTo(soft, CV_32F, polarity);
  cv::GaussianBlur(soft, soft, {0, 0}, 2, 2, cv::BORDER_REPLICATE);
  cv::Sobel(soft, gx, CV_32F, 1, 0, 3), cv::Sobel(soft, gy, CV_32F, 0, 1, 3);
  const auto at = [&](float x, float y) {
    return level(std::clamp(cvRound(y), 0, level.rows - 1), std::clamp(cvRound(x), 0, level.cols - 1));
  };
  for (int y = 0; y < label.rows; ++y)
    for (int x = 0; x < label.cols; ++x) {
      if (number(y, x) == 0 || core(y, x) != 0 || inner(y, x) == 0) continue;
      FigureRegion& region = regions[static_cast<std::size_t>(number(y, x) - 1)];
      ++region.rim;
      const cv::Vec2f across =
          kAcrossRim / std::max(1e-9F, std::hypot(gx(y, x), gy(y, x))) * cv::Vec2f(gx(y, x), gy(y, x));
      const auto u = static_cast<float>(x), v = static_cast<float>(y);
      const float step = at(u + across[0], v + across[1]) - at(u - across[0], v - across[1]);
      region.steps += step >= half(y, x) ? 1 : 0;
    }
}

/// Adds how well each region explains the frame.
void explain_regions(const cv::Mat1b& label, const cv::Mat1f& level, double noise,
                     std::vector<FigureRegion>& regions) {
  cv::Mat1f soft;
  label.convertTo(soft, CV_32F);
  cv::GaussianBlur(soft, soft, {0, 0}, kSoftEdge, kSoftEdge, cv::BORDER_REPLICATE);
  for (FigureRegion& region : regions) {
    const cv::Rect box = cv::Rect(region.box.tl() - cv::Point(kAround, kAround),
                                  region.box.br() + cv::Point(kAround, kAround)) &
                         cv::Rect({0, 0}, label.size());
    const cv::Mat1b all(box.size(), std::uint8_t{1});
    const double floor = box.area() * noise * noise;
    region.plane = left_by_plane(level(box), all) + floor;
    region.figure = left_by_figure(level(box), soft(box), all) + floor;
  }
}

FrameRegions find_regions(const cv::Mat1b& label, std::size_t frame, const cv::Mat1f& level,
                          const cv::Mat1f& half, const cv::Mat1b& inner, int polarity) {
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
  cv::Mat1f depth;
  cv::distanceTransform(label, depth, cv::DIST_L2, cv::DIST_MASK_PRECISE);
  for (int y = 0; y < label.rows; ++y)
    for (int x = 0; x < label.cols; ++x) {
      int& n = number(y, x);
      if (n == 0) continue;
      const std::size_t index = found.of_component[static_cast<std::size_t>(n - 1)];
      n = index == kNoRegion ? 0 : static_cast<int>(index) + 1;
      if (n == 0) continue;
      FigureRegion& region = found.regions[index];
      region.at_border = region.at_border || inner(y, x) == 0;
      region.thickness = std::max(region.thickness, 2. * depth(y, x) - 1);
    }
  measure_rims(label, number, level, half, inner, polarity, found.regions);
  return found;
}

/// What is found in a frame.
struct FrameLabels {
  cv::Mat1b labels;
  std::array<FrameRegions, kFigureReadings> readings;
};

FrameLabels label_frame(const cv::Mat1f& level, std::size_t frame, const FigureGround& ground) {
  FrameLabels out;
  out.labels = cv::Mat1b(level.size(), std::uint8_t{0});
  const cv::Mat1b inner = inner_part(ground, frame);
  for (std::size_t p = 0; p < kFigurePolarities.size(); ++p) {
    cv::Mat1f half;
    const cv::Mat1f amplitude = figure_amplitude(ground, frame, p, level, half);
    for (std::size_t k = 0; k < kFigureThresholds.size(); ++k) {
      const std::size_t r = p * kFigureThresholds.size() + k;
      const cv::Mat1b label = cv::Mat((amplitude > kFigureThresholds[k]) / 255);
      out.labels |= label * (1 << r);
      out.readings[r] = find_regions(label, frame, level, half, inner, kFigurePolarities[p]);
      if (k == 0) explain_regions(label, level, ground.noise, out.readings[r].regions);
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
  for (std::size_t r = 0; r < kFigureReadings; ++r) all.readings[r].polarity = r / kFigureThresholds.size();
  const core::ClipInfo info = source.info();
  const auto label = [&](int t, const cv::Mat& frame) {
    return label_frame(figure_level(frame, info, ground.view), static_cast<std::size_t>(t), ground);
  };
  core::stream_frames(source, "figures", info.frames, context, label, [&](int, FrameLabels frame) {
    all.labels.emplace_back(kept_image(frame.labels, context.memory(), all.blocks));
    for (std::size_t r = 0; r < kFigureReadings; ++r) {
      FigureReading& reading = all.readings[r];
      for (std::size_t& index : frame.readings[r].of_component)
        if (index != kNoRegion) index += reading.regions.size();
      reading.of_component.push_back(std::move(frame.readings[r].of_component));
      std::ranges::move(frame.readings[r].regions, std::back_inserter(reading.regions));
    }
  });
  return all;
}

cv::Mat1i region_numbers(const FigureRegions& all, std::size_t reading, std::size_t frame) {
  cv::Mat1i numbers;
  cv::connectedComponents(cv::Mat((all.labels[frame] & (1 << reading)) != 0), numbers, kConnectivity, CV_32S);
  const FigureReading& of = all.readings[reading];
  std::vector<int> number_of{0};
  for (const std::size_t index : of.of_component[frame])
    number_of.push_back(index == kNoRegion || of.regions[index].is_removed ? 0 : static_cast<int>(index) + 1);
  for (int& n : numbers) n = number_of[static_cast<std::size_t>(n)];
  return numbers;
}

}  // namespace emberfold::pipeline
