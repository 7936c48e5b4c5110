// SPDX-License-Identifier: Apache-2.0
#include "dytex/model/layers.hpp"

#include "core/error.hpp"
#include "dytex/editing/edit.hpp"
#include "dytex/learn.hpp"
#include "dytex/synthesize.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/matrices.hpp"
#include "tests/support/messages.hpp"

using namespace emberfold;
using namespace emberfold::test;

namespace {

/// White in a box.
cv::Mat box(cv::Size size, const cv::Rect& inside) {
  cv::Mat mask = cv::Mat::zeros(size, CV_8U);
  mask(inside).setTo(255);
  return mask;
}

dytex::LearnResult learn_region(const core::Clip& clip, const cv::Mat& mask) {
  core::ClipSource source(clip);
  dytex::RegionSource region(source, mask);
  dytex::LearnResult learned = dytex::learn(region, {.components = 5, .energy = {}});
  dytex::confine(learned.texture, mask);
  return learned;
}

}  // namespace

TEST_CASE("The opacity rises from a mask's edge inwards and is the mask behind that", "[dytex][layers]") {
  const cv::Mat mask = box({40, 30}, {10, 5, 25, 20});
  const cv::Mat sharp = dytex::layer_opacity(mask, 0), soft = dytex::layer_opacity(mask, 4);
  for (int y = 0; y < 30; ++y)
    for (int x = 0; x < 40; ++x) {
      const bool inside = mask.at<std::uint8_t>(y, x) != 0;
      CHECK(sharp.at<float>(y, x) == (inside ? 1.0F : 0.0F));
      const int depth = std::min({x - 9, 35 - x, y - 4, 25 - y});
      if (depth <= 0) CHECK(soft.at<float>(y, x) == 0);
      if (depth >= 5) CHECK(soft.at<float>(y, x) == 1);
      if (depth >= 1 && depth < 5) CHECK((soft.at<float>(y, x) > 0 && soft.at<float>(y, x) < 1));
    }
  CHECK_THAT(soft.at<float>(15, 11), WithinAbs(0.4 * 0.4 * (3 - 0.8), 1e-5));  // two of five px in
  // No edge at the picture's border, and none where there is no outside.
  CHECK(dytex::layer_opacity(box({20, 10}, {0, 0, 12, 10}), 3).at<float>(0, 0) == 1);
  CHECK(cv::norm(dytex::layer_opacity(cv::Mat(5, 5, CV_8U, cv::Scalar(255)), 3), cv::Mat::ones(5, 5, CV_32F),
                 cv::NORM_INF) == 0);
  CHECK_THAT(dytex::layer_opacity(cv::Mat(2, 2, CV_16U, cv::Scalar(16384)), 0).at<float>(1, 1),
             WithinRel(0.25, 1e-4));
}

TEST_CASE("A region is learned alone", "[dytex][layers]") {
  for (const int channels : {1, 3}) {
    const core::Clip clip = test::wavy_clip(40, 30, channels, CV_8U, 40);
    const cv::Mat mask = box({40, 30}, {4, 6, 18, 15});
    const dytex::LinearDynamicTexture texture = learn_region(clip, mask).texture;
    const cv::Mat moves = dytex::moving_region(texture);
    CHECK(cv::countNonZero(moves & ~mask) == 0);
    CHECK(cv::countNonZero(moves) == 18 * 15);
    // Pixels outside the region do not count: other surroundings give an equal model.
    core::Clip other = clip;
    core::Rng rng(5);
    for (cv::Mat& frame : other.frames) {
      cv::Mat noise(frame.size(), frame.type());
      for (std::uint8_t& value : cv::Mat_<std::uint8_t>(noise.reshape(1)))
        value = static_cast<std::uint8_t>(rng.below(256));
      noise.copyTo(frame = frame.clone(), ~mask);
    }
    const dytex::LinearDynamicTexture same = learn_region(other, mask).texture;
    CHECK((same.A - texture.A).norm() < 1e-9 * texture.A.norm());
    CHECK((same.C - texture.C).norm() < 1e-5F);
    const cv::Mat drawn = dytex::draw(texture, texture.states.col(3));
    cv::Mat shown, first;
    drawn.convertTo(shown, CV_8U);
    cv::Mat away = shown != clip.frames[0];
    if (channels == 3) cv::extractChannel(away, away, 0);
    CHECK(cv::countNonZero(away & ~mask) == 0);  // the first frame outside
    // The noise is inside, its mean over all values is r.
    CHECK_THAT(double(texture.noise.mean()), WithinRel(texture.r, 1e-4));
    CHECK(texture.noise[0] == 0);
  }
}

