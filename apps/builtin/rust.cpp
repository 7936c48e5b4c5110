// SPDX-License-Identifier: Apache-2.0
#include "apps/builtin/rust.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "core/parallel.hpp"
#include "core/rng.hpp"

namespace emberfold::apps {

namespace {

constexpr float kNever = std::numeric_limits<float>::max();

/// The development of the plate by pixel; times as shares of the clip.
struct Plate {
  cv::Mat rust;          ///< when rust arrives
  cv::Mat crack;         ///< when a crack arrives
  cv::Mat fine, coarse;  ///< noise, SD 1
};

// Draws Gaussian-filtered noise of mean 0 and SD 1.
cv::Mat draw_noise(const BuiltinOptions& options, std::uint32_t stream, double sigma) {
  cv::Mat field(options.height, options.width, CV_32F);
  core::Rng rng(options.seed, {0x72757374u, stream, 0});
  for (float& value : cv::Mat_<float>(field)) value = static_cast<float>(rng.normal());
  if (sigma > 0) cv::GaussianBlur(field, field, {}, sigma, sigma, cv::BORDER_REFLECT);
  cv::Scalar mean, deviation;
  cv::meanStdDev(field, mean, deviation);
  return (field - mean[0]) / deviation[0];
}

// Returns when rust arrives at each pixel: spots start in turn and spread at their own pace, with ragged
// fronts.
cv::Mat rust_arrival(const BuiltinOptions& options) {
  constexpr double kAreaPerSpot = 240, kReach = 24;
  const int count = std::max(6, cvRound(static_cast<double>(options.width) * options.height / kAreaPerSpot));
  const cv::Mat bend =
      0.6 * draw_noise(options, 1, 5) + 0.4 * draw_noise(options, 2, 2) + 0.25 * draw_noise(options, 3, 0.8);
  cv::Mat arrival(options.height, options.width, CV_32F, cv::Scalar(kNever));
  core::Rng rng(options.seed, {0x72757374u, 4, 0});
  for (int i = 0; i < count; ++i) {
    const double x = rng.uniform(-10, options.width + 10), y = rng.uniform(-10, options.height + 10);
    const double start = rng.uniform(0.03, 0.95), pace = rng.uniform(4, 14);  // px in the whole clip
    const double long_side = rng.uniform(1, 1.7), turn = rng.uniform(0, std::numbers::pi);
    const double c = std::cos(turn), s = std::sin(turn);
    const int top = std::max(0, static_cast<int>(y - kReach)),
              left = std::max(0, static_cast<int>(x - kReach));
    for (int v = top; v < std::min<double>(options.height, y + kReach); ++v)
      for (int u = left; u < std::min<double>(options.width, x + kReach); ++u) {
        const double along = (c * (u - x) + s * (v - y)) / long_side, across = -s * (u - x) + c * (v - y);
        const double far =
            std::max(0.0, std::hypot(along, across) * (1 + 0.28 * static_cast<double>(bend.at<float>(v, u))));
        auto& at = arrival.at<float>(v, u);
        at = std::min(at, static_cast<float>(start + far / pace));
      }
  }
  return arrival;
}

// Returns when cracks arrive at each pixel: wandering lines, one or two pixels wide, that grow from one end.
cv::Mat crack_arrival(const BuiltinOptions& options) {
  constexpr double kAreaPerCrack = 420;
  const int count = std::max(3, cvRound(static_cast<double>(options.width) * options.height / kAreaPerCrack));
  cv::Mat arrival(options.height, options.width, CV_32F, cv::Scalar(kNever));
  core::Rng rng(options.seed, {0x72757374u, 5, 0});
  for (int i = 0; i < count; ++i) {
    double x = rng.uniform(0, options.width), y = rng.uniform(0, options.height);
    double heading = rng.uniform(0, 2 * std::numbers::pi), time = rng.uniform(0.1, 0.9);
    const double pace = rng.uniform(60, 160), length = rng.uniform(8, 28);
    for (double run = 0; run < length; run += 0.5, time += 0.5 / pace) {
      heading += 0.16 * rng.normal();
      x += 0.5 * std::cos(heading), y += 0.5 * std::sin(heading);
      const int u = cvRound(x), v = cvRound(y);
      if (u < 0 || v < 0 || u >= options.width || v >= options.height) break;
      // Neighbours crack later: the crack opens.
      for (const auto [dx, dy, late] : {std::array{0, 0, 0}, {1, 0, 1}, {0, 1, 2}}) {
        if (u + dx < 0 || v + dy < 0 || u + dx >= options.width || v + dy >= options.height) continue;
        auto& at = arrival.at<float>(v + dy, u + dx);
        at = std::min(at, static_cast<float>(time + 0.2 * late));
      }
    }
  }
  return arrival;
}

double smooth_step(double from, double to, double at) {
  const double share = std::clamp((at - from) / (to - from), 0.0, 1.0);
  return share * share * (3 - 2 * share);
}

cv::Vec3d mix(const cv::Vec3d& a, const cv::Vec3d& b, double share) {
  return a + (b - a) * share;
}

cv::Vec3d colour_at(const Plate& plate, int x, int y, double time) {
  const cv::Vec3d paint(142, 128, 74), lifted(150, 146, 118), fresh(30, 104, 204), old(24, 44, 92),
      gap(26, 26, 30);
  const double fine = static_cast<double>(plate.fine.at<float>(y, x));
  const double coarse = static_cast<double>(plate.coarse.at<float>(y, x));
  const double age = time - static_cast<double>(plate.rust.at<float>(y, x));
  cv::Vec3d colour = paint * (1 + 0.03 * fine + 0.03 * coarse);
  colour = mix(colour, lifted, 0.8 * smooth_step(-0.10, -0.01, age));  // blisters run ahead of rust
  const cv::Vec3d rust = mix(fresh, old, smooth_step(0, 0.55, age)) * (1 + 0.10 * fine + 0.12 * coarse);
  colour = mix(colour, rust, smooth_step(-0.012, 0.03, age));
  const double open = time - static_cast<double>(plate.crack.at<float>(y, x));
  return mix(colour, gap, 0.85 * smooth_step(0, 0.05, open));
}

}  // namespace

core::Clip make_rust(const BuiltinOptions& options, const core::Context& context) {
  options.validate();
  const Plate plate{rust_arrival(options), crack_arrival(options), draw_noise(options, 6, 0.7),
                    draw_noise(options, 7, 3)};
  core::Clip clip{{options.width, options.height, 3, CV_8U, options.fps, 255, options.frames}, {}};
  clip.frames.resize(static_cast<std::size_t>(options.frames));
  core::parallel_for(clip.frames.size(), context, [&](std::size_t t) {
    core::Rng rng(options.seed, {0x72757374u, 8, static_cast<std::uint32_t>(t)});
    const double time = static_cast<double>(t) / (options.frames - 1);
    cv::Mat frame(options.height, options.width, CV_8UC3);
    for (int y = 0; y < options.height; ++y)
      for (int x = 0; x < options.width; ++x) {
        const cv::Vec3d colour = colour_at(plate, x, y, time) + cv::Vec3d::all(0.8 * rng.normal());
        for (int c = 0; c < 3; ++c)
          frame.at<cv::Vec3b>(y, x)[c] = cv::saturate_cast<unsigned char>(colour[c]);
      }
    clip.frames[t] = frame;
  });
  return clip;
}

}  // namespace emberfold::apps
