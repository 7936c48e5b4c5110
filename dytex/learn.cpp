// SPDX-License-Identifier: Apache-2.0
#include "dytex/learn.hpp"

#include <utility>
#include <vector>

#include "core/error.hpp"
#include "core/text/check_range.hpp"
#include "dytex/learning/components.hpp"
#include "dytex/learning/fitted_spectra.hpp"
#include "dytex/learning/frame_blocks.hpp"
#include "dytex/learning/gram.hpp"
#include "dytex/learning/model_order.hpp"

namespace emberfold::dytex {

namespace {

using detail::FrameBlocks;
using detail::FrameValues;
using detail::Spectrum;

constexpr int kMostLags = 16;  // bounds the order of A, n · lags

/// Sums over all frames, of the first pass.
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

void make_C(FrameBlocks& frame_blocks, const FrameSums& seen, const Eigen::MatrixXd& weights, bool single,
            LinearDynamicTexture& texture, const core::Context& context) {
  const char* stage = "making components";
  if (single) frame_blocks.release();  // before C needs its memory
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

}  // namespace

void LearnOptions::validate() const {
  core::check_fields("LearnOptions", *this);
  if (energy) core::check_above("LearnOptions.energy", *energy, 0, 1);
  core::check_range("LearnOptions.lags", lags, 1, kMostLags);
  if (order == Order::given && !energy)
    core::check_range("LearnOptions.noise_rank", noise_rank, 0, components);
  else
    core::check_at_least("LearnOptions.noise_rank", noise_rank, 0);
  if (lags > 1 && method != Method::closed_form)
    throw core::InputError("LearnOptions.lags is " + std::to_string(lags) + "; allowed with n4sid is 1");
  core::check_at_least("LearnOptions.memory", static_cast<double>(memory), detail::kLeastMemory);
}

LearnResult learn(core::FrameSource& source, const LearnOptions& options, const core::Context& context) {
  options.validate();
  FrameBlocks frame_blocks(source, options.memory, detail::kMostFrames, context);
  const auto frames = static_cast<Eigen::Index>(frame_blocks.frames()),
             m = static_cast<Eigen::Index>(frame_blocks.values());
  detail::check_count(options, frames);
  const bool separate = options.channels == Channels::separate && source.info().channels > 1;
  const FrameSums seen =
      accumulate_gram(frame_blocks, separate ? static_cast<std::size_t>(source.info().channels) : 1, context);
  const double to_levels = 255 / source.info().white;
  std::vector<Spectrum> spectra;
  for (const Eigen::MatrixXd& gram : seen.grams)
    spectra.push_back(detail::spectrum(gram, to_levels, m / static_cast<Eigen::Index>(seen.grams.size())));
  core::ClipInfo info = source.info();
  info.frames = frames;
  detail::FittedSpectra fitted = detail::fit_spectra(spectra, seen.grams, info, options);
  LearnResult& result = fitted.result;
  context.check();
  make_C(frame_blocks, seen, fitted.weights, fitted.single, result.texture, context);
  result.texture.mean = (seen.mean * to_levels).cast<float>();
  result.passes = frame_blocks.passes();
  return std::move(result);
}

}  // namespace emberfold::dytex
