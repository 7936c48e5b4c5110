// SPDX-License-Identifier: Apache-2.0
#include "sketch/rendering/sharpening.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <string>
#include <variant>
#include <vector>

#include <opencv2/core.hpp>

#include "core/context.hpp"
#include "core/error.hpp"
#include "core/math/bilinear.hpp"
#include "core/math/image_gradient.hpp"

namespace emberfold::sketch {

namespace {

constexpr std::size_t most_frames = 8;
constexpr int trials = 3;              // after those of both ends
constexpr double near_enough = 0.005;  // of the gradient that is wanted
constexpr double least_share = 0.25, most_gain = 1.5;
constexpr double border = 4;  // px

/// Mean flank gradient of all frames as they are drawn.
double measure_drawn_gradient(std::span<const FrameContent> content, const RenderOptions& options,
                              const core::Context& context) {
  const auto frames = render_frames(content, options, context);
  FlankGradient all;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    cv::Mat levels;
    frames[i].convertTo(levels, CV_32F);
    const auto one = measure_flank_gradient(core::luma(levels), visible_patches(content[i]));
    all.sum += one.sum, all.places += one.places;
  }
  return all.mean();
}

/// A value of what is to be found, and the gradient that it draws.
struct Trial {
  double value, gradient;
};

/// Finds the value between one that is not steep enough and one that is, by false position: the gradient is
/// nearly straight in both shares.
double solve(Trial soft, Trial steep, double target, const std::function<double(double)>& gradient_of) {
  const auto between = [&] {
    return std::lerp(soft.value, steep.value, (target - soft.gradient) / (steep.gradient - soft.gradient));
  };
  for (int i = 0; i < trials; ++i) {
    const double value = between();
    const Trial now{value, gradient_of(value)};
    if (std::abs(now.gradient - target) <= near_enough * target) return now.value;
    (now.gradient >= target ? steep : soft) = now;
  }
  return between();
}

}  // namespace

FlankGradient measure_flank_gradient(const cv::Mat& luma, const graph::AttributeGraph& graph) {
  const cv::Mat slope = core::sobel(luma).size;
  FlankGradient result;
  const graph::AttributeGraph strokes = graph::without_anchors(graph);
  for (const auto& vertex : strokes.vertices()) {
    const graph::Patch& patch = vertex.patch;
    const double aside = graph::on_step(patch) ? 0 : std::max(patch.width / 2, patch.blur);
    const graph::Point normal{-std::sin(patch.theta), std::cos(patch.theta)};
    for (const double side : {-aside, aside}) {
      const graph::Point at = patch.position + normal * side;
      if (!(at.x >= border && at.y >= border && at.x <= luma.cols - 1 - border &&
            at.y <= luma.rows - 1 - border))
        continue;
      result.sum += core::sample_bilinear(slope, at.x, at.y);
      ++result.places;
    }
  }
  return result;
}

FlankGradient measure_clip_flank_gradient(core::FrameSource& source, const graph::SketchSequence& sketch,
                                          const core::Context& context) {
  const std::size_t count = sketch.frames.size();
  const std::size_t every = std::max<std::size_t>(1, (count + most_frames - 1) / most_frames);
  FlankGradient all;
  source.rewind();
  for (std::size_t t = 0; t < count; ++t) {
    context.check();
    const cv::Mat frame = source.next();
    if (frame.empty()) break;
    if (t % every != every / 2) continue;
    const auto one = measure_flank_gradient(core::luma(frame, source.info()), sketch.frames[t]);
    all.sum += one.sum, all.places += one.places;
  }
  return all;
}

Sharpening fit_sharpening(std::span<const FrameContent> content, RenderOptions options, double target,
                          const core::Context& context) {
  const auto gradient_of = [&](double share, double gain) {
    options.blur_share = share, options.contrast_gain = gain;
    return measure_drawn_gradient(content, options, context);
  };
  const Trial fitted{1, gradient_of(1, 1)};
  if (fitted.gradient <= 0 || fitted.gradient >= target) return {};
  const Trial sharp{least_share, gradient_of(least_share, 1)};
  if (sharp.gradient >= target)
    return {solve(fitted, sharp, target, [&](double share) { return gradient_of(share, 1); }), 1};
  const Trial strong{most_gain, gradient_of(least_share, most_gain)};
  if (strong.gradient <= target) return {least_share, most_gain};
  return {least_share, solve({1, sharp.gradient}, strong, target,
                             [&](double gain) { return gradient_of(least_share, gain); })};
}

RenderOptions apply_sharpening(RenderOptions options, const Sharpening& sharpening) {
  options.blur_share = sharpening.blur_share;
  options.contrast_gain = sharpening.contrast_gain;
  return options;
}

void add_sharpening(core::ModelArchive& archive, const Sharpening& sharpening) {
  archive.arrays["sharpening"] = {
      {2}, false, std::vector<double>{sharpening.blur_share, sharpening.contrast_gain}};
}

Sharpening read_sharpening(const core::ModelArchive& archive) {
  const auto found = archive.arrays.find("sharpening");
  if (found == archive.arrays.end()) return {};
  const auto* const values = std::get_if<std::vector<double>>(&found->second.data);
  if (!values || values->size() != 2)
    throw core::IoError("motion model: sharpening.npy is not two numbers in float64");
  const Sharpening read{(*values)[0], (*values)[1]};
  if (!(read.blur_share >= 0.1 && read.blur_share <= 1 && read.contrast_gain >= 1 &&
        read.contrast_gain <= 10))
    throw core::IoError("motion model: sharpening.npy is " + std::to_string(read.blur_share) + ", " +
                        std::to_string(read.contrast_gain) + "; allowed are 0.1…1 and 1…10");
  return read;
}

}  // namespace emberfold::sketch
