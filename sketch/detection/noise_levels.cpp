// SPDX-License-Identifier: Apache-2.0
#include "sketch/detection/noise_levels.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/math/robust.hpp"

namespace emberfold::sketch {

using graph::Point;

namespace {

// From one sample to the next, odd, so that samples can lie alike seen from either border.
int sample_step(double sigma, cv::Size frame) {
  constexpr double kEnough = 19000;
  const double step = std::max(1.5 * sigma, std::sqrt(frame.area() / kEnough));
  return 2 * static_cast<int>(std::min(0.5 * step, 50.0)) + 1;
}

// The first sample, as far from its border as the last is from the other.
int first_sample(int size, int step) {
  int first = 0;
  while ((size - 1 - 2 * first) % step != 0) ++first;
  return first;
}

}  // namespace

void add_samples(const ScaleSpace& space, const FramePart& part, DerivativeSamples& samples) {
  samples.second.resize(space.size()), samples.first.resize(space.size());
  const cv::Size frame = part.frame;
  for (std::size_t k = 0; k < space.size(); ++k) {
    const cv::Mat1f& smooth = space[k].smooth;
    // Neighbours nearer than 1.5 σ hardly differ, and some 20 000 values give the median to a hundredth.
    const int step = sample_step(space[k].sigma, frame);
    const int down = std::min(step, std::max(frame.height - 1, 1)),
              across = std::min(step, std::max(frame.width - 1, 1));
    for (int v = first_sample(frame.height, down); v < frame.height; v += down) {
      if (v < part.core.y || v >= part.core.br().y) continue;
      const int y = v - part.origin.y;
      const float *above = smooth[y], *here = smooth[y + 1], *below = smooth[y + 2];
      for (int u = first_sample(frame.width, across); u < frame.width; u += across) {
        if (u < part.core.x || u >= part.core.br().x) continue;
        const int x = u - part.origin.x;
        const Hessian h = hessian_of(above + x, here + x, below + x);
        const Point g = gradient_of(above + x, here + x, below + x);
        samples.second[k].insert(samples.second[k].end(), {std::abs(h.xx), std::abs(h.yy)});
        samples.first[k].insert(samples.first[k].end(),
                                {static_cast<float>(std::abs(g.x)), static_cast<float>(std::abs(g.y))});
      }
    }
  }
}

NoiseLevels measure_noise_levels(DerivativeSamples samples, const ScaleSpace& space,
                                 std::span<const double> noise) {
  NoiseLevels ground;
  const auto median = [](std::vector<float>& values) {
    return core::kMadToSd * double{core::median_of_positive(std::move(values))};
  };
  for (std::size_t k = 0; k < space.size(); ++k) {
    const double white = noise[static_cast<std::size_t>(space[k].channel)];
    ground.second.push_back(std::max(white * space[k].hessian_sd, median(samples.second[k])));
    ground.first.push_back(std::max(white * space[k].gradient_sd, median(samples.first[k])));
  }
  return ground;
}

NoiseLevels measure_noise_levels(const ScaleSpace& space, double noise) {
  DerivativeSamples samples;
  add_samples(space, whole_frame(space.front().frame.size()), samples);
  return measure_noise_levels(std::move(samples), space,
                              std::vector<double>(static_cast<std::size_t>(space.back().channel) + 1, noise));
}

}  // namespace emberfold::sketch
