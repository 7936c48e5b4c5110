// SPDX-License-Identifier: Apache-2.0
// EM in n dimensions against a plain step over all values, and against what is known to be true.
#include "dytex/estimation/em.hpp"

#include <algorithm>
#include <cmath>

#include "core/error.hpp"
#include "core/parallel.hpp"
#include "dytex/estimation/em_appearance.hpp"
#include "dytex/estimation/em_dynamics.hpp"
#include "dytex/estimation/observations.hpp"
#include "tests/dytex/estimation/em_make.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/messages.hpp"
#include "tests/support/reference_linalg.hpp"

using namespace emberfold;
using namespace emberfold::test;

namespace {

void check_near(const Eigen::MatrixXd& found, const Eigen::MatrixXd& truth, double share = 1e-9) {
  CHECK((found - truth).norm() <= share * truth.norm());
}

void check_dynamics(const dytex::StateSpace& found, const test::PlainStep& truth) {
  check_near(found.A, truth.space.A);
  check_near(found.B * found.B.transpose(), truth.Q);
  check_near(found.first, truth.space.first);
  check_near(found.first_factor * found.first_factor.transpose(), truth.first_covariance);
}

dytex::LinearDynamicTexture learned(const core::Clip& clip, int n) {
  core::ClipSource source(clip);
  return dytex::learn(source, {.components = n, .energy = {}}).texture;
}

dytex::EmResult improved(const core::Clip& clip, const dytex::LinearDynamicTexture& start,
                         const dytex::EmOptions& options = {}, const dytex::Missing& missing = {}) {
  core::ClipSource source(clip);
  return dytex::maximise_likelihood(source, start, options, missing);
}

void check_never_falls(const std::vector<double>& log_likelihood) {
  for (std::size_t i = 1; i < log_likelihood.size(); ++i) {
    INFO("iteration " << i);
    CHECK(log_likelihood[i] >= log_likelihood[i - 1] - 1e-10 * std::abs(log_likelihood[i]));
  }
}

}  // namespace

TEST_CASE("A step from the Gram matrix equals a plain step over all values", "[dytex][em]") {
  const Eigen::Index m = 12, n = 3, frames = 9;
  for (const bool gap : {false, true}) {
    std::vector<Eigen::Index> seen_frames;
    Eigen::MatrixXd seen = Eigen::MatrixXd::Ones(m, frames);
    for (Eigen::Index t = 0; t < frames; ++t) {
      if (gap && (t == 3 || t == 4)) {
        seen.col(t).setZero();
      } else {
        seen_frames.push_back(t);
      }
    }
    Eigen::MatrixXd Y = 6 * test::normals(m, frames, 1);
    Y.array() *= seen.array();
    Y.colwise() -= (Y.rowwise().sum() / static_cast<double>(seen_frames.size())).eval();
    const Eigen::MatrixXd part = Y(Eigen::all, seen_frames), gram = part.transpose() * part;
    const auto count = static_cast<Eigen::Index>(seen_frames.size());

    Eigen::MatrixXd W = test::normals(count, n, 2) / 10;
    double r = 1.5;
    dytex::StateSpace space{0.3 * test::normals(n, n, 3), test::normals(n, n, 4), test::normals(n, 1, 5),
                            test::normals(n, n, 6)};
    for (int step = 0; step < 3; ++step) {
      INFO("gap " << gap << ", step " << step);
      const test::Look look{part * W, Eigen::VectorXd::Zero(m), Eigen::VectorXd::Constant(m, r)};
      const auto observations = dytex::detail::gram_observations(
          W.transpose() * gram * W, W.transpose() * gram, gram.diagonal(), m, r, seen_frames, frames);
      const dytex::Filtered filtered = dytex::filter(space, observations);
      const dytex::Smoothed smoothed = dytex::smooth(space, filtered);
      const auto dense = test::dense_gaussian(space, look, Y, seen);
      CHECK_THAT(filtered.log_likelihood, WithinRel(dense.log_likelihood, 1e-9));
      const auto plain = test::plain_em_step(dense, look, Y, seen, false, false);
      const auto model = dytex::detail::maximise_gram(gram, m, seen_frames, smoothed, 1e-9);
      space = dytex::detail::maximise_dynamics(smoothed);
      check_dynamics(space, plain);
      check_near(part * model.W, plain.look.C);
      CHECK_THAT(model.r, WithinRel(plain.look.noise[0], 1e-9));
      W = model.W, r = model.r;
    }
  }
}

