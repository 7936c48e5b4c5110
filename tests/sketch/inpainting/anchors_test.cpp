// SPDX-License-Identifier: Apache-2.0
#include "sketch/inpainting/anchors.hpp"

#include <cmath>
#include <limits>
#include <sstream>
#include <vector>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "core/error.hpp"
#include "core/rng.hpp"
#include "graph/io/motion_io.hpp"
#include "sketch/background/still_background.hpp"
#include "sketch/extract.hpp"
#include "sketch/inpainting/fill.hpp"
#include "sketch/rendering/sharpening.hpp"
#include "tests/support/catch.hpp"

using namespace emberfold;

namespace {

/// Discs and bars of different levels, a slope, and grain.
cv::Mat make_frame(cv::Size size, std::uint64_t seed) {
  core::Rng rng(seed);
  cv::Mat frame(size, CV_32F);
  for (int y = 0; y < size.height; ++y)
    for (int x = 0; x < size.width; ++x) frame.at<float>(y, x) = 60.0F + 0.3F * static_cast<float>(x + y);
  for (int i = 0; i < 12; ++i) {
    const cv::Point a(static_cast<int>(rng.below(static_cast<std::uint32_t>(size.width))),
                      static_cast<int>(rng.below(static_cast<std::uint32_t>(size.height))));
    cv::circle(frame, a, 4 + static_cast<int>(rng.below(14)), cv::Scalar(rng.uniform(0, 255)),
               i % 2 == 0 ? -1 : 3);
  }
  cv::GaussianBlur(frame, frame, {}, 1.2);
  for (float& value : cv::Mat_<float>(frame))
    value = std::round(value + static_cast<float>(2 * rng.normal()));
  return frame;
}

double rms_after_fill(const cv::Mat& levels, const cv::Mat& mask) {
  return cv::norm(sketch::fill(levels, mask).levels, levels, cv::NORM_L2) / std::sqrt(double(levels.total()));
}

cv::Mat random_mask(cv::Size size, int count, const cv::Mat& taken, std::uint64_t seed) {
  core::Rng rng(seed);
  cv::Mat mask = taken.clone();
  while (count > 0) {
    auto& pixel = mask.at<uchar>(static_cast<int>(rng.below(static_cast<std::uint32_t>(size.height))),
                                 static_cast<int>(rng.below(static_cast<std::uint32_t>(size.width))));
    if (pixel != 0) continue;
    pixel = 255;
    --count;
  }
  return mask;
}

const cv::Size kAnchorsSize(120, 90);

cv::Mat nothing(cv::Size size) {
  return cv::Mat(size, CV_8U, cv::Scalar(0));
}

}  // namespace

TEST_CASE("Anchors are no more than allowed and never where something is taken", "[sketch][anchors]") {
  const cv::Mat frame = make_frame(kAnchorsSize, 1);
  cv::Mat taken = nothing(kAnchorsSize);
  taken.colRange(30, 50) = 255;
  for (const int rounds : {0, 1, 2, 16})
    for (const double share : {0.0, 0.0001, 0.01, 0.2, 0.7, 1.0}) {
      const cv::Mat mask = sketch::choose_anchors(frame, taken, share, {.rounds = rounds});
      INFO(rounds << " rounds, share " << share);
      CHECK(mask.type() == CV_8U);
      CHECK(cv::countNonZero(mask & taken) == 0);
      CHECK(cv::countNonZero(mask) <= share * kAnchorsSize.area() + 1e-6);
      CHECK(cv::countNonZero((mask != 0) & (mask != 255)) == 0);
      // The frame has grain: every pixel allowed is of use.
      if (rounds > 1 && share <= 0.2)
        CHECK(cv::countNonZero(mask) >= std::floor(share * kAnchorsSize.area()) - 1);
      // Errors that are diffused over the border are lost.
      if (rounds == 0 && share >= 0.2)
        CHECK(cv::countNonZero(mask) >= 0.95 * std::min(share, 7.0 / 9) * kAnchorsSize.area());
    }
}

