// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>

#include <opencv2/core/types.hpp>

#include "core/math/luma.hpp"
#include "core/parallel.hpp"
#include "dytex/distances/window_bands.hpp"
#include "dytex/distances/window_spectra.hpp"

namespace emberfold::dytex {

namespace {

// One octave in time: the energy of u·x is ūᵀ(R + iI)u, of waves that run the other way ūᵀ(R − iI)u, and of
// white noise of variance 1 `white`.
struct TimeBand {
  Eigen::MatrixXd R, I;  // n × n
  double white = 0;
};

std::array<TimeBand, detail::kTimeBands> time_bands(const LinearDynamicTexture& texture) {
  const Eigen::Index n = texture.components();
  std::array<TimeBand, detail::kTimeBands> bands;
  for (auto& band : bands) band.R = band.I = Eigen::MatrixXd::Zero(n, n);
  const auto& made = detail::window_transforms();
  const Eigen::MatrixXd cosine = made.time_cosine.cast<double>(), sine = made.time_sine.cast<double>();
  Eigen::MatrixXd lagged = stationary_covariance(texture.A, texture.B);  // E x(t + lag) x(t)ᵀ
  for (int lag = 0; lag < detail::kSegment; ++lag) {
    const Eigen::MatrixXd shown = lagged.topLeftCorner(n, n);
    const Eigen::MatrixXd even = shown + shown.transpose(), odd = shown - shown.transpose();
    const int rest = detail::kSegment - lag;
    for (Eigen::Index f = 0; f < cosine.cols(); ++f) {
      auto& band = bands[static_cast<std::size_t>(detail::time_band(static_cast<int>(f) + 1))];
      const auto c = cosine.col(f), s = sine.col(f);
      const double real = c.tail(rest).dot(c.head(rest)) + s.tail(rest).dot(s.head(rest));
      const double imaginary = s.tail(rest).dot(c.head(rest)) - c.tail(rest).dot(s.head(rest));
      band.R += (lag == 0 ? real / 2 : real) * even;
      band.I += imaginary * odd;
      if (lag == 0) band.white += real;
    }
    lagged = texture.A * lagged;
  }
  return bands;
}

// The luma of a window's components, 256 × n, and the variance of its noise, 256.
struct Window {
  Eigen::MatrixXf components;
  Eigen::VectorXf noise;
};

Window cut_window(const LinearDynamicTexture& texture, cv::Point corner) {
  constexpr int kPixels = detail::kWindow * detail::kWindow;
  const Eigen::Index channels = texture.info.channels;
  Window window{Eigen::MatrixXf::Zero(kPixels, texture.components()), Eigen::VectorXf::Zero(kPixels)};
  for (int y = 0; y < detail::kWindow; ++y) {
    const Eigen::Index row = (Eigen::Index{corner.y} + y) * texture.info.width + corner.x;
    for (int x = 0; x < detail::kWindow; ++x)
      for (Eigen::Index c = 0; c < channels; ++c) {
        const auto weight =
            static_cast<float>(channels == 3 ? core::kLumaWeights[static_cast<std::size_t>(c)] : 1);
        const Eigen::Index value = (row + x) * channels + c, pixel = y * detail::kWindow + x;
        window.components.row(pixel) += weight * texture.C.row(value);
        window.noise[pixel] +=
            weight * weight *
            (texture.noise.size() > 0 ? texture.noise[value] : static_cast<float>(texture.r));
      }
  }
  return window;
}

Eigen::VectorXd window_energies(const LinearDynamicTexture& texture, const Window& window,
                                const std::array<TimeBand, detail::kTimeBands>& bands) {
  const auto& made = detail::window_transforms();
  const Eigen::Index waves = made.space.rows() / 2;
  const Eigen::MatrixXd u = (made.space * window.components).cast<double>() * texture.weights.asDiagonal();
  const Eigen::VectorXd all =
      made.space.array().square().matrix().cast<double>() * window.noise.cast<double>();
  const Eigen::ArrayXd noise = (all.head(waves) + all.tail(waves)).array();
  const auto a = u.topRows(waves), b = u.bottomRows(waves);
  Eigen::VectorXd energies = Eigen::VectorXd::Zero(detail::kWindowBands);
  for (std::size_t octave = 0; octave < bands.size(); ++octave) {
    const auto& band = bands[octave];
    const Eigen::MatrixXd turned = u * band.R;
    const Eigen::ArrayXd both = turned.topRows(waves).cwiseProduct(a).rowwise().sum().array() +
                                turned.bottomRows(waves).cwiseProduct(b).rowwise().sum().array() +
                                band.white * noise;
    const Eigen::ArrayXd apart = 2 * (a * band.I).cwiseProduct(b).rowwise().sum().array();
    const int first = static_cast<int>(octave) * detail::kPatterns;
    for (Eigen::Index k = 0; k < waves; ++k) {
      const auto wave = static_cast<std::size_t>(k);
      // Rounding may give less than 0.
      energies[first + made.pattern[wave]] += std::max(0.0, both[k] + apart[k]);
      energies[first + made.turned[wave]] += std::max(0.0, both[k] - apart[k]);
    }
  }
  return energies;
}

}  // namespace

WindowSpectrum window_spectrum(const LinearDynamicTexture& texture) {
  const int width = texture.info.width, height = texture.info.height,
            step = detail::window_step(width, height);
  std::vector<cv::Point> corners;
  for (const int y : detail::window_starts(height, step))
    for (const int x : detail::window_starts(width, step)) corners.emplace_back(x, y);
  if (corners.empty() || texture.order() == 0) return std::nullopt;
  const auto bands = time_bands(texture);
  Eigen::MatrixXd energies(detail::kWindowBands, static_cast<Eigen::Index>(corners.size()));
  core::parallel_for(corners.size(), {}, [&](std::size_t i) {
    energies.col(static_cast<Eigen::Index>(i)) =
        window_energies(texture, cut_window(texture, corners[i]), bands);
  });
  return detail::mean_shares(energies, detail::least_energy());
}

std::vector<WindowSpectrum> window_spectra(std::span<const LinearDynamicTexture> models,
                                           const core::Context& context) {
  std::vector<WindowSpectrum> spectra;
  for (const auto& model : models) {
    context.check();
    spectra.push_back(window_spectrum(model));
  }
  return spectra;
}

}  // namespace emberfold::dytex
