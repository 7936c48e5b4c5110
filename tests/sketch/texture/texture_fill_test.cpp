// SPDX-License-Identifier: Apache-2.0
#include "sketch/texture/texture_fill.hpp"

#include <array>
#include <cstring>
#include <limits>
#include <vector>

#include <opencv2/core.hpp>

#include "core/error.hpp"
#include "sketch/inpainting/anchors.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/still_textures.hpp"

using namespace emberfold;
using sketch::FillMethod;

namespace {

const cv::Size kTextureFillSize(80, 60);

sketch::Sketchable drawn_of(const cv::Mat& frame, const cv::Mat& mask) {
  sketch::Sketchable drawn{cv::Mat(frame.size(), frame.type(), cv::Scalar::all(0)), mask};
  cv::Mat(frame + cv::Scalar::all(0.25)).copyTo(drawn.levels, mask);  // as fitted patches: near, not the same
  return drawn;
}

constexpr std::array kKinds{FillMethod::diffusion, FillMethod::julesz, FillMethod::efros_leung};

}  // namespace

TEST_CASE("The ground is drawn in any way and the patches stay", "[sketch][ground]") {
  const cv::Mat frame = test::texture(kTextureFillSize, 4, 120, 1), mask = test::bands(kTextureFillSize);
  const auto drawn = drawn_of(frame, mask);
  for (const FillMethod kind : kKinds) {
    const auto result = sketch::fill_nonsketchable(frame, drawn, {.kind = kind});
    CHECK(result.converged);
    REQUIRE(result.levels.size() == kTextureFillSize);
    for (int y = 0; y < kTextureFillSize.height; ++y)
      for (int x = 0; x < kTextureFillSize.width; ++x)
        if (mask.at<uchar>(y, x) != 0)
          CHECK(std::memcmp(result.levels.ptr(y, x), drawn.levels.ptr(y, x), sizeof(float)) == 0);
    // Textures have the observed contrast, the diffusion less.
    cv::Scalar mean, observed, own;
    cv::meanStdDev(frame, mean, observed, mask == 0);
    cv::meanStdDev(result.levels, mean, own, mask == 0);
    if (kind == FillMethod::diffusion) {
      CHECK(own[0] < 0.5 * observed[0]);
      CHECK(result.regions == 0);
      CHECK(cv::norm(result.levels, sketch::fill(drawn.levels, mask).levels, cv::NORM_INF) == 0);
    } else {
      CHECK(own[0] > 0.6 * observed[0]);
      CHECK(result.regions >= 1);
    }
  }
}

TEST_CASE("The ground's one seed counts", "[sketch][ground]") {
  const cv::Mat frame = test::texture(kTextureFillSize, 0, 120, 1);
  const auto drawn = drawn_of(frame, test::bands(kTextureFillSize));
  for (const FillMethod kind : {FillMethod::julesz, FillMethod::efros_leung}) {
    const sketch::NonsketchableFillOptions options{.kind = kind, .texture = {.regions = 1}, .seed = 3};
    auto same = options, other = options;
    same.julesz.seed = same.efros_leung.seed = same.texture.seed = 99;
    other.seed = 4;
    const cv::Mat levels = sketch::fill_nonsketchable(frame, drawn, options).levels;
    CHECK(cv::norm(levels, sketch::fill_nonsketchable(frame, drawn, same).levels, cv::NORM_INF) == 0);
    CHECK(cv::norm(levels, sketch::fill_nonsketchable(frame, drawn, other).levels, cv::NORM_INF) > 1);
  }
}

TEST_CASE("The ground of frames of which all or nothing is drawn", "[sketch][ground]") {
  for (const cv::Size size : {cv::Size(1, 1), {3, 20}, {20, 3}, kTextureFillSize})
    for (const FillMethod kind : kKinds)
      for (const int channels : {1, 3}) {
        cv::Mat frame = test::texture(size, 3, 120, 2);
        if (channels == 3) cv::merge(std::vector<cv::Mat>{frame, frame, frame}, frame);
        const auto none =
            sketch::fill_nonsketchable(frame, drawn_of(frame, test::nothing(size)), {.kind = kind});
        CHECK(cv::checkRange(none.levels));
        if (kind == FillMethod::diffusion)
          CHECK(cv::norm(none.levels, cv::Mat(size, frame.type(), cv::mean(frame)), cv::NORM_INF) == 0);
        const auto drawn = drawn_of(frame, cv::Mat(size, CV_8U, cv::Scalar(255)));
        const auto all = sketch::fill_nonsketchable(frame, drawn, {.kind = kind});
        CHECK(cv::norm(all.levels, drawn.levels, cv::NORM_INF) == 0);
        CHECK(all.regions == 0);
      }
}

TEST_CASE("Anchors are the frame's own pixels beside the patches", "[sketch][ground][anchors]") {
  const cv::Mat frame = test::texture(kTextureFillSize, 0, 120, 1), mask = test::bands(kTextureFillSize);
  const auto drawn = drawn_of(frame, mask);
  const cv::Mat anchors = sketch::choose_anchors(frame, drawn, 0.1);
  const auto both = sketch::hold_anchors(drawn, sketch::add_anchors({}, frame, anchors));
  CHECK(cv::norm(both.levels, drawn.levels, cv::NORM_INF, mask) == 0);
  CHECK(cv::norm(both.levels, frame, cv::NORM_INF, anchors) == 0);
  CHECK(cv::countNonZero(both.mask) == cv::countNonZero(mask) + cv::countNonZero(anchors));
  CHECK(cv::norm(drawn.mask, test::bands(kTextureFillSize), cv::NORM_INF) == 0);  // its own memory
  const double before = cv::norm(sketch::fill_nonsketchable(frame, drawn).levels, frame, cv::NORM_L2);
  CHECK(cv::norm(sketch::fill_nonsketchable(frame, both).levels, frame, cv::NORM_L2) < 0.5 * before);
}

TEST_CASE("The ground rejects what is none", "[sketch][ground]") {
  cv::Mat frame = test::texture(kTextureFillSize, 0, 120, 1);
  const auto drawn = drawn_of(frame, test::bands(kTextureFillSize));
  CHECK_THROWS_AS(sketch::fill_nonsketchable(cv::Mat(), drawn), core::InputError);
  CHECK_THROWS_AS(sketch::fill_nonsketchable(frame(cv::Rect(0, 0, 9, 9)), drawn), core::InputError);
  CHECK_THROWS_AS(sketch::fill_nonsketchable(frame, {drawn.levels, cv::Mat(3, 3, CV_8U)}), core::InputError);
  CHECK_THROWS_AS(sketch::fill_nonsketchable(frame, drawn, {.kind = static_cast<FillMethod>(7)}),
                  core::InputError);
  CHECK_THROWS_AS(sketch::fill_nonsketchable(frame, drawn, {.julesz = {.sweeps = 0}}), core::InputError);
  frame.at<float>(4, 4) = std::numeric_limits<float>::infinity();
  CHECK_THROWS_AS(sketch::fill_nonsketchable(frame, drawn), core::InputError);
}
