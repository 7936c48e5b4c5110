// SPDX-License-Identifier: Apache-2.0
#include "dytex/baselines/star.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <utility>

#include <opencv2/core.hpp>

#include "core/error.hpp"
#include "core/parallel.hpp"
#include "core/rng.hpp"
#include "core/text/check_range.hpp"
#include "dytex/baselines/star_waves.hpp"

namespace emberfold::dytex {

namespace {

constexpr int kWarmUpFrames = 64;  // drawn and not shown, so that a clip does not begin at the mean
constexpr std::uint32_t kStarNoise = 0x57A2;  // of random streams

int reach_of(const Star& star) {
  int reach = 0;
  for (const auto& term : star.terms) reach = std::max({reach, std::abs(term.x), std::abs(term.y)});
  return reach;
}

// Returns a frame's planes, one below the other, each with a border of zeros: a neighbour outside is 0.
cv::Mat padded(cv::Size size, int channels, int reach) {
  return cv::Mat::zeros(channels * (size.height + 2 * reach), size.width + 2 * reach, CV_32F);
}

cv::Mat plane(const cv::Mat& planes, int channel, int channels) {
  const int rows = planes.rows / channels;
  return planes.rowRange(channel * rows, (channel + 1) * rows);
}

// Makes one plane of the next frame: `out` holds a (or 0) inside its border and becomes s.
void step_plane(const Star& star, int reach, const std::vector<cv::Mat>& past, cv::Mat out) {
  const int width = out.cols - 2 * reach;
  const auto coefficient = [&](std::size_t i) {
    return static_cast<float>(star.coefficients(static_cast<Eigen::Index>(i)));
  };
  for (int y = reach; y < out.rows - reach; ++y) {  // a becomes e
    float* row = out.ptr<float>(y) + reach;
    std::vector<std::pair<int, float>> left;
    for (std::size_t i = 0; i < star.terms.size(); ++i) {
      const auto& term = star.terms[i];
      if (term.lag > 0) continue;
      if (term.y == 0) {
        left.emplace_back(term.x, coefficient(i));
        continue;
      }
      const float c = coefficient(i), *from = out.ptr<float>(y + term.y) + reach + term.x;
      for (int x = 0; x < width; ++x) row[x] += c * from[x];
    }
    for (int x = 0; x < width; ++x)
      for (const auto& [dx, c] : left) row[x] += c * row[x + dx];
  }
  for (int y = reach; y < out.rows - reach; ++y) {  // and e becomes s
    float* row = out.ptr<float>(y) + reach;
    for (std::size_t i = 0; i < star.terms.size(); ++i) {
      const auto& term = star.terms[i];
      if (term.lag == 0) continue;
      const auto& frame = past[past.size() - static_cast<std::size_t>(term.lag)];
      const float c = coefficient(i), *from = frame.ptr<float>(y + term.y) + reach + term.x;
      for (int x = 0; x < width; ++x) row[x] += c * from[x];
    }
  }
}

// s of the next frame, all planes; `noise` holds a(x, y) inside its borders.
cv::Mat step(const Star& star, const std::vector<cv::Mat>& past, cv::Mat noise) {
  const int channels = star.info.channels, reach = reach_of(star);
  core::parallel_for(static_cast<std::size_t>(channels), {}, [&](std::size_t c) {
    std::vector<cv::Mat> planes;
    for (const auto& frame : past) planes.push_back(plane(frame, static_cast<int>(c), channels));
    step_plane(star, reach, planes, plane(noise, static_cast<int>(c), channels));
  });
  return noise;
}

cv::Mat without_mean(const Star& star, const cv::Mat& levels, int reach) {
  const int channels = star.info.channels;
  cv::Mat out = padded(levels.size(), channels, reach);
  for (int y = 0; y < levels.rows; ++y)
    for (int x = 0; x < levels.cols; ++x)
      for (int c = 0; c < channels; ++c) {
        const auto i = (static_cast<Eigen::Index>(y) * levels.cols + x) * channels + c;
        plane(out, c, channels).at<float>(y + reach, x + reach) =
            levels.ptr<float>(y)[x * channels + c] - star.mean(i);
      }
  return out;
}

cv::Mat with_mean(const Star& star, const cv::Mat& planes, int reach) {
  const int channels = star.info.channels;
  cv::Mat out(star.info.height, star.info.width, CV_MAKETYPE(CV_32F, channels));
  for (int c = 0; c < channels; ++c) {
    const cv::Mat from = plane(planes, c, channels);
    for (int y = 0; y < out.rows; ++y)
      for (int x = 0; x < out.cols; ++x) {
        const auto i = (static_cast<Eigen::Index>(y) * out.cols + x) * channels + c;
        out.ptr<float>(y)[x * channels + c] = star.mean(i) + from.at<float>(y + reach, x + reach);
      }
  }
  return out;
}

// Draws noise row by row, each from a stream of its own.
cv::Mat draw_noise(const Star& star, int reach, std::uint64_t seed, std::uint32_t frame) {
  const int channels = star.info.channels;
  cv::Mat out = padded({star.info.width, star.info.height}, channels, reach);
  core::parallel_for(static_cast<std::size_t>(star.info.height), {}, [&](std::size_t row) {
    core::Rng rng(seed, {frame, static_cast<std::uint32_t>(row), kStarNoise});
    Eigen::VectorXd white(channels);
    for (int x = 0; x < star.info.width; ++x) {
      for (auto& value : white) value = rng.normal();
      const Eigen::VectorXd a = star.noise * white;
      for (int c = 0; c < channels; ++c)
        plane(out, c, channels).at<float>(static_cast<int>(row) + reach, x + reach) =
            static_cast<float>(a(c));
    }
  });
  return out;
}

}  // namespace

int Star::lags() const {
  int most = 1;
  for (const auto& term : terms) most = std::max(most, term.lag);
  return most;
}

void StarOptions::validate() const {
  core::check_range("StarOptions.reach", reach, 1, 4);
  core::check_range("StarOptions.lags", lags, 1, 2);
}

std::vector<StarTerm> star_terms(const StarOptions& options) {
  options.validate();
  std::vector<StarTerm> terms;
  for (int lag = 0; lag <= options.lags; ++lag)
    for (int y = -options.reach; y <= options.reach; ++y)
      for (int x = -options.reach; x <= options.reach; ++x)
        if (lag > 0 || y < 0 || (y == 0 && x < 0)) terms.push_back({x, y, lag});
  return terms;
}

void validate(const Star& star) {
  const auto& info = star.info;
  if (info.width < 1 || info.height < 1 || (info.channels != 1 && info.channels != 3))
    throw core::InputError("STAR: a frame has at least 1x1 pixels of 1 or 3 channels");
  if (star.mean.size() != Eigen::Index{info.width} * info.height * info.channels)
    throw core::InputError("STAR: the mean has " + std::to_string(star.mean.size()) +
                           " values, the frame another number");
  if (star.coefficients.size() != static_cast<Eigen::Index>(star.terms.size()))
    throw core::InputError("STAR: there are " + std::to_string(star.terms.size()) + " terms and " +
                           std::to_string(star.coefficients.size()) + " coefficients");
  if (star.noise.rows() != info.channels || star.noise.cols() != info.channels)
    throw core::InputError("STAR: the noise is not a matrix of as many rows and columns as channels");
  if (!star.mean.allFinite() || !star.coefficients.allFinite() || !star.noise.allFinite())
    throw core::InputError("STAR: a number is not finite");
  for (const auto& term : star.terms) {
    const bool earlier = term.lag > 0 || term.y < 0 || (term.y == 0 && term.x < 0);
    if (!earlier || term.lag < 0 || term.lag > 2 || std::abs(term.x) > 16 || std::abs(term.y) > 16)
      throw core::InputError("STAR: the term (" + std::to_string(term.x) + ", " + std::to_string(term.y) +
                             ", lag " + std::to_string(term.lag) +
                             ") is no earlier neighbour within 16 px and 2 frames");
  }
}

double spectral_radius(const Star& star) {
  double radius = 0;
  detail::for_each_wave(star, [&](const detail::Wave& wave) {
    const auto root = std::sqrt(wave.first * wave.first + 4.0 * wave.second);
    radius = std::max({radius, std::abs((wave.first + root) / 2.0), std::abs((wave.first - root) / 2.0)});
  });
  return radius;
}

std::vector<cv::Mat> predict(const Star& star, std::span<const cv::Mat> past, int steps) {
  validate(star);
  const auto lags = static_cast<std::size_t>(star.lags());
  if (past.size() < lags || steps < 1)
    throw core::InputError("STAR: it predicts at least 1 step from at least " + std::to_string(lags) +
                           " frames; here are " + std::to_string(steps) + " and " +
                           std::to_string(past.size()));
  const int reach = reach_of(star);
  std::vector<cv::Mat> known, told;
  for (const auto& frame : past.last(lags)) {
    if (frame.size() != cv::Size(star.info.width, star.info.height) ||
        frame.type() != CV_MAKETYPE(CV_32F, star.info.channels))
      throw core::InputError("STAR: a frame is not of the model's size, or not levels of 32-bit floats");
    known.push_back(without_mean(star, frame, reach));
  }
  for (int i = 0; i < steps; ++i) {
    const cv::Mat next =
        step(star, known, padded({star.info.width, star.info.height}, star.info.channels, reach));
    told.push_back(with_mean(star, next, reach));
    known.erase(known.begin());
    known.push_back(next);
  }
  return told;
}

StarSynthesis::StarSynthesis(const Star& star, std::uint64_t seed) : star_(star), seed_(seed) {
  validate(star);
  const double radius = spectral_radius(star);
  if (!(radius < 1))
    throw core::InputError("STAR: the model is not stable, its spectral radius is " + std::to_string(radius) +
                           "; allowed is below 1");
  const auto lags = static_cast<std::size_t>(star.lags());
  past_.assign(lags, padded({star.info.width, star.info.height}, star.info.channels, reach_of(star)));
  for (int i = 0; i < kWarmUpFrames; ++i) next();
}

cv::Mat StarSynthesis::next() {
  const int reach = reach_of(star_);
  cv::Mat made = step(star_, past_, draw_noise(star_, reach, seed_, frame_++));
  past_.erase(past_.begin());
  past_.push_back(made);
  return core::to_bytes(with_mean(star_, made, reach));
}

}  // namespace emberfold::dytex