TEST_CASE("A step over hidden values and noise by place equals a plain step", "[dytex][em]") {
  const int width = 4, height = 3, channels = 3;
  const Eigen::Index m = 36, n = 2, frames = 12;
  const core::Clip clip = test::clip_of((20 * test::normals(m, frames, 1).array() + 120).matrix(), width,
                                        height, channels, CV_32F);
  const Eigen::MatrixXd Y = test::levels_of(clip);
  for (const bool hidden : {false, true}) {
    for (const bool per_value : {false, true}) {
      if (!hidden && !per_value) continue;  // the Gram matrix's
      INFO("hidden " << hidden << ", noise per value " << per_value);
      Eigen::MatrixXd seen = Eigen::MatrixXd::Ones(m, frames);
      core::Rng rng(2);
      const core::Clip mask = test::mask_clip(width, height, frames, [&](int p, int t) {
        const bool hide = t == 5 || rng.uniform() < (t == 7 ? 0.8 : 0.3);
        if (hide && hidden) seen.col(t).segment(3 * p, 3).setZero();
        return hide;
      });
      const dytex::Missing missing = hidden ? test::missing_of(mask, clip.info) : dytex::Missing();
      dytex::LinearDynamicTexture start;
      start.mean = (test::normals(m, 1, 3).array() + 120).matrix().cast<float>();
      start.C = test::orthonormal(m, n, 4).cast<float>();
      start.r = 30;
      dytex::StateSpace space{0.4 * test::normals(n, n, 5), 20 * test::normals(n, n, 6),
                              test::normals(n, 1, 7), 20 * test::normals(n, n, 8)};
      test::Look look{start.C.cast<double>(), start.mean.cast<double>(), Eigen::VectorXd::Constant(m, 30)};

      core::ClipSource source(clip);
      const core::Context context;
      dytex::EmOptions options;
      options.noise_per_value = per_value;
      options.least_noise = 1e-6;
      // One block of every frame at a time makes no difference here: the frames are smaller than that.
      dytex::detail::FrameBlocks frame_blocks(source, options.memory, 100, context);
      const auto appearance =
          dytex::detail::value_appearance({frame_blocks, missing, start, options, context, {255, channels}});
      dytex::Observations found = appearance->observe();
      for (int step = 0; step < 3; ++step) {
        INFO("step " << step);
        const auto plain = test::plain_observations(look, Y, seen);
        check_near(found.vectors, plain.vectors);
        check_near(found.squares, plain.squares);
        check_near(found.constants, plain.constants);
        const auto dense = test::dense_gaussian(space, look, Y, seen);
        const auto filtered = dytex::filter(space, found);
        CHECK_THAT(filtered.log_likelihood, WithinRel(dense.log_likelihood, 1e-9));
        const auto smoothed = dytex::smooth(space, filtered);
        const auto next = test::plain_em_step(dense, look, Y, seen, per_value, hidden);
        space = dytex::detail::maximise_dynamics(smoothed);
        check_dynamics(space, next);
        found = appearance->maximise(smoothed);
        look = next.look;
        check_near(appearance->products(), look.C.transpose() * look.C);
        CHECK_THAT(appearance->r(), WithinRel(look.noise.mean(), 1e-9));
      }
    }
  }
}

TEST_CASE("Likelihood never falls and stops where it no longer grows", "[dytex][em]") {
  const auto known = test::known_clip(600, 60, 9, 1);
  const core::Clip clip = test::clip_of(known.levels, 30, 20, 1, CV_8U);
  const auto start = learned(clip, 4);
  const core::Clip mask = test::mask_clip(30, 20, 60, [](int p, int t) { return (p * 7 + t * 13) % 10 < 3; });
  const core::Clip gaps = test::mask_clip(30, 20, 60, [](int, int t) { return t % 9 == 4; });
  const dytex::Missing none, pixels = test::missing_of(mask, clip.info),
                             frames = test::missing_of(gaps, clip.info);
  for (const auto* missing : {&none, &pixels, &frames}) {
    for (const bool per_value : {false, true}) {
      dytex::EmOptions options;
      options.noise_per_value = per_value;
      options.iterations = 40;
      options.tolerance = 1e-6;
      const auto result = improved(clip, start, options, *missing);
      INFO("per value " << per_value);
      CHECK(result.converged);
      CHECK(result.log_likelihood.size() < 41);
      CHECK(result.log_likelihood.size() > 2);
      check_never_falls(result.log_likelihood);
      REQUIRE_NOTHROW(dytex::validate(result.texture));
      CHECK((result.texture.noise.size() > 0) == per_value);
      const Eigen::MatrixXd C = result.texture.C.cast<double>();
      CHECK((C.transpose() * C - Eigen::MatrixXd::Identity(4, 4)).norm() < 1e-5);
      const Eigen::VectorXd energy = result.texture.states.rowwise().squaredNorm();
      CHECK(std::is_sorted(energy.begin(), energy.end(), std::greater<>()));

      // The likelihood is that of the texture, but for where it begins.
      auto as_likely = result.texture;
      const float correction = static_cast<float>(result.likelihood_r / result.texture.r);
      as_likely.r = result.likelihood_r;
      as_likely.noise *= correction;
      core::ClipSource source(clip);
      const double again =
          dytex::filter(dytex::state_space(as_likely), dytex::observe(as_likely, source, *missing, {}, 1e-9))
              .log_likelihood;
      CHECK_THAT(again, WithinAbs(result.log_likelihood.back(), 30));
    }
  }
}

