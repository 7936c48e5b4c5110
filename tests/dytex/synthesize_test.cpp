// SPDX-License-Identifier: Apache-2.0
#include "dytex/synthesize.hpp"

#include <algorithm>
#include <array>
#include <limits>

#include "core/error.hpp"
#include "core/parallel.hpp"
#include "dytex/learn.hpp"
#include "dytex/synthesis/draw_frames.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/matrices.hpp"
#include "tests/support/messages.hpp"
#include "tests/support/reference_linalg.hpp"

using namespace emberfold;
using namespace emberfold::test;

namespace {

dytex::LinearDynamicTexture learned(int width = 40, int height = 30, int channels = 1) {
  const core::Clip clip = test::wavy_clip(width, height, channels, CV_8U, 50);
  core::ClipSource source(clip);
  return dytex::learn(source, {.components = 6, .energy = {}}).texture;
}

bool equal(const cv::Mat& a, const cv::Mat& b) {
  return a.size() == b.size() && a.type() == b.type() && cv::norm(a, b, cv::NORM_INF) == 0;
}

/// A system of three states whose noise has two inputs.
dytex::LinearDynamicTexture small_system() {
  dytex::LinearDynamicTexture texture;
  texture.info = {5, 3, 1, CV_8U, 25, 255, 4};
  texture.mean = Eigen::VectorXf::LinSpaced(15, 60, 200);
  texture.C = test::orthonormal(15, 3, 1).cast<float>();
  texture.A.resize(3, 3);
  texture.A << 0.8, -0.4, 0.1, 0.3, 0.7, 0, 0, 0.2, 0.5;
  texture.B.resize(3, 2);
  texture.B << 3, 0, 1, 2, 0, 1;
  texture.weights = Eigen::VectorXd::Ones(3);
  texture.states = test::normals(3, 4, 2);
  texture.singular = Eigen::Vector4d(4, 3, 2, 0);
  texture.r = 9;
  return texture;
}

}  // namespace

TEST_CASE("The stationary covariance solves its equation", "[dytex][synthesize]") {
  for (const double size : {0.0, 0.5, 0.99, 0.99999}) {
    Eigen::MatrixXd A = test::normals(6, 6, 4);
    A *= size / dytex::spectral_radius(A);
    const Eigen::MatrixXd B = test::normals(6, 4, 5), P = dytex::stationary_covariance(A, B);
    CHECK((P - A * P * A.transpose() - B * B.transpose()).norm() < 1e-11 * P.norm());
    CHECK(P == P.transpose());
  }
  CHECK_THROWS_AS(
      dytex::stationary_covariance(Eigen::MatrixXd::Identity(2, 2) * 1.01, Eigen::MatrixXd::Identity(2, 2)),
      core::NumericalError);
  CHECK_THROWS_AS(
      dytex::stationary_covariance(Eigen::MatrixXd::Identity(2, 2), Eigen::MatrixXd::Identity(2, 2)),
      core::NumericalError);
}

TEST_CASE("Synthesized states are stationary from the first frame on", "[dytex][synthesize]") {
  const dytex::LinearDynamicTexture texture = small_system();
  const Eigen::MatrixXd P = dytex::stationary_covariance(texture.A, texture.B);
  Eigen::MatrixXd first = Eigen::MatrixXd::Zero(3, 3), later = first, lag = first;
  constexpr int kClips = 6000;
  for (std::uint64_t seed = 0; seed < kClips; ++seed) {
    dytex::Synthesis synthesis(texture, {.seed = seed, .first_frame = {}});
    synthesis.next();
    const Eigen::VectorXd x0 = synthesis.state();
    synthesis.next();
    const Eigen::VectorXd x1 = synthesis.state();
    first += x0 * x0.transpose() / kClips;
    later += x1 * x1.transpose() / kClips;
    lag += x1 * x0.transpose() / kClips;
  }
  // The SD of an entry is at most √2 P_max / √6000 = 1.8 %.
  CHECK((first - P).cwiseAbs().maxCoeff() < 0.08 * P.maxCoeff());
  CHECK((later - P).cwiseAbs().maxCoeff() < 0.08 * P.maxCoeff());
  CHECK((lag - texture.A * P).cwiseAbs().maxCoeff() < 0.08 * P.maxCoeff());
}

TEST_CASE("A long clip has the model's covariance", "[dytex][synthesize]") {
  const dytex::LinearDynamicTexture texture = small_system();
  const Eigen::MatrixXd P = dytex::stationary_covariance(texture.A, texture.B);
  dytex::Synthesis synthesis(texture, {});
  Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(3, 3);
  constexpr int kLong = 60000;
  for (int t = 0; t < kLong; ++t) {
    synthesis.next();
    sum += synthesis.state() * synthesis.state().transpose() / kLong;
  }
  CHECK((sum - P).cwiseAbs().maxCoeff() < 0.05 * P.maxCoeff());
}

