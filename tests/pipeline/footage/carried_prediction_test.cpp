// SPDX-License-Identifier: Apache-2.0
#include "pipeline/footage/carried_prediction.hpp"

#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include <opencv2/core.hpp>

#include "core/error.hpp"
#include "core/rng.hpp"
#include "tests/support/catch.hpp"

using namespace emberfold;

namespace {

/// Waves that travel right above, noise about a still picture below.
core::Clip noisy_waves(int frames, double noise) {
  core::Clip clip{{96, 64, 1, CV_8U, 25, 255, frames}, {}};
  core::Rng rng(9);
  for (int t = 0; t < frames; ++t) {
    cv::Mat1b frame(64, 96);
    for (int y = 0; y < 64; ++y)
      for (int x = 0; x < 96; ++x) {
        const double level =
            y < 32 ? 128 + 70 * std::sin(2 * std::numbers::pi * (x - 2 * t + 3 * std::sin(y / 6.0)) / 29)
                   : 60 + x + noise * rng.normal();
        frame(y, x) = cv::saturate_cast<std::uint8_t>(level);
      }
    clip.frames.push_back(frame);
  }
  return clip;
}

double error(const cv::Mat& predicted, const core::Clip& clip, int frame, const cv::Rect& where) {
  const auto truth = core::to_levels(clip.frames[static_cast<std::size_t>(frame)], clip.info);
  return cv::norm(predicted(where), truth(where)) / std::sqrt(double(where.area()));
}

}  // namespace

TEST_CASE("carried prediction: what moves is moved on, what is noise falls back to the mean image") {
  const auto clip = noisy_waves(60, 8);
  core::ClipSource source(clip);
  const std::array steps{1, 4};
  const auto model = pipeline::learn_carried_prediction(source, steps, {});
  const auto later = noisy_waves(70, 8);
  const auto level = [&](int t) {
    return core::to_levels(later.frames[static_cast<std::size_t>(t)], later.info);
  };
  const std::vector<cv::Mat> past{level(61), level(62)};
  const auto predicted = pipeline::predict(model, past, steps);
  REQUIRE(predicted.size() == 2);
  const cv::Rect moving(8, 4, 80, 24), noisy(4, 36, 88, 24);
  for (std::size_t s = 0; s < steps.size(); ++s) {
    const int truth = 62 + steps[s];
    CHECK(error(predicted[s], later, truth, moving) < 0.35 * error(past[1], later, truth, moving));
    // A frame repeated errs by √2 times the noise, the mean image by once.
    CHECK(error(predicted[s], later, truth, noisy) < 1.1 * 8);
    CHECK(error(past[1], later, truth, noisy) > 1.3 * 8);
  }
}

TEST_CASE("carried prediction: by the newest frame moved on alone, a frame is moved on by its motion") {
  const auto clip = noisy_waves(12, 0);
  const std::array steps{1, 3};
  pipeline::CarriedPrediction model{{1, 3}, cv::Mat(64, 96, CV_32F, cv::Scalar(100)), {}};
  model.weights.assign(2, cv::Mat(4, 6, CV_32FC4, cv::Scalar(1, 0, 0, 0)));
  const auto level = [&](int t) {
    return core::to_levels(clip.frames[static_cast<std::size_t>(t)], clip.info);
  };
  const std::vector<cv::Mat> past{level(5), level(6)};
  const auto predicted = pipeline::predict(model, past, steps);
  const cv::Rect moving(16, 4, 64, 24);
  for (std::size_t s = 0; s < steps.size(); ++s)
    CHECK(error(predicted[s], clip, 6 + steps[s], moving) < 0.4 * error(past[1], clip, 6 + steps[s], moving));
}

TEST_CASE("carried prediction: a clip without a frame to predict is refused") {
  const auto clip = noisy_waves(2, 0);
  core::ClipSource source(clip);
  CHECK_THROWS_AS(pipeline::learn_carried_prediction(source, std::array{1}, {}), core::InputError);
}
