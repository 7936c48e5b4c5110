// SPDX-License-Identifier: Apache-2.0
#include "dytex/learning/fitted_spectrum.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/error.hpp"
#include "dytex/learning/dynamics.hpp"

namespace emberfold::dytex::detail {

namespace {

// Largest over least singular value. Up to it C is made in single precision, which leaves some 4 digits.
constexpr double kFloatRange = 1e3;

Eigen::Index count_by_number(Eigen::Index asked, Eigen::Index rank, LearnResult& result) {
  if (rank < asked)
    result.notes.push_back("the frames change in " + std::to_string(rank) +
                           (rank == 1 ? " direction only, " : " directions only, ") + std::to_string(asked) +
                           " components were asked for: the model has " + std::to_string(rank));
  return std::min(rank, asked);
}

Eigen::Index count_by_energy(const Spectrum& spectrum, double share) {
  const double whole = spectrum.singular.squaredNorm();
  double sum = 0;
  Eigen::Index n = 0;
  while (n < spectrum.rank() && sum < share * whole) sum += std::pow(spectrum.singular[n++], 2);
  return n;
}

Eigen::Index count_by_rule(const Spectrum& spectrum, const Eigen::MatrixXd& gram, double to_levels,
                           Eigen::Index values, const LearnOptions& options, LearnResult& result) {
  if (options.order == Order::gavish_donoho)
    return std::clamp<Eigen::Index>(gavish_donoho(spectrum.singular, values), 1, spectrum.rank());
  result.held_out = held_out_errors(gram, to_levels, values);
  if (result.held_out.empty())
    throw core::InputError("order: to hold out a fifth of the frames takes a clip of at least 10, this has " +
                           std::to_string(gram.rows()));
  const auto least = std::min_element(result.held_out.begin(), result.held_out.end(),
                                      [](const auto& a, const auto& b) { return a.second < b.second; });
  return std::min<Eigen::Index>(least->first, spectrum.rank());
}

/// Returns the number of components, the strongest directions of the frames.
Eigen::Index count_components(const Spectrum& spectrum, const Eigen::MatrixXd& gram, Eigen::Index values,
                              double to_levels, const LearnOptions& options, LearnResult& result) {
  if (spectrum.rank() == 0) {
    result.notes.emplace_back("the frames do not change: the model is their mean, without components");
    return 0;
  }
  if (options.order != Order::given) return count_by_rule(spectrum, gram, to_levels, values, options, result);
  if (options.energy) return count_by_energy(spectrum, *options.energy);
  return count_by_number(options.components, spectrum.rank(), result);
}

/// Scales the noise where clips of the source's length would vary much more or less than the source.
void match_variance(LearnResult& result) {
  LinearDynamicTexture& texture = result.texture;
  const Eigen::Index n = texture.components(), frames = texture.states.cols();
  if (n == 0) return;
  const double drawn = variance_within(texture.A, texture.B, frames).head(n).sum();
  const double seen = texture.states.topRows(n).squaredNorm() / static_cast<double>(frames);
  const auto note = variance_note(drawn, seen);
  if (!note) return;
  result.notes.push_back(*note);
  if (!(drawn > 0)) return;
  texture.B *= std::sqrt(seen / drawn);
  result.notes.back() += ": its noise is scaled to the clip's variance";
}

/// The residual variance by its degrees of freedom: n directions of the frames and of time, and the mean, are
/// taken out of m × τ values.
double left_variance(const Spectrum& spectrum, Eigen::Index n, Eigen::Index values) {
  const Eigen::Index frames = spectrum.singular.size(), gaps = frames - 1 - n;
  if (gaps <= 0 || values <= n) return 0;
  return spectrum.singular.tail(frames - n).squaredNorm() /
         (static_cast<double>(values - n) * static_cast<double>(gaps));
}

void take_dynamics(Dynamics dynamics, LearnResult& result) {
  result.least_squares_radius = dynamics.least_squares_radius;
  result.transition = dynamics.transition;
  result.notes.insert(result.notes.end(), dynamics.notes.begin(), dynamics.notes.end());
  LinearDynamicTexture& texture = result.texture;
  texture.A = std::move(dynamics.A);
  texture.B = std::move(dynamics.B);
  texture.noise_share = dynamics.noise_share;
  texture.states = std::move(dynamics.states);
}

}  // namespace

void check_count(const LearnOptions& options, Eigen::Index frames) {
  if (options.order == Order::given && !options.energy && options.components > frames - 1)
    throw core::InputError("n is " + std::to_string(options.components) + "; a clip of " +
                           std::to_string(frames) + " frames has at most " + std::to_string(frames - 1) +
                           (frames == 2 ? " component" : " components"));
}

FittedSpectrum fit_spectrum(const Spectrum& spectrum, const Eigen::MatrixXd& gram, const core::ClipInfo& info,
                            const LearnOptions& options) {
  const Eigen::Index m = Eigen::Index{info.width} * info.height * info.channels;
  const double to_levels = 255 / info.white;
  FittedSpectrum fitted;
  LearnResult& result = fitted.result;
  LinearDynamicTexture& texture = result.texture;
  const Eigen::Index n = count_components(spectrum, gram, m, to_levels, options, result);
  const Eigen::VectorXd s = spectrum.singular.head(n);
  const Eigen::MatrixXd V = spectrum.V.leftCols(n);
  texture.info = info;
  texture.C.resize(0, n);
  texture.singular = spectrum.singular;
  texture.weights = Eigen::VectorXd::Ones(n);
  take_dynamics(fit_dynamics({s, V}, options), result);
  texture.r = left_variance(spectrum, n, m);
  match_variance(result);
  fitted.weights.resize(V.rows(), n);
  for (Eigen::Index k = 0; k < n; ++k) fitted.weights.col(k) = V.col(k) * (to_levels / s[k]);
  fitted.single = n == 0 || texture.singular[0] <= kFloatRange * texture.singular[n - 1];
  return fitted;
}

}  // namespace emberfold::dytex::detail
