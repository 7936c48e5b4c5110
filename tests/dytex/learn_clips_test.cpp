// SPDX-License-Identifier: Apache-2.0
// Learning from every kind of clip: too short, still, long beyond memory, damaged.
#include <limits>
#include <stop_token>

#include "core/error.hpp"
#include "core/parallel.hpp"
#include "dytex/learn.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/matrices.hpp"
#include "tests/support/messages.hpp"

using namespace emberfold;
using namespace emberfold::test;

namespace {

/// A clip that tells another number of frames than it has, or none; and counts how often it is read.
class Teller final : public core::FrameSource {
 public:
  Teller(const core::Clip& clip, std::optional<std::int64_t> told) : info_(clip.info), source_(clip) {
    info_.frames = told;
  }
  [[nodiscard]] const core::ClipInfo& info() const override { return info_; }
  cv::Mat next() override { return source_.next(); }
  void rewind() override {
    ++rewinds;
    source_.rewind();
  }
  int rewinds = 0;

 private:
  core::ClipInfo info_;
  core::ClipSource source_;
};

dytex::LearnResult learn(const core::Clip& clip, const dytex::LearnOptions& options) {
  core::ClipSource source(clip);
  return dytex::learn(source, options);
}

dytex::LearnOptions components(int n) {
  dytex::LearnOptions options;
  options.components = n;
  return options;
}

std::string complaint(const core::Clip& clip, const dytex::LearnOptions& options) {
  return test::message_of<core::InputError>([&] { learn(clip, options); });
}

}  // namespace

TEST_CASE("Several passes over blocks give the same bytes as one pass", "[dytex][learn]") {
  for (const int depth : {CV_8U, CV_16U, CV_32F}) {
    const core::Clip clip = test::wavy_clip(200, 150, 1, depth, 40);  // 1.2 MB or more
    const dytex::LearnResult whole = learn(clip, components(6));
    REQUIRE(whole.passes == 1);
    for (const std::optional<std::int64_t> told :
         {std::optional<std::int64_t>(40), {}, {39}, {41}, {5}, {1000}}) {
      Teller source(clip, told);
      dytex::LearnOptions options = components(6);
      options.memory = std::size_t{1} << 20;
      const dytex::LearnResult in_blocks = dytex::learn(source, options);
      CHECK(in_blocks.passes > 1);
      CHECK(in_blocks.passes == source.rewinds);
      const auto bytes = static_cast<int>(CV_ELEM_SIZE1(depth)) * 200 * 150 * 40;
      const int blocks = (bytes + (1 << 20) - 1) >> 20;
      INFO("depth " << depth << ", told " << told.value_or(-1));
      CHECK(in_blocks.passes <= 2 * (blocks + 1));
      CHECK(test::same(in_blocks.texture, whole.texture));
    }
  }
}

TEST_CASE("The same bytes at any number of threads", "[dytex][learn]") {
  const core::Clip clip = test::wavy_clip(64, 50, 3, CV_8U, 110);
  std::optional<dytex::LinearDynamicTexture> first;
  for (const std::size_t threads : {1, 2, 8}) {
    const core::ThreadLimit limit(threads);
    const dytex::LinearDynamicTexture texture = learn(clip, components(9)).texture;
    if (!first) first = texture;
    CHECK(test::same(texture, *first));
  }
}

TEST_CASE("A clip that does not change is its mean", "[dytex][learn]") {
  for (const int depth : {CV_8U, CV_16U, CV_32F}) {
    const dytex::LearnResult result =
        learn(test::clip_of(Eigen::MatrixXd::Constant(12, 8, 100.3), 4, 3, 1, depth), components(5));
    const dytex::LinearDynamicTexture& texture = result.texture;
    CHECK_NOTHROW(dytex::validate(texture));
    CHECK(texture.order() == 0);
    CHECK(texture.r == 0);
    CHECK(texture.C.rows() == 12);
    CHECK_THAT(static_cast<double>(texture.mean[7]), WithinAbs(100.3, 0.31));
    REQUIRE(result.notes.size() == 1);
    CHECK(result.notes[0] == "the frames do not change: the model is their mean, without components");
  }
}

