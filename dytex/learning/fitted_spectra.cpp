// SPDX-License-Identifier: Apache-2.0
#include "dytex/learning/fitted_spectra.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/error.hpp"
#include "dytex/learning/dynamics.hpp"

namespace emberfold::dytex::detail {

namespace {

// Largest over least singular value. Up to it C is made in single precision, which leaves some 4 digits.
constexpr double kFloatRange = 1e3;

/// A component: one spectrum's i-th direction.
struct Direction {
  std::size_t spectrum;
  Eigen::Index i;
};

/// All directions, the strongest first.
std::vector<Direction> directions(const std::vector<Spectrum>& spectra) {
  std::vector<Direction> result;
  for (std::size_t s = 0; s < spectra.size(); ++s)
    for (Eigen::Index i = 0; i < spectra[s].rank(); ++i) result.push_back({s, i});
  std::stable_sort(result.begin(), result.end(), [&](const Direction& a, const Direction& b) {
    return spectra[a.spectrum].singular[a.i] > spectra[b.spectrum].singular[b.i];
  });
  return result;
}

void take_first(std::vector<Direction>& all, Eigen::Index asked, LearnResult& result) {
  const auto rank = static_cast<Eigen::Index>(all.size());
  if (rank < asked)
    result.notes.push_back("the frames change in " + std::to_string(rank) +
                           (rank == 1 ? " direction only, " : " directions only, ") + std::to_string(asked) +
                           " components were asked for: the model has " + std::to_string(rank));
  all.resize(static_cast<std::size_t>(std::min(rank, asked)));
}

/// Number of directions of a spectrum that the rule takes.
Eigen::Index count_by_rule(const Spectrum& spectrum, const Eigen::MatrixXd& gram, double to_levels,
                           Eigen::Index values, const LearnOptions& options, LearnResult& result) {
  if (spectrum.rank() == 0) return 0;
  if (options.order == Order::gavish_donoho)
    return std::clamp<Eigen::Index>(gavish_donoho(spectrum.singular, values), 1, spectrum.rank());
  const auto errors = held_out_errors(gram, to_levels, values);
  if (errors.empty())
    throw core::InputError("order: to hold out a fifth of the frames takes a clip of at least 10, this has " +
                           std::to_string(gram.rows()));
  if (result.held_out.empty()) result.held_out = errors;
  const auto least = std::min_element(errors.begin(), errors.end(),
                                      [](const auto& a, const auto& b) { return a.second < b.second; });
  return std::min<Eigen::Index>(least->first, spectrum.rank());
}

std::vector<Direction> choose(const std::vector<Spectrum>& spectra, const std::vector<Eigen::MatrixXd>& grams,
                              Eigen::Index m, double to_levels, const LearnOptions& options,
                              LearnResult& result) {
  std::vector<Direction> all = directions(spectra);
  if (all.empty()) {
    result.notes.emplace_back("the frames do not change: the model is their mean, without components");
    return all;
  }
  if (options.order != Order::given) {
    const Eigen::Index values = m / static_cast<Eigen::Index>(spectra.size());
    std::vector<Eigen::Index> counts;
    for (std::size_t s = 0; s < spectra.size(); ++s)
      counts.push_back(count_by_rule(spectra[s], grams[s], to_levels, values, options, result));
    std::erase_if(all, [&](const Direction& d) { return d.i >= counts[d.spectrum]; });
  } else if (options.energy) {
    const auto variance = [&](const Direction& d) { return std::pow(spectra[d.spectrum].singular[d.i], 2); };
    double whole = 0, sum = 0;
    for (const Spectrum& spectrum : spectra) whole += spectrum.singular.squaredNorm();
    std::size_t n = 0;
    while (n < all.size() && sum < *options.energy * whole) sum += variance(all[n++]);
    all.resize(n);
  } else {
    take_first(all, options.components, result);
  }
  return all;
}

/// The chosen directions of each spectrum, and which components of the model they become.
std::vector<Block> blocks_of(const std::vector<Spectrum>& spectra, const std::vector<Direction>& chosen) {
  std::vector<Block> blocks(spectra.size());
  for (std::size_t place = 0; place < chosen.size(); ++place)
    blocks[chosen[place].spectrum].places.push_back(static_cast<Eigen::Index>(place));
  for (std::size_t s = 0; s < spectra.size(); ++s) {
    const auto n = static_cast<Eigen::Index>(blocks[s].places.size());
    blocks[s].s = spectra[s].singular.head(n);
    blocks[s].V = spectra[s].V.leftCols(n);
  }
  return blocks;
}

/// The columns of V S⁻¹ that make C of the frames' values, in the order of the components.
Eigen::MatrixXd component_weights(const std::vector<Block>& blocks, Eigen::Index n, double to_levels) {
  Eigen::MatrixXd weights(blocks[0].V.rows(), n);
  for (const Block& block : blocks)
    for (std::size_t i = 0; i < block.places.size(); ++i) {
      const auto k = static_cast<Eigen::Index>(i);
      weights.col(block.places[i]) = block.V.col(k) * (to_levels / block.s[k]);
    }
  return weights;
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
double left_variance(const std::vector<Spectrum>& spectra, const std::vector<Block>& blocks, Eigen::Index m) {
  const Eigen::Index frames = spectra[0].singular.size(),
                     values = m / static_cast<Eigen::Index>(spectra.size());
  double sum = 0, freedom = 0;
  for (std::size_t s = 0; s < spectra.size(); ++s) {
    const Eigen::Index n = blocks[s].s.size(), gaps = frames - 1 - n;
    if (gaps <= 0 || values <= n) continue;
    sum += spectra[s].singular.tail(frames - n).squaredNorm();
    freedom += static_cast<double>(values - n) * static_cast<double>(gaps);
  }
  return freedom > 0 ? sum / freedom : 0;
}

Eigen::VectorXd all_singular(const std::vector<Spectrum>& spectra) {
  std::vector<double> all;
  for (const Spectrum& spectrum : spectra)
    all.insert(all.end(), spectrum.singular.begin(), spectrum.singular.end());
  std::sort(all.begin(), all.end(), std::greater<>());
  return Eigen::Map<const Eigen::VectorXd>(all.data(), static_cast<Eigen::Index>(all.size()));
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

FittedSpectra fit_spectra(const std::vector<Spectrum>& spectra, const std::vector<Eigen::MatrixXd>& grams,
                          const core::ClipInfo& info, const LearnOptions& options) {
  const Eigen::Index m = Eigen::Index{info.width} * info.height * info.channels;
  const double to_levels = 255 / info.white;
  FittedSpectra fitted;
  LearnResult& result = fitted.result;
  LinearDynamicTexture& texture = result.texture;
  const std::vector<Direction> chosen = choose(spectra, grams, m, to_levels, options, result);
  const auto n = static_cast<Eigen::Index>(chosen.size());
  const std::vector<Block> blocks = blocks_of(spectra, chosen);
  texture.info = info;
  texture.C.resize(0, n);
  texture.singular = all_singular(spectra);
  texture.weights = Eigen::VectorXd::Ones(n);
  if (spectra.size() > 1) {
    texture.channels.resize(n);
    for (Eigen::Index i = 0; i < n; ++i)
      texture.channels[i] = static_cast<int>(chosen[static_cast<std::size_t>(i)].spectrum);
  }
  take_dynamics(fit_dynamics(blocks, options), result);
  texture.r = left_variance(spectra, blocks, m);
  match_variance(result);
  fitted.weights = component_weights(blocks, n, to_levels);
  fitted.single = n == 0 || texture.singular[0] <= kFloatRange * texture.singular[n - 1];
  return fitted;
}

}  // namespace emberfold::dytex::detail
