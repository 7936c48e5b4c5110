// SPDX-License-Identifier: Apache-2.0
#include "dytex/baselines/gaussian_texture.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <numbers>

#include <opencv2/core.hpp>

#include "core/rng.hpp"

namespace emberfold::dytex {

namespace {

constexpr float kMostPole = 0.99F;   // modulus; a wave decorrelates within some hundred frames
constexpr double kLeastPairs = 0.5;  // of pixels: counts are whole numbers up to the transform's rounding
// Turns 32 random bits, as a signed number, into one of variance 1: 2^-32 √12.
constexpr float kUniformScale = 0x1p-32F * 3.4641016F;
constexpr std::uint32_t kGaussianNoise = 0x7e87;  // of random streams

/// A size that transforms are fast at, of a frame and the lags beyond it.
cv::Size padded_size(cv::Size frame) {
  return {cv::getOptimalDFTSize(frame.width + kTextureReach),
          cv::getOptimalDFTSize(frame.height + kTextureReach)};
}

cv::Mat transformed(const cv::Mat& values, cv::Size size) {
  cv::Mat whole = cv::Mat::zeros(size, CV_64F), spectrum;
  cv::Mat corner = whole(cv::Rect({0, 0}, values.size()));
  values.convertTo(corner, CV_64F);
  cv::dft(whole, spectrum, 0, values.rows);
  return spectrum;
}

/// Index of a lag in a periodic table.
int wrap_lag(int lag, int length) {
  return ((lag % length) + length) % length;
}

template <class Visit>
void each_lag(const Visit& visit) {
  for (int y = -kTextureReach; y <= kTextureReach; ++y)
    for (int x = -kTextureReach; x <= kTextureReach; ++x) visit(x, y);
}

/// Returns the full transform of a table of lags on a frame of this size.
cv::Mat spectrum_of(const cv::Mat& lags, cv::Size size) {
  cv::Mat whole = cv::Mat::zeros(size, CV_32F), spectrum;
  each_lag([&](int x, int y) {
    whole.at<float>(wrap_lag(y, size.height), wrap_lag(x, size.width)) +=
        lags.at<float>(y + kTextureReach, x + kTextureReach);
  });
  cv::dft(whole, spectrum, cv::DFT_COMPLEX_OUTPUT);
  return spectrum;
}

std::complex<float> at_speed(std::complex<float> pole, float speed) {
  if (speed == 1) return pole;
  return std::polar(std::pow(std::abs(pole), std::abs(speed)), speed * std::arg(pole));
}

/// Packs a full spectrum of real numbers as cv::dft does.
cv::Mat pack_spectrum(const cv::Mat& full) {
  cv::Mat real, spectrum;
  cv::dft(full, real, cv::DFT_INVERSE | cv::DFT_SCALE | cv::DFT_REAL_OUTPUT);
  cv::dft(real, spectrum);
  return spectrum;
}

}  // namespace

GaussianTextureLearner::GaussianTextureLearner(cv::Size frame) : frame_(frame), padded_(padded_size(frame)) {
  for (auto* sum : {&within_, &within_count_, &ahead_, &ahead_count_}) *sum = cv::Mat::zeros(padded_, CV_64F);
}

void GaussianTextureLearner::sum_up(cv::Mat& sum, const cv::Mat& spectrum, const cv::Mat& other) const {
  cv::Mat product;
  cv::mulSpectrums(other, spectrum, product, 0, true);
  sum += product;
}

void GaussianTextureLearner::add(const cv::Mat& now, const cv::Mat& seen_now, const cv::Mat& next,
                                 const cv::Mat& seen_next) {
  std::array<cv::Mat, 2> values, masks;
  const std::array frames{&now, &next}, seen{&seen_now, &seen_next};
  for (std::size_t i = 0; i < frames.size(); ++i) {
    cv::Mat shown = cv::Mat::zeros(frame_, CV_32F);
    frames[i]->copyTo(shown, *seen[i]);
    values[i] = transformed(shown, padded_);
    masks[i] = transformed((*seen[i] != 0) / 255, padded_);
    sum_up(within_, values[i], values[i]);
    sum_up(within_count_, masks[i], masks[i]);
  }
  sum_up(ahead_, values[0], values[1]);
  sum_up(ahead_count_, masks[0], masks[1]);
}

GaussianTexture GaussianTextureLearner::learned() const {
  const auto means = [&](const cv::Mat& sums, const cv::Mat& counts) {
    cv::Mat sum, count, lags = cv::Mat::zeros(kTextureLags, kTextureLags, CV_32F);
    cv::dft(sums, sum, cv::DFT_INVERSE | cv::DFT_SCALE);
    cv::dft(counts, count, cv::DFT_INVERSE | cv::DFT_SCALE);
    each_lag([&](int x, int y) {
      const int row = wrap_lag(y, padded_.height), column = wrap_lag(x, padded_.width);
      const auto taper = [](int lag) {
        return (1 + std::cos(std::numbers::pi * lag / (kTextureReach + 1))) / 2;
      };
      if (std::abs(x) < frame_.width && std::abs(y) < frame_.height &&
          count.at<double>(row, column) > kLeastPairs)
        lags.at<float>(y + kTextureReach, x + kTextureReach) = static_cast<float>(
            taper(x) * taper(y) * sum.at<double>(row, column) / count.at<double>(row, column));
    });
    return lags;
  };
  return {means(within_, within_count_), means(ahead_, ahead_count_)};
}

GaussianTextureFrames::GaussianTextureFrames(const GaussianTexture& texture, cv::Size frame,
                                             std::uint64_t seed, std::uint32_t stream, double speed)
    : frame_(frame), padded_(padded_size(frame)), seed_(seed), stream_(stream) {
  using Complex = std::complex<float>;
  const cv::Mat power = spectrum_of(texture.within, padded_);
  cv::Mat pole = spectrum_of(texture.ahead, padded_), force(padded_, CV_32FC2), first(padded_, CV_32FC2);
  for (int y = 0; y < power.rows; ++y) {
    const auto* s = power.ptr<Complex>(y);
    auto *rho = pole.ptr<Complex>(y), *w = force.ptr<Complex>(y), *z = first.ptr<Complex>(y);
    for (int x = 0; x < power.cols; ++x) {
      const float strength = std::max(0.0F, s[x].real());  // a table of sample means may be a little off
      const float size = std::abs(rho[x]), kept = std::min(size, kMostPole * strength);
      rho[x] = strength > 0 && size > 0
                   ? at_speed(rho[x] * (kept / size / strength), static_cast<float>(speed))
                   : 0;
      w[x] = std::sqrt(strength * (1 - std::norm(rho[x])));
      z[x] = std::sqrt(strength);
    }
  }
  pole_ = pack_spectrum(pole), force_ = pack_spectrum(force);
  cv::mulSpectrums(white(), pack_spectrum(first), state_, 0);
}

cv::Mat GaussianTextureFrames::white() {
  core::Rng rng(seed_, {frames_, stream_, kGaussianNoise});
  cv::Mat noise(padded_, CV_32F), spectrum;
  // Uniform noise is enough: sums over many pixels are normal.
  for (int y = 0; y < noise.rows; ++y) {
    auto* row = noise.ptr<float>(y);
    for (int x = 0; x < noise.cols; ++x)
      row[x] = static_cast<float>(static_cast<std::int32_t>(rng.bits() ^ 0x80000000U)) * kUniformScale;
  }
  cv::dft(noise, spectrum);
  return spectrum;
}

cv::Mat GaussianTextureFrames::next() {
  if (frames_++ > 0) {
    cv::Mat driven;
    cv::mulSpectrums(white(), force_, driven, 0);
    cv::mulSpectrums(state_, pole_, state_, 0);
    state_ += driven;
  }
  cv::Mat values;
  cv::dft(state_, values, cv::DFT_INVERSE | cv::DFT_SCALE);
  return values(cv::Rect({0, 0}, frame_)).clone();
}

}  // namespace emberfold::dytex
