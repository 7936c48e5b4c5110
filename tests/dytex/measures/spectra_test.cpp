// SPDX-License-Identifier: Apache-2.0
#include "dytex/measures/spectra.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <numeric>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "core/error.hpp"
#include "core/rng.hpp"
#include "tests/dytex/baselines/made_waves.hpp"
#include "tests/support/catch.hpp"

using namespace emberfold;
using namespace emberfold::dytex;
using namespace emberfold::test;

namespace {

constexpr int kSegment = 32;

struct Spectra {
  Eigen::VectorXd temporal, radial;
};
Spectra spectra(const core::Clip& clip) {
  core::ClipSource source(clip);
  return {temporal_spectrum(source, kSegment),
          radial_spectrum(source, ring_count({clip.info.width, clip.info.height}))};
}

}  // namespace

TEST_CASE("white noise has a flat spectrum at its variance") {
  const double deviation = 7;
  const auto made = spectra(white_noise(64, 48, 128, deviation, 3));
  REQUIRE(made.temporal.size() == kSegment / 2);
  // 7 segments of 3072 pixels: some 1 % of chance, in the last frequency, a real one, half as much again
  CHECK_THAT(made.temporal(0), WithinRel(deviation * deviation * 5 / 6, 0.03));
  for (Eigen::Index k = 1; k < made.temporal.size(); ++k)
    CHECK_THAT(made.temporal(k), WithinRel(deviation * deviation, 0.04));
  for (Eigen::Index i = 2; i < made.radial.size(); ++i)
    CHECK_THAT(made.radial(i), WithinRel(deviation * deviation, 0.08));
}

TEST_CASE("a sinusoid in time stands at its frequency with its power") {
  const int k = 5;
  const double amplitude = 20;
  auto clip = empty_clip(6, 5);
  for (int t = 0; t < 80; ++t) {
    cv::Mat frame(5, 6, CV_32F);
    for (int y = 0; y < 5; ++y)
      for (int x = 0; x < 6; ++x)
        frame.at<float>(y, x) = static_cast<float>(
            100 + amplitude * std::cos(2 * std::numbers::pi * k * t / kSegment + x + 2.0 * y));
    clip.frames.push_back(frame);
  }
  core::ClipSource source(clip);
  const auto power = temporal_spectrum(source, kSegment);
  const double peak = amplitude * amplitude * kSegment / 6;
  for (int i = 1; i <= kSegment / 2; ++i)
    CHECK_THAT(power(i - 1), WithinAbs(i == k ? peak : std::abs(i - k) == 1 ? peak / 4 : 0.0, 1e-3 * peak));
}

TEST_CASE("a sinusoid in space of any direction stands in its ring") {
  const int side = 64, rings = 32;
  for (const auto& [u, v] : {std::pair{10, 0}, {0, 10}, {6, 8}, {8, -6}}) {
    cv::Mat frame(side, side, CV_32F);
    for (int y = 0; y < side; ++y)
      for (int x = 0; x < side; ++x)
        frame.at<float>(y, x) =
            static_cast<float>(90 + 30 * std::sin(2 * std::numbers::pi * (u * x + v * y) / side));
    const auto power = radial_spectrum(frame, rings);
    Eigen::Index peak = 0;
    power.maxCoeff(&peak);
    CHECK(peak == 9);  // 10/64 cycles a pixel: (9, 10] of 32 rings up to 1/2
    CHECK(power(9) > 1e6 * (power(2) + power(20)));
  }
}

TEST_CASE("what stands still has no power in time and what is flat none in space") {
  const auto noise = white_noise(20, 20, 1, 30, 5);
  auto still = empty_clip(20, 20);
  still.frames.assign(40, noise.frames[0]);
  core::ClipSource source(still);
  CHECK(temporal_spectrum(source, kSegment).maxCoeff() < 1e-6);
  CHECK(radial_spectrum(cv::Mat(20, 31, CV_32F, cv::Scalar(200)), 10).maxCoeff() < 1e-12);
}

TEST_CASE("the power agrees with its definition written out") {
  const int segment = 8;
  const auto clip = white_noise(3, 2, 19, 40, 9);  // segments at 0, 4 and 8; three frames are left over
  core::ClipSource source(clip);
  const auto power = temporal_spectrum(source, segment);
  REQUIRE(power.size() == segment / 2);
  const auto window = [&](int i) { return 0.5 - 0.5 * std::cos(2 * std::numbers::pi * (i + 0.5) / segment); };
  for (int k = 1; k <= segment / 2; ++k) {
    double total = 0, energy = 0;
    for (int i = 0; i < segment; ++i) energy += window(i) * window(i);
    for (const int first : {0, 4, 8})
      for (int p = 0; p < 6; ++p) {
        const auto value = [&](int i) {
          return static_cast<double>(
              clip.frames[static_cast<std::size_t>(first + i)].at<float>(p / 3, p % 3));
        };
        double mean = 0;
        for (int i = 0; i < segment; ++i) mean += value(i) / segment;
        std::complex<double> sum = 0;
        for (int i = 0; i < segment; ++i)
          sum += window(i) * (value(i) - mean) * std::polar(1.0, -2 * std::numbers::pi * k * i / segment);
        total += std::norm(sum);
      }
    CHECK_THAT(power(k - 1), WithinRel(total / energy / 18, 1e-5));
  }
}

