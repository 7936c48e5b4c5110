// SPDX-License-Identifier: Apache-2.0
// What drives a texture: noise of fewer directions than the state has, and noise that is not normal.
#include <cmath>
#include <numbers>

#include "core/error.hpp"
#include "dytex/distances/distances.hpp"
#include "dytex/editing/edit.hpp"
#include "dytex/estimation/forecast.hpp"
#include "dytex/learn.hpp"
#include "dytex/learning/independent_noise.hpp"
#include "dytex/model/archive.hpp"
#include "dytex/model/compression.hpp"
#include "dytex/synthesize.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/matrices.hpp"
#include "tests/support/messages.hpp"
#include "tests/support/reference_linalg.hpp"

using namespace emberfold;
using namespace emberfold::test;

namespace {

using dytex::LinearDynamicTexture;
using NoiseLaw = double (*)(core::Rng&);

constexpr int kDrivenWidth = 12, kDrivenHeight = 10;

double normal_law(core::Rng& rng) {
  return rng.normal();
}
/// Kurtosis 6.
double laplace_law(core::Rng& rng) {
  const double u = rng.uniform(-0.5, 0.5);
  return -std::copysign(std::log(1 - 2 * std::abs(u)), u) / std::numbers::sqrt2;
}
/// A spike of one sign in one frame of twelve, in normal noise a tenth as strong: skewed, kurtosis some 20.
double spike_law(core::Rng& rng) {
  const double spike = rng.uniform() < 1 / 12.0 ? 3.4 : 0;
  return spike - 3.4 / 12 + 0.1 * rng.normal();
}

/// A clip of levels driven by a system of four states and two inputs of variance 1.
struct Driven {
  Eigen::MatrixXd C, A, B;
  core::Clip clip;
};

Driven driven_clip(NoiseLaw law, int frames, double frame_noise = 0, std::uint64_t seed = 3) {
  constexpr Eigen::Index kValues = Eigen::Index{kDrivenWidth} * kDrivenHeight;
  Driven made;
  made.C = orthonormal(kValues, 4, 7);
  const auto turn = [](double radius, double angle) -> Eigen::Matrix2d {
    return radius * Eigen::Matrix2d{{std::cos(angle), -std::sin(angle)}, {std::sin(angle), std::cos(angle)}};
  };
  made.A = Eigen::MatrixXd::Zero(4, 4);
  made.A.topLeftCorner(2, 2) = turn(0.8, 0.9);
  made.A.bottomRightCorner(2, 2) = turn(0.7, 0.4);
  made.B = 30 * normals(4, 2, 8);
  core::Rng rng(seed);
  Eigen::VectorXd x = Eigen::VectorXd::Zero(4);
  Eigen::MatrixXd levels(kValues, frames);
  for (int t = -100; t < frames; ++t) {
    Eigen::Vector2d v;
    for (double& one : v) one = law(rng);
    x = (made.A * x + made.B * v).eval();
    if (t < 0) continue;
    levels.col(t) = (made.C * x).array() + 128;
    for (Eigen::Index p = 0; p < kValues && frame_noise > 0; ++p) levels(p, t) += frame_noise * rng.normal();
  }
  made.clip = clip_of(levels, kDrivenWidth, kDrivenHeight, 1, CV_32F);
  return made;
}

LinearDynamicTexture learned_from(const core::Clip& clip, int rank,
                                  dytex::Noise noise = dytex::Noise::normal) {
  core::ClipSource source(clip);
  dytex::LearnOptions options;
  options.components = 4;
  options.noise_rank = rank;
  options.noise = noise;
  return dytex::learn(source, options).texture;
}

/// What drove a clip drawn from the model, N × frames.
Eigen::MatrixXd drawn_innovations(const LinearDynamicTexture& texture, int frames) {
  dytex::Synthesis synthesis(texture, {});
  synthesis.next();
  Eigen::VectorXd before = synthesis.state();
  Eigen::MatrixXd result(texture.order(), frames);
  for (int t = 0; t < frames; ++t) {
    synthesis.next();
    result.col(t) = synthesis.state() - texture.A * before;
    before = synthesis.state();
  }
  return result;
}

/// The mean kurtosis of independent inputs of this covariance I, from (Σ v²)², whatever their rotation: E (Σ
/// v²)² = k (k − 1) + Σ kurtosis (Mardia 1970).
double mean_kurtosis(const Eigen::MatrixXd& v) {
  const auto k = static_cast<double>(v.rows());
  return (v.colwise().squaredNorm().array().square().mean() - k * (k - 1)) / k;
}

/// The kurtosis of what drove a clip, as a model learned of it sees it.
double clip_kurtosis(const core::Clip& clip) {
  return mean_kurtosis(learned_from(clip, 2, dytex::Noise::resampled).residuals);
}

core::Clip drawn_clip(const LinearDynamicTexture& texture, int frames) {
  dytex::Synthesis synthesis(texture, {});
  core::Clip clip{texture.info, {}};
  clip.info.depth = CV_8U;
  clip.info.white = 255;
  clip.info.frames = frames;
  for (int t = 0; t < frames; ++t) clip.frames.push_back(synthesis.next());
  return clip;
}

}  // namespace

