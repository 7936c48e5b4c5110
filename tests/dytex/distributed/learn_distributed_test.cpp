// SPDX-License-Identifier: Apache-2.0
// Models learned by several ranks, here threads, against those of one.
#include "dytex/distributed/learn_distributed.hpp"

#include <algorithm>
#include <mutex>
#include <optional>

#include "core/error.hpp"
#include "dytex/distributed/together.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/matrices.hpp"
#include "tests/support/messages.hpp"
#include "tests/support/reference_linalg.hpp"
#include "tests/support/thread_ranks.hpp"

using namespace emberfold;
using namespace emberfold::test;

namespace {

struct Asked {
  int ranks = 1;
  bool all_read = true;  ///< else rank 0 alone
  std::size_t block = 0;
  dytex::LearnOptions options{.components = 5};
};

struct Learned {
  dytex::LearnResult result;
  dytex::DistributedResult root;  ///< rank 0's, without the model
  std::vector<std::size_t> decoded;
  std::uint64_t sent = 0;
};

/// A source that gives out at a frame.
class BreakingSource final : public core::FrameSource {
 public:
  BreakingSource(const core::Clip& clip, std::size_t breaks_at) : clip_(clip), left_(breaks_at) {}
  [[nodiscard]] const core::ClipInfo& info() const override { return clip_.info(); }
  cv::Mat next() override {
    if (left_-- == 0) throw core::IoError("the frame is damaged");
    return clip_.next();
  }
  void rewind() override { clip_.rewind(); }

 private:
  core::ClipSource clip_;
  std::size_t left_;
};

Learned learn(const core::Clip& clip, const Asked& asked, SharedMemory& memory,
              std::optional<std::size_t> breaks_at = {}) {
  Learned learned;
  core::ClipInfo info = clip.info;
  info.frames = static_cast<std::int64_t>(clip.frames.size());
  const auto m = static_cast<Eigen::Index>(info.width) * info.height * info.channels;
  Eigen::MatrixXf C;
  std::mutex mutex;
  learned.decoded.resize(static_cast<std::size_t>(asked.ranks));
  run_ranks(asked.ranks, [&](dytex::Communicator& ranks) {
    core::ClipSource whole(clip);
    BreakingSource breaking(clip, breaks_at.value_or(0));
    const bool breaks = breaks_at && ranks.rank() == asked.ranks - 1;
    const dytex::SharedClip shared{info, asked.all_read ? asked.ranks : 1,
                                   breaks ? static_cast<core::FrameSource*>(&breaking) : &whole};
    MemoryKeeper keeper(memory);
    const dytex::RowSink rows{[&](Eigen::Index n) { C = Eigen::MatrixXf::Zero(m, n); },
                              [&](std::size_t first, const Eigen::MatrixXf& some) {
                                const std::scoped_lock lock(mutex);
                                C.middleRows(static_cast<Eigen::Index>(first), some.rows()) = some;
                              }};
    auto found = dytex::learn_distributed(ranks, shared, asked.options, asked.block, keeper, rows, {});
    const std::scoped_lock lock(mutex);
    learned.decoded[static_cast<std::size_t>(ranks.rank())] = found.decoded;
    learned.sent += ranks.bytes_sent();
    if (ranks.rank() > 0) return;
    learned.result = std::move(found.learned);
    learned.root = std::move(found);
  });
  learned.result.texture.C = C;
  return learned;
}

Learned learn(const core::Clip& clip, const Asked& asked) {
  SharedMemory memory;
  return learn(clip, asked, memory);
}

void check_same_bytes(const dytex::LinearDynamicTexture& a, const dytex::LinearDynamicTexture& b) {
  CHECK(a.C == b.C);
  CHECK(a.mean == b.mean);
  CHECK(a.A == b.A);
  CHECK(a.B == b.B);
  CHECK(a.states == b.states);
  CHECK(a.singular == b.singular);
  CHECK(a.r == b.r);
}

/// The eight expected frames behind the clip's last one, less the mean.
Eigen::MatrixXd forecast_frames(const dytex::LinearDynamicTexture& texture) {
  Eigen::MatrixXd frames(texture.pixels(), 8);
  Eigen::VectorXd state = texture.states.rightCols(1);
  for (Eigen::Index k = 0; k < frames.cols(); ++k) {
    state = texture.A * state;
    frames.col(k) = texture.C.cast<double>() * state.head(texture.components());
  }
  return frames;
}

/// Sine of the largest angle between the spaces that the components span.
double apart(const dytex::LinearDynamicTexture& a, const dytex::LinearDynamicTexture& b) {
  const Eigen::MatrixXd left = a.C.cast<double>(), right = b.C.cast<double>();
  return test::singular_values(right - left * (left.transpose() * right)).maxCoeff();
}

}  // namespace

