// SPDX-License-Identifier: Apache-2.0
#include "core/clip/masked_source.hpp"

#include <algorithm>
#include <cstdint>
#include <memory>
#include <vector>

#include <opencv2/core.hpp>

#include "core/clip/clip_range.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/clip_fixture.hpp"

using namespace emberfold;

namespace {

/// Frames of one row, of which in frame t only the pixels t and t + 1 count.
class MovingMask final : public core::FrameSource, public core::ClipKnowledge {
 public:
  explicit MovingMask(int frames) : clip_(test::noise_clip({8, 1}, frames, 3)), source_(clip_) {}
  [[nodiscard]] const core::ClipInfo& info() const override { return source_.info(); }
  [[nodiscard]] cv::Mat mask() const override {
    cv::Mat1b mask(1, 8, std::uint8_t{0});
    for (const int x : {t_, t_ + 1})
      if (x < 8) mask(0, x) = 255;
    return mask;
  }
  [[nodiscard]] std::vector<core::CameraMotion> drift() const override { return {}; }
  cv::Mat next() override {
    ++t_;
    return source_.next();
  }
  void rewind() override {
    t_ = -1;
    source_.rewind();
  }

 private:
  core::Clip clip_;
  core::ClipSource source_;
  int t_ = -1;
};

}  // namespace

TEST_CASE("a pixel outside the mask keeps what it had inside last, in every pass the same") {
  const auto clip = test::noise_clip({8, 1}, 5, 3);
  core::HeldOutside held(std::make_unique<MovingMask>(5));
  for (int pass = 0; pass < 2; ++pass) {
    for (int t = 0; t < 5; ++t) {
      const cv::Mat frame = held.next();
      for (int x = 0; x < 8; ++x) {
        // Inside in the frames x − 1 and x, and before that as in the first frame.
        const int seen = std::min(t, x);
        const auto from = static_cast<std::size_t>(seen < x - 1 ? 0 : seen);
        CHECK(frame.at<std::uint8_t>(0, x) == clip.frames[from].at<std::uint8_t>(0, x));
      }
    }
    CHECK(held.next().empty());
    held.rewind();
  }
}

TEST_CASE("a range of a clip has its frames alone, in every pass") {
  const auto clip = test::noise_clip({8, 4}, 9, 5);
  core::ClipSource source(clip);
  core::ClipRange range(source, 3, 7);
  CHECK(range.info().frames == 4);
  for (int pass = 0; pass < 2; ++pass) {
    for (std::size_t t = 3; t < 7; ++t) CHECK(test::same_pixels(range.next(), clip.frames[t]));
    CHECK(range.next().empty());
    CHECK(range.next().empty());
    range.rewind();
  }
}
