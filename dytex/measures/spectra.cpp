// SPDX-License-Identifier: Apache-2.0
#include "dytex/measures/spectra.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include <opencv2/core.hpp>

#include "core/error.hpp"
#include "core/parallel.hpp"
#include "core/text/size_text.hpp"
#include "dytex/measures/check_frames.hpp"

namespace emberfold::dytex {

namespace {

constexpr std::size_t kBlock = 4096;  // pixels whose spectra are summed at once

// Sampled in the middles of its steps, so that it vanishes nowhere; Σ w² = 3/8 length from length 3 on.
double hann(int i, int length) {
  const double s = std::sin(std::numbers::pi * (i + 0.5) / length);
  return s * s;
}

// Rows: cosine and sine of frequencies 1 … segment/2 under the window, scaled to the noise's variance,
// applied to a column of frames less its mean.
Eigen::MatrixXf segment_transform(int segment) {
  Eigen::MatrixXd rows(segment, segment);
  double energy = 0;
  for (int t = 0; t < segment; ++t) {
    const double w = hann(t, segment);
    energy += w * w;
    for (int k = 1; k <= segment / 2; ++k) {
      const double angle = 2 * std::numbers::pi * ((k * t) % segment) / segment;
      rows(2 * k - 2, t) = w * std::cos(angle);
      rows(2 * k - 1, t) = w * std::sin(angle);
    }
  }
  rows.colwise() -= rows.rowwise().mean().eval();
  return (rows / std::sqrt(energy)).cast<float>();
}

}  // namespace

TemporalSpectrum::TemporalSpectrum(cv::Size size, int segment) : size_(size), segment_(segment) {
  if (segment < 4 || segment > 1024 || segment % 2 != 0)
    throw core::InputError("temporal spectrum: segment is " + std::to_string(segment) +
                           "; allowed is an even number from 4 to 1024");
  if (size.width < 1 || size.height < 1)
    throw core::InputError("temporal spectrum: the size is " + core::size_text(size) +
                           "; allowed is at least 1x1");
  transform_ = segment_transform(segment);
  sum_ = Eigen::VectorXd::Zero(segment / 2);
}

void TemporalSpectrum::add(const cv::Mat& luma) {
  detail::check_luma(luma, "temporal spectrum");
  if (luma.size() != size_)
    throw core::InputError("temporal spectrum: a frame is " + core::size_text(luma.size()) +
                           ", those before it " + core::size_text(size_));
  frames_.push_back(luma.clone());
  if (frames_.size() < static_cast<std::size_t>(segment_)) return;
  close_segment();
  frames_.erase(frames_.begin(), frames_.begin() + segment_ / 2);
}

void TemporalSpectrum::close_segment() {
  const auto pixels = static_cast<std::size_t>(size_.area());
  const std::size_t blocks = (pixels + kBlock - 1) / kBlock;
  std::vector<Eigen::VectorXd> sums(blocks);
  core::parallel_for(blocks, {}, [&](std::size_t b) {
    const std::size_t first = b * kBlock;
    const auto count = static_cast<Eigen::Index>(std::min(kBlock, pixels - first));
    Eigen::MatrixXf values(count, segment_);
    for (int t = 0; t < segment_; ++t)
      values.col(t) =
          Eigen::Map<const Eigen::VectorXf>(frames_[static_cast<std::size_t>(t)].ptr<float>() + first, count);
    const Eigen::MatrixXf parts = values * transform_.transpose();
    const Eigen::VectorXd energy = parts.colwise().squaredNorm().transpose().eval().cast<double>();
    sums[b].resize(segment_ / 2);
    for (Eigen::Index k = 0; k < segment_ / 2; ++k) sums[b](k) = energy(2 * k) + energy(2 * k + 1);
  });
  for (const auto& sum : sums) sum_ += sum;
  ++segments_;
}

Eigen::VectorXd TemporalSpectrum::power() const {
  if (segments_ == 0)
    throw core::InputError("temporal spectrum: there are fewer frames than one segment of " +
                           std::to_string(segment_));
  return sum_ / (static_cast<double>(segments_) * size_.area());
}

Eigen::VectorXd temporal_spectrum(core::FrameSource& source, int segment, const core::Context& context) {
  const auto& info = source.info();
  TemporalSpectrum spectrum({info.width, info.height}, segment);
  source.rewind();
  for (cv::Mat frame = source.next(); !frame.empty(); frame = source.next()) {
    context.check();
    spectrum.add(core::luma(frame, info));
  }
  return spectrum.power();
}

int ring_count(cv::Size size) {
  return std::clamp(std::min(size.width, size.height) / 2, 1, 64);
}

Eigen::VectorXd radial_spectrum(const cv::Mat& luma, int rings) {
  detail::check_luma(luma, "radial spectrum");
  if (rings < 1 || rings > 4096)
    throw core::InputError("radial spectrum: rings is " + std::to_string(rings) + "; allowed is 1 to 4096");
  const int width = luma.cols, height = luma.rows;
  cv::Mat window(luma.size(), CV_64F);
  double total = 0, energy = 0, weighted = 0;
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const double w = hann(y, height) * hann(x, width);
      window.at<double>(y, x) = w;
      total += w, energy += w * w, weighted += w * static_cast<double>(luma.at<float>(y, x));
    }
  // Subtracts the mean as the window sees it, or its bright border would leak into the lowest rings.
  const double mean = weighted / total;
  cv::Mat values, spectrum;
  luma.convertTo(values, CV_64F);
  values = (values - mean).mul(window);
  cv::dft(values, spectrum, cv::DFT_COMPLEX_OUTPUT);