TEST_CASE("A known system is found by EM where the closed form is biased", "[dytex][em]") {
  const auto known = test::known_clip(400, 400, 36, 4, 20);
  const core::Clip clip = test::clip_of(known.levels, 20, 20, 1, CV_32F);
  const auto start = learned(clip, 4);
  dytex::EmOptions options;
  options.iterations = 200;
  options.tolerance = 1e-10;
  const auto result = improved(clip, start, options);
  check_never_falls(result.log_likelihood);
  const auto& texture = result.texture;
  INFO("closed form " << test::eigenvalue_error(start.A, known.A) << ", EM "
                      << test::eigenvalue_error(texture.A, known.A));
  CHECK(test::eigenvalue_error(texture.A, known.A) < 0.03);
  CHECK(test::eigenvalue_error(texture.A, known.A) < 0.7 * test::eigenvalue_error(start.A, known.A));
  const Eigen::MatrixXd turn = texture.C.cast<double>().transpose() * known.C;
  CHECK(test::singular_values(turn).minCoeff() > 0.97);
  // Q = 400 diag(1, .81, .64, .49) in the true basis
  const Eigen::VectorXd drive = 400 * Eigen::Vector4d(1, 0.81, 0.64, 0.49);
  const Eigen::MatrixXd Q = turn * drive.asDiagonal() * turn.transpose();
  CHECK((texture.B * texture.B.transpose() - Q).norm() < 0.2 * Q.norm());
  CHECK((start.B * start.B.transpose() - Q).norm() > (texture.B * texture.B.transpose() - Q).norm());
  check_near(texture.C.cast<double>() * texture.states,
             known.clean.array() - known.levels.rowwise().mean().replicate(1, 400).array(), 0.2);
}

TEST_CASE("The bias of r is taken out", "[dytex][em]") {
  const auto known = test::known_clip(2000, 40, 4, 11);
  const core::Clip clip = test::clip_of(known.levels, 50, 40, 1, CV_32F);
  const auto start = learned(clip, 4);
  for (const bool per_value : {false, true}) {
    dytex::EmOptions options;
    options.noise_per_value = per_value;
    options.least_noise = 1e-3;
    const auto result = improved(clip, start, options);
    CHECK_THAT(result.likelihood_r, WithinRel(4.0 * 35 / 40, 0.02));
    CHECK_THAT(result.texture.r, WithinRel(4.0, 0.02));
    if (per_value) CHECK_THAT(result.texture.noise.cast<double>().mean(), WithinRel(result.texture.r, 1e-5));
  }
}

TEST_CASE("Noise by place finds where the noise is", "[dytex][em]") {
  auto known = test::known_clip(600, 150, 1, 21);
  const Eigen::MatrixXd more = test::normals(300, 150, 22);
  known.levels.bottomRows(300) += 6 * more;  // the lower half: a variance of 37
  const core::Clip clip = test::clip_of(known.levels, 30, 20, 1, CV_32F);
  const auto start = learned(clip, 4);
  dytex::EmOptions options;
  const auto plain = improved(clip, start, options);
  options.noise_per_value = true;
  const auto result = improved(clip, start, options);
  CHECK_THAT(static_cast<double>(result.texture.noise.head(300).mean()), WithinRel(1.0, 0.05));
  CHECK_THAT(static_cast<double>(result.texture.noise.tail(300).mean()), WithinRel(37.0, 0.05));
  const auto miss = [&](const dytex::LinearDynamicTexture& texture) {
    const Eigen::MatrixXd shown =
        (texture.C.cast<double>() * texture.states).colwise() + texture.mean.cast<double>();
    return (shown - known.clean).topRows(300).norm();
  };
  CHECK(miss(result.texture) < 0.7 * miss(plain.texture));  // where there is little noise
}