TEST_CASE("Ranks learn what one process learns", "[dytex][distributed]") {
  for (const int depth : {CV_8U, CV_16U, CV_32F}) {
    const core::Clip clip = test::wavy_clip(61, 40, depth == CV_8U ? 3 : 1, depth, 60);
    core::ClipSource source(clip);
    const auto one = dytex::learn(source, {.components = 5}).texture;
    const auto two = learn(clip, {.ranks = 2}).result.texture;
    INFO("depth " << depth);
    validate(two);
    CHECK(apart(one, two) < 1e-6);
    CHECK((one.singular - two.singular).norm() < 1e-6 * one.singular.norm());
    CHECK((one.mean - two.mean).norm() < 1e-6F * one.mean.norm());
    CHECK((forecast_frames(one) - forecast_frames(two)).norm() < 1e-6 * forecast_frames(one).norm());
  }
}

TEST_CASE("A distributed model has the same bytes at any number of ranks", "[dytex][distributed]") {
  for (const int depth : {CV_8U, CV_32F})
    for (const std::size_t block : {0, 16}) {
      const core::Clip clip = test::wavy_clip(61, 40, 1, depth, 60);
      const auto one = learn(clip, {.ranks = 1, .block = block});
      INFO("depth " << depth << ", block " << block);
      for (const int ranks : {2, 3, 4, 7}) {
        const auto many = learn(clip, {.ranks = ranks, .block = block});
        check_same_bytes(one.result.texture, many.result.texture);
        std::size_t decoded = 0;
        for (const std::size_t count : many.decoded) decoded += count;
        CHECK(decoded == 60);  // each frame once
        CHECK(std::ranges::max(many.decoded) < 60);
      }
      check_same_bytes(one.result.texture,
                       learn(clip, {.ranks = 4, .all_read = false, .block = block}).result.texture);
    }
}

TEST_CASE("More ranks than stripes do no harm", "[dytex][distributed]") {
  const core::Clip clip = test::wavy_clip(20, 20, 1, CV_16U, 24);  // 400 values: two stripes
  for (const std::size_t block : {0, 8})
    check_same_bytes(learn(clip, {.ranks = 1, .block = block}).result.texture,
                     learn(clip, {.ranks = 5, .block = block}).result.texture);
}

TEST_CASE("Merged blocks have the directions of all frames", "[dytex][distributed]") {
  const core::Clip clip = test::wavy_clip(40, 30, 1, CV_32F, 90);
  const auto whole = learn(clip, {}).result.texture;
  for (const std::size_t block : {1, 7, 30, 89, 90, 200}) {
    const auto merged = learn(clip, {.block = block}).result.texture;
    INFO("blocks of " << block);
    validate(merged);
    CHECK(apart(whole, merged) < 1e-4);
    CHECK_THAT(merged.singular.head(5).squaredNorm(), WithinRel(whole.singular.head(5).squaredNorm(), 1e-6));
    CHECK_THAT(merged.singular.squaredNorm(), WithinRel(whole.singular.squaredNorm(), 1e-6));
    // States are the frames seen through C: the right vectors were put together rightly.
    const Eigen::MatrixXd moving = test::levels_of(clip).colwise() - merged.mean.cast<double>(),
                          seen = merged.C.cast<double>().transpose() * moving;
    CHECK((seen - merged.states).norm() < 1e-3 * seen.norm());  // what was dropped is missing
  }
}