TEST_CASE("Anchors beat random pixels by far and rounds beat curvature alone", "[sketch][anchors]") {
  cv::Mat band = nothing(kAnchorsSize);
  cv::circle(band, {60, 45}, 25, 255, 3);
  for (const cv::Mat& taken : {nothing(kAnchorsSize), band})
    for (std::uint64_t seed = 1; seed <= 4; ++seed) {
      const cv::Mat frame = make_frame(kAnchorsSize, seed);
      const cv::Mat best = sketch::choose_anchors(frame, taken, 0.15),
                    quick = sketch::choose_anchors(frame, taken, 0.15, {.rounds = 0});
      const double random =
          rms_after_fill(frame, random_mask(kAnchorsSize, cv::countNonZero(best), taken, seed + 100));
      CHECK(rms_after_fill(frame, best | taken) < 0.5 * random);    // 6 dB
      CHECK(rms_after_fill(frame, quick | taken) < 0.63 * random);  // 4 dB
      CHECK(rms_after_fill(frame, best | taken) < 0.9 * rms_after_fill(frame, quick | taken));
    }
}

TEST_CASE("More anchors leave less error", "[sketch][anchors]") {
  const cv::Mat frame = make_frame(kAnchorsSize, 5);
  double before = std::numeric_limits<double>::infinity();
  for (const double share : {0.02, 0.05, 0.1, 0.2, 0.4}) {
    const double error = rms_after_fill(frame, sketch::choose_anchors(frame, nothing(kAnchorsSize), share));
    CHECK(error < 0.8 * before);
    before = error;
  }
}

TEST_CASE("Anchors turn with the frame", "[sketch][anchors]") {
  const cv::Mat frame = make_frame(kAnchorsSize, 6),
                mask = sketch::choose_anchors(frame, nothing(kAnchorsSize), 0.1);
  const double count = cv::countNonZero(mask);
  for (const int code : {cv::ROTATE_90_CLOCKWISE, cv::ROTATE_180, cv::ROTATE_90_COUNTERCLOCKWISE}) {
    cv::Mat turned, expected;
    cv::rotate(frame, turned, code);
    cv::rotate(mask, expected, code);
    const cv::Mat found = sketch::choose_anchors(turned, nothing(turned.size()), 0.1);
    CHECK(cv::countNonZero(found & expected) > 0.9 * count);
  }
  for (const int axis : {0, 1}) {
    cv::Mat turned, expected;
    cv::flip(frame, turned, axis);
    cv::flip(mask, expected, axis);
    CHECK(cv::countNonZero(sketch::choose_anchors(turned, nothing(kAnchorsSize), 0.1) & expected) >
          0.9 * count);
  }
}

TEST_CASE("Anchors go where only the colour changes, too", "[sketch][anchors]") {
  // Left green, right red, of the same luma.
  cv::Mat frame(kAnchorsSize, CV_32FC3, cv::Scalar(0, 100, 0));
  const int middle = kAnchorsSize.width / 2;
  frame.colRange(middle, kAnchorsSize.width).setTo(cv::Scalar(0, 0, 58.7 / 0.299));
  const cv::Mat mask = sketch::choose_anchors(frame, nothing(kAnchorsSize), 0.1);
  const cv::Mat filled = sketch::fill(frame, mask).levels;
  CHECK(cv::norm(filled, frame, cv::NORM_L2) / std::sqrt(double(frame.total())) < 20);
}

TEST_CASE("Anchors of a grey frame in three channels are those of one", "[sketch][anchors]") {
  const cv::Mat frame = make_frame(kAnchorsSize, 7);
  cv::Mat colour;
  cv::merge(std::vector<cv::Mat>{frame, frame, frame}, colour);
  const cv::Mat grey = sketch::choose_anchors(frame, nothing(kAnchorsSize), 0.1);
  const cv::Mat mask = sketch::choose_anchors(colour, nothing(kAnchorsSize), 0.1);
  CHECK(cv::countNonZero(mask & grey) > 0.95 * cv::countNonZero(grey));
}

TEST_CASE("Anchors make up for patches that are drawn wrong", "[sketch][anchors]") {
  const cv::Mat frame = make_frame(kAnchorsSize, 8);
  sketch::Sketchable drawn{frame.clone(), nothing(kAnchorsSize)};
  drawn.mask.colRange(58, 62) = 255;
  drawn.levels.setTo(0, drawn.mask == 0);
  const cv::Mat right = sketch::choose_anchors(frame, drawn, 0.1);
  CHECK(cv::norm(right, sketch::choose_anchors(frame, drawn.mask, 0.1), cv::NORM_INF) == 0);
  drawn.levels.setTo(255, drawn.mask);
  const cv::Mat wrong = sketch::choose_anchors(frame, drawn, 0.1);
  CHECK(cv::countNonZero(wrong & drawn.mask) == 0);
  // They stand against what leaks out of the wrong patch.
  const auto beside = [&](const cv::Mat& mask) {
    return cv::countNonZero(mask.colRange(57, 58)) + cv::countNonZero(mask.colRange(62, 63));
  };
  CHECK(beside(wrong) > 2 * beside(right));
}

