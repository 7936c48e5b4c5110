// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <deque>
#include <sstream>

#include <opencv2/core.hpp>

#include "core/error.hpp"
#include "core/rng.hpp"
#include "dytex/decompose.hpp"
#include "dytex/star.hpp"
#include "dytex/star_waves.hpp"

namespace emberfold::dytex {

namespace {

constexpr double kUnstable = 0.999, kTaken = 0.998;
constexpr double kSamples = 1 << 16;  // pixels of all frames

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
  for (cv::Mat frame = source.next(); !frame.empty() && !context.cancelled(); frame = source.next()) {
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

// Σ z zᵀ of all pixels taken, z the neighbours and the value itself of every channel in turn.
struct Sums {
  Eigen::MatrixXd products;
  double count = 0;
};

void add_frame(const std::deque<cv::Mat>& past, const std::vector<StarTerm>& terms, int reach,
               std::size_t taken, core::Rng rng, Sums& sums) {
  const cv::Mat& now = past.back();
  const int channels = now.channels(), inner_width = now.cols - 2 * reach,
            inner_height = now.rows - 2 * reach;
  const auto inner = static_cast<std::size_t>(inner_width) * static_cast<std::size_t>(inner_height);
  const auto length = static_cast<Eigen::Index>(terms.size() + 1);
  Eigen::MatrixXd z(length * channels, static_cast<Eigen::Index>(std::min(taken, inner)));
  for (Eigen::Index k = 0; k < z.cols(); ++k) {
    const auto pixel =
        taken >= inner ? static_cast<std::uint32_t>(k) : rng.below(static_cast<std::uint32_t>(inner));
    const int x = reach + static_cast<int>(pixel) % inner_width,
              y = reach + static_cast<int>(pixel) / inner_width;
    for (int c = 0; c < channels; ++c) {
      for (Eigen::Index i = 0; i + 1 < length; ++i) {
        const auto& term = terms[static_cast<std::size_t>(i)];
        const cv::Mat& frame = past[past.size() - 1 - static_cast<std::size_t>(term.lag)];
        z(c * length + i, k) =
            static_cast<double>(frame.ptr<float>(y + term.y)[(x + term.x) * channels + c]);
      }
      z(c * length + length - 1, k) = static_cast<double>(now.ptr<float>(y)[x * channels + c]);
    }
  }
  sums.products.selfadjointView<Eigen::Lower>().rankUpdate(z);
  sums.count += static_cast<double>(z.cols());
}

Sums read_sums(core::FrameSource& source, const Star& star, int reach, const core::Context& context) {
  const auto& info = star.info;
  const int lags = star.lags();
  const double frames = static_cast<double>(*info.frames - lags);
  const auto taken = static_cast<std::size_t>(std::ceil(kSamples / frames));
  const auto size = static_cast<Eigen::Index>(star.terms.size() + 1) * info.channels;
  Sums sums{Eigen::MatrixXd::Zero(size, size)};
  std::deque<cv::Mat> past;
  source.rewind();
  std::uint32_t t = 0;
  for (cv::Mat frame = source.next(); !frame.empty() && !context.cancelled(); frame = source.next(), ++t) {
    cv::Mat levels = core::to_levels(frame, source.info()).clone();
    Eigen::Map<Eigen::VectorXf>(levels.ptr<float>(), star.mean.size()) -= star.mean;
    past.push_back(levels);
    if (past.size() <= static_cast<std::size_t>(lags)) continue;
    add_frame(past, star.terms, reach, taken, core::Rng(0, {t, 0, 0x57A1}), sums);
    past.pop_front();
    context.report("STAR", std::min(1.0, (t + 1.0) / (frames + lags)));
  }
  sums.products = sums.products.selfadjointView<Eigen::Lower>();
  return sums;
}

// The coefficients of least squared error, and the factor of what they leave.
void solve(const Sums& sums, Star& star) {
  const auto terms = static_cast<Eigen::Index>(star.terms.size()), length = terms + 1;
  const int channels = star.info.channels;
  Eigen::MatrixXd gram = Eigen::MatrixXd::Zero(length, length);
  for (int c = 0; c < channels; ++c)
    gram += sums.products.block(c * length, c * length, length, length);
  Eigen::MatrixXd among = gram.topLeftCorner(terms, terms);
  const double size = among.trace() / static_cast<double>(terms);
  star.coefficients = Eigen::VectorXd::Zero(terms);
  if (size > 0) {
    // A billionth keeps neighbours that always agree from standing against each other.
    among.diagonal().array() += 1e-9 * size;
    star.coefficients = detail::right_divide(gram.row(terms).head(terms), among).transpose();
  }
  Eigen::VectorXd left(length);
  left << -star.coefficients, 1;
  Eigen::MatrixXd covariance(channels, channels);
  for (int a = 0; a < channels; ++a)
    for (int b = 0; b < channels; ++b)
      covariance(a, b) = left.dot(sums.products.block(a * length, b * length, length, length) * left) /
                         std::max(1.0, sums.count);
  const Eigen::MatrixXd factor = detail::symmetric_factor(covariance);
  // Lower triangular with the same covariance: the transposed R of its transposed factor.
  star.noise = Eigen::MatrixXd::Zero(channels, channels);
  if (factor.cols() > 0) {
    Eigen::MatrixXd square = Eigen::MatrixXd::Zero(channels, channels);
    square.leftCols(factor.cols()) = factor;
    star.noise = detail::triangular_factor(square.transpose()).transpose();
  }
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

// Of a single frame's filter: whether what one pixel starts dies away over the rows below it.
bool grows_downwards(const Star& star) {
  constexpr int kRows = 64, kWidth = 129;
  Eigen::MatrixXd response = Eigen::MatrixXd::Zero(kRows, kWidth);
  for (int y = 0; y < kRows; ++y)
    for (int x = 0; x < kWidth; ++x) {
      double value = y == 0 && x == kWidth / 2 ? 1 : 0;
      for (std::size_t i = 0; i < star.terms.size(); ++i) {
        const auto& term = star.terms[i];
        const int u = x + term.x, v = y + term.y;
        if (term.lag == 0 && u >= 0 && u < kWidth && v >= 0)
          value += star.coefficients(static_cast<Eigen::Index>(i)) * response(v, u);
      }
      response(y, x) = value;
    }
  return !response.allFinite() ||
         response.bottomRows(8).cwiseAbs().maxCoeff() >= response.topRows(8).cwiseAbs().maxCoeff();
}

void steady(double variance, StarResult& result) {
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
    result.notes.emplace_back("the fit grows from row to row: its neighbours of the same frame are scaled");
  result.least_squares_radius = spectral_radius(star);
  if (result.least_squares_radius >= kUnstable) {
    std::ostringstream note;
    note << "the fit is not stable (spectral radius " << result.least_squares_radius << "): it is scaled to "
         << kTaken;
    result.notes.push_back(note.str());
    scale(kTaken / result.least_squares_radius, false);
    changed = true;
  }
  const double drawn = variance_gain(star) * star.noise.squaredNorm() / star.info.channels;
  if (changed && drawn > 0) star.noise *= std::sqrt(variance / drawn);
}

}  // namespace

StarResult learn_star(core::FrameSource& source, const StarOptions& options, const core::Context& context) {
  options.validate();
  const auto& info = source.info();
  if (info.width < 2 * options.reach + 2 || info.height < 2 * options.reach + 2)
    throw core::InputError("STAR: frames of " + std::to_string(info.width) + "x" +
                           std::to_string(info.height) + " are too small for a reach of " +
                           std::to_string(options.reach));
  StarResult result;
  const auto mean = read_mean(source, context);
  if (context.cancelled()) return {{}, 0, {}, core::Status::cancelled};
  if (mean.frames < options.lags + 2)
    throw core::InputError("STAR: " + std::to_string(mean.frames) + " frames are too few; " +
                           std::to_string(options.lags) + " lags need at least " +
                           std::to_string(options.lags + 2));
  auto& star = result.star;
  star.info = info, star.info.frames = mean.frames;
  const Eigen::VectorXd average = mean.sum / mean.frames;
  star.mean = average.cast<float>();
  star.terms = star_terms(options);
  const auto sums = read_sums(source, star, options.reach, context);
  if (context.cancelled()) return {{}, 0, {}, core::Status::cancelled};
  solve(sums, star);
  const double variance =
      (mean.squares / mean.frames - average.cwiseAbs2()).cwiseMax(0.0).mean();
  steady(variance, result);
  return result;
}

}  // namespace emberfold::dytex