TEST_CASE("Frames that repeat give fewer components with a note", "[dytex][learn]") {
  core::Clip clip = test::wavy_clip(12, 10, 1, CV_8U, 4);
  for (int t = 4; t < 32; ++t) clip.frames.push_back(clip.frames[static_cast<std::size_t>(t % 4)]);
  clip.info.frames = 32;
  const dytex::LearnResult result = learn(clip, components(10));
  CHECK(result.texture.order() == 3);
  CHECK_NOTHROW(dytex::validate(result.texture));
  REQUIRE_FALSE(result.notes.empty());
  CHECK(result.notes[0] ==
        "the frames change in 3 directions only, 10 components were asked for: the model has 3");
}

TEST_CASE("One level of one pixel in one frame is a component", "[dytex][learn]") {
  core::Clip clip = test::clip_of(Eigen::MatrixXd::Constant(76800, 100, 255), 320, 240, 1, CV_8U);
  clip.frames[50].at<std::uint8_t>(100, 100) = 254;
  const dytex::LearnResult result = learn(clip, components(3));
  REQUIRE(result.texture.order() == 1);
  CHECK_THAT(std::abs(static_cast<double>(result.texture.C(100 * 320 + 100, 0))), WithinAbs(1, 1e-4));
}

TEST_CASE("Clips of two frames and of fewer pixels than components can be learned", "[dytex][learn]") {
  const dytex::LearnResult two = learn(test::wavy_clip(9, 7, 1, CV_8U, 2), components(1));
  CHECK_NOTHROW(dytex::validate(two.texture));
  CHECK(two.texture.order() == 1);
  const dytex::LearnResult narrow = learn(test::wavy_clip(2, 1, 1, CV_8U, 30), components(10));
  CHECK_NOTHROW(dytex::validate(narrow.texture));
  CHECK(narrow.texture.order() == 2);
  const dytex::LearnResult all = learn(test::wavy_clip(9, 7, 1, CV_8U, 12), components(11));
  CHECK_NOTHROW(dytex::validate(all.texture));
  CHECK(all.transition == dytex::Transition::yule_walker);
  CHECK_FALSE(all.notes.empty());
}

TEST_CASE("Energy takes the fewest components that hold it", "[dytex][learn]") {
  const core::Clip clip = test::wavy_clip(16, 12, 1, CV_8U, 30);
  for (const double energy : {0.2, 0.8, 0.95, 1.0}) {
    dytex::LearnOptions options;
    options.energy = energy;
    const dytex::LinearDynamicTexture texture = learn(clip, options).texture;
    const Eigen::VectorXd variance = texture.singular.cwiseAbs2();
    const Eigen::Index n = texture.order();
    CHECK(variance.head(n).sum() >= energy * variance.sum() * (1 - 1e-12));
    CHECK(variance.head(n - 1).sum() < energy * variance.sum());
  }
}

