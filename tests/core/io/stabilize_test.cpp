// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "core/clip/masked_source.hpp"
#include "core/error.hpp"
#include "core/io/clip_reader.hpp"
#include "core/io/reading/stabilizer.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/clip_fixture.hpp"
#include "tests/support/messages.hpp"

using namespace emberfold;
using namespace emberfold::test;

namespace {

constexpr int kFrames = 24;
const cv::Size kSize(160, 120);

/// A picture of blurred noise, larger than the frame on all sides.
cv::Mat scenery(std::uint64_t seed) {
  cv::Mat image;
  noise_frame({320, 280}, CV_8UC1, seed).convertTo(image, CV_32F);
  cv::GaussianBlur(image, image, {}, 3);
  cv::normalize(image, image, 30, 220, cv::NORM_MINMAX);
  return image;
}

core::CameraMotion true_motion(int t, bool turns) {
  core::CameraMotion motion;
  motion.x = 0.7 * t + 1.5 * std::sin(t), motion.y = -0.4 * t + std::cos(2. * t) - 1;
  if (turns) motion.angle = 0.004 * t, motion.scale = 1 + 0.003 * t;
  return motion;
}

/// The scenery as a camera in motion sees it, with a bar in front that moves by itself.
core::Clip filmed(bool turns, bool with_bar) {
  core::Clip clip;
  clip.info.width = kSize.width, clip.info.height = kSize.height, clip.info.depth = CV_8U;
  const cv::Mat world = scenery(5);
  for (int t = 0; t < kFrames; ++t) {
    // From pixels of the frame to those of the first frame, and on to the scenery.
    cv::Mat matrix = io::warp_matrix(true_motion(t, turns), kSize), back;
    cv::invertAffineTransform(matrix, back);
    back.at<double>(0, 2) += 80, back.at<double>(1, 2) += 80;
    cv::Mat frame;
    cv::warpAffine(world, frame, back, kSize, cv::INTER_CUBIC | cv::WARP_INVERSE_MAP);
    if (with_bar) frame(cv::Rect(4 * t, 30, 40, 60)) = cv::Scalar(255);
    frame.convertTo(frame, CV_8U);
    clip.frames.push_back(frame);
  }
  return clip;
}

/// Largest distance of places, over the frame's corners.
double error_of(const core::CameraMotion& found, const core::CameraMotion& wanted) {
  const cv::Mat a = io::warp_matrix(found, kSize), b = io::warp_matrix(wanted, kSize);
  double most = 0;
  for (const double x : {0., kSize.width - 1.})
    for (const double y : {0., kSize.height - 1.}) {
      const cv::Mat gap = (a - b) * (cv::Mat_<double>(3, 1) << x, y, 1);
      most = std::max(most, cv::norm(gap));
    }
  return most;
}

}  // namespace

TEST_CASE("drift of the camera is found and taken out, whatever moves in front", "[heavy]") {
  for (const bool turns : {false, true})
    for (const bool with_bar : {false, true}) {
      INFO("turns " << turns << ", bar " << with_bar);
      io::ReadOptions options;
      options.stabilize = turns ? io::Stabilize::similarity : io::Stabilize::translation;
      const auto source = io::open_clip(filmed(turns, with_bar), "made", options);
      const auto steady = core::read_all(*source);
      const auto drift = core::drift_of(*source);
      REQUIRE(drift.size() == kFrames);
      for (int t = 0; t < kFrames; ++t) {
        INFO("frame " << t);
        CHECK(error_of(drift[static_cast<std::size_t>(t)], true_motion(t, turns)) < (with_bar ? 0.5 : 0.2));
      }
      if (with_bar) continue;
      const cv::Rect inside(40, 30, 80, 60);
      for (const auto& frame : steady.frames) {
        cv::Mat gap;
        cv::absdiff(frame(inside), steady.frames.front()(inside), gap);
        CHECK(cv::mean(gap)[0] < 2.5);
      }
    }
}

