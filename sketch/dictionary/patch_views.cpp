// SPDX-License-Identifier: Apache-2.0
#include "sketch/dictionary/patch_views.hpp"

#include <algorithm>
#include <cmath>

#include <opencv2/core.hpp>

#include "core/error.hpp"
#include "core/math/luma.hpp"
#include "sketch/patches/blob_shape.hpp"
#include "sketch/rendering/curve_bands.hpp"

namespace emberfold::sketch {

namespace {

constexpr int kRows = 5;  // px along a profile's patch

/// Keys' cubic convolution, a = −½: exact for parabolas.
std::array<double, 4> cubic_weights(double f) {
  const double g = 1 - f;
  return {-0.5 * f * g * g, 1 + f * f * (1.5 * f - 2.5), 1 + g * g * (1.5 * g - 2.5), -0.5 * g * f * f};
}

/// Adds what the frame shows at a place to one sum a channel.
void sample(const cv::Mat& levels, graph::Point at, double weight, double* sum) {
  const int channels = levels.channels();
  const double x = std::clamp(at.x, 0.0, levels.cols - 1.0), y = std::clamp(at.y, 0.0, levels.rows - 1.0);
  const int x0 = static_cast<int>(x), y0 = static_cast<int>(y);
  const auto across = cubic_weights(x - x0), down = cubic_weights(y - y0);
  for (int j = 0; j < 4; ++j) {
    const float* row = levels.ptr<float>(std::clamp(y0 - 1 + j, 0, levels.rows - 1));
    for (int i = 0; i < 4; ++i) {
      const float* pixel = row + std::clamp(x0 - 1 + i, 0, levels.cols - 1) * channels;
      const double w = weight * down[static_cast<std::size_t>(j)] * across[static_cast<std::size_t>(i)];
      for (int c = 0; c < channels; ++c) sum[c] += w * double{pixel[c]};
    }
  }
}

void append(ColourPatchView& seen, std::array<double, 3> sum, int channels) {
  if (channels == 1) sum[1] = sum[2] = sum[0];
  for (std::size_t c = 0; c < 3; ++c) seen.channel[c].push_back(static_cast<float>(sum[c]));
  seen.view.luma.push_back(static_cast<float>(channels == 1 ? sum[0] : core::luma(sum[0], sum[1], sum[2])));
}

/// Σ d·level over the view, d from left to right.
double rise(const PatchView& view, bool window) {
  double sum = 0;
  for (std::size_t i = 0; i < view.luma.size(); ++i) {
    const double d =
        window ? static_cast<double>(i % kWindowSide) - 0.5 * (kWindowSide - 1) : profile_position(i);
    sum += d * double{view.luma[i]};
  }
  return sum;
}

void turn(ColourPatchView& seen) {
  seen.view.reversed = true;
  std::ranges::reverse(seen.view.luma);  // of a window, both ways: half a turn
  for (auto& channel : seen.channel) std::ranges::reverse(channel);
}

}  // namespace

void check_levels(const cv::Mat& levels) {
  if (levels.empty() || levels.depth() != CV_32F || (levels.channels() != 1 && levels.channels() != 3))
    throw core::InputError("dictionary: the frame must be CV_32F with 1 or 3 channels and not empty");
}

ColourPatchView view_patch(const cv::Mat& levels, const graph::AttributeGraph& graph, std::size_t vertex) {
  const graph::Patch& patch = graph.patch(vertex);
  ColourPatchView seen;
  PatchView& view = seen.view;
  view.vertex = graph.vertices()[vertex].id;
  view.type = patch.type;
  view.degree = counted_degree(graph, vertex);
  view.reach = patch.type == graph::PatchType::blob ? BlobShape(patch).reach() : profile_reach(patch);
  const bool window = looks_like_window(view.type, view.degree);
  const graph::Point along{std::cos(patch.theta), std::sin(patch.theta)}, across{-along.y, along.x};
  const int channels = levels.channels();
  if (window) {
    const double step = 2 * window_reach(view) / (kWindowSide - 1), half = 0.5 * (kWindowSide - 1);
    for (std::size_t a = 0; a < kWindowSide; ++a)
      for (std::size_t d = 0; d < kWindowSide; ++d) {
        std::array<double, 3> sum{};
        sample(levels,
               patch.position + along * (step * (static_cast<double>(a) - half)) +
                   across * (step * (static_cast<double>(d) - half)),
               1, sum.data());
        append(seen, sum, channels);
      }
  } else {
    for (std::size_t i = 0; i < kProfileSamples; ++i) {
      std::array<double, 3> sum{};
      for (int row = 0; row < kRows; ++row)
        sample(
            levels,
            patch.position + across * (view.reach * profile_position(i)) + along * (row - 0.5 * (kRows - 1)),
            1.0 / kRows, sum.data());
      append(seen, sum, channels);
    }
  }
  if (!std::ranges::all_of(view.luma, [](float v) { return std::isfinite(v); })) {
    view.luma.clear();
    for (auto& channel : seen.channel) channel.clear();
  } else if (rise(view, window) < 0) {
    turn(seen);
  }
  return seen;
}

std::vector<PatchView> view_patches(const cv::Mat& levels, const graph::AttributeGraph& graph) {
  check_levels(levels);
  const graph::AttributeGraph strokes = graph::without_anchors(graph);
  std::vector<PatchView> all;
  all.reserve(strokes.size());
  for (std::size_t i = 0; i < strokes.size(); ++i) all.push_back(view_patch(levels, strokes, i).view);
  return all;
}

}  // namespace emberfold::sketch