TEST_CASE("What cannot be learned is refused with one line", "[dytex][learn]") {
  const core::Clip clip = test::wavy_clip(8, 6, 1, CV_8U, 10);
  CHECK(complaint(clip, components(200)) == "n is 200; a clip of 10 frames has at most 9 components");
  CHECK(complaint(clip, components(10)) == "n is 10; a clip of 10 frames has at most 9 components");
  CHECK(complaint(clip, components(9)).empty());
  CHECK(complaint(clip, components(0)) == "LearnOptions.components is 0; allowed is at least 1");
  dytex::LearnOptions options;
  options.energy = 1.5;
  CHECK(complaint(clip, options) == "LearnOptions.energy is 1.5; allowed is above 0, up to 1");
  options.energy = std::numeric_limits<double>::quiet_NaN();
  CHECK_FALSE(complaint(clip, options).empty());
  options = components(3);
  options.memory = 1000;
  CHECK(complaint(clip, options) == "LearnOptions.memory is 1000; allowed is at least 1048576");
  CHECK(complaint(test::wavy_clip(8, 6, 1, CV_8U, 1), components(1)) ==
        "the clip has 1 frame, at least 2 are needed");
  core::Clip none = clip;
  none.frames.clear();
  CHECK(complaint(none, components(1)) == "the clip has 0 frames, at least 2 are needed");
  core::Clip hole = test::wavy_clip(8, 6, 1, CV_32F, 10);
  for (const float bad : {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
    hole.frames[3].at<float>(2, 2) = bad;
    CHECK(complaint(hole, components(2)) == "the clip has a value that is not finite");
  }
}

TEST_CASE("A frame of another size is refused", "[dytex][learn]") {
  core::Clip clip = test::wavy_clip(8, 6, 1, CV_8U, 10);
  clip.frames[4] = cv::Mat(6, 7, CV_8U, cv::Scalar(0));
  CHECK(test::message_of<core::IoError>([&] { learn(clip, components(2)); }) ==
        "frame 4 is 7 × 6 of OpenCV's type 0, the clip's frames are 8 × 6 of OpenCV's type 0");
}

TEST_CASE("Learning can be cancelled at any stage", "[dytex][learn]") {
  const core::Clip clip = test::wavy_clip(200, 150, 1, CV_8U, 40);
  for (const char* when : {"reading", "comparing frames", "making components"}) {
    for (const std::size_t memory : {std::size_t{1} << 20, std::size_t{1} << 30}) {
      std::stop_source stop;
      const core::Context context(stop.get_token(), [&](std::string_view stage, double fraction) {
        CHECK((fraction >= 0 && fraction <= 1));
        if (stage == when) stop.request_stop();
      });
      core::ClipSource source(clip);
      dytex::LearnOptions options = components(4);
      options.memory = memory;
      INFO(when);
      CHECK_THROWS_AS(dytex::learn(source, options, context), core::Cancelled);
    }
  }
}

TEST_CASE("Whatever is asked for gives the same bytes in blocks and threads", "[dytex][learn]") {
  const core::Clip clip = test::wavy_clip(120, 80, 3, CV_16U, 60);
  for (const dytex::Method method : {dytex::Method::closed_form, dytex::Method::n4sid}) {
    dytex::LearnOptions options = components(5);
    options.method = method;
    const dytex::LinearDynamicTexture whole = learn(clip, options).texture;
    CHECK_NOTHROW(dytex::validate(whole));
    options.memory = std::size_t{1} << 20;
    const core::ThreadLimit limit(1);
    const dytex::LearnResult in_blocks = learn(clip, options);
    CHECK(in_blocks.passes > 2);
    CHECK(test::same(in_blocks.texture, whole));
  }
}

TEST_CASE("A clip that does not fit takes a pass for each block and one more", "[dytex][learn]") {
  const core::Clip clip = test::wavy_clip(200, 150, 1, CV_8U, 80);  // 2.4 MB
  dytex::LearnOptions options = components(6);
  options.memory = std::size_t{1} << 20;
  CHECK(learn(clip, options).passes == 4);
  options.memory = std::size_t{3} << 20;
  CHECK(learn(clip, options).passes == 1);
}

TEST_CASE("Clips that stand still or change once are learned by every method", "[dytex][learn]") {
  const core::Clip still = test::clip_of(Eigen::MatrixXd::Constant(12, 40, 100), 4, 3, 1, CV_8U);
  core::Clip flash = test::clip_of(Eigen::MatrixXd::Constant(12, 40, 100), 4, 3, 1, CV_8U);
  flash.frames[20].setTo(200);
  for (const core::Clip& clip : {still, flash})
    for (int kind = 0; kind < 4; ++kind) {
      dytex::LearnOptions options = components(3);
      if (kind == 1) options.method = dytex::Method::n4sid;
      if (kind == 2) options.order = dytex::Order::held_out;
      if (kind == 3) options.order = dytex::Order::gavish_donoho;
      INFO(kind);
      CHECK_NOTHROW(dytex::validate(learn(clip, options).texture));
    }
}
