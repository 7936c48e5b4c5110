// SPDX-License-Identifier: Apache-2.0
#include "dytex/learn.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "core/error.hpp"
#include "core/text/check_range.hpp"
#include "dytex/learning/components.hpp"
#include "dytex/learning/dynamics.hpp"
#include "dytex/learning/frame_blocks.hpp"
#include "dytex/learning/gram.hpp"
#include "dytex/learning/model_order.hpp"

namespace emberfold::dytex {

namespace {

using detail::FrameBlocks;
using detail::FrameValues;
using detail::Spectrum;

constexpr int kMostLags = 16;  // bounds the order of A, n · lags
// Largest over least singular value. Up to it C is made in single precision, which leaves some 4 digits.
constexpr double kFloatRange = 1e3;

/// Sums over all frames, of the first reading.
struct FrameSums {
  std::vector<Eigen::MatrixXd> grams;  // of all channels, or one a channel
  Eigen::VectorXd mean;                // m
};

FrameSums accumulate_gram(FrameBlocks& frame_blocks, std::size_t channels, const core::Context& context) {
  FrameSums seen;
  const auto frames = static_cast<Eigen::Index>(frame_blocks.frames());
  seen.grams.assign(channels, Eigen::MatrixXd::Zero(frames, frames));
  seen.mean = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(frame_blocks.values()));
  const auto add = [&](std::size_t first, const FrameValues& values) {
    detail::add_sums(values, first, seen.mean, context);
    for (std::size_t c = 0; c < channels; ++c) {
      const FrameValues some = channels == 1 ? values : detail::channel_values(values, first, channels, c);
      detail::add_gram(some, seen.grams[c], context);
    }
  };
  frame_blocks.for_each("comparing frames", false, add, context);
  seen.mean /= static_cast<double>(frames);
  return seen;
}

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
    return std::clamp<Eigen::Index>(detail::gavish_donoho(spectrum.singular, values), 1, spectrum.rank());
  const auto errors = detail::held_out_errors(gram, to_levels, values);
  if (errors.empty())
    throw core::InputError("order: to hold out a fifth of the frames takes a clip of at least 10, this has " +
                           std::to_string(gram.rows()));
  if (result.held_out.empty()) result.held_out = errors;
  const auto least = std::min_element(errors.begin(), errors.end(),
                                      [](const auto& a, const auto& b) { return a.second < b.second; });
  return std::min<Eigen::Index>(least->first, spectrum.rank());
}