  Eigen::VectorXd sum = Eigen::VectorXd::Zero(rings), count = Eigen::VectorXd::Zero(rings);
  for (int v = 0; v < height; ++v)
    for (int u = 0; u < width; ++u) {
      const double fx = static_cast<double>(std::min(u, width - u)) / width;
      const double fy = static_cast<double>(std::min(v, height - v)) / height;
      // 1e-9: a frequency on a ring's outer edge belongs to it, however it is rounded.
      const double ring = std::ceil(2 * rings * std::hypot(fx, fy) - 1e-9) - 1;
      if (ring < 0 || ring >= rings) continue;
      const auto& z = spectrum.at<cv::Vec2d>(v, u);
      const auto i = static_cast<Eigen::Index>(ring);
      sum(i) += z[0] * z[0] + z[1] * z[1];
      count(i) += 1;
    }
  return (sum.array() / count.array().max(1.0) / energy).matrix();
}

Eigen::VectorXd radial_spectrum(core::FrameSource& source, int rings, const core::Context& context) {
  const auto& info = source.info();
  Eigen::VectorXd sum;
  int frames = 0;
  source.rewind();
  for (cv::Mat frame = source.next(); !frame.empty(); frame = source.next()) {
    context.check();
    const auto one = radial_spectrum(core::luma(frame, info), rings);
    sum = frames++ == 0 ? one : (sum + one).eval();
  }
  if (frames == 0) throw core::InputError("radial spectrum: there is no frame");
  return sum / frames;
}

double log_spectral_distance(const Eigen::Ref<const Eigen::VectorXd>& p,
                             const Eigen::Ref<const Eigen::VectorXd>& q, double floor) {
  if (p.size() != q.size() || p.size() == 0)
    throw core::InputError("log-spectral distance: the spectra have " + std::to_string(p.size()) + " and " +
                           std::to_string(q.size()) + " values; allowed is the same number, at least 1");
  if (!(floor > 0) || !std::isfinite(floor))
    throw core::InputError("log-spectral distance: the floor must be above 0");
  for (const auto& spectrum : {p, q})
    if (!spectrum.allFinite() || spectrum.minCoeff() < 0)
      throw core::InputError("log-spectral distance: a spectrum has a value that is negative or not finite");
  const Eigen::ArrayXd decibel = 10 * ((p.array() + floor) / (q.array() + floor)).log10();
  return std::sqrt(decibel.square().mean());
}

}  // namespace emberfold::dytex
