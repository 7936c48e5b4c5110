// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <deque>
#include <functional>
#include <sstream>

#include <opencv2/core.hpp>

#include "core/error.hpp"
#include "core/rng.hpp"
#include "core/text/size_text.hpp"
#include "dytex/baselines/star.hpp"
#include "dytex/baselines/star_waves.hpp"
#include "dytex/learning/decompositions.hpp"

namespace emberfold::dytex {

namespace {

constexpr double kMostRadius = 0.999;     // from here on a fit is scaled: it would vary for a thousand frames
constexpr double kScaledRadius = 0.998;   // spectral radius that it is scaled to
constexpr double kMostSamples = 1 << 16;  // pixels of all frames that least squares reads
constexpr double kRidge = 1e-9;           // of the mean square: separates neighbours that are always equal
constexpr int kResponseRows = 64, kResponseWidth = 129;  // px, of the impulse response that is examined
constexpr std::uint32_t kSamplePurpose = 0x57A1;         // of random streams

struct Mean {
  Eigen::VectorXd sum, squares;  // of a frame's values
  int frames = 0;
};

Eigen::Map<const Eigen::VectorXf> as_vector(const cv::Mat& levels) {
  return {levels.ptr<float>(),
          static_cast<Eigen::Index>(levels.total() * static_cast<std::size_t>(levels.channels()))};
}

Mean read_mean(core::FrameSource& source, const core::Context& context) {
  Mean mean;
  source.rewind();
  for (cv::Mat frame = source.next(); !frame.empty(); frame = source.next()) {
    context.check();
    const cv::Mat levels = core::to_levels(frame, source.info());
    const Eigen::VectorXd values = as_vector(levels).cast<double>();
    if (!values.allFinite()) throw core::InputError("STAR: a frame has a value that is not finite");
    if (mean.frames++ == 0)
      mean.sum = values, mean.squares = values.cwiseAbs2();
    else
      mean.sum += values, mean.squares += values.cwiseAbs2();
  }
  return mean;
}

// Frames less the mean, the newest last, and a value in them.
using Past = std::deque<cv::Mat>;

double value(const Past& past, int x, int y, int lag, int channel) {
  const cv::Mat& frame = past[past.size() - 1 - static_cast<std::size_t>(lag)];
  return static_cast<double>(frame.ptr<float>(y)[x * frame.channels() + channel]);
}

// Neighbours and the value itself of one channel of a pixel.
using Row = std::function<Eigen::VectorXd(const Past& past, int x, int y, int channel)>;

// Σ z zᵀ over the pixels taken, z the rows of every channel, one below the other.
struct Sums {
  Eigen::MatrixXd products;
  double count = 0;
};

// Pixels at least `margin` from the border.
void add_frame(const Past& past, int margin, std::size_t taken, core::Rng rng, const Row& row, Sums& sums) {
  const cv::Mat& now = past.back();
  const int width = now.cols - 2 * margin, height = now.rows - 2 * margin, channels = now.channels();
  const auto inner = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  Eigen::MatrixXd z(sums.products.rows(), static_cast<Eigen::Index>(std::min(taken, inner)));
  const Eigen::Index length = z.rows() / channels;
  for (Eigen::Index k = 0; k < z.cols(); ++k) {
    const auto pixel = static_cast<int>(taken >= inner ? static_cast<std::uint32_t>(k)
                                                       : rng.below(static_cast<std::uint32_t>(inner)));
    for (int c = 0; c < channels; ++c)
      z.col(k).segment(c * length, length) = row(past, margin + pixel % width, margin + pixel / width, c);
  }
  sums.products.selfadjointView<Eigen::Lower>().rankUpdate(z);
  sums.count += static_cast<double>(z.cols());
}

// Sums rows over the source; `length`: of a row.
Sums read_sums(core::FrameSource& source, const Star& star, int margin, Eigen::Index length, const Row& row,
               const core::Context& context) {
  const int lags = star.lags();
  const auto frames = static_cast<double>(*star.info.frames);
  const auto taken = static_cast<std::size_t>(std::ceil(kMostSamples / (frames - lags)));
  const auto size = length * star.info.channels;
  Sums sums{Eigen::MatrixXd::Zero(size, size)};
  Past past;
  source.rewind();
  std::uint32_t t = 0;
  for (cv::Mat frame = source.next(); !frame.empty(); frame = source.next(), ++t) {
    context.check();
    cv::Mat levels = core::to_levels(frame, source.info()).clone();
    Eigen::Map<Eigen::VectorXf>(levels.ptr<float>(), star.mean.size()) -= star.mean;
    past.push_back(levels);
    if (past.size() <= static_cast<std::size_t>(lags)) continue;
    add_frame(past, margin, taken, core::Rng(0, {t, 0, kSamplePurpose}), row, sums);
    past.pop_front();
    context.report("STAR", std::min(1.0, (t + 1.0) / frames));
  }
  sums.products = sums.products.selfadjointView<Eigen::Lower>();
  return sums;
}

// Returns the least-squares coefficients of each row's last value from its others, all channels together.
Eigen::VectorXd least_squares(const Sums& sums, int channels) {
  const Eigen::Index length = sums.products.rows() / channels, terms = length - 1;
  Eigen::MatrixXd gram = Eigen::MatrixXd::Zero(length, length);
  for (int c = 0; c < channels; ++c) gram += sums.products.block(c * length, c * length, length, length);
  Eigen::MatrixXd among = gram.topLeftCorner(terms, terms);
  const double size = among.trace() / static_cast<double>(terms);
  if (!(size > 0)) return Eigen::VectorXd::Zero(terms);
  among.diagonal().array() += kRidge * size;
  return detail::right_divide(gram.row(terms).head(terms), among).transpose();
}

// Returns the factor of the residual's covariance between channels.
Eigen::MatrixXd noise_factor(const Sums& sums, const Eigen::VectorXd& coefficients, int channels) {
  const Eigen::Index length = coefficients.size() + 1;
  Eigen::VectorXd left(length);
  left << -coefficients, 1;
  Eigen::MatrixXd covariance(channels, channels);
  for (int a = 0; a < channels; ++a)
    for (int b = 0; b < channels; ++b)
      covariance(a, b) = left.dot(sums.products.block(a * length, b * length, length, length) * left) /
                         std::max(1.0, sums.count);
  const Eigen::MatrixXd factor = detail::symmetric_factor(covariance);
  if (factor.cols() == 0) return Eigen::MatrixXd::Zero(channels, channels);
  // Lower triangular with the same covariance: the transposed R of its transposed factor.
  Eigen::MatrixXd square = Eigen::MatrixXd::Zero(channels, channels);
  square.leftCols(factor.cols()) = factor;
  return detail::triangular_factor(square.transpose()).transpose();
}

// Fits the prediction from the frames before, then the correlation within its residual.
void fit(core::FrameSource& source, int reach, Star& star, const core::Context& context) {
  const auto same = std::ranges::find_if(star.terms, [](const StarTerm& term) { return term.lag > 0; });
  const std::vector<StarTerm> here(star.terms.begin(), same), before(same, star.terms.end());
  const auto told = static_cast<Eigen::Index>(before.size()), beside = static_cast<Eigen::Index>(here.size());
  const auto first = read_sums(
      source, star, reach, told + 1,
      [&](const Past& past, int x, int y, int c) {
        Eigen::VectorXd row(told + 1);
        for (Eigen::Index i = 0; i < told; ++i) {
          const auto& term = before[static_cast<std::size_t>(i)];
          row(i) = value(past, x + term.x, y + term.y, term.lag, c);
        }
        row(told) = value(past, x, y, 0, c);
        return row;
      },
      context);
  const Eigen::VectorXd later = least_squares(first, star.info.channels);
  const auto left = [&](const Past& past, int x, int y, int c) {
    double e = value(past, x, y, 0, c);
    for (Eigen::Index i = 0; i < told; ++i) {
      const auto& term = before[static_cast<std::size_t>(i)];
      e -= later(i) * value(past, x + term.x, y + term.y, term.lag, c);
    }
    return e;
  };
  const auto second = read_sums(
      source, star, 2 * reach, beside + 1,
      [&](const Past& past, int x, int y, int c) {
        Eigen::VectorXd row(beside + 1);
        for (Eigen::Index i = 0; i < beside; ++i)
          row(i) =
              left(past, x + here[static_cast<std::size_t>(i)].x, y + here[static_cast<std::size_t>(i)].y, c);
        row(beside) = left(past, x, y, c);
        return row;
      },
      context);
  const Eigen::VectorXd alike = least_squares(second, star.info.channels);
  star.noise = noise_factor(second, alike, star.info.channels);
  star.coefficients.resize(beside + told);
  star.coefficients << alike, later;
}

// Variance of s in an endless frame under noise of variance 1.
double variance_gain(const Star& star) {
  double sum = 0;
  int waves = 0;
  detail::for_each_wave(star, [&](const detail::Wave& wave) {
    std::complex<double> now = wave.gain, before = 0;
    for (int i = 0; i < 8000 && std::norm(now) > 1e-12; ++i) {
      sum += std::norm(now);
      const auto next = wave.first * now + wave.second * before;
      before = now, now = next;
    }
    ++waves;
  });
  return sum / waves;
}

// Returns whether the impulse response of the filter within a frame does not decay over the rows below.
bool grows_downwards(const Star& star) {
  Eigen::MatrixXd response = Eigen::MatrixXd::Zero(kResponseRows, kResponseWidth);
  for (int y = 0; y < kResponseRows; ++y)
    for (int x = 0; x < kResponseWidth; ++x) {
      double value = y == 0 && x == kResponseWidth / 2 ? 1 : 0;
      for (std::size_t i = 0; i < star.terms.size(); ++i) {
        const auto& term = star.terms[i];
        const int u = x + term.x, v = y + term.y;
        if (term.lag == 0 && u >= 0 && u < kResponseWidth && v >= 0)
          value += star.coefficients(static_cast<Eigen::Index>(i)) * response(v, u);
      }
      response(y, x) = value;
    }
  return !response.allFinite() ||
         response.bottomRows(8).cwiseAbs().maxCoeff() >= response.topRows(8).cwiseAbs().maxCoeff();
}

void stabilise(double variance, StarResult& result) {
  auto& star = result.star;
  const auto scale = [&](double share, bool same_frame) {
    for (std::size_t i = 0; i < star.terms.size(); ++i) {
      const auto& term = star.terms[i];
      const int power = same_frame ? (term.lag == 0 ? std::abs(term.x) + std::abs(term.y) : 0) : term.lag;
      star.coefficients(static_cast<Eigen::Index>(i)) *= std::pow(share, power);
    }
  };
  bool changed = false;
  for (int round = 0; round < 200 && grows_downwards(star); ++round) scale(0.98, true), changed = true;
  if (changed)
    result.notes.emplace_back("disturbances grow from row to row: neighbours of the same frame are scaled");
  result.least_squares_radius = spectral_radius(star);
  if (result.least_squares_radius >= kMostRadius) {
    std::ostringstream note;
    note << "the fit is not stable (spectral radius " << result.least_squares_radius << "): it is scaled to "
         << kScaledRadius;
    result.notes.push_back(note.str());
    scale(kScaledRadius / result.least_squares_radius, false);
    changed = true;
  }
  const double drawn = variance_gain(star) * star.noise.squaredNorm() / star.info.channels;
  if (changed && drawn > 0) star.noise *= std::sqrt(variance / drawn);
}

}  // namespace

StarResult learn_star(core::FrameSource& source, const StarOptions& options, const core::Context& context) {
  options.validate();
  const auto& info = source.info();
  if (info.width < 4 * options.reach + 2 || info.height < 4 * options.reach + 2)
    throw core::InputError("STAR: frames of " + core::size_text(info.width, info.height) +
                           " are too small for a reach of " + std::to_string(options.reach));
  StarResult result;
  const auto mean = read_mean(source, context);
  if (mean.frames < options.lags + 2)
    throw core::InputError("STAR: " + std::to_string(mean.frames) + " frames are too few; " +
                           std::to_string(options.lags) + " lags need at least " +
                           std::to_string(options.lags + 2));
  auto& star = result.star;
  star.info = info, star.info.frames = mean.frames;
  const Eigen::VectorXd average = mean.sum / mean.frames;
  star.mean = average.cast<float>();
  star.terms = star_terms(options);
  fit(source, options.reach, star, context);
  const double variance = (mean.squares / mean.frames - average.cwiseAbs2()).cwiseMax(0.0).mean();
  stabilise(variance, result);
  return result;
}

}  // namespace emberfold::dytex