std::vector<Direction> choose(const std::vector<Spectrum>& spectra, const FrameSums& seen, double to_levels,
                              const LearnOptions& options, LearnResult& result) {
  std::vector<Direction> all = directions(spectra);
  if (all.empty()) {
    result.notes.emplace_back("the frames do not change: the model is their mean, without components");
    return all;
  }
  if (options.order != Order::given) {
    const Eigen::Index values = seen.mean.size() / static_cast<Eigen::Index>(spectra.size());
    std::vector<Eigen::Index> counts;
    for (std::size_t s = 0; s < spectra.size(); ++s)
      counts.push_back(count_by_rule(spectra[s], seen.grams[s], to_levels, values, options, result));
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
std::vector<detail::Block> blocks_of(const std::vector<Spectrum>& spectra,
                                     const std::vector<Direction>& chosen) {
  std::vector<detail::Block> blocks(spectra.size());
  for (std::size_t place = 0; place < chosen.size(); ++place)
    blocks[chosen[place].spectrum].places.push_back(static_cast<Eigen::Index>(place));
  for (std::size_t s = 0; s < spectra.size(); ++s) {
    const auto n = static_cast<Eigen::Index>(blocks[s].places.size());
    blocks[s].s = spectra[s].singular.head(n);
    blocks[s].V = spectra[s].V.leftCols(n);
  }
  return blocks;
}

/// The columns of V S⁻¹ that make C out of the frames' values, in the order of the components.
Eigen::MatrixXd component_weights(const std::vector<detail::Block>& blocks, Eigen::Index n,
                                  double to_levels) {
  Eigen::MatrixXd weights(blocks[0].V.rows(), n);
  for (const detail::Block& block : blocks)
    for (std::size_t i = 0; i < block.places.size(); ++i) {
      const auto k = static_cast<Eigen::Index>(i);
      weights.col(block.places[i]) = block.V.col(k) * (to_levels / block.s[k]);
    }
  return weights;
}

void make_C(FrameBlocks& frame_blocks, const FrameSums& seen, const Eigen::MatrixXd& weights, bool single,
            LinearDynamicTexture& texture, const core::Context& context) {
  const char* stage = "making components";
  if (single) frame_blocks.release();  // before C takes its place
  texture.C = Eigen::MatrixXf::Zero(seen.mean.size(), weights.cols());
  const auto add = [&](std::size_t first, const FrameValues& values) {
    const auto t = static_cast<Eigen::Index>(first), count = static_cast<Eigen::Index>(values.frames.size());
    detail::add_components(values, 0, seen.mean, weights.middleRows(t, count), texture.C, context);
  };
  const auto make = [&](std::size_t first, const FrameValues& values) {
    detail::make_components(values, first, seen.mean, weights, texture.C, context);
  };
  if (weights.cols() == 0) return;
  if (single)
    frame_blocks.for_each_batch(stage, detail::kBatch, add, context);
  else
    frame_blocks.for_each(stage, true, make, context);
  if (texture.channels.size() > 0)
    detail::keep_channels(texture.channels, texture.info.channels, texture.C, context);
  detail::orthonormalise(texture.C, context);
}

/// Scales the noise where clips of the source's length would vary much more or less than the source.
void match_variance(LearnResult& result) {
  LinearDynamicTexture& texture = result.texture;
  const Eigen::Index n = texture.components(), frames = texture.states.cols();
  if (n == 0) return;
  const double drawn = detail::variance_within(texture.A, texture.B, frames).head(n).sum();
  const double seen = texture.states.topRows(n).squaredNorm() / static_cast<double>(frames);
  const auto note = detail::variance_note(drawn, seen);
  if (!note) return;
  result.notes.push_back(*note);
  if (!(drawn > 0)) return;
  texture.B *= std::sqrt(seen / drawn);
  result.notes.back() += ": its noise is scaled to the clip's variance";
}

/// The variance that the components leave, by its degrees of freedom: n directions of the frames and of time,
/// and the mean, are taken out of m × τ values.
double left_variance(const std::vector<Spectrum>& spectra, const std::vector<detail::Block>& blocks,
                     Eigen::Index m) {
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

void take_dynamics(detail::Dynamics dynamics, LearnResult& result) {
  result.least_squares_radius = dynamics.least_squares_radius;
  result.transition = dynamics.transition;
  result.notes.insert(result.notes.end(), dynamics.notes.begin(), dynamics.notes.end());
  LinearDynamicTexture& texture = result.texture;
  texture.A = std::move(dynamics.A);
  texture.B = std::move(dynamics.B);
  texture.residuals = std::move(dynamics.residuals);
  texture.marginals = std::move(dynamics.marginals);
  texture.noise_share = dynamics.noise_share;
  texture.states = std::move(dynamics.states);
}

void check_count(const LearnOptions& options, Eigen::Index frames) {
  if (options.order == Order::given && !options.energy && options.components > frames - 1)
    throw core::InputError("n is " + std::to_string(options.components) + "; a clip of " +
                           std::to_string(frames) + " frames has at most " + std::to_string(frames - 1) +
                           (frames == 2 ? " component" : " components"));
}

}  // namespace

void LearnOptions::validate() const {
  core::check_at_least("LearnOptions.components", components, 1);
  if (energy) core::check_above("LearnOptions.energy", *energy, 0, 1);
  core::check_range("LearnOptions.lags", lags, 1, kMostLags);
  if (order == Order::given && !energy)
    core::check_range("LearnOptions.noise_rank", noise_rank, 0, components);
  else
    core::check_at_least("LearnOptions.noise_rank", noise_rank, 0);
  if (lags > 1 && method != Method::closed_form)
    throw core::InputError("LearnOptions.lags is " + std::to_string(lags) +
                           "; allowed with n4sid and pem is 1");
  if (lags > 1 && stable == Stable::soc)
    throw core::InputError("LearnOptions.lags is " + std::to_string(lags) + "; allowed with soc is 1");
  core::check_at_least("LearnOptions.memory", static_cast<double>(memory), detail::kLeastMemory);
}

LearnResult learn(core::FrameSource& source, const LearnOptions& options, const core::Context& context) {
  options.validate();
  FrameBlocks frame_blocks(source, options.memory, detail::kMostFrames, context);
  const auto frames = static_cast<Eigen::Index>(frame_blocks.frames()),
             m = static_cast<Eigen::Index>(frame_blocks.values());
  check_count(options, frames);
  const bool separate = options.channels == Channels::separate && source.info().channels > 1;
  const FrameSums seen =
      accumulate_gram(frame_blocks, separate ? static_cast<std::size_t>(source.info().channels) : 1, context);
  const double to_levels = 255 / source.info().white;
  std::vector<Spectrum> spectra;
  for (const Eigen::MatrixXd& gram : seen.grams)
    spectra.push_back(detail::spectrum(gram, to_levels, m / static_cast<Eigen::Index>(seen.grams.size())));

  LearnResult result;
  LinearDynamicTexture& texture = result.texture;
  const std::vector<Direction> chosen = choose(spectra, seen, to_levels, options, result);
  const auto n = static_cast<Eigen::Index>(chosen.size());
  const std::vector<detail::Block> blocks = blocks_of(spectra, chosen);
  texture.info = source.info();
  texture.info.frames = frames;
  texture.singular = all_singular(spectra);
  texture.weights = Eigen::VectorXd::Ones(n);
  if (separate) {
    texture.channels.resize(n);
    for (Eigen::Index i = 0; i < n; ++i)
      texture.channels[i] = static_cast<int>(chosen[static_cast<std::size_t>(i)].spectrum);
  }
  take_dynamics(detail::fit_dynamics(blocks, options, context), result);
  texture.r = left_variance(spectra, blocks, m);
  const bool single = n == 0 || texture.singular[0] <= kFloatRange * texture.singular[n - 1];
  context.check();
  make_C(frame_blocks, seen, component_weights(blocks, n, to_levels), single, texture, context);
  texture.mean = (seen.mean * to_levels).cast<float>();
  match_variance(result);
  result.passes = frame_blocks.passes();
  return result;
}

}  // namespace emberfold::dytex