TEST_CASE("Noise of two directions is found with rank two", "[dytex][noise]") {
  constexpr int kFrames = 900;
  const Driven truth = driven_clip(normal_law, kFrames);
  const LinearDynamicTexture texture = learned_from(truth.clip, 2);
  REQUIRE(texture.B.cols() == 2);
  CHECK(texture.B.rows() == 4);
  CHECK(texture.noise_share > 1 - 1e-5);  // the mean that was taken away moves a little, too
  // In the frames' coordinates, which the learned states share with the true ones.
  const Eigen::MatrixXd found = texture.C.cast<double>() * texture.B, real = truth.C * truth.B;
  const Eigen::MatrixXd span = orthonormal_columns(real);
  CHECK((found - span * (span.transpose() * found)).norm() < 1e-4 * found.norm());
  const Eigen::MatrixXd Q = found * found.transpose(), true_Q = real * real.transpose();
  CHECK((Q - true_Q).norm() < 5 / std::sqrt(double(kFrames)) * true_Q.norm());
  // What drives drawn clips lies there, too.
  const Eigen::MatrixXd drives = texture.C.cast<double>() * drawn_innovations(texture, 200);
  CHECK((drives - span * (span.transpose() * drives)).norm() < 1e-4 * drives.norm());
}

TEST_CASE("The rank's share is that of the strongest directions of the residuals", "[dytex][noise]") {
  const Driven truth = driven_clip(normal_law, 500, 6);
  const LinearDynamicTexture full = learned_from(truth.clip, 0);
  REQUIRE(full.B.cols() == 4);
  CHECK(full.noise_share == 1);
  const Eigen::MatrixXd Q = full.B * full.B.transpose();
  const Eigen::VectorXd values = symmetric_eigenvalues(Q);
  double sum = 0;
  for (int rank = 1; rank <= 4; ++rank) {
    CAPTURE(rank);
    const LinearDynamicTexture texture = learned_from(truth.clip, rank);
    REQUIRE(texture.B.cols() == rank);
    sum += values[4 - rank];
    CHECK_THAT(texture.noise_share, WithinRel(sum / values.sum(), 1e-9));
    // The best approximation of that rank (Eckart, Young 1936): what is left are the other eigenvalues.
    CHECK_THAT((Q - texture.B * texture.B.transpose()).norm(),
               WithinAbs(values.head(4 - rank).norm(), 1e-9 * values.norm()));
    CHECK(texture.A == full.A);
  }
}

TEST_CASE("All that a texture is for goes with noise of few directions", "[dytex][noise]") {
  const Driven truth = driven_clip(normal_law, 400, 3);
  const LinearDynamicTexture texture = learned_from(truth.clip, 2);
  CHECK(same(dytex::linear_dynamic_texture(dytex::to_archive(texture)), texture));
  // KL: another model of the same law is nearer than another system; of itself it is 0.
  const LinearDynamicTexture again = learned_from(driven_clip(normal_law, 400, 3, 77).clip, 2);
  LinearDynamicTexture other = texture;
  other.A *= 0.5;
  CHECK(dytex::kl_rate(texture, texture) == 0);
  CHECK(5 * dytex::kl_rate(again, texture) < dytex::kl_rate(other, texture));
  // Edits keep the states' covariance as they do of full noise.
  const Eigen::MatrixXd P = dytex::stationary_covariance(texture.A, texture.B);
  const std::vector<dytex::Edit> reversed{{dytex::Reverse{}}}, stronger{{dytex::Intensity{2.25}}};
  const auto back = dytex::edit(texture, reversed).texture;
  CHECK((dytex::stationary_covariance(back.A, back.B) - P).norm() < 1e-9 * P.norm());
  const auto strong = dytex::edit(texture, stronger).texture;
  CHECK(strong.B.cols() == 2);
  CHECK((dytex::stationary_covariance(strong.A, strong.B) - 2.25 * P).norm() < 1e-9 * P.norm());
  // A loop ends where it began, and a forecast widens to the stationary covariance.
  dytex::SynthesisOptions looped;
  looped.loop = 20;
  dytex::Synthesis loop(texture, looped);
  loop.next();
  const Eigen::VectorXd begin = loop.state();
  for (int t = 0; t < 20; ++t) loop.next();
  CHECK(loop.state() == begin);
  const auto forecast = dytex::forecast(texture, {texture.states.col(0), Eigen::MatrixXd::Zero(4, 4)}, 200);
  CHECK_THAT(forecast.error[199],
             WithinRel(std::sqrt(P.trace() / double(texture.pixels()) + texture.r), 1e-6));
  CHECK(dytex::rounded(texture, dytex::Precision::f16).B == texture.B);
  CHECK(dytex::stored_bytes(texture, 4, dytex::Precision::f32) + 8 * 2 * 4 ==
        dytex::stored_bytes(learned_from(truth.clip, 0), 4, dytex::Precision::f32));
}

