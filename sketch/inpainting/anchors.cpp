// SPDX-License-Identifier: Apache-2.0
#include "sketch/inpainting/anchors.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <sstream>
#include <utility>
#include <vector>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "core/clip.hpp"
#include "core/error.hpp"
#include "core/text/check_range.hpp"
#include "sketch/inpainting/check_levels.hpp"
#include "sketch/inpainting/fill.hpp"

namespace emberfold::sketch {

namespace {

constexpr double kFirstShare = 0.15;     // of the anchors, placed by curvature alone
constexpr double kSmoothing = 0.5;       // px, SD, before the Laplacian
constexpr double kDensityPower = 0.8;    // of |Δu| in the halftone
constexpr double kFloor = 1e-3;          // of |Δu|: where it is 0 a halftone has few pixels, not none
constexpr double kRoughTolerance = 0.3;  // grey levels, of the fills between
constexpr double kLeastScore = 1e-4;     // grey levels²: what is nearer than this needs no anchor

void check(const cv::Mat& levels, const cv::Mat& taken, double share) {
  check_levels_and_mask("anchors", levels, taken);
  std::ostringstream message;
  if (!(share >= 0 && share <= 1))
    message << "anchors: the share is " << share << "; allowed are 0 to 1";
  else if (!cv::checkRange(levels))
    message << "anchors: the levels hold a number that is not finite";
  if (!message.str().empty()) throw core::InputError(message.str());
}

cv::Mat smooth(const cv::Mat& u, double deviation) {
  cv::Mat result;
  const int side = 2 * static_cast<int>(std::ceil(4 * deviation)) + 1;
  cv::GaussianBlur(u, result, {side, side}, deviation, deviation, cv::BORDER_REPLICATE);
  return result;
}

/// |Δu|, 5 points, insulated border.
cv::Mat curvature(const cv::Mat& luma) {
  cv::Mat result;
  cv::Laplacian(smooth(luma, kSmoothing), result, CV_32F, 1, 1, 0, cv::BORDER_REPLICATE);
  return cv::abs(result);
}

/// Whatever is no peak of 3 × 3 pixels becomes 0.
void keep_peaks(cv::Mat& score) {
  cv::Mat around;
  cv::dilate(score, around, {});
  score.setTo(0, score < around);
}

/// Sets the `count` best pixels above 0 of the score, or as many as there are; of equals the first in the
/// raster. Returns how many.
int add_best(const cv::Mat& score, int count, cv::Mat& mask) {
  std::vector<float> values;
  for (int y = 0; y < score.rows; ++y)
    for (int x = 0; x < score.cols; ++x)
      if (const float value = score.at<float>(y, x); value > 0) values.push_back(value);
  count = std::min(count, static_cast<int>(values.size()));
  if (count <= 0) return 0;
  const auto last = values.begin() + count - 1;
  std::nth_element(values.begin(), last, values.end(), std::greater<>());
  const float least = *last;
  auto equals =
      count - static_cast<int>(std::count_if(values.begin(), last, [=](float v) { return v > least; }));
  for (int y = 0; y < score.rows; ++y)
    for (int x = 0; x < score.cols; ++x) {
      const float value = score.at<float>(y, x);
      if (value > least || (value == least && equals-- > 0)) mask.at<std::uint8_t>(y, x) = 255;
    }
  return count;
}

/// The factor that gives Σ min(1, factor · weight) = count.
double halftone_factor(const cv::Mat& weight, int count) {
  double low = 0, high = count / std::max(cv::sum(weight)[0], 1e-12);
  const auto sum = [&](double factor) { return cv::sum(cv::min(weight * factor, 1.0))[0]; };
  for (int i = 0; i < 40 && sum(high) < count - 0.5; ++i) high *= 2;
  for (int i = 0; i < 40; ++i) {
    const double middle = (low + high) / 2;
    (sum(middle) < count ? low : high) = middle;
  }
  return low;
}

/// At most `count` pixels with a density as the weight, by error diffusion over rows of alternating sense. A
/// pixel of weight 0 passes on what it gets.
cv::Mat halftone(const cv::Mat& weight, int count) {
  const auto factor = static_cast<float>(halftone_factor(weight, count));
  cv::Mat result(weight.size(), CV_8U, cv::Scalar(0));
  const auto width = static_cast<std::size_t>(weight.cols);
  std::vector<float> here(width + 2), below(width + 2);
  for (int y = 0; y < weight.rows; ++y) {
    std::fill(below.begin(), below.end(), 0.0F);
    const bool back = y % 2 == 1;
    for (int k = 0; k < weight.cols; ++k) {
      const int x = back ? weight.cols - 1 - k : k;
      const auto i = static_cast<std::size_t>(x) + 1, next = back ? i - 1 : i + 1,
                 last = back ? i + 1 : i - 1;
      const float own = weight.at<float>(y, x);
      const float value = here[i] + std::min(own * factor, 1.0F);
      const bool on = own > 0 && value >= 0.5F && count > 0;
      if (on) {
        result.at<std::uint8_t>(y, x) = 255;
        --count;
      }
      const float rest = value - (on ? 1.0F : 0.0F);
      here[next] += rest * 7 / 16;
      below[last] += rest * 3 / 16;
      below[i] += rest * 5 / 16;
      below[next] += rest / 16;
    }
    std::swap(here, below);
  }
  return result;
}

/// e · (g ∗ e), summed over the channels.
cv::Mat error_score(const cv::Mat& error, double spread) {
  cv::Mat product = error.mul(smooth(error, spread)), sum;
  if (product.channels() == 1) return product;
  cv::transform(product, sum, cv::Matx13f(1, 1, 1));
  return sum;
}

/// By rounds; `held`: levels of what is held, the frame's own but at drawn patches.
cv::Mat by_error(const cv::Mat& levels, const cv::Mat& held, const cv::Mat& taken, int count,
                 const AnchorOptions& options) {
  cv::Mat result(levels.size(), CV_8U, cv::Scalar(0)), mask = taken.clone();
  cv::Mat score = curvature(core::luma(levels));
  score.setTo(0, mask);
  keep_peaks(score);
  const int first = add_best(score, static_cast<int>(std::lround(count * kFirstShare)), result);
  int placed = first;
  for (int round = 1; round <= options.rounds && placed < count; ++round) {
    const bool last = round == options.rounds;
    mask.setTo(255, result);
    score = error_score(fill(held, mask, {.tolerance = kRoughTolerance}).levels - levels, options.spread);
    score.setTo(0, (mask != 0) | (score < kLeastScore));
    cv::Mat everywhere = last ? score.clone() : cv::Mat();
    keep_peaks(score);
    const auto due = first + static_cast<int>(std::lround(double(count - first) * round / options.rounds));
    const int found = add_best(score, due - placed, result);
    placed += found;
    if (!last || placed >= count) continue;
    everywhere.setTo(0, result);
    placed += add_best(everywhere, count - placed, result);
  }
  return result;
}

cv::Mat place(const cv::Mat& levels, const cv::Mat& held, const cv::Mat& taken, double share,
              const AnchorOptions& options) {
  const int free = levels.rows * levels.cols - cv::countNonZero(taken);
  const int count = std::min(free, static_cast<int>(std::floor(share * double(levels.total()) + 1e-9)));
  if (count == 0) return cv::Mat(levels.size(), CV_8U, cv::Scalar(0));
  if (options.rounds > 0) return by_error(levels, held, taken, count, options);
  cv::Mat weight = curvature(core::luma(levels));
  cv::pow(weight, kDensityPower, weight);
  weight += kFloor;
  weight.setTo(0, taken);
  return halftone(weight, count);
}

}  // namespace

graph::AttributeGraph add_anchors(const graph::AttributeGraph& graph, const cv::Mat& levels,
                                  const cv::Mat& mask) {
  check(levels, mask, 0);
  std::vector<graph::Vertex> vertices(graph.vertices().begin(), graph.vertices().end());
  std::uint32_t next = vertices.empty() ? 0 : vertices.back().id.value + 1;
  const int channels = levels.channels();
  for (int y = 0; y < mask.rows; ++y)
    for (int x = 0; x < mask.cols; ++x) {
      if (mask.at<std::uint8_t>(y, x) == 0) continue;
      const float* level = levels.ptr<float>(y) + x * channels;
      vertices.push_back({{next++},
                          {},
                          graph::make_anchor({double(x), double(y)}, {level[0], level[channels > 1 ? 1 : 0],
                                                                      level[channels > 1 ? 2 : 0]})});
    }
  return {std::move(vertices), {graph.edges().begin(), graph.edges().end()}};
}

void AnchorOptions::validate() const {
  core::check_range("AnchorOptions.rounds", rounds, 0, 256);
  core::check_range("AnchorOptions.spread", spread, 0.3, 5);
}

cv::Mat choose_anchors(const cv::Mat& levels, const cv::Mat& taken, double share,
                       const AnchorOptions& options) {
  options.validate();
  check(levels, taken, share);
  return place(levels, levels, taken, share, options);
}

cv::Mat choose_anchors(const cv::Mat& levels, const Sketchable& drawn, double share,
                       const AnchorOptions& options) {
  options.validate();
  check(levels, drawn.mask, share);
  if (drawn.levels.type() != levels.type() || drawn.levels.size() != levels.size()) {
    std::ostringstream message;
    message << "anchors: the patches are " << cv::typeToString(drawn.levels.type()) << ", "
            << drawn.levels.cols << " × " << drawn.levels.rows << "; they have to be as the levels are, "
            << cv::typeToString(levels.type()) << ", " << levels.cols << " × " << levels.rows;
    throw core::InputError(message.str());
  }
  cv::Mat held = levels.clone();
  drawn.levels.copyTo(held, drawn.mask);
  return place(levels, held, drawn.mask, share, options);
}

}  // namespace emberfold::sketch
