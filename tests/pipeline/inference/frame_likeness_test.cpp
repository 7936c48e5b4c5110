// SPDX-License-Identifier: Apache-2.0
#include "pipeline/inference/frame_likeness.hpp"

#include <algorithm>
#include <string>
#include <vector>

#include <opencv2/imgproc.hpp>

#include "core/rng.hpp"
#include "graph/matching/match.hpp"
#include "pipeline/inference/event_posterior.hpp"
#include "pipeline/sketch_clip.hpp"
#include "tests/support/catch.hpp"

using namespace emberfold;

namespace {

constexpr int kLikenessFrames = 24;

/// A texture with detail of some 4 px.
cv::Mat1f texture(std::uint64_t seed, cv::Size size) {
  core::Rng rng(seed);
  cv::Mat1f levels(size);
  for (float& level : levels) level = static_cast<float>(rng.normal());
  cv::GaussianBlur(levels, levels, {}, 4);
  cv::normalize(levels, levels, 20, 230, cv::NORM_MINMAX);
  return levels;
}

pipeline::FrameWindow window_of(const std::vector<cv::Mat1f>& frames) {
  pipeline::FrameWindow window;
  core::ClipInfo info;
  for (const auto& frame : frames) window.push(pipeline::make_window_frame(frame, info));
  return window;
}

/// A texture that moves by 3 px a frame and is another one after some frames.
std::vector<cv::Mat1f> moving_texture() {
  std::vector<cv::Mat1f> frames;
  const cv::Mat1f wide = texture(1, {240, 120});
  for (int t = 0; t < kLikenessFrames; ++t) frames.push_back(wide(cv::Rect(3 * t, 0, 160, 120)).clone());
  return frames;
}

std::vector<cv::Mat1f> unlike_textures() {
  std::vector<cv::Mat1f> frames;
  for (int t = 0; t < kLikenessFrames; ++t)
    frames.push_back(texture(static_cast<std::uint64_t>(t) + 10, {160, 120}));
  return frames;
}

}  // namespace

TEST_CASE("What moves is alike in neighbouring frames alone", "[likeness]") {
  const auto found = pipeline::measure_likeness(window_of(moving_texture()), 12, {80, 60}, kLikenessFrames);
  REQUIRE(found);
  CHECK(found->next > 0.9);
  CHECK(found->apart < found->next - 0.2);
}

TEST_CASE("Likeness is that of the place in the frame", "[likeness]") {
  // Left of x = 100 one texture moves, right of it every frame has another.
  auto frames = moving_texture();
  const auto other = unlike_textures();
  for (std::size_t t = 0; t < frames.size(); ++t)
    other[t].colRange(100, 160).copyTo(frames[t].colRange(100, 160));
  const auto window = window_of(frames);
  const auto left = pipeline::measure_likeness(window, 12, {64, 60}, kLikenessFrames);
  const auto right = pipeline::measure_likeness(window, 12, {136, 60}, kLikenessFrames);
  REQUIRE(left);
  REQUIRE(right);
  CHECK(left->next > 0.9);
  CHECK(right->next < 0.8);
}

TEST_CASE("Frames of nothing in common are as unlike next to each other as apart", "[likeness]") {
  double next = 0, apart = 0;
  const auto window = window_of(unlike_textures());
  for (int at = 11; at < 14; ++at)
    for (const double x : {40, 80, 120}) {
      const auto found = pipeline::measure_likeness(window, at, {x, 60}, kLikenessFrames);
      REQUIRE(found);
      next += found->next / 9, apart += found->apart / 9;
    }
  CHECK(next < 0.85);
  CHECK(std::abs(next - apart) < 0.1);
}

TEST_CASE("Likeness is the same played backwards, and unknown where nothing is to be seen", "[likeness]") {
  auto frames = moving_texture();
  const auto forwards = pipeline::measure_likeness(window_of(frames), 9, {70, 50}, kLikenessFrames);
  std::ranges::reverse(frames);
  const auto backwards =
      pipeline::measure_likeness(window_of(frames), kLikenessFrames - 9, {70, 50}, kLikenessFrames);
  REQUIRE((forwards && backwards));
  CHECK(forwards->next == backwards->next);
  CHECK(forwards->apart == backwards->apart);
  const std::vector<cv::Mat1f> flat(kLikenessFrames, cv::Mat1f(120, 160, 90.0F));
  CHECK_FALSE(pipeline::measure_likeness(window_of(flat), 12, {80, 60}, kLikenessFrames));
  const std::vector<cv::Mat1f> small(kLikenessFrames, texture(3, {20, 20}));
  CHECK_FALSE(pipeline::measure_likeness(window_of(small), 12, {10, 10}, kLikenessFrames));
  // The whole frame: windows are moved inside.
  CHECK(pipeline::measure_likeness(window_of(frames), 12, {0, 0}, kLikenessFrames));
  CHECK(pipeline::measure_likeness(window_of(frames), 12, {159, 119}, kLikenessFrames));
}

TEST_CASE("In frames that have nothing in common no event is believed, and that is told",
          "[likeness][posterior]") {
  core::Clip clip;
  clip.info.width = 160, clip.info.height = 120, clip.info.channels = 1, clip.info.frames = kLikenessFrames;
  core::Rng rng(4);
  const auto place = [&] {
    return cv::Point{static_cast<int>(rng.below(160)), static_cast<int>(rng.below(120))};
  };
  for (const cv::Mat1f& levels : unlike_textures()) {
    cv::Mat bytes;
    levels.convertTo(bytes, CV_8U, 0.2, 60);
    for (int k = 0; k < 14; ++k) {
      const cv::Point from = place(), to = place();
      cv::line(bytes, from, to, cv::Scalar(180), 3, cv::LINE_AA);
    }
    clip.frames.push_back(bytes);
  }
  core::ClipSource sketched(clip), source(clip);
  const auto sketch = pipeline::sketch_clip(sketched, {}, {}).sketch;
  std::string warned;
  const core::Context context({}, {}, [&](const std::string& text) { warned += text; });
  const auto events = pipeline::event_posterior(source, {{graph::match(sketch, {})}, {}}, context);
  REQUIRE(events.size() > 10);
  CHECK(std::ranges::all_of(events, [](const graph::Event& e) { return e.probability < 0.1; }));
  CHECK(warned.find("no more alike") != std::string::npos);
}