TEST_CASE("Anchors of odd frames", "[sketch][anchors]") {
  for (const cv::Size size : {cv::Size(1, 1), {3, 1}, {1, 40}, {3, 50}, {50, 3}})
    for (const int rounds : {0, 16}) {
      const cv::Mat frame = make_frame(size, 9);
      const cv::Mat mask = sketch::choose_anchors(frame, nothing(size), 0.3, {.rounds = rounds});
      CHECK(mask.size() == size);
      CHECK(cv::countNonZero(mask) <= 0.3 * size.area());
      CHECK(cv::countNonZero(sketch::choose_anchors(frame, cv::Mat(size, CV_8U, cv::Scalar(255)), 0.3)) == 0);
    }
  cv::Mat constant(kAnchorsSize, CV_32F, cv::Scalar(77)), corner = nothing(kAnchorsSize);
  corner.at<uchar>(0, 0) = 255;
  CHECK(cv::countNonZero(sketch::choose_anchors(constant, corner, 0.2)) == 0);  // one pixel tells it all
  const cv::Mat free = sketch::choose_anchors(constant, nothing(kAnchorsSize), 0.2);
  CHECK(cv::countNonZero(free) > 0);  // and one is needed
  CHECK(rms_after_fill(constant, free) < 1e-3);
}

TEST_CASE("Anchors reject what is none", "[sketch][anchors]") {
  const cv::Mat frame = make_frame(kAnchorsSize, 10);
  CHECK_THROWS_AS(sketch::choose_anchors(cv::Mat(), nothing(kAnchorsSize), 0.1), core::InputError);
  CHECK_THROWS_AS(sketch::choose_anchors(frame, nothing({4, 4}), 0.1), core::InputError);
  CHECK_THROWS_AS(sketch::choose_anchors(frame, nothing(kAnchorsSize), 1.1), core::InputError);
  CHECK_THROWS_AS(sketch::choose_anchors(frame, nothing(kAnchorsSize), std::nan("")), core::InputError);
  CHECK_THROWS_AS(sketch::choose_anchors(frame, nothing(kAnchorsSize), 0.1, {.rounds = -1}),
                  core::InputError);
  CHECK_THROWS_AS(sketch::choose_anchors(frame, nothing(kAnchorsSize), 0.1, {.spread = 9}), core::InputError);
  cv::Mat broken = frame.clone();
  broken.at<float>(3, 3) = std::numeric_limits<float>::quiet_NaN();
  CHECK_THROWS_AS(sketch::choose_anchors(broken, nothing(kAnchorsSize), 0.1), core::InputError);
  const sketch::Sketchable other{cv::Mat(kAnchorsSize, CV_32FC3, cv::Scalar::all(0)), nothing(kAnchorsSize)};
  CHECK_THROWS_AS(sketch::choose_anchors(frame, other, 0.1), core::InputError);
}

TEST_CASE("Anchors in the graph hold their pixels in every drawing", "[sketch][anchors]") {
  const cv::Mat grey = make_frame(kAnchorsSize, 8);
  cv::Mat colour;
  cv::merge(std::vector<cv::Mat>{grey, 255 - grey, grey * 0.5}, colour);
  for (const cv::Mat& frame : {grey, colour}) {
    const auto strokes = sketch::extract(frame, {});
    REQUIRE(strokes.size() > 10);
    const auto patches = sketch::draw_cores(strokes, kAnchorsSize, frame.channels());
    const cv::Mat mask = sketch::choose_anchors(frame, patches, 0.25);
    const auto both = sketch::add_anchors(strokes, frame, mask);
    CHECK(graph::without_anchors(both) == strokes);
    CHECK(both.size() - strokes.size() == static_cast<std::size_t>(cv::countNonZero(mask)));
    for (const auto& drawn : {sketch::draw_fitted(both, kAnchorsSize, frame.channels()),
                              sketch::draw_pixels(both, frame), sketch::hold_anchors(patches, both)}) {
      CHECK(cv::norm(drawn.mask, patches.mask | mask, cv::NORM_INF) == 0);
      CHECK(cv::norm(drawn.levels, frame, cv::NORM_INF, mask) < 1e-4);
    }
    CHECK(cv::norm(sketch::draw_fitted(both, kAnchorsSize, frame.channels()).levels, patches.levels,
                   cv::NORM_INF, patches.mask) == 0);
    CHECK(cv::countNonZero(patches.mask & mask) == 0);  // what was drawn before is as it was
  }
  // An anchor lies over a patch; one outside the frame shows nothing.
  graph::Patch patch;
  patch.position = {10, 10}, patch.width = 6;
  const graph::AttributeGraph over({{{0}, {}, patch},
                                    {{1}, {}, graph::make_anchor({10, 10}, {40, 50, 60})},
                                    {{2}, {}, graph::make_anchor({30, 3}, {1, 2, 3})},
                                    {{3}, {}, graph::make_anchor({-1, 3}, {1, 2, 3})}},
                                   {});
  const auto drawn = sketch::draw_fitted(over, {30, 20}, 3);
  CHECK(drawn.levels.at<cv::Vec3f>(10, 10) == cv::Vec3f(40, 50, 60));
  CHECK(drawn.mask.at<uchar>(3, 29) == 0);
  CHECK(drawn.mask.at<uchar>(3, 0) == 0);
}

