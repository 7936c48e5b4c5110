// SPDX-License-Identifier: Apache-2.0
#include "pipeline/comparison/prediction.hpp"

#include <algorithm>
#include <cmath>

#include "pipeline/comparison/compared_models.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/clip_fixture.hpp"

using namespace emberfold;
using namespace emberfold::test;

TEST_CASE("Steps of a prediction double up to the farthest, which is there once") {
  CHECK(pipeline::prediction_steps(1) == std::vector<int>{1});
  CHECK(pipeline::prediction_steps(2) == std::vector<int>{1, 2});
  CHECK(pipeline::prediction_steps(8) == std::vector<int>{1, 2, 4, 8});
  CHECK(pipeline::prediction_steps(11) == std::vector<int>{1, 2, 4, 8, 11});
}

TEST_CASE("Of many frames to predict 32 are taken, evenly spread") {
  // From frame t to the next the level changes by t + 1.
  core::Clip clip;
  clip.info.width = 6, clip.info.height = 5, clip.info.depth = CV_32F;
  constexpr int kFirst = 4, kFrames = 4 + 96;
  for (int t = 0; t < kFrames; ++t) {
    const int level = t % 2 == 0 ? 20 - t / 2 + 100 : 20 + (t + 1) / 2 + 100;
    clip.frames.push_back(cv::Mat(5, 6, CV_32FC1, cv::Scalar(level)));
  }
  core::ClipSource source(clip);
  const std::vector<int> next{1};
  const auto measured = pipeline::measure_prediction(source, kFirst, kFrames, next, {}, {});
  REQUIRE(measured.starts == 32);
  const auto& found = measured.methods.at(0).next_frame_psnr;
  REQUIRE(measured.methods.at(0).key == "frame_before");
  for (int i = 0; i < 32; ++i) {
    const double step = kFirst - 1 + 3 * i + 1;
    CHECK_THAT(found[static_cast<std::size_t>(i)],
               WithinAbs(10 * std::log10(255 * 255 / (step * step)), 1e-9));
  }
}

TEST_CASE("Predictions are measured against the frame that comes") {
  // The frames of the second half hold four levels more each, the first half is all 10.
  core::Clip clip;
  clip.info.width = 6, clip.info.height = 5, clip.info.depth = CV_8U;
  for (int t = 0; t < 10; ++t)
    clip.frames.push_back(cv::Mat(5, 6, CV_8UC1, cv::Scalar(t < 5 ? 10 : 10 + 4 * (t - 4))));
  core::ClipSource source(clip);
  // A model with the true law: four more levels with every frame.
  pipeline::ComparedModel knows{"knows", "knows"};
  knows.predict = [](const pipeline::PastFrames& past, std::span<const int> steps) {
    std::vector<cv::Mat> predicted;
    for (const int step : steps) predicted.push_back(past.levels.back() + 4 * step);
    return predicted;
  };
  knows.reconstruct = [](const pipeline::PastFrames& past) { return past.levels.back() + 1; };
  const std::vector<int> steps = pipeline::prediction_steps(3);
  CHECK(steps == std::vector<int>{1, 2, 3});
  const auto measured = pipeline::measure_prediction(source, 5, 10, steps, std::span(&knows, 1), {});
  CHECK(measured.first_frame == 5);
  CHECK(measured.starts == 5);
  const auto decibel = [](double mse) { return 10 * std::log10(255 * 255 / mse); };
  const auto method = [&](const std::string& key) {
    const auto found = std::ranges::find(measured.methods, key, &pipeline::MethodPrediction::key);
    REQUIRE(found != measured.methods.end());
    return *found;
  };
  const auto before = method("frame_before"), mean = method("mean_image"), model = method("knows");
  CHECK_THAT(before.by_step[0]->psnr, WithinAbs(decibel(16), 1e-9));
  CHECK_THAT(mean.by_step[0]->psnr, WithinAbs(decibel((16 + 64 + 144 + 256 + 400) / 5.0), 1e-9));
  CHECK_THAT(mean.next_frame_psnr[4], WithinAbs(decibel(400), 1e-9));
  CHECK(model.by_step[0]->psnr == 100);
  // Three frames on from frames 4 to 6; two of five starts have no such frame.
  CHECK_THAT(before.by_step[2]->psnr, WithinAbs(decibel(144), 1e-9));
  CHECK(model.by_step[2]->psnr == 100);
  CHECK_THAT(model.reconstruction->psnr, WithinAbs(decibel(1), 1e-9));
  CHECK_FALSE(before.reconstruction);
}