TEST_CASE("An unstable A becomes a stable one and a note", "[dytex][em]") {
  const core::Clip clip = test::flaring_clip(0.3);
  const auto result = improved(clip, learned(clip, 2));
  CHECK(dytex::spectral_radius(result.texture.A) < 1);
  REQUIRE(result.notes.size() == 1);
  CHECK_THAT(result.notes[0], Contains("not stable") && Contains("Yule-Walker"));
  check_never_falls(result.log_likelihood);
}

TEST_CASE("Two hundred iterations at fifty components stay finite", "[dytex][em][slow]") {
  const core::Clip clip = test::wavy_clip(24, 20, 1, CV_8U, 75);
  dytex::EmOptions options;
  options.iterations = 200;
  options.tolerance = 0;
  const auto result = improved(clip, learned(clip, 50), options);
  check_never_falls(result.log_likelihood);
  CHECK(result.log_likelihood.size() > 2);
  REQUIRE_NOTHROW(dytex::validate(result.texture));
}

TEST_CASE("EM gives the same bytes at any number of threads", "[dytex][em]") {
  const core::Clip clip = test::wavy_clip(167, 101, 3, CV_8U, 24);
  const auto start = learned(clip, 5);
  const core::Clip mask =
      test::mask_clip(167, 101, 24, [](int p, int t) { return (p * 31 + t * 17) % 23 < 5; });
  const dytex::Missing missing = test::missing_of(mask, clip.info);
  for (const bool hidden : {false, true}) {
    dytex::EmOptions options;
    options.iterations = 3;
    const auto run = [&] { return improved(clip, start, options, hidden ? missing : dytex::Missing()); };
    const auto once = run();
    for (const std::size_t threads : {1, 8}) {
      const core::ThreadLimit limit(threads);
      CHECK(test::same(run().texture, once.texture));
    }
    options.memory = std::size_t{1} << 20;  // the frames do not fit
    const auto in_blocks = run();
    CHECK(in_blocks.passes > once.passes);
    CHECK_THAT(in_blocks.log_likelihood.back(), WithinRel(once.log_likelihood.back(), 1e-11));
    check_near(in_blocks.texture.states, once.texture.states, 1e-7);
  }
}

TEST_CASE("What EM cannot take is named", "[dytex][em]") {
  const core::Clip clip = test::wavy_clip(12, 10, 1, CV_8U, 20);
  const auto start = learned(clip, 3);
  const auto said = [&](const dytex::LinearDynamicTexture& from, const dytex::EmOptions& options,
                        const core::Clip& of) {
    return test::message_of<core::InputError>([&] { improved(of, from, options); });
  };
  dytex::EmOptions options;
  options.iterations = 0;
  CHECK(said(start, options, clip) == "EmOptions.iterations is 0; allowed is 1 to 1e+05");
  options = {};
  options.tolerance = -1;
  CHECK(said(start, options, clip) == "EmOptions.tolerance is -1; allowed is 0 to 1");
  options = {};
  options.least_noise = 0;
  CHECK(said(start, options, clip) == "EmOptions.least_noise is 0; allowed is above 0");
  CHECK_THAT(said(start, {}, test::wavy_clip(12, 11, 1, CV_8U, 20)), Contains("12x10") && Contains("12x11"));
  CHECK_THAT(said(start, {}, test::wavy_clip(12, 10, 1, CV_8U, 19)), Contains("20 frames") && Contains("19"));
  auto edited = start;
  edited.weights[1] = 0.5;
  CHECK_THAT(said(edited, {}, clip), Contains("edited"));
  core::Clip broken = test::wavy_clip(12, 10, 1, CV_32F, 20);
  broken.frames[7].at<float>(3, 2) = std::nanf("");
  CHECK_THAT(said(start, {}, broken), Contains("frame 7") && Contains("not finite"));
  core::Clip still{{8, 6, 1, CV_8U, 25, 255, 5}, {}};
  for (int t = 0; t < 5; ++t) still.frames.emplace_back(6, 8, CV_8U, cv::Scalar(9));
  const auto of_still = improved(still, learned(still, 2));
  CHECK(of_still.texture.components() == 0);
  CHECK_THAT(of_still.notes.at(0), Contains("do not change"));
  std::stop_source stop;
  stop.request_stop();
  core::ClipSource source(clip);
  CHECK_THROWS_AS(dytex::maximise_likelihood(source, start, {}, {}, core::Context(stop.get_token())),
                  core::Cancelled);
}