TEST_CASE("a distance of spectra is 0 for equals and symmetric and counts decibels") {
  const Eigen::VectorXd p = Eigen::VectorXd::LinSpaced(9, 1, 500);
  CHECK(log_spectral_distance(p, p) == 0);
  const Eigen::VectorXd tenfold = 10 * p;
  CHECK_THAT(log_spectral_distance(p, tenfold, 1e-12), WithinAbs(10, 1e-9));
  CHECK(log_spectral_distance(p, tenfold) == log_spectral_distance(tenfold, p));
  const Eigen::VectorXd none = Eigen::VectorXd::Zero(4), little = Eigen::VectorXd::Constant(4, kRounding);
  CHECK_THAT(log_spectral_distance(none, little), WithinAbs(10 * std::log10(2.0), 1e-12));
}

TEST_CASE("each way to get a texture wrong is told in its own way", "[heavy]") {
  const int frames = 192;
  const auto source = waves(frames, 11);
  const auto truth = spectra(source);
  const auto distance = [&](const core::Clip& clip) {
    const auto other = spectra(clip);
    return std::pair{log_spectral_distance(truth.temporal, other.temporal),
                     log_spectral_distance(truth.radial, other.radial)};
  };
  const auto [sample_time, sample_space] = distance(waves(frames, 12));
  INFO("another sample: " << sample_time << " dB in time, " << sample_space << " dB in space");
  CHECK(sample_time < 1.5);
  CHECK(sample_space < 1.5);
  const auto check = [&](const char* what, const core::Clip& clip, double least_time, double most_time,
                         double least_space, double most_space) {
    const auto [time, space] = distance(clip);
    INFO(what << ": " << time << " dB in time, " << space << " dB in space");
    CHECK(time >= least_time);
    CHECK(time <= most_time);
    CHECK(space >= least_space);
    CHECK(space <= most_space);
  };
  cv::Mat mean(64, 64, CV_32F, cv::Scalar(0));
  for (const auto& frame : source.frames) mean += frame / frames;
  check("mean image", changed(source, [&](std::size_t) { return mean; }), 15, 100, 8, 100);
  check("frozen", changed(source, [&](std::size_t) { return source.frames[40]; }), 15, 100, 0, 4);
  std::vector<std::size_t> order(frames);
  std::iota(order.begin(), order.end(), 0);
  core::Rng rng(2);
  for (std::size_t i = frames; i-- > 1;)
    std::swap(order[i], order[rng.below(static_cast<std::uint32_t>(i + 1))]);
  check("shuffled", changed(source, [&](std::size_t t) { return source.frames[order[t]]; }), 5, 100, 0, 1e-9);
  const auto longer = waves(2 * frames, 12);
  check("double speed", changed(source, [&](std::size_t t) { return longer.frames[2 * t]; }), 3, 100, 0, 1.5);
  check("blurred",
        changed(source,
                [&](std::size_t t) {
                  cv::Mat blurred;
                  cv::GaussianBlur(source.frames[t], blurred, {}, 2);
                  return blurred;
                }),
        1.5, 100, 5, 100);
}

TEST_CASE("measures refuse what they cannot measure") {
  CHECK_THROWS_AS(TemporalSpectrum({8, 8}, 3), core::InputError);
  CHECK_THROWS_AS(TemporalSpectrum({8, 8}, 33), core::InputError);
  CHECK_THROWS_AS(TemporalSpectrum({8, 8}, 2048), core::InputError);
  CHECK_THROWS_AS(TemporalSpectrum({0, 8}, 32), core::InputError);
  TemporalSpectrum spectrum({8, 8}, 4);
  CHECK_THROWS_AS(spectrum.power(), core::InputError);
  CHECK_THROWS_AS(spectrum.add(cv::Mat(8, 9, CV_32F)), core::InputError);
  CHECK_THROWS_AS(spectrum.add(cv::Mat(8, 8, CV_8U)), core::InputError);
  CHECK_THROWS_AS(radial_spectrum(cv::Mat(8, 8, CV_32FC3), 4), core::InputError);
  CHECK_THROWS_AS(radial_spectrum(cv::Mat(8, 8, CV_32F), 0), core::InputError);
  const Eigen::VectorXd p = Eigen::VectorXd::Ones(3), q = Eigen::VectorXd::Ones(4), none;
  CHECK_THROWS_AS(log_spectral_distance(p, q), core::InputError);
  CHECK_THROWS_AS(log_spectral_distance(none, none), core::InputError);
  CHECK_THROWS_AS(log_spectral_distance(p, -p), core::InputError);
  CHECK_THROWS_AS(log_spectral_distance(p, p, 0), core::InputError);
  const Eigen::VectorXd lost = p * std::nan("");
  CHECK_THROWS_AS(log_spectral_distance(p, lost), core::InputError);
}

TEST_CASE("the smallest frames have spectra too") {
  for (const auto& size : {cv::Size{1, 1}, {1, 7}, {2, 2}, {3, 2}}) {
    const auto clip = white_noise(size.width, size.height, 8, 9, 4);
    core::ClipSource source(clip);
    const auto radial = radial_spectrum(source, ring_count(size));
    CHECK(radial.size() == 1);
    CHECK(radial.allFinite());
    CHECK(temporal_spectrum(source, 4).allFinite());
  }
  CHECK(ring_count({352, 288}) == 64);
  CHECK(ring_count({40, 30}) == 15);
}
