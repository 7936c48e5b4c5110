// SPDX-License-Identifier: Apache-2.0
// Small time-lapses for the tests of quilting.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "core/rng.hpp"
#include "dytex/quilting/quilt.hpp"

namespace emberfold::test {

/// Blurred noise that brightens and darkens, each place at its own pace: a texture that changes.
inline core::Clip made_lapse(cv::Size size, int frames, int type = CV_8UC1, std::uint64_t seed = 1,
                             double grain = 0) {
  const int depth = CV_MAT_DEPTH(type), channels = CV_MAT_CN(type);
  const double white = depth == CV_32F ? 1 : depth == CV_16U ? 65535 : 255;
  core::Clip clip{{size.width, size.height, channels, depth, 25, white, frames}, {}};
  const auto blurred = [&](std::uint32_t stream) {
    core::Rng rng(seed, {stream, 7, 0});
    cv::Mat noise(size, CV_32FC(channels));
    for (float& v : cv::Mat_<float>(noise.reshape(1))) v = static_cast<float>(rng.normal());
    cv::GaussianBlur(noise, noise, {}, 2, 2, cv::BORDER_REFLECT);
    return noise;
  };
  const cv::Mat still = blurred(0), slow = blurred(1), fast = blurred(2);
  for (int t = 0; t < frames; ++t) {
    const double u = frames > 1 ? static_cast<double>(t) / (frames - 1) : 0;
    cv::Mat levels = still + u * slow + std::sin(9 * u) * fast;
    core::Rng rng(seed, {static_cast<std::uint32_t>(t), 8, 0});
    for (float& v : cv::Mat_<float>(levels.reshape(1)))
      v = static_cast<float>(std::clamp(0.5 + static_cast<double>(v) + grain * rng.normal(), 0.0, 1.0));
    cv::Mat frame;
    levels.convertTo(frame, depth, white);
    clip.frames.push_back(frame);
  }
  return clip;
}

inline dytex::Trajectories held(const core::Clip& clip) {
  dytex::Trajectories trajectories(clip.info);
  for (const auto& frame : clip.frames) trajectories.add(frame);
  trajectories.finish();
  return trajectories;
}

inline dytex::QuiltResult quilted(const dytex::Trajectories& source, const dytex::QuiltOptions& options) {
  const std::vector<dytex::QuiltSource> sources{{&source, {}, {}}};
  return dytex::quilt(sources, options);
}

}  // namespace emberfold::test
