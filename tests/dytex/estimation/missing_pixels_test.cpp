// SPDX-License-Identifier: Apache-2.0
// Clips with hidden parts: what is learned from them, and how near the filled values come to the truth.
#include "dytex/estimation/missing_pixels.hpp"

#include <cmath>
#include <functional>
#include <limits>

#include "core/error.hpp"
#include "dytex/estimation/em.hpp"
#include "dytex/synthesize.hpp"
#include "tests/dytex/estimation/em_make.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/messages.hpp"

using namespace emberfold;
using namespace emberfold::test;

namespace {

using Hidden = std::function<bool(int pixel, int frame)>;

constexpr int kWidth = 24, kHeight = 20, kFrames = 80;
constexpr Eigen::Index kPixels = kWidth * kHeight;

/// RMS distances to the clean values where something is hidden.
struct Misses {
  double model = 0, mean = 0, interpolated = 0;
};

/// Estimate of a hidden value from the nearest frames before and after in which its pixel is seen.
double interpolate(const Eigen::MatrixXd& levels, const Hidden& hidden, int p, int t) {
  int before = t, after = t;
  while (before >= 0 && hidden(p, before)) --before;
  while (after < kFrames && hidden(p, after)) ++after;
  if (before < 0) return levels(p, after);
  if (after >= kFrames) return levels(p, before);
  const double share = static_cast<double>(t - before) / (after - before);
  return (1 - share) * levels(p, before) + share * levels(p, after);
}

Misses misses(const core::Clip& filled, const Eigen::MatrixXd& clean, const Eigen::MatrixXd& levels,
              const Hidden& hidden) {
  const Eigen::MatrixXd shown = test::levels_of(filled);
  Misses result;
  double count = 0;
  for (int p = 0; p < kPixels; ++p) {
    double sum = 0, seen = 0;
    for (int t = 0; t < kFrames; ++t)
      if (!hidden(p, t)) sum += levels(p, t), seen += 1;
    for (int t = 0; t < kFrames; ++t) {
      if (!hidden(p, t)) {
        CHECK(shown(p, t) == levels(p, t));  // what is seen stays
        continue;
      }
      result.model += std::pow(shown(p, t) - clean(p, t), 2);
      result.mean += std::pow(sum / seen - clean(p, t), 2);
      result.interpolated += std::pow(interpolate(levels, hidden, p, t) - clean(p, t), 2);
      count += 1;
    }
  }
  for (double* miss : {&result.model, &result.mean, &result.interpolated}) *miss = std::sqrt(*miss / count);
  return result;
}

/// Learns with the hidden values made garbage, then fills.
Misses fill(const Hidden& hidden, dytex::EmResult& result) {
  const auto known = test::known_clip(kPixels, kFrames, 4, 31, 60);
  core::Clip clip = test::clip_of(known.levels, kWidth, kHeight, 1, CV_8U);
  const Eigen::MatrixXd levels = test::levels_of(clip);
  const core::Clip mask = test::mask_clip(kWidth, kHeight, kFrames, hidden);
  core::Rng rng(1);
  for (int t = 0; t < kFrames; ++t)
    for (int p = 0; p < kPixels; ++p)
      if (hidden(p, t))
        clip.frames[static_cast<std::size_t>(t)].data[p] = static_cast<unsigned char>(rng.below(256));
  const dytex::Missing missing = test::missing_of(mask, clip.info);
  core::ClipSource source(clip);
  result = dytex::learn_missing(source, missing, {.components = 4, .energy = {}}, {});
  REQUIRE_NOTHROW(dytex::validate(result.texture));
  dytex::FilledSource filled(source, missing, result.texture);
  filled.rewind();
  return misses(core::read_all(filled), known.clean, levels, hidden);
}

bool random_hidden(int p, int t) {
  core::Rng rng(5, {static_cast<std::uint32_t>(p), static_cast<std::uint32_t>(t), 0});
  return rng.uniform() < 0.3;
}
bool frames_hidden(int, int t) {
  return t % 10 == 3 || t % 10 == 4 || t % 20 == 15;
}
/// A block of 8 × 8 that moves a pixel a frame.
bool block_hidden(int p, int t) {
  const int x = p % kWidth - t % (kWidth - 8), y = p / kWidth - (t / 2) % (kHeight - 8);
  return x >= 0 && x < 8 && y >= 0 && y < 8;
}

}  // namespace

TEST_CASE("Hidden pixels are filled better than by the mean or in between", "[dytex][missing]") {
  for (const auto& [name, hidden] :
       {std::pair<const char*, Hidden>{"random", random_hidden}, {"block", block_hidden}}) {
    dytex::EmResult result;
    const Misses found = fill(hidden, result);
    INFO(name << ": model " << found.model << ", mean " << found.mean << ", in between "
              << found.interpolated);
    CHECK(found.model < 0.3 * found.mean);
    CHECK(found.model < 0.6 * found.interpolated);
    CHECK(found.model < 1);  // with noise of SD 2 on what is seen
    CHECK_THAT(result.texture.r, WithinRel(4 + 1.0 / 12, 0.05));
  }
}

TEST_CASE("Hidden frames are filled better than by the mean or in between", "[dytex][missing]") {
  dytex::EmResult result;
  const Misses found = fill(frames_hidden, result);
  INFO("model " << found.model << ", mean " << found.mean << ", in between " << found.interpolated);
  CHECK(found.model < 0.8 * found.mean);
  CHECK(found.model < 0.9 * found.interpolated);
}

