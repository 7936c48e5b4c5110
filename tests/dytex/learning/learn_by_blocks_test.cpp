// SPDX-License-Identifier: Apache-2.0
// Models learned by blocks of frames, against those of all frames at once.
#include "dytex/learning/learn_by_blocks.hpp"

#include "core/error.hpp"
#include "core/parallel.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/matrices.hpp"
#include "tests/support/messages.hpp"
#include "tests/support/reference_linalg.hpp"

using namespace emberfold;
using namespace emberfold::test;

namespace {

dytex::LinearDynamicTexture at_once(const core::Clip& clip, const dytex::LearnOptions& options) {
  core::ClipSource source(clip);
  return dytex::learn(source, options).texture;
}

dytex::LearnResult by_blocks(const core::Clip& clip, const dytex::LearnOptions& options, std::size_t block) {
  core::ClipSource source(clip);
  return dytex::learn_by_blocks(source, options, block);
}

/// Sine of the largest angle between the spaces that the components span.
double sine_between(const dytex::LinearDynamicTexture& a, const dytex::LinearDynamicTexture& b) {
  const Eigen::MatrixXd left = a.C.cast<double>(), right = b.C.cast<double>();
  return test::singular_values(right - left * (left.transpose() * right)).maxCoeff();
}

}  // namespace

TEST_CASE("One block of all frames gives the model of all frames", "[dytex][blocks]") {
  for (const int depth : {CV_8U, CV_16U, CV_32F}) {
    const core::Clip clip = test::wavy_clip(61, 40, depth == CV_8U ? 3 : 1, depth, 60);
    const auto one = at_once(clip, {.components = 5});
    const auto two = by_blocks(clip, {.components = 5}, 60).texture;
    INFO("depth " << depth);
    validate(two);
    CHECK(sine_between(one, two) < 1e-5);
    CHECK((one.mean - two.mean).norm() < 1e-6F * one.mean.norm());
    CHECK((one.singular - two.singular).head(50).norm() < 1e-9 * one.singular.norm());
    CHECK((one.A - two.A).norm() < 1e-9 * one.A.norm());
    CHECK((one.states - two.states).norm() < 1e-9 * one.states.norm());
    CHECK_THAT(two.r, WithinRel(one.r, 1e-9));
  }
}

TEST_CASE("Merged blocks have the directions of all frames", "[dytex][blocks]") {
  const core::Clip clip = test::wavy_clip(40, 30, 1, CV_32F, 90);
  const auto whole = at_once(clip, {.components = 5});
  for (const std::size_t block : {1, 7, 30, 89, 90, 200}) {
    const auto learned = by_blocks(clip, {.components = 5}, block);
    const auto& merged = learned.texture;
    INFO("blocks of " << block);
    validate(merged);
    CHECK(learned.passes == 1);
    CHECK(merged.info.frames == 90);
    CHECK(sine_between(whole, merged) < 1e-4);
    CHECK_THAT(merged.singular.head(5).squaredNorm(), WithinRel(whole.singular.head(5).squaredNorm(), 1e-6));
    CHECK_THAT(merged.singular.squaredNorm(), WithinRel(whole.singular.squaredNorm(), 1e-6));
    // States are the frames seen through C: the right vectors were put together rightly.
    const Eigen::MatrixXd moving = test::levels_of(clip).colwise() - merged.mean.cast<double>(),
                          seen = merged.C.cast<double>().transpose() * moving;
    CHECK((seen - merged.states).norm() < 1e-3 * seen.norm());  // what was dropped is missing
  }
}

TEST_CASE("Merged blocks lose next to nothing of the energy where noise is cut", "[dytex][blocks]") {
  // 240 frames of 6 waves in noise; 54 directions are kept from block to block.
  core::Clip clip = test::wavy_clip(48, 40, 1, CV_32F, 240);
  Eigen::MatrixXd levels = test::levels_of(clip) + 8 * test::normals(48 * 40, 240, 4);
  clip = test::clip_of(levels, 48, 40, 1, CV_32F);
  const auto whole = at_once(clip, {.components = 4}),
             merged = by_blocks(clip, {.components = 4}, 60).texture;
  levels.colwise() -= levels.rowwise().mean().eval();
  const auto captured = [&](const dytex::LinearDynamicTexture& texture) {
    return (texture.C.cast<double>().transpose() * levels).squaredNorm();
  };
  CHECK(captured(merged) > (1 - 1e-4) * captured(whole));
}

TEST_CASE("By blocks a share of the variance takes as many components", "[dytex][blocks]") {
  const core::Clip clip = test::wavy_clip(61, 40, 1, CV_8U, 60);
  const auto whole = at_once(clip, {.energy = 0.9}), merged = by_blocks(clip, {.energy = 0.9}, 16).texture;
  CHECK(whole.components() == 5);
  CHECK(merged.components() == 5);
}

TEST_CASE("Learning by blocks gives the same bytes at any thread count", "[dytex][blocks]") {
  const core::Clip clip = test::wavy_clip(61, 40, 1, CV_8U, 60);
  const auto many = by_blocks(clip, {.components = 5}, 16).texture;
  const core::ThreadLimit limit(1);
  CHECK(test::same(many, by_blocks(clip, {.components = 5}, 16).texture));
}

TEST_CASE("By blocks a clip that stands still is its mean", "[dytex][blocks]") {
  const core::Clip clip = test::clip_of(Eigen::MatrixXd::Constant(600, 9, 77), 30, 20, 1, CV_8U);
  const auto texture = by_blocks(clip, {.components = 5}, 4).texture;
  CHECK(texture.components() == 0);
  CHECK(texture.mean == Eigen::VectorXf::Constant(600, 77));
}

TEST_CASE("Blocks that are not told are as long as memory holds", "[dytex][blocks]") {
  const core::Clip clip = test::wavy_clip(160, 100, 1, CV_8U, 90);
  dytex::LearnOptions options{.components = 5};
  options.memory = std::size_t{1} << 20;
  const auto learned = by_blocks(clip, options, 0);
  REQUIRE_FALSE(learned.notes.empty());
  CHECK(contains(learned.notes.back(), "blocks of 65 frames"));
  CHECK(test::same(learned.texture, by_blocks(clip, options, 65).texture));
}

TEST_CASE("Learning by blocks refuses what it cannot learn", "[dytex][blocks]") {
  const core::Clip clip = test::wavy_clip(61, 40, 3, CV_8U, 20);
  const auto refusal = [](const core::Clip& from, const dytex::LearnOptions& options,
                          std::size_t block = 16) {
    return message_of<core::InputError>([&] { by_blocks(from, options, block); });
  };
  CHECK(contains(refusal(clip, {.components = 20}), "n is 20"));
  CHECK(contains(refusal(clip, {.order = dytex::Order::held_out}), "all frames at once"));
  dytex::LearnOptions little{.components = 5};
  little.memory = std::size_t{1} << 20;
  CHECK(contains(refusal(clip, little, 100'000), "learn.block is 100000"));
  core::Clip one = clip;
  one.frames.resize(1);
  CHECK(contains(refusal(one, {.components = 1}), "at least 2 are needed"));
}