TEST_CASE("Frames are the states drawn and rounded", "[dytex][synthesize]") {
  for (const int channels : {1, 3}) {
    const dytex::LinearDynamicTexture texture = learned(40, 30, channels);
    dytex::Synthesis synthesis(texture, {.seed = 3, .first_frame = {}});
    for (int t = 0; t < 20; ++t) {
      const cv::Mat frame = synthesis.next();
      REQUIRE(frame.type() == CV_MAKETYPE(CV_8U, channels));
      cv::Mat exact;
      dytex::draw(texture, synthesis.state()).convertTo(exact, CV_32F);
      cv::Mat clipped = cv::min(cv::max(exact.reshape(1), 0.0), 255.0), shown;
      frame.reshape(1).convertTo(shown, CV_32F);
      CHECK(cv::norm(clipped, shown, cv::NORM_INF) < 0.5 + 1e-3);
    }
  }
}

TEST_CASE("A clip may begin with a training frame", "[dytex][synthesize]") {
  const dytex::LinearDynamicTexture texture = learned();
  dytex::Synthesis synthesis(texture, {.seed = 1, .first_frame = 17});
  synthesis.next();
  CHECK(synthesis.state() == texture.states.col(17));
  for (const int none : {-1, 50}) {
    CHECK(test::message_of<core::InputError>([&] {
            dytex::Synthesis(texture, {.seed = 1, .first_frame = none});
          }) == "first_frame is " + std::to_string(none) + "; allowed is 0 to 49");
  }
}

TEST_CASE("Synthesis gives the same bytes at any number of threads and others for other seeds",
          "[dytex][synthesize]") {
  const dytex::LinearDynamicTexture texture = learned(100, 70, 3);
  for (const bool noise : {false, true}) {
    const dytex::SynthesisOptions options{.seed = 5, .first_frame = {}, .pixel_noise = noise};
    const std::vector<cv::Mat> expected = drawn_frames(texture, options, 19);
    for (const std::size_t threads : {1, 2, 8}) {
      const core::ThreadLimit limit(threads);
      const std::vector<cv::Mat> found = drawn_frames(texture, options, 19);
      CHECK(std::equal(found.begin(), found.end(), expected.begin(), equal));
    }
    dytex::SynthesisOptions other = options;
    other.seed = 6;
    CHECK_FALSE(equal(drawn_frames(texture, other, 1)[0], expected[0]));
  }
}

TEST_CASE("Pixel noise has the variance that was left", "[dytex][synthesize]") {
  dytex::LinearDynamicTexture texture = learned(100, 80);
  texture.mean.setConstant(128);
  texture.r = 36;
  const std::vector<cv::Mat> without = drawn_frames(texture,
                                                    {.seed = 2, .first_frame = 1, .pixel_noise = false}, 10),
                             with = drawn_frames(texture, {.seed = 2, .first_frame = 1, .pixel_noise = true},
                                                 10);
  double products = 0;
  cv::Mat last;
  for (std::size_t t = 0; t < with.size(); ++t) {
    cv::Mat noise;
    cv::subtract(with[t], without[t], noise, cv::noArray(), CV_32F);
    cv::Scalar mean, deviation;
    cv::meanStdDev(noise, mean, deviation);
    CHECK_THAT(mean[0], WithinAbs(0, 0.35));
    CHECK_THAT(deviation[0], WithinRel(6.01, 0.04));  // and rounding
    if (!last.empty()) products = std::max(products, std::abs(noise.dot(last)) / (36.0 * 8000));
    last = noise;
  }
  CHECK(products < 0.06);  // frames' noises know nothing of each other
}

TEST_CASE("One step ahead is predicted as the definition says", "[dytex][synthesize]") {
  for (const int channels : {1, 3}) {
    const dytex::LinearDynamicTexture texture = learned(37, 23, channels);
    const core::Clip clip = test::wavy_clip(37, 23, channels, CV_8U, 3, 77);
    const cv::Mat levels = core::to_levels(clip.frames[1], clip.info);
    const Eigen::VectorXd y = test::levels_of(clip).col(1), mean = texture.mean.cast<double>();
    const Eigen::MatrixXd C = texture.C.cast<double>();
    const Eigen::VectorXd x = C.transpose() * (y - mean), expected = mean + C * (texture.A * x);
    CHECK((dytex::project(texture, levels) - x).norm() < 1e-5 * x.norm());
    const cv::Mat predicted = dytex::predict(texture, levels);
    REQUIRE(predicted.type() == CV_MAKETYPE(CV_32F, channels));
    const Eigen::VectorXd found =
        Eigen::Map<const Eigen::VectorXf>(predicted.ptr<float>(), y.size()).cast<double>();
    CHECK((found - expected).cwiseAbs().maxCoeff() < 1e-3);
    // The states of the clip that was learned from are its frames' projections.
    CHECK((dytex::project(texture, dytex::draw(texture, texture.states.col(4))) - texture.states.col(4))
              .norm() < 1e-3);
  }
}