TEST_CASE("A rank of the noise that cannot be is refused, one above all is told", "[dytex][noise]") {
  const Driven truth = driven_clip(normal_law, 60);
  core::ClipSource source(truth.clip);
  dytex::LearnOptions options;
  options.components = 4;
  for (const int bad : {-1, 5}) {
    options.noise_rank = bad;
    CHECK(message_of<core::InputError>([&] { dytex::learn(source, options); }) ==
          "LearnOptions.noise_rank is " + std::to_string(bad) + "; allowed is 0 to 4");
  }
  options.energy = 0.5;
  options.noise_rank = -1;
  CHECK(
      message_of<core::InputError>([&] { options.validate(); }).starts_with("LearnOptions.noise_rank is -1"));
  options.noise_rank = 5;
  const auto learned = dytex::learn(source, options);
  REQUIRE(learned.texture.B.cols() < 5);
  CHECK(std::ranges::any_of(learned.notes, [](const std::string& note) {
    return note.find("5 were asked for: all are kept") != std::string::npos;
  }));
  CHECK(learned.texture.noise_share == 1);
}

TEST_CASE("Independent inputs are found in their mixture", "[dytex][noise]") {
  // Three that are not normal, two that are, mixed by a rotation.
  constexpr Eigen::Index kInputs = 5, kSamples = 2000;
  core::Rng rng(4);
  Eigen::MatrixXd sources(kInputs, kSamples);
  for (Eigen::Index t = 0; t < kSamples; ++t)
    sources.col(t) << laplace_law(rng), spike_law(rng), rng.normal(), rng.uniform(-1.7, 1.7), rng.normal();
  sources.colwise() -= sources.rowwise().mean().eval();
  const Eigen::MatrixXd covariance = sources * sources.transpose() / double(kSamples);
  const Eigen::MatrixXd white = inverse(cholesky_factor(covariance)) * sources;
  const Eigen::MatrixXd mixing = orthonormal(kInputs, kInputs, 6);
  const auto found = dytex::detail::independent_noise(mixing * white);
  REQUIRE(found.has_value());
  REQUIRE(found->marginals.rows() == 3);
  CHECK((found->turn * found->turn.transpose()).isIdentity(1e-10));
  // Each is one of the three sources, up to sign, and each another.
  const Eigen::MatrixXd matched = (found->turn * mixing).cwiseAbs().topRows(3);
  for (Eigen::Index i = 0; i < 3; ++i) {
    Eigen::Index source = 0;
    CHECK(matched.row(i).maxCoeff(&source) > 0.98);
    CHECK((source == 0 || source == 1 || source == 3));
    CHECK(matched.col(source).maxCoeff() == matched(i, source));
  }
  for (const auto& row : found->marginals.rowwise()) {
    const Eigen::Index gaps = row.size() - 1;
    const Eigen::ArrayXd low = row.head(gaps).transpose().array(), high = row.tail(gaps).transpose().array();
    CHECK((low <= high).all());
    CHECK_THAT((low + high).mean() / 2, WithinAbs(0, 1e-12));
    CHECK_THAT((low.square() + low * high + high.square()).mean() / 3, WithinRel(1.0, 1e-12));
  }
}

TEST_CASE("Normal noise is hardly ever taken for another", "[dytex][noise]") {
  // At most one clip in twenty; of forty, four or more by chance in one of seven.
  int alarms = 0;
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    Eigen::MatrixXd v = normals(6, 240, seed);
    v.colwise() -= v.rowwise().mean().eval();
    v = (inverse(cholesky_factor(v * v.transpose() / double(v.cols()))) * v).eval();
    if (dytex::detail::independent_noise(v)) ++alarms;
  }
  CHECK(alarms <= 3);
}

TEST_CASE("The gain over the normal law is that of the laws themselves", "[dytex][noise]") {
  // The divergence of a Laplace law from the normal of its variance is log(2π)/2 + 1/2 − 1 − log(2)/2 nats.
  constexpr Eigen::Index kSamples = 40000;
  core::Rng rng(8);
  Eigen::VectorXd first(kSamples), second(kSamples);
  for (double& x : first) x = laplace_law(rng);
  for (double& x : second) x = laplace_law(rng);
  const double expected = std::log(2 * std::numbers::pi) / 2 - 0.5 - std::log(2.0) / 2;
  CHECK_THAT(dytex::detail::gain_over_normal(first, second) / double(kSamples), WithinAbs(expected, 0.01));
  for (double& x : first) x = rng.normal();
  for (double& x : second) x = rng.normal();
  CHECK_THAT(dytex::detail::gain_over_normal(first, second) / double(kSamples), WithinAbs(0, 1e-3));
}