TEST_CASE("Merged blocks lose next to nothing of the energy where noise is cut", "[dytex][distributed]") {
  // 240 frames of 6 waves in noise; 54 directions are kept from block to block.
  core::Clip clip = test::wavy_clip(48, 40, 1, CV_32F, 240);
  Eigen::MatrixXd levels = test::levels_of(clip) + 8 * test::normals(48 * 40, 240, 4);
  clip = test::clip_of(levels, 48, 40, 1, CV_32F);
  Asked asked{.ranks = 2};
  asked.options.components = 4;
  const auto whole = learn(clip, asked).result.texture;
  asked.block = 60;
  const auto merged = learn(clip, asked).result.texture;
  levels.colwise() -= levels.rowwise().mean().eval();
  const auto captured = [&](const dytex::LinearDynamicTexture& texture) {
    return (texture.C.cast<double>().transpose() * levels).squaredNorm();
  };
  CHECK(captured(merged) > (1 - 1e-4) * captured(whole));
}

TEST_CASE("A clip that stands still is its mean on any ranks", "[dytex][distributed]") {
  const core::Clip clip = test::clip_of(Eigen::MatrixXd::Constant(600, 9, 77), 30, 20, 1, CV_8U);
  for (const std::size_t block : {0, 4}) {
    const auto learned = learn(clip, {.ranks = 2, .block = block});
    CHECK(learned.result.texture.components() == 0);
    CHECK(learned.result.texture.mean == Eigen::VectorXf::Constant(600, 77));
  }
}

TEST_CASE("A job that broke off goes on from what was kept", "[dytex][distributed]") {
  const core::Clip clip = test::wavy_clip(160, 100, 1, CV_8U, 60);
  for (const std::size_t block : {0, 16}) {
    Asked asked{.ranks = 2, .block = block};
    asked.options.memory = std::size_t{1} << 20;
    const auto whole = learn(clip, asked);
    SharedMemory memory;
    try {
      learn(clip, asked, memory, 40);  // frames that the last rank reads or passes over

      FAIL("the broken clip was learned");
    } catch (const dytex::FailedTogether& failed) {
      CHECK(failed.rank() == 1);
      CHECK(contains(message_of<core::IoError>([&] { failed.rethrow(); }), "the frame is damaged"));
    }
    asked.ranks = 3;
    const auto rest = learn(clip, asked, memory);
    INFO("block " << block);
    CHECK(rest.root.resumed == 32);
    check_same_bytes(whole.result.texture, rest.result.texture);
    asked.ranks = 1;
    const auto again = learn(clip, asked, memory);
    CHECK(again.root.resumed == 60);
    CHECK(again.decoded[0] == 0);
    check_same_bytes(whole.result.texture, again.result.texture);
  }
}

TEST_CASE("What a rank sends is its share of the frames and some matrices", "[dytex][distributed]") {
  const core::Clip clip = test::wavy_clip(320, 160, 1, CV_8U, 40);
  const auto learned = learn(clip, {.ranks = 2});
  const double frames = 40 * 320 * 160, half = frames / 2;  // of each frame the half that is not one's own
  const double gram = 8.0 * 40 * 41 / 2, weights = 8 * 40 * 5, mean = 4.0 * 320 * 160 / 2;
  const double all = half + gram + weights + mean;
  CHECK(static_cast<double>(learned.sent) > all);
  CHECK(static_cast<double>(learned.sent) < all + 4000);
}

TEST_CASE("Ranks refuse what they cannot learn", "[dytex][distributed]") {
  const core::Clip clip = test::wavy_clip(61, 40, 1, CV_8U, 60);
  const auto refusal = [&](const Asked& asked) {
    try {
      learn(clip, asked);
    } catch (const dytex::FailedTogether& failed) {
      return message_of<core::InputError>([&] { failed.rethrow(); });
    }
    return std::string();
  };
  Asked asked{.ranks = 2};
  asked.options.components = 60;
  CHECK(contains(refusal(asked), "n is 60"));
  asked = {.ranks = 2, .block = 16};
  asked.options.order = dytex::Order::held_out;
  CHECK(contains(refusal(asked), "all frames at once"));
  asked = {.ranks = 2, .block = 100'000};
  asked.options.memory = std::size_t{1} << 20;
  CHECK(contains(refusal(asked), "learn.block is 100000"));
}
