// SPDX-License-Identifier: Apache-2.0
#include "dytex/learn.hpp"

#include <utility>
#include <vector>

#include "core/error.hpp"
#include "core/text/check_range.hpp"
#include "dytex/learning/components.hpp"
#include "dytex/learning/fitted_spectrum.hpp"
#include "dytex/learning/frame_blocks.hpp"
#include "dytex/learning/gram.hpp"
#include "dytex/learning/model_order.hpp"

namespace emberfold::dytex {

namespace {

using detail::FrameBlocks;
using detail::FrameValues;
using detail::Spectrum;

/// Sums over all frames, of the first pass.
struct FrameSums {
  Eigen::MatrixXd gram;
  Eigen::VectorXd mean;  // m
};

FrameSums accumulate_gram(FrameBlocks& frame_blocks, const core::Context& context) {
  const auto frames = static_cast<Eigen::Index>(frame_blocks.frames());
  FrameSums seen{Eigen::MatrixXd::Zero(frames, frames),
                 Eigen::VectorXd::Zero(static_cast<Eigen::Index>(frame_blocks.values()))};
  const auto add = [&](std::size_t first, const FrameValues& values) {
    detail::add_sums(values, first, seen.mean, context);
    detail::add_gram(values, seen.gram, context);
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
  detail::orthonormalise(texture.C, context);
}

}  // namespace

void LearnOptions::validate() const {
  core::check_fields("LearnOptions", *this);
  if (energy) core::check_above("LearnOptions.energy", *energy, 0, 1);
  if (order == Order::given && !energy)
    core::check_range("LearnOptions.noise_rank", noise_rank, 0, components);
  else
    core::check_at_least("LearnOptions.noise_rank", noise_rank, 0);
  core::check_at_least("LearnOptions.memory", static_cast<double>(memory), detail::kLeastMemory);
}

LearnResult learn(core::FrameSource& source, const LearnOptions& options, const core::Context& context) {
  options.validate();
  FrameBlocks frame_blocks(source, options.memory, detail::kMostFrames, context);
  const auto frames = static_cast<Eigen::Index>(frame_blocks.frames()),
             m = static_cast<Eigen::Index>(frame_blocks.values());
  detail::check_count(options, frames);
  const FrameSums seen = accumulate_gram(frame_blocks, context);
  const double to_levels = 255 / source.info().white;
  const Spectrum spectrum = detail::spectrum(seen.gram, to_levels, m);
  core::ClipInfo info = source.info();
  info.frames = frames;
  detail::FittedSpectrum fitted = detail::fit_spectrum(spectrum, seen.gram, info, options);
  LearnResult& result = fitted.result;
  context.check();
  make_C(frame_blocks, seen, fitted.weights, fitted.single, result.texture, context);
  result.texture.mean = (seen.mean * to_levels).cast<float>();
  result.passes = frame_blocks.passes();
  return std::move(result);
}

}  // namespace emberfold::dytex