TEST_CASE("A texture driven by spikes keeps their kurtosis", "[dytex][noise]") {
  constexpr int kFrames = 600;
  for (const NoiseLaw law : {&laplace_law, &spike_law}) {
    const core::Clip clip = driven_clip(law, kFrames).clip;
    const double source = clip_kurtosis(clip);
    const auto independent = learned_from(clip, 2, dytex::Noise::independent);
    const auto normal = learned_from(clip, 2);
    REQUIRE(independent.marginals.rows() == 2);
    CHECK(independent.A == normal.A);
    // The same covariance, turned.
    CHECK((independent.B * independent.B.transpose() - normal.B * normal.B.transpose()).norm() <
          1e-12 * normal.B.squaredNorm());
    const double kept = clip_kurtosis(drawn_clip(independent, kFrames));
    const double lost = clip_kurtosis(drawn_clip(normal, kFrames));
    CAPTURE(source, kept, lost);
    CHECK(source > 4.5);
    CHECK_THAT(kept, WithinRel(source, 0.25));
    CHECK_THAT(lost, WithinAbs(3, 0.3));
  }
}

TEST_CASE("Of normal noise the model is the same to the bit", "[dytex][noise]") {
  const core::Clip clip = driven_clip(normal_law, 500).clip;
  CHECK(same(learned_from(clip, 2, dytex::Noise::independent), learned_from(clip, 2)));
  core::ClipSource source(clip);
  dytex::LearnOptions options;
  options.components = 4;
  options.noise = dytex::Noise::independent;
  const auto learned = dytex::learn(source, options);
  CHECK(std::ranges::any_of(learned.notes, [](const std::string& note) {
    return note.find("cannot be told from normal noise") != std::string::npos;
  }));
}

TEST_CASE("Marginals come back from their archive, and broken ones are refused", "[dytex][noise]") {
  const auto texture = learned_from(driven_clip(laplace_law, 700).clip, 2, dytex::Noise::independent);
  REQUIRE(texture.marginals.size() > 0);
  const core::ModelArchive archive = dytex::to_archive(texture);
  CHECK(archive.text.find("\"version\": 3") != std::string::npos);
  CHECK(same(dytex::linear_dynamic_texture(archive), texture));
  CHECK(same(dytex::rounded(texture, dytex::Precision::f32), texture));
  // A model without them is of version 2, which programs before this one read.
  LinearDynamicTexture plain = texture;
  plain.marginals.resize(0, 0);
  const core::ModelArchive old = dytex::to_archive(plain);
  CHECK(old.text.find("\"version\": 2") != std::string::npos);
  CHECK(same(dytex::linear_dynamic_texture(old), plain));
  const auto reason = [&](const std::function<void(core::ModelArchive&)>& spoil) {
    core::ModelArchive broken = archive;
    spoil(broken);
    return message_of<core::IoError>([&] { dytex::linear_dynamic_texture(broken); });
  };
  const auto say = [](core::ModelArchive& a, const std::string& from, const std::string& to) {
    a.text.replace(a.text.find(from), from.size(), to);
  };
  CHECK(reason([&](auto& a) { a.arrays.erase("marginals"); }) == "model: the array marginals is missing");
  CHECK(reason([&](auto& a) {
          say(a, "\"marginals\": 2", "\"marginals\": 3");
        }).starts_with("model: \"marginals\" is \"3\", must be a whole number from 1 to 2"));
  CHECK(reason([&](auto& a) {
          say(a, "\"quantiles\": ", "\"quantiles\": 1");
        }).starts_with("model: the array marginals has the shape"));
  CHECK(reason([&](auto& a) {
          say(a, "\"version\": 3", "\"version\": 4");
        }).starts_with("model: version 4 is newer than 3"));
  CHECK(reason([&](auto& a) { std::get<std::vector<double>>(a.arrays.at("marginals").data)[1] = 1e9; }) ==
        "model: texture: marginals has a row that falls");
  LinearDynamicTexture both = texture;
  both.residuals = normals(2, 5, 1);
  CHECK(message_of<core::InputError>([&] {
          dytex::validate(both);
        }).starts_with("texture: marginals are there beside residuals"));
  both = texture;
  both.noise_share = 0;
  CHECK(
      message_of<core::InputError>([&] { dytex::validate(both); }).starts_with("texture: noise_share is 0"));
}