TEST_CASE("A layer leaves what is outside its edge as it was and is all itself inside", "[dytex][layers]") {
  const core::Clip clip = test::wavy_clip(48, 36, 3, CV_8U, 40);
  const cv::Mat mask = box({48, 36}, {8, 6, 30, 22}), opacity = dytex::layer_opacity(mask, 5);
  const dytex::LinearDynamicTexture texture = learn_region(clip, mask).texture;
  const std::vector<dytex::Edit> edits{{dytex::Speed{-2}}, {dytex::Intensity{3}}};
  const dytex::LinearDynamicTexture fast = dytex::edit(texture, edits).texture;
  dytex::Synthesis synthesis(fast, {});
  double changed = 0;
  for (int t = 0; t < 12; ++t) {
    const cv::Mat before = clip.frames[static_cast<std::size_t>(t)], layer = synthesis.next();
    cv::Mat frame = before.clone();
    dytex::put_layer(frame, layer, opacity);
    for (int y = 0; y < 36; ++y)
      for (int x = 0; x < 48; ++x) {
        const auto &was = before.at<cv::Vec3b>(y, x), &is = frame.at<cv::Vec3b>(y, x),
                   &new_ = layer.at<cv::Vec3b>(y, x);
        const float share = opacity.at<float>(y, x);
        if (share == 0) CHECK(is == was);
        if (share == 1) CHECK(is == new_);
        for (int c = 0; c < 3; ++c)
          CHECK(std::abs(is[c] - (was[c] + share * float(new_[c] - was[c]))) <= 0.5F + 1e-4F);
      }
    changed += cv::norm(frame, before, cv::NORM_L1);
  }
  CHECK(changed > 12 * 1000);
}

TEST_CASE("Masks of layers that do not fit are refused", "[dytex][layers]") {
  const core::Clip clip = test::wavy_clip(20, 10, 1, CV_8U, 5);
  core::ClipSource source(clip);
  const auto refused = [](const auto& call) { return test::message_of<core::InputError>(call); };
  CHECK(refused([&] { dytex::RegionSource(source, cv::Mat(10, 21, CV_8U, cv::Scalar(1))); }) ==
        "mask is 21x10, must be as the frames are, 20x10");
  CHECK(refused([&] { dytex::RegionSource(source, cv::Mat::zeros(10, 20, CV_8U)); }) ==
        "mask is 0 everywhere, must hold some pixels");
  CHECK(refused([&] { dytex::RegionSource(source, cv::Mat::zeros(10, 20, CV_8UC3)); }) ==
        "mask has 3 channels, must have 1");
  CHECK_FALSE(refused([&] { dytex::layer_opacity(cv::Mat::ones(3, 3, CV_8U), -1); }).empty());
  CHECK_FALSE(refused([&] { dytex::layer_opacity(cv::Mat(3, 3, CV_32F, cv::Scalar(2)), 0); }).empty());
  cv::Mat frame = clip.frames[0].clone();
  CHECK_FALSE(refused([&] {
                dytex::put_layer(frame, cv::Mat(10, 20, CV_8UC3), cv::Mat::ones(10, 20, CV_32F));
              }).empty());
  CHECK_FALSE(
      refused([&] { dytex::put_layer(frame, clip.frames[1], cv::Mat::ones(9, 20, CV_32F)); }).empty());
}