TEST_CASE("what moved out of the picture does not count, and a second pass gives the same frames") {
  io::ReadOptions options;
  options.stabilize = io::Stabilize::translation;
  options.region = io::parse_region("0,0,100,100");
  options.scale = 0.5;
  const auto source = io::open_clip(filmed(false, false), "made", options);
  core::Clip first;
  cv::Mat mask;
  for (cv::Mat frame = source->next(); !frame.empty(); frame = source->next()) {
    first.frames.push_back(frame);
    mask = core::mask_of(*source).clone();
    REQUIRE(mask.size() == frame.size());
    REQUIRE(mask.type() == CV_8UC1);
  }
  CHECK(mask.at<std::uint8_t>(2, 20) == 0);  // the last frame has moved down by some 9 px
  CHECK(mask.at<std::uint8_t>(25, 20) == 255);
  source->rewind();
  const auto second = core::read_all(*source);
  REQUIRE(second.frames.size() == first.frames.size());
  for (std::size_t t = 0; t < second.frames.size(); ++t)
    CHECK(same_pixels(second.frames[t], first.frames[t]));
}

TEST_CASE("a mask is an image or a clip, cut and scaled like the frames") {
  const TempFolder temp;
  cv::Mat mask = cv::Mat::zeros(24, 32, CV_8UC1);
  mask(cv::Rect(8, 4, 16, 12)) = cv::Scalar(1);  // of 0 and 1
  cv::imwrite((temp / "mask.png").string(), mask);
  io::ReadOptions options;
  options.mask = (temp / "mask.png").string();
  options.region = io::parse_region("8,4,24,20");
  options.scale = 0.5;
  const auto source = io::open_clip(noise_clip({32, 24}, 4, 1), "made", options);
  CHECK(core::mask_of(*source).empty() == false);
  REQUIRE_FALSE(source->next().empty());
  const cv::Mat seen = core::mask_of(*source);
  CHECK(seen.size() == cv::Size(12, 10));
  CHECK(cv::countNonZero(seen) == 8 * 6);
  CHECK(seen.at<std::uint8_t>(0, 0) == 255);

  // a clip of masks goes with the frames, also those that are skipped
  fs::create_directory(temp / "masks");
  for (int t = 0; t < 4; ++t) {
    cv::Mat one = cv::Mat::zeros(24, 32, CV_8UC1);
    one.col(t) = cv::Scalar(255);
    cv::imwrite((temp / "masks").string() + "/m" + std::to_string(t) + ".png", one);
  }
  io::ReadOptions moving;
  moving.mask = (temp / "masks").string(), moving.first = 1, moving.every = 2;
  const auto clip = io::open_clip(noise_clip({32, 24}, 4, 1), "made", moving);
  for (const int column : {1, 3}) {
    REQUIRE_FALSE(clip->next().empty());
    CHECK(cv::countNonZero(core::mask_of(*clip).col(column)) == 24);
    CHECK(cv::countNonZero(core::mask_of(*clip)) == 24);
  }
  const auto refused = [&](const io::ReadOptions& asked, int frames = 4) {
    return message_of<core::InputError>([&] {
      core::read_all(*io::open_clip(noise_clip({32, 24}, frames, 1), "made", asked));
    });
  };
  io::ReadOptions wrong;
  cv::imwrite((temp / "black.png").string(), cv::Mat::zeros(24, 32, CV_8UC1));
  cv::imwrite((temp / "small.png").string(), cv::Mat::ones(23, 32, CV_8UC1));
  wrong.mask = (temp / "black.png").string();
  CHECK(contains(refused(wrong), "black"));
  wrong.mask = (temp / "small.png").string();
  CHECK(contains(refused(wrong), "32x23"));
  wrong.mask = (temp / "masks").string();
  CHECK(contains(refused(wrong, 6), "fewer frames"));
}

TEST_CASE("pixels outside the mask stand still where all pixels are looked at") {
  const TempFolder temp;
  cv::Mat mask = cv::Mat::zeros(24, 32, CV_8UC1);
  mask.colRange(0, 10) = cv::Scalar(255);
  cv::imwrite((temp / "mask.png").string(), mask);
  io::ReadOptions options;
  options.mask = (temp / "mask.png").string();
  const auto clip = noise_clip({32, 24}, 4, 1);
  core::HeldOutside held(io::open_clip(clip, "made", options));
  for (int pass = 0; pass < 2; ++pass) {
    const auto read = core::read_all(held);
    REQUIRE(read.frames.size() == 4);
    for (std::size_t t = 0; t < 4; ++t) {
      CHECK(same_pixels(read.frames[t].colRange(0, 10), clip.frames[t].colRange(0, 10)));
      CHECK(same_pixels(read.frames[t].colRange(10, 32), clip.frames[0].colRange(10, 32)));
    }
    held.rewind();
  }
}
