// SPDX-License-Identifier: Apache-2.0
#include "pipeline/comparison/visible_measures.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <utility>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "core/parallel.hpp"
#include "core/rng.hpp"
#include "dytex/measures/optical_flow.hpp"
#include "pipeline/footage/copied_share.hpp"

namespace emberfold::pipeline {

namespace {

constexpr double kMostPixels = 1 << 16;  // of a picture
constexpr double kMoves = 8;             // grey levels, SD over time of a pixel that moves
constexpr int kFewestMoving = 300;       // px; where fewer move …
constexpr double kMovingShare = 0.15;    // … this share of all is taken
constexpr int kRadius = 3;               // px of a patch
constexpr int kBasePatches = 30'000, kPatches = 1'500, kComponents = 16;
constexpr std::uint32_t kPatchStream = 0x70617463;       // of the random stream
constexpr double kFastest = 0.95;                        // quantile of the speeds
constexpr int kMostFlows = 50;                           // pairs of frames whose flow is measured
constexpr double kMostApart = 1.0986, kPatchWeight = 3;  // ln 3; chosen visually (VisibleFigures::apart)
constexpr std::size_t kCopiedEvery = 5;                  // frames between two whose copied pixels are counted
// Values below these count as still: px, levels², levels, levels.
constexpr double kLeastFlow = 0.01, kLeastVariance = 0.25, kLeastDifference = 0.1, kLeastDistance = 0.1;

cv::Mat deviation_over_time(const std::vector<cv::Mat>& clip, cv::Mat* variance = nullptr) {
  cv::Mat sum = cv::Mat::zeros(clip.front().size(), CV_32F), squares = sum.clone(), levels;
  for (const auto& picture : clip) {
    picture.convertTo(levels, CV_32F);
    sum += levels;
    squares += levels.mul(levels);
  }
  const double frames = static_cast<double>(clip.size());
  cv::Mat mean = sum / frames, out = cv::max(squares / frames - mean.mul(mean), 0), deviation;
  if (variance != nullptr) *variance = out;
  cv::sqrt(out, deviation);
  return deviation;
}

cv::Mat1b find_moving(const std::vector<cv::Mat>& source) {
  const cv::Mat1f deviation = deviation_over_time(source);
  cv::Mat1b moves;
  cv::compare(deviation, kMoves, moves, cv::CMP_GT);
  if (cv::countNonZero(moves) >= kFewestMoving) return moves;
  std::vector<float> values(deviation.begin(), deviation.end());
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(double(values.size()) * (1 - kMovingShare));
  std::ranges::nth_element(values, at);
  cv::compare(deviation, double{*at}, moves, cv::CMP_GE);
  return moves;
}

/// Returns the mean distance of `patches` to the nearest of `base`, rows of components.
double mean_distance(const cv::Mat& patches, const cv::Mat& base, const core::Context& context) {
  std::vector<double> nearest(static_cast<std::size_t>(patches.rows));
  core::parallel_for(nearest.size(), context, [&](std::size_t i) {
    const float* const own = patches.ptr<float>(static_cast<int>(i));
    float least = std::numeric_limits<float>::infinity();
    for (int k = 0; k < base.rows; ++k) {
      const float* const other = base.ptr<float>(k);
      float sum = 0;
      for (int c = 0; c < kComponents; ++c) sum += (own[c] - other[c]) * (own[c] - other[c]);
      least = std::min(least, sum);
    }
    nearest[i] = std::sqrt(double{least});
  });
  double sum = 0;
  for (const double one : nearest) sum += one;
  return sum / static_cast<double>(nearest.size());
}

double share(double value, double reference, double least) {
  return std::max(value, reference) < least ? 1 : value / std::max(reference, least);
}

}  // namespace

std::span<const MeasureDescription> visible_measures() {
  static constexpr std::array<MeasureDescription, 6> kMeasures{{
      {"complete", "Complete", "",
       "distance to what the source shows, 1 as its own halves; more: something is missing"},
      {"coherent", "Coherent", "",
       "distance of what it shows from the source, 1 as its own halves; more: the source has no such thing"},
      {"flow", "Flow", "", "speed of the fastest motion, share of the source's"},
      {"variance", "Variance", "", "over time, share of the source's"},
      {"difference", "Difference", "", "from frame to frame, share of the source's"},
      {"copied", "Copied", "", "share of what moves that is as in one frame of the source"},
  }};
  return kMeasures;
}

bool VisibleFigures::moves_alike() const {
  return std::ranges::all_of(std::array{flow, variance, difference},
                             [](double one) { return one >= 0.7 && one <= 1.4; });
}

double VisibleFigures::apart() const {
  const auto logarithm = [](double share) { return std::log(std::max(share, 1e-3)); };
  double sum = 0;
  for (const double one : {flow, variance, difference})
    sum += std::pow(std::clamp(logarithm(one), -kMostApart, kMostApart), 2);
  for (const double one : {complete, coherent})
    sum += std::pow(kPatchWeight * std::max(logarithm(one), 0.0), 2);
  return std::sqrt(sum);
}

cv::Mat visible_picture(const cv::Mat& luma) {
  const double factor = std::min(0.5, std::sqrt(kMostPixels / (double(luma.cols) * luma.rows)));
  cv::Mat small, bytes;
  cv::resize(luma, small,
             {std::max(1, static_cast<int>(std::lround(luma.cols * factor))),
              std::max(1, static_cast<int>(std::lround(luma.rows * factor)))},
             0, 0, cv::INTER_AREA);
  small.convertTo(bytes, CV_8U);
  return bytes;
}

VisibleMeasures::VisibleMeasures(std::vector<cv::Mat> source, const core::Context& context)
    : source_(std::move(source)), moves_(find_moving(source_)) {
  const cv::Size size = moves_.size();
  const cv::Rect inside(kRadius, kRadius, size.width - 2 * kRadius, size.height - 2 * kRadius);
  if (inside.width > 0 && inside.height > 0) {
    cv::findNonZero(moves_(inside), places_);
    for (auto& place : places_) place += inside.tl();
  }
  motion_ = motion(source_, context);
  if (places_.empty()) return;
  const std::span<const cv::Mat> all(source_);
  const auto half = source_.size() / 2;
  const cv::Mat first = patches(all.first(half), kBasePatches, 0);
  // A tenth of the patches is enough for the components.
  const cv::PCA components(first.rowRange(0, kBasePatches / 10), cv::noArray(), cv::PCA::DATA_AS_ROW,
                           kComponents);
  mean_ = components.mean;
  axes_ = components.eigenvectors;
  second_half_ = components.project(patches(all.subspan(half), kPatches, 1));
  all_ = components.project(patches(all, 2 * kBasePatches, 3));
  base_ = mean_distance(second_half_, components.project(first), context);
}

/// Draws `count` patches of 3 frames, a row each.
cv::Mat VisibleMeasures::patches(std::span<const cv::Mat> clip, int count, std::uint32_t stream) const {
  constexpr int side = 2 * kRadius + 1;
  cv::Mat out(count, 3 * side * side, CV_32F);
  core::Rng rng(1, {kPatchStream, stream});
  const auto frames = static_cast<std::uint32_t>(clip.size());
  for (int i = 0; i < count; ++i) {
    const auto& place = places_[rng.below(static_cast<std::uint32_t>(places_.size()))];
    const std::size_t t = 1 + rng.below(frames - 2);
    float* level = out.ptr<float>(i);
    for (std::size_t f = t - 1; f <= t + 1; ++f)
      for (int y = place.y - kRadius; y <= place.y + kRadius; ++y)
        for (int x = place.x - kRadius; x <= place.x + kRadius; ++x)
          *level++ = static_cast<float>(clip[f].at<std::uint8_t>(y, x));
  }
  return out;
}

cv::Mat VisibleMeasures::components(const cv::Mat& patches) const {
  cv::Mat components;
  cv::PCAProject(patches, mean_, axes_, components);
  return components;
}

VisibleMeasures::Motion VisibleMeasures::motion(const std::vector<cv::Mat>& clip,
                                                const core::Context& context) const {
  Motion out;
  cv::Mat variance, difference;
  deviation_over_time(clip, &variance);
  out.variance = cv::mean(variance, moves_)[0];
  const std::size_t pairs = clip.size() - 1;
  for (std::size_t t = 0; t < pairs; ++t) {
    cv::absdiff(clip[t], clip[t + 1], difference);
    out.difference += cv::mean(difference, moves_)[0] / double(pairs);
  }
  const std::size_t flows = std::min<std::size_t>(kMostFlows, pairs);
  std::vector<std::vector<float>> speeds(flows);
  core::parallel_for(flows, context, [&](std::size_t i) {
    const std::size_t t = i * pairs / flows;
    cv::Mat before, after;
    clip[t].convertTo(before, CV_32F);
    clip[t + 1].convertTo(after, CV_32F);
    const cv::Mat flow = dytex::optical_flow(before, after);
    for (int y = 0; y < flow.rows; ++y)
      for (int x = 0; x < flow.cols; ++x)
        if (moves_(y, x) != 0) speeds[i].push_back(static_cast<float>(cv::norm(flow.at<cv::Vec2f>(y, x))));
  });
  std::vector<float> all;
  for (const auto& some : speeds) all.insert(all.end(), some.begin(), some.end());
  if (all.empty()) return out;
  const auto at = all.begin() + static_cast<std::ptrdiff_t>(double(all.size() - 1) * kFastest);
  std::ranges::nth_element(all, at);
  out.flow = double{*at};
  return out;
}

VisibleFigures VisibleMeasures::measure(std::vector<cv::Mat> clip, const core::Context& context) const {
  for (auto& picture : clip)
    if (picture.size() != moves_.size())
      cv::resize(cv::Mat(picture), picture, moves_.size(), 0, 0, cv::INTER_AREA);
  VisibleFigures out;
  if (!places_.empty()) {
    const cv::Mat shown = components(patches(clip, kBasePatches, 2));
    out.complete = share(mean_distance(second_half_, shown, context), base_, kLeastDistance);
    out.coherent = share(mean_distance(shown.rowRange(0, kPatches), all_, context), base_, kLeastDistance);
  }
  const Motion own = motion(clip, context);
  out.flow = share(own.flow, motion_.flow, kLeastFlow);
  out.variance = share(own.variance, motion_.variance, kLeastVariance);
  out.difference = share(own.difference, motion_.difference, kLeastDifference);
  CopiedShare copied(source_, moves_);
  for (std::size_t t = 0; t < clip.size(); t += kCopiedEvery) copied.add(clip[t]);
  out.copied = copied.mean();
  return out;
}

}  // namespace emberfold::pipeline
