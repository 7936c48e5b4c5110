// SPDX-License-Identifier: Apache-2.0
#include "dytex/synthesis/loop.hpp"

#include <algorithm>

#include "core/error.hpp"
#include "dytex/synthesize.hpp"
#include "tests/dytex/distances/systems.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/messages.hpp"
#include "tests/support/reference_linalg.hpp"

using namespace emberfold;
using namespace emberfold::test;
using Eigen::MatrixXd;

namespace {

dytex::SynthesisOptions loop_of(int length, std::uint64_t seed = 1) {
  return {.seed = seed, .first_frame = {}, .loop = length};
}

/// Frames of all states by the noise of all frames, stacked: what loop_states does as one matrix.
MatrixXd response(const dytex::LinearDynamicTexture& texture, Eigen::Index length) {
  const Eigen::Index k = texture.B.cols();
  MatrixXd result(texture.order() * length, k * length);
  for (Eigen::Index i = 0; i < k * length; ++i) {
    MatrixXd noise = MatrixXd::Zero(k, length);
    noise(i % k, i / k) = 1;
    result.col(i) = dytex::detail::loop_states(texture.A, texture.B, noise).reshaped();
  }
  return result;
}

}  // namespace

TEST_CASE("The covariance on a circle solves its equations", "[dytex][loop]") {
  const dytex::LinearDynamicTexture texture = test::random_texture(3, 0.9, 4, 2);
  const MatrixXd P = test::covariance(texture);
  for (const int length : {1, 2, 5, 12}) {
    // x(t+1) − A x(t) = B v(t) of all frames at once.
    MatrixXd system = MatrixXd::Identity(3 * length, 3 * length),
             input = MatrixXd::Zero(3 * length, 2 * length);
    for (int t = 0; t < length; ++t) {
      system.block<3, 3>(3 * ((t + 1) % length), 3 * t) -= texture.A;
      input.block<3, 2>(3 * ((t + 1) % length), 2 * t) = texture.B;
    }
    const MatrixXd G = test::inverse(system) * input;
    const MatrixXd found = dytex::detail::loop_covariance(texture.A, P, length);
    for (int t = 0; t < length; ++t)
      CHECK(apart(found, G.middleRows(3 * t, 3) * G.middleRows(3 * t, 3).transpose()) < 1e-11);
  }
  const MatrixXd one = MatrixXd::Constant(1, 1, 0.9), p = MatrixXd::Constant(1, 1, 2);
  CHECK_THAT(dytex::detail::loop_covariance(one, p, 10)(0, 0),
             WithinRel(2 * (1 + std::pow(0.9, 10)) / (1 - std::pow(0.9, 10)), 1e-12));
}

TEST_CASE("Every frame of a loop has the endless clip's covariance and every step is alike",
          "[dytex][loop]") {
  for (const Eigen::Index inputs : {4, 2}) {
    const dytex::LinearDynamicTexture texture = test::random_texture(4, 0.97, 4, inputs);
    const MatrixXd P = test::covariance(texture);
    for (const Eigen::Index length : {1, 3, 20, 200}) {
      if (inputs * length < 4) continue;  // too little noise for all directions
      const MatrixXd G = response(texture, length);
      MatrixXd step;
      for (Eigen::Index t = 0; t < length; ++t) {
        const auto now = G.middleRows(4 * t, 4), next = G.middleRows(4 * ((t + 1) % length), 4);
        CHECK(apart(now * now.transpose(), P) < 1e-7);
        const MatrixXd lag = next * now.transpose();
        if (t == 0) step = lag;
        CHECK(apart(lag, step) < 1e-7);
      }
      if (length == 200) CHECK(apart(step, texture.A * P) < 0.02);
    }
  }
}

TEST_CASE("A loop begins again to the byte", "[dytex][loop]") {
  dytex::LinearDynamicTexture texture = test::random_texture(6, 0.95, 3);
  texture.B *= 20;
  for (const bool noise : {false, true})
    for (const int length : {1, 2, 7, 8, 20, 33}) {
      dytex::SynthesisOptions options = loop_of(length);
      options.pixel_noise = noise;
      const std::vector<cv::Mat> drawn = drawn_frames(texture, options, 2 * length + 5);
      for (std::size_t t = static_cast<std::size_t>(length); t < drawn.size(); ++t)
        CHECK(cv::norm(drawn[t], drawn[t - static_cast<std::size_t>(length)], cv::NORM_INF) == 0);
      if (length > 1) CHECK(cv::norm(drawn[0], drawn[1], cv::NORM_INF) > 0);
    }
  const cv::Mat one = drawn_frames(texture, loop_of(9, 1), 1)[0],
                other = drawn_frames(texture, loop_of(9, 2), 1)[0];
  CHECK(cv::norm(one, other, cv::NORM_INF) > 0);
}

TEST_CASE("The step over a loop's seam is no larger than others", "[dytex][loop]") {
  dytex::LinearDynamicTexture texture = test::random_texture(6, 0.995, 3);
  texture.B *= 5;
  int largest = 0;
  constexpr int kLoops = 60, kLength = 12;
  for (std::uint64_t seed = 0; seed < kLoops; ++seed) {
    const std::vector<cv::Mat> drawn = drawn_frames(texture, loop_of(kLength, seed), kLength + 1);
    std::vector<double> steps;
    for (std::size_t t = 0; t < kLength; ++t) steps.push_back(cv::norm(drawn[t], drawn[t + 1], cv::NORM_L2));
    largest += steps.back() == *std::ranges::max_element(steps) ? 1 : 0;
  }
  CHECK(largest <= 13);  // 5 are expected, SD 2.1
}

TEST_CASE("Loops that cannot be are refused", "[dytex][loop]") {
  const dytex::LinearDynamicTexture texture = test::random_texture(3, 0.9, 1);
  const auto refused = [&](const dytex::SynthesisOptions& options) {
    return test::message_of<core::InputError>([&] { dytex::Synthesis(texture, options); });
  };
  CHECK(refused(loop_of(-1)) == "SynthesisOptions.loop is -1; allowed is 0 to 1000000");
  CHECK(refused({.seed = 1, .first_frame = 2, .loop = 5})
            .starts_with("SynthesisOptions.loop is 5, and a loop"));
  CHECK(refused({.seed = 1, .first_frame = 2, .from_mean = true}).starts_with("SynthesisOptions.from_mean"));
}

TEST_CASE("A loop without noise stands still", "[dytex][loop]") {
  dytex::LinearDynamicTexture texture = test::random_texture(3, 0.9, 1);
  texture.B.setZero();
  const std::vector<cv::Mat> drawn = drawn_frames(texture, loop_of(4), 5);
  for (const cv::Mat& frame : drawn) CHECK(cv::norm(frame, drawn[0], cv::NORM_INF) == 0);
}