TEST_CASE("Levels and states that do not fit are refused", "[dytex][synthesize]") {
  const dytex::LinearDynamicTexture texture = learned();
  CHECK(test::message_of<core::InputError>([&] { dytex::project(texture, cv::Mat(30, 41, CV_32F)); }) ==
        "levels are 41 × 30 of OpenCV's type 5, the texture needs 40 × 30 of type 5");
  CHECK_THROWS_AS(dytex::predict(texture, cv::Mat(30, 40, CV_8U)), core::InputError);
  CHECK(test::message_of<core::InputError>([&] { dytex::draw(texture, Eigen::VectorXd::Zero(7)); }) ==
        "the state has 7 numbers, the texture needs 6");
}

TEST_CASE("A model without components shows its mean", "[dytex][synthesize]") {
  const core::Clip clip = test::clip_of(Eigen::MatrixXd::Constant(12, 5, 77), 4, 3, 1, CV_8U);
  core::ClipSource source(clip);
  const dytex::LinearDynamicTexture texture = dytex::learn(source, {.components = 2, .energy = {}}).texture;
  for (const cv::Mat& frame : drawn_frames(texture, {}, 10)) CHECK(equal(frame, clip.frames[0]));
  CHECK(equal(dytex::predict(texture, core::to_levels(clip.frames[0], clip.info)),
              core::to_levels(clip.frames[0], clip.info)));
}

TEST_CASE("Weights scale what components show and nothing else", "[dytex][synthesize]") {
  dytex::LinearDynamicTexture texture = small_system();
  const Eigen::Vector3d state(10, -20, 30);
  texture.weights << 2, 0, -1;
  const cv::Mat drawn = dytex::draw(texture, state);
  texture.weights.setOnes();
  CHECK(equal(drawn, dytex::draw(texture, Eigen::Vector3d(20, 0, -30))));
}

TEST_CASE("A longer state goes on from what is expected beside the shown one", "[dytex][synthesize]") {
  // x(t+1) = A₁ x(t) + A₂ x(t−1) + B v(t), the state being (x(t), x(t−1)).
  dytex::LinearDynamicTexture texture = small_system();
  Eigen::MatrixXd A = Eigen::MatrixXd::Zero(6, 6);
  A.topLeftCorner(3, 3) = 0.5 * texture.A;
  A.topRightCorner(3, 3) = -0.4 * Eigen::Matrix3d::Identity();
  A.bottomLeftCorner(3, 3).setIdentity();
  texture.A = A;
  texture.B.conservativeResizeLike(Eigen::MatrixXd::Zero(6, 2));
  texture.states = test::normals(6, 4, 2);
  dytex::validate(texture);
  // The regression of x(t−1) on x(t), by the sum that the stationary covariance is.
  Eigen::MatrixXd covariance = Eigen::MatrixXd::Zero(6, 6), power = texture.B;
  for (int k = 0; k < 2000; ++k) {
    covariance += power * power.transpose();
    power = (A * power).eval();
  }
  const Eigen::Matrix3d regression =
      covariance.bottomLeftCorner(3, 3) * test::inverse(covariance.topLeftCorner(3, 3));
  const Eigen::Vector3d shown(10, -20, 30);
  const Eigen::VectorXd expected = dytex::expected_state(texture, shown);
  CHECK(expected.head(3) == shown);
  CHECK((expected.tail(3) - regression * shown).norm() < 1e-9 * shown.norm());
  const cv::Mat levels = dytex::draw(texture, shown);
  CHECK(cv::norm(dytex::predict(texture, levels), dytex::draw(texture, A * expected), cv::NORM_INF) < 1e-3);
  dytex::Synthesis synthesis(texture, {.seed = 1, .first_frame = 2, .pixel_noise = false});
  CHECK(synthesis.state() == texture.states.col(2));
  synthesis.next();
  const Eigen::VectorXd first = synthesis.state();
  synthesis.next();
  CHECK(synthesis.state().tail(3) == first.head(3));
}

