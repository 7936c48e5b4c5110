// SPDX-License-Identifier: Apache-2.0
#include "apps/crease_sharpness.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <string>
#include <variant>
#include <vector>

#include <opencv2/imgproc.hpp>

#include "apps/interrupt.hpp"
#include "core/error.hpp"

namespace emberfold::apps {

namespace {

constexpr std::size_t most_frames = 8;
constexpr int halvings = 6;  // of the interval that the share lies in
constexpr double least_share = 0.25, most_gain = 1.5;
constexpr double border = 4;  // px

/// `at` between pixels, linear; inside the frame.
double between_pixels(const cv::Mat& values, graph::Point at) {
  const int x = static_cast<int>(at.x), y = static_cast<int>(at.y);
  const double u = at.x - x, v = at.y - y;
  const float *above = values.ptr<float>(y) + x, *below = values.ptr<float>(y + 1) + x;
  return (1 - v) * ((1 - u) * double{above[0]} + u * double{above[1]}) +
         v * ((1 - u) * double{below[0]} + u * double{below[1]});
}

/// Of all frames, as they are drawn.
double drawn_sharpness(std::span<const FrameParts> parts, const FrameLook& look,
                       const core::Context& context) {
  const auto frames = draw_batch(parts, look, context);
  CreaseSharpness all;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    cv::Mat levels;
    frames[i].convertTo(levels, CV_32F);
    const auto one = crease_sharpness(core::luma(levels), mostly_there(parts[i]));
    all.sum += one.sum, all.places += one.places;
  }
  return all.mean();
}

/// The value between one that is not sharp enough and one that is.
double bisect(double& value, double too_soft, double sharp, const std::function<bool()>& is_sharp) {
  for (int i = 0; i < halvings; ++i) {
    value = (too_soft + sharp) / 2;
    (is_sharp() ? sharp : too_soft) = value;
  }
  return value = (too_soft + sharp) / 2;
}

}  // namespace

CreaseSharpness crease_sharpness(const cv::Mat& luma, const graph::AttributeGraph& graph) {
  cv::Mat across, down, magnitude;
  cv::Sobel(luma, across, CV_32F, 1, 0, 3, 1 / 8.0);
  cv::Sobel(luma, down, CV_32F, 0, 1, 3, 1 / 8.0);
  cv::magnitude(across, down, magnitude);
  CreaseSharpness result;
  for (const auto& vertex : graph.vertices()) {
    const graph::Patch& patch = vertex.patch;
    if (patch.type == graph::PatchType::blob) continue;
    const double aside = graph::on_step(patch) ? 0 : std::max(patch.width / 2, patch.blur);
    const graph::Point normal{-std::sin(patch.theta), std::cos(patch.theta)};
    for (const double side : {-aside, aside}) {
      const graph::Point at = patch.position + normal * side;
      if (!(at.x >= border && at.y >= border && at.x <= luma.cols - 1 - border &&
            at.y <= luma.rows - 1 - border))
        continue;
      result.sum += between_pixels(magnitude, at);
      ++result.places;
    }
  }
  return result;
}

CreaseSharpness clip_sharpness(core::FrameSource& source, const graph::SketchSequence& sketch,
                               const core::Context& context) {
  const std::size_t count = sketch.frames.size();
  const std::size_t every = std::max<std::size_t>(1, (count + most_frames - 1) / most_frames);
  CreaseSharpness all;
  source.rewind();
  for (std::size_t t = 0; t < count; ++t) {
    if (context.cancelled()) throw Interrupted{};
    const cv::Mat frame = source.next();
    if (frame.empty()) break;
    if (t % every != every / 2) continue;
    const auto one = crease_sharpness(core::luma(frame, source.info()), sketch.frames[t]);
    all.sum += one.sum, all.places += one.places;
  }
  return all;
}

Sharpening fit_sharpening(std::span<const FrameParts> parts, FrameLook look, double wanted,
                          const core::Context& context) {
  look.blur_share = look.contrast_gain = 1;
  const auto is_sharp = [&] { return drawn_sharpness(parts, look, context) >= wanted; };
  if (const double fitted = drawn_sharpness(parts, look, context); fitted <= 0 || fitted >= wanted) return {};
  look.blur_share = least_share;
  if (is_sharp()) {
    bisect(look.blur_share, 1, least_share, is_sharp);
    return {look.blur_share, 1};
  }
  bisect(look.contrast_gain, 1, most_gain, is_sharp);
  return {look.blur_share, look.contrast_gain};
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

}  // namespace emberfold::apps
