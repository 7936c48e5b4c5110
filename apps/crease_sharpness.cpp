// SPDX-License-Identifier: Apache-2.0
#include "apps/crease_sharpness.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>
#include <variant>
#include <vector>

#include <opencv2/imgproc.hpp>

#include "apps/draw_graph_frames.hpp"
#include "apps/interrupt.hpp"
#include "core/error.hpp"
#include "core/parallel.hpp"

namespace emberfold::apps {

namespace {

constexpr std::size_t most_frames = 8;
constexpr int halvings = 6;         // of the interval that the share lies in
constexpr double least_fit = 0.25;  // sharper than that nothing was seen to need
constexpr double least_read = 0.1;
constexpr double border = 4;  // px

/// `at` between pixels, linear; inside the frame.
double between_pixels(const cv::Mat& values, graph::Point at) {
  const int x = static_cast<int>(at.x), y = static_cast<int>(at.y);
  const double u = at.x - x, v = at.y - y;
  const float *above = values.ptr<float>(y) + x, *below = values.ptr<float>(y + 1) + x;
  return (1 - v) * ((1 - u) * double{above[0]} + u * double{above[1]}) +
         v * ((1 - u) * double{below[0]} + u * double{below[1]});
}

struct Sample {
  cv::Mat levels;  // CV_32F
  const graph::AttributeGraph* graph = nullptr;
};

std::vector<Sample> spread_samples(core::FrameSource& source, const graph::SketchSequence& sketch,
                                   const core::Context& context) {
  const std::size_t count = sketch.frames.size();
  const std::size_t every = std::max<std::size_t>(1, (count + most_frames - 1) / most_frames);
  std::vector<Sample> samples;
  source.rewind();
  for (std::size_t t = 0; t < count; ++t) {
    if (context.cancelled()) throw Interrupted{};
    const cv::Mat frame = source.next();
    if (frame.empty()) break;
    if (t % every == every / 2) samples.push_back({core::to_levels(frame, source.info()), &sketch.frames[t]});
  }
  return samples;
}

/// Of all samples, as they are drawn.
double drawn_sharpness(const std::vector<Sample>& samples, double share, const core::Context& context) {
  std::vector<CreaseSharpness> found(samples.size());
  const auto status = core::parallel_for(samples.size(), context, [&](std::size_t i) {
    FrameLook look;
    look.size = samples[i].levels.size(), look.channels = samples[i].levels.channels();
    look.blur_share = share;
    cv::Mat drawn;
    draw_frame(*samples[i].graph, look).convertTo(drawn, CV_32F);
    found[i] = crease_sharpness(core::luma(drawn), *samples[i].graph);
  });
  if (status == core::Status::cancelled) throw Interrupted{};
  CreaseSharpness all;
  for (const auto& one : found) all.sum += one.sum, all.places += one.places;
  return all.mean();
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

double fit_blur_share(core::FrameSource& source, const graph::SketchSequence& sketch,
                      const core::Context& context) {
  const auto samples = spread_samples(source, sketch, context);
  CreaseSharpness seen;
  for (const auto& sample : samples) {
    const auto one = crease_sharpness(core::luma(sample.levels), *sample.graph);
    seen.sum += one.sum, seen.places += one.places;
  }
  if (seen.places == 0 || drawn_sharpness(samples, 1, context) >= seen.mean()) return 1;
  double low = least_fit, high = 1;
  for (int i = 0; i < halvings; ++i) {
    const double middle = (low + high) / 2;
    (drawn_sharpness(samples, middle, context) >= seen.mean() ? low : high) = middle;
  }
  return (low + high) / 2;
}

void add_blur_share(core::ModelArchive& archive, double share) {
  archive.arrays["blur_share"] = {{1}, false, std::vector<double>{share}};
}

double read_blur_share(const core::ModelArchive& archive) {
  const auto found = archive.arrays.find("blur_share");
  if (found == archive.arrays.end()) return 1;
  const auto* const values = std::get_if<std::vector<double>>(&found->second.data);
  if (!values || values->size() != 1)
    throw core::IoError("motion model: blur_share.npy is not one number in float64");
  const double share = values->front();
  if (!(share >= least_read && share <= 1))
    throw core::IoError("motion model: blur_share.npy is " + std::to_string(share) + "; allowed is 0.1…1");
  return share;
}

}  // namespace emberfold::apps