TEST_CASE("A picture with anchors comes back from its file at 42 dB, without them at much less",
          "[sketch][anchors]") {
  // Discs and bars on a slope; grain would take an anchor a pixel.
  cv::Mat frame(kAnchorsSize, CV_32F);
  for (int y = 0; y < kAnchorsSize.height; ++y)
    for (int x = 0; x < kAnchorsSize.width; ++x)
      frame.at<float>(y, x) = 60.0F + 0.3F * static_cast<float>(x + y);
  cv::circle(frame, {40, 40}, 17, cv::Scalar(210), -1);
  cv::circle(frame, {85, 30}, 9, cv::Scalar(20), -1);
  cv::line(frame, {8, 80}, {110, 60}, cv::Scalar(240), 3);
  cv::GaussianBlur(frame, frame, {}, 1.5);
  const auto strokes = sketch::extract(frame, {});
  const auto patches = sketch::draw_cores(strokes, kAnchorsSize, 1);
  graph::SketchSequence sketch;
  sketch.width = kAnchorsSize.width, sketch.height = kAnchorsSize.height;
  sketch.append(
      sketch::add_anchors(strokes, frame, sketch::choose_anchors(frame, patches, 0.2 - patches.share())));
  std::stringstream file;
  graph::write_sketch(file, sketch);
  const auto read = graph::read_sketch(file, "sketch.jsonl");
  const auto psnr = [&](const graph::AttributeGraph& graph) {
    const auto drawn = sketch::draw_fitted(graph, kAnchorsSize, 1);
    CHECK(drawn.share() <= 0.2);
    const cv::Mat filled = sketch::fill(drawn.levels, drawn.mask).levels;
    return 20 * std::log10(255 / (cv::norm(filled, frame, cv::NORM_L2) / std::sqrt(double(frame.total()))));
  };
  const double with = psnr(read.frames[0]), without = psnr(graph::without_anchors(read.frames[0]));
  CAPTURE(with, without);
  CHECK(with >= 42);
  CHECK(without < with - 10);
}

TEST_CASE("What is measured of strokes does not change by anchors among them", "[sketch][anchors]") {
  const cv::Mat frame = make_frame(kAnchorsSize, 9);
  const auto strokes = sketch::extract(frame, {});
  const auto both =
      sketch::add_anchors(strokes, frame, random_mask(kAnchorsSize, 900, nothing(kAnchorsSize), 3));
  const auto same = [](const cv::Mat& a, const cv::Mat& b) { return cv::norm(a, b, cv::NORM_INF) == 0; };
  CHECK(same(sketch::measure_background(frame, both).uncovered,
             sketch::measure_background(frame, strokes).uncovered));
  CHECK(sketch::measure_flank_gradient(frame, both).places ==
        sketch::measure_flank_gradient(frame, strokes).places);
}

TEST_CASE("Anchors are added only where a mask of the frame says so", "[sketch][anchors]") {
  const cv::Mat frame = make_frame({9, 7}, 3);
  CHECK(sketch::add_anchors({}, frame, nothing({9, 7})).empty());
  CHECK_THROWS_AS(sketch::add_anchors({}, frame, nothing({7, 9})), core::InputError);
  CHECK_THROWS_AS(sketch::add_anchors({}, cv::Mat(7, 9, CV_8U), nothing({9, 7})), core::InputError);
}