TEST_CASE("Noise may differ from value to value", "[dytex][synthesize]") {
  dytex::LinearDynamicTexture texture = small_system();
  texture.mean.setConstant(128);
  texture.A.setZero();
  texture.B.setZero();
  texture.noise = Eigen::VectorXf::LinSpaced(15, 0, 400);
  dytex::Synthesis synthesis(texture, {.seed = 1, .first_frame = {}, .pixel_noise = true});
  Eigen::VectorXd squares = Eigen::VectorXd::Zero(15);
  constexpr int kDrawn = 4000;
  for (int t = 0; t < kDrawn; ++t) {
    const cv::Mat frame = synthesis.next();
    for (int p = 0; p < 15; ++p) {
      const double off = frame.data[p] - 128.0;
      squares[p] += off * off / kDrawn;
    }
  }
  CHECK(squares[0] == 0);
  for (int p = 1; p < 15; ++p) {
    const double variance = static_cast<double>(texture.noise[p]) + 1 / 12.0;  // and rounding
    CHECK(std::abs(squares[p] - variance) < 0.1 * variance);
  }
}

TEST_CASE("Levels become bytes as they are rounded elsewhere", "[dytex][synthesize]") {
  using dytex::detail::byte_of;
  for (const auto& [level, byte] : {std::pair{0.5F, 0},
                                    {1.5F, 2},
                                    {2.5F, 2},
                                    {-0.4F, 0},
                                    {-3.0F, 0},
                                    {254.5F, 254},
                                    {254.51F, 255},
                                    {300.0F, 255},
                                    {1e30F, 255},
                                    {-1e30F, 0}})
    CHECK(int{byte_of(level)} == byte);
  CHECK(byte_of(std::numeric_limits<float>::quiet_NaN()) == 0);
  for (int i = -20; i < 2600; ++i)
    CHECK(byte_of(static_cast<float>(i) / 10) == cv::saturate_cast<std::uint8_t>(static_cast<float>(i) / 10));
}

TEST_CASE("All instruction sets draw the same bits as the formula one by one", "[dytex][synthesize]") {
  using dytex::detail::Isa;
  for (const Eigen::Index m : {1, 15, 64, 333})
    for (const Eigen::Index n : {0, 1, 7, 50}) {
      const Eigen::VectorXf mean =
          100 * test::normals(m, 1, 1).cast<float>() + Eigen::VectorXf::Constant(m, 128);
      const Eigen::MatrixXf C = test::normals(m, n, 2).cast<float>();
      const Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> states =
          20 * test::normals(n, 8, 3).cast<float>();
      const dytex::detail::Batch batch{mean.data(), C.data(), m, n, states.data()};
      const Eigen::Index first = m / 5, count = m - first;
      for (const Isa isa : {Isa::baseline, Isa::avx2, Isa::avx512}) {
        if (isa > dytex::detail::best_isa()) continue;
        Eigen::MatrixXf levels = Eigen::MatrixXf::Constant(count, 8, -1);
        Eigen::Matrix<std::uint8_t, Eigen::Dynamic, Eigen::Dynamic> bytes(m, 8);
        bytes.setConstant(77);
        std::array<float*, 8> to_levels{};
        std::array<std::uint8_t*, 8> to_bytes{};
        for (std::size_t i = 0; i < 8; ++i) {
          to_levels[i] = levels.col(static_cast<Eigen::Index>(i)).data();
          to_bytes[i] = bytes.col(static_cast<Eigen::Index>(i)).data();
        }
        dytex::detail::draw_levels(batch, first, count, to_levels, isa);
        dytex::detail::draw_bytes(batch, first, count, to_bytes, isa);
        int wrong = 0;
        for (Eigen::Index f = 0; f < 8; ++f)
          for (Eigen::Index p = 0; p < m; ++p) {
            float level = mean[p];
            for (Eigen::Index k = 0; k < n; ++k) {
              const volatile float product = C(p, k) * states(k, f);
              level += product;
            }
            if (p < first) {
              wrong += bytes(p, f) != 77 ? 1 : 0;
            } else {
              wrong += levels(p - first, f) != level ? 1 : 0;
              wrong += bytes(p, f) != cv::saturate_cast<std::uint8_t>(level) ? 1 : 0;
            }
          }
        CHECK(wrong == 0);
      }
    }
}

TEST_CASE("A clip may set out from the mean", "[dytex][synthesize]") {
  const dytex::LinearDynamicTexture texture = learned();
  dytex::Synthesis synthesis(texture, {.seed = 1, .first_frame = {}, .from_mean = true});
  CHECK(equal(synthesis.next(), core::to_bytes(dytex::draw(texture, Eigen::VectorXd::Zero(6)))));
  CHECK(synthesis.state().norm() == 0);
  synthesis.next();
  CHECK(synthesis.state().norm() > 0);
}