TEST_CASE("With nothing hidden a mask changes nothing", "[dytex][missing]") {
  const core::Clip clip = test::wavy_clip(14, 12, 3, CV_8U, 30);
  const core::Clip mask = test::mask_clip(14, 12, 30, [](int, int) { return false; });
  core::ClipSource source(clip);
  const auto start = dytex::learn(source, {.components = 4, .energy = {}});
  const auto plain = dytex::maximise_likelihood(source, start.texture);
  const auto masked =
      dytex::learn_missing(source, test::missing_of(mask, clip.info), {.components = 4, .energy = {}});
  CHECK(masked.log_likelihood == plain.log_likelihood);
  CHECK((masked.texture.singular - plain.texture.singular).norm() < 1e-9 * plain.texture.singular.norm());
}

TEST_CASE("What is hidden is not looked at", "[dytex][missing]") {
  const auto nan = std::numeric_limits<float>::quiet_NaN();
  for (const bool frames : {false, true}) {
    const Hidden hidden = frames ? Hidden(frames_hidden) : Hidden(random_hidden);
    core::Clip clip = test::wavy_clip(kWidth, kHeight, 1, CV_32F, kFrames), other = clip;
    for (int t = 0; t < kFrames; ++t)
      other.frames[static_cast<std::size_t>(t)] = clip.frames[static_cast<std::size_t>(t)].clone();
    for (int t = 0; t < kFrames; ++t)
      for (int p = 0; p < kPixels; ++p)
        if (hidden(p, t)) other.frames[static_cast<std::size_t>(t)].at<float>(p / kWidth, p % kWidth) = nan;
    const core::Clip mask = test::mask_clip(kWidth, kHeight, kFrames, hidden);
    const dytex::Missing missing = test::missing_of(mask, clip.info);
    dytex::EmOptions options;
    options.iterations = 3;
    core::ClipSource a(clip), b(other);
    CHECK(test::same(dytex::learn_missing(a, missing, {.components = 6, .energy = {}}, options).texture,
                     dytex::learn_missing(b, missing, {.components = 6, .energy = {}}, options).texture));
  }
}

TEST_CASE("Pixels that are seldom or never seen are told", "[dytex][missing]") {
  const core::Clip clip = test::wavy_clip(10, 8, 3, CV_8U, 30);
  const core::Clip mask =
      test::mask_clip(10, 8, 30, [](int p, int t) { return p == 0 || (p < 4 && t > 3) || t == 7; });
  const dytex::Missing missing = test::missing_of(mask, clip.info);
  core::ClipSource source(clip);
  const auto result = dytex::learn_missing(source, missing, {.components = 3, .energy = {}});
  REQUIRE(result.notes.size() >= 2);
  CHECK_THAT(result.notes[0], Contains("1 pixel is hidden in every frame"));
  CHECK_THAT(result.notes.back(), Contains("12 of 240 values") && Contains("fewer than 5 frames"));
  REQUIRE_NOTHROW(dytex::validate(result.texture));
}

TEST_CASE("A mask's bits are what its frames show", "[dytex][missing]") {
  core::Clip mask{{3, 2, 3, CV_16U, 25, 65535, 70}, {}};
  for (int t = 0; t < 70; ++t) mask.frames.emplace_back(2, 3, CV_16UC3, cv::Scalar::all(t == 66 ? 65535 : 0));
  mask.frames[2].at<cv::Vec3w>(1, 2) = {65535, 65535, 65535};
  mask.frames[3].at<cv::Vec3w>(1, 2) = {65535, 65535, 65535};
  mask.frames[65].at<cv::Vec3w>(0, 0) = {32768, 32768, 32768};
  mask.frames[64].at<cv::Vec3w>(0, 0) = {32000, 32000, 32000};
  const auto missing = test::missing_of(mask, {3, 2, 1, CV_8U, 25, 255, 70});
  CHECK(missing.frames() == 70);
  CHECK(missing.hidden(5, 2));
  CHECK_FALSE(missing.hidden(4, 2));
  CHECK(missing.hidden(0, 65));
  CHECK_FALSE(missing.hidden(0, 64));
  CHECK(missing.all_hidden(66));
  CHECK(missing.all_seen(67));
  CHECK(missing.count(65) == 1);
  CHECK(missing.groups()[2] == missing.groups()[3]);
  CHECK(missing.groups()[3] != missing.groups()[4]);
  CHECK(missing.groups()[66] == -1);
  CHECK_FALSE(missing.by_frames());
  CHECK(dytex::Missing().by_frames());
  CHECK_FALSE(dytex::Missing().any());
}

TEST_CASE("Masks that do not fit are refused", "[dytex][missing]") {
  const core::Clip clip = test::wavy_clip(12, 10, 1, CV_8U, 8);
  const auto said = [&](const core::Clip& mask) {
    return test::message_of<core::InputError>([&] {
      core::ClipSource source(clip);
      dytex::learn_missing(source, test::missing_of(mask, clip.info), {.components = 2, .energy = {}});
    });
  };
  const auto none = [](int, int) { return false; };
  CHECK(said(test::mask_clip(10, 12, 8, none)) == "the mask is 10x12, the clip 12x10");
  CHECK(said(test::mask_clip(12, 10, 7, none)) == "the mask has 7 frames, the clip 8");
  CHECK(said(test::mask_clip(12, 10, 9, none)) == "the mask has 9 frames, the clip 8");
  CHECK(said(test::mask_clip(12, 10, 0, none)) == "the mask has no frames");
  CHECK(said(test::mask_clip(12, 10, 8, [](int, int) { return true; })) ==
        "the mask hides every pixel of every frame");
  CHECK_THAT(said(test::mask_clip(12, 10, 8, [](int, int t) { return t != 3; })),
             Contains("all frames but one"));
}
