// SPDX-License-Identifier: Apache-2.0
#include "dytex/learning/learn_by_blocks.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "core/error.hpp"
#include "dytex/learning/components.hpp"
#include "dytex/learning/decompositions.hpp"
#include "dytex/learning/fitted_spectrum.hpp"
#include "dytex/learning/frame_blocks.hpp"
#include "dytex/learning/gram.hpp"
#include "dytex/learning/model_order.hpp"

namespace emberfold::dytex {

namespace {

using detail::FrameValues;
using Eigen::Index;

constexpr std::size_t kUsualBlock = 1024;                // frames: decomposed in seconds
constexpr Index kSpareDirections = 50, kForShare = 200;  // kept from block to block: the rest is not missed

/// Frames less their mean, Y ≈ U S Vᵀ, of which the strongest directions are kept.
struct SeenFrames {
  Eigen::VectorXd mean;      // m
  Eigen::MatrixXf scores;    // U S, m × k
  Eigen::MatrixXd V;         // τ × k
  Eigen::VectorXd singular;  // k, falling, in the clip's values
  double squares = 0;        // ‖Y‖²
};

Index kept_directions(const LearnOptions& options) {
  const Index n = options.components;
  return options.energy ? kForShare : std::max(2 * n, n + kSpareDirections);
}

void refuse_all_at_once(const LearnOptions& options) {
  if (options.order != Order::given)
    throw core::InputError(
        "order: a rule needs all frames at once; for blocks give the number of components "
        "or a share of the variance");
}

std::size_t frames_of_block(const core::ClipInfo& info, std::size_t memory, std::size_t asked) {
  const std::size_t fitting = memory / (detail::value_count(info) * CV_ELEM_SIZE1(info.depth));
  if (asked > fitting)
    throw core::InputError("learn.block is " + std::to_string(asked) + "; " + std::to_string(memory >> 20) +
                           " MiB for frames hold at most " + std::to_string(fitting));
  return asked > 0 ? asked : std::clamp<std::size_t>(fitting, 1, kUsualBlock);
}

/// Reads the next frames, at most `most`; `first` have been read before.
std::vector<cv::Mat> read_block(core::FrameSource& source, std::size_t first, std::size_t most,
                                const core::Context& context) {
  std::vector<cv::Mat> frames;
  while (frames.size() < most) {
    context.check();
    cv::Mat frame = detail::next_frame(source, first + frames.size());
    if (frame.empty()) break;
    frames.push_back(std::move(frame));
  }
  return frames;
}

/// Returns (Y − mean 1ᵀ) · weights, summed in double.
Eigen::MatrixXf weighted_sums(const FrameValues& Y, const Eigen::VectorXd& mean,
                              const Eigen::MatrixXd& weights, const core::Context& context) {
  Eigen::MatrixXf sums = Eigen::MatrixXf::Zero(mean.size(), weights.cols());
  if (weights.cols() > 0) detail::make_components(Y, 0, mean, weights, sums, context);
  return sums;
}

Eigen::MatrixXd gram_of(const FrameValues& Y, const core::Context& context) {
  const auto columns = static_cast<Index>(Y.frames.size());
  Eigen::MatrixXd gram = Eigen::MatrixXd::Zero(columns, columns);
  detail::add_gram(Y, gram, context);
  return gram;
}

SeenFrames decompose_block(const std::vector<cv::Mat>& frames, const core::ClipInfo& info, Index most,
                           const core::Context& context) {
  FrameValues values{{}, detail::value_count(info), info.depth};
  for (const cv::Mat& frame : frames) values.frames.push_back(frame.data);
  const auto m = static_cast<Index>(values.count);
  SeenFrames block;
  block.mean = Eigen::VectorXd::Zero(m);
  detail::add_sums(values, 0, block.mean, context);
  block.mean /= static_cast<double>(frames.size());
  const detail::Spectrum found = detail::spectrum(gram_of(values, context), 1, m);
  const Index kept = std::min(found.rank(), most);
  block.V = found.V.leftCols(kept);
  block.singular = found.singular.head(kept);
  block.squares = found.singular.squaredNorm();
  block.scores = weighted_sums(values, block.mean, block.V, context);
  return block;
}

/// Returns the strongest eigenvectors of a Gram matrix of which the lower half is read, and sets `singular`.
Eigen::MatrixXd strongest_directions(const Eigen::MatrixXd& gram, Index most, Eigen::VectorXd& singular) {
  if (!gram.allFinite()) throw core::InputError("the clip has a value that is not finite");
  const detail::SymmetricEigen eigen = detail::symmetric_eigen(gram);
  const double least = 8 * static_cast<double>(gram.rows()) * std::numeric_limits<double>::epsilon() *
                       gram.diagonal().maxCoeff();
  const Index kept = std::min<Index>((eigen.values.array() > least).count(), most);
  singular = eigen.values.head(kept).cwiseSqrt();
  return eigen.vectors.leftCols(kept);
}

/// Adds a block to the frames before it.
void merge_block(const SeenFrames& block, Index most, SeenFrames& seen, const core::Context& context) {
  const Index before = seen.V.rows(), added = block.V.rows(), k = seen.V.cols();
  const double all = static_cast<double>(before + added), share = static_cast<double>(added) / all,
               size = std::sqrt(static_cast<double>(before) * share);
  const Eigen::VectorXd step = block.mean - seen.mean;
  const Eigen::VectorXf last = (step * size).cast<float>();
  FrameValues M{{}, static_cast<std::size_t>(step.size()), CV_32F};
  for (const auto& column : seen.scores.colwise()) M.frames.push_back(column.data());
  for (const auto& column : block.scores.colwise()) M.frames.push_back(column.data());
  M.frames.push_back(last.data());
  const Eigen::MatrixXd gram = gram_of(M, context), W = strongest_directions(gram, most, seen.singular);
  const Eigen::RowVectorXd shift = W.bottomRows(1) / size;  // of V by a step of the mean
  Eigen::MatrixXd V(before + added, W.cols());
  V.topRows(before) = (seen.V * W.topRows(k)).rowwise() - shift * share;
  V.bottomRows(added) = (block.V * W.middleRows(k, block.V.cols())).rowwise() + shift * (1 - share);
  seen.V = std::move(V);
  seen.scores = weighted_sums(M, Eigen::VectorXd::Zero(step.size()), W, context);
  seen.mean += step * share;
  seen.squares += block.squares + gram.bottomRightCorner<1, 1>().value();
}

SeenFrames see_frames(core::FrameSource& source, std::size_t block, Index most,
                      const core::Context& context) {
  SeenFrames seen;
  source.rewind();
  for (std::size_t read = 0;;) {
    const std::vector<cv::Mat> frames = read_block(source, read, block, context);
    if (!frames.empty() && read == 0)
      seen = decompose_block(frames, source.info(), most, context);
    else if (!frames.empty())
      merge_block(decompose_block(frames, source.info(), most, context), most, seen, context);
    read += frames.size();
    if (const auto all = source.info().frames; all && *all > 0)
      context.report("comparing frames", static_cast<double>(read) / static_cast<double>(*all));
    if (frames.size() < block) return seen;
  }
}

/// Makes each direction's entry of largest size in V positive.
void fix_signs(SeenFrames& seen) {
  for (Index i = 0; i < seen.V.cols(); ++i) {
    Index largest = 0;
    seen.V.col(i).cwiseAbs().maxCoeff(&largest);
    if (seen.V(largest, i) >= 0) continue;
    seen.V.col(i) *= -1;
    seen.scores.col(i) *= -1;
  }
}

/// Returns the spectrum, in levels. Directions that were not kept count as equally strong.
detail::Spectrum whole_spectrum(const SeenFrames& seen, double to_levels) {
  const Index frames = seen.V.rows(), kept = seen.V.cols(),
              others = std::min(frames - 1, seen.mean.size()) - kept;
  detail::Spectrum result{Eigen::VectorXd::Zero(frames), seen.V};
  result.singular.head(kept) = to_levels * seen.singular;
  if (others <= 0 || kept == 0) return result;
  const double left = std::max(seen.squares - seen.singular.squaredNorm(), 0.0),
               each = std::sqrt(left / static_cast<double>(others));
  result.singular.segment(kept, others).setConstant(to_levels * std::min(each, seen.singular[kept - 1]));
  return result;
}

}  // namespace

bool needs_blocks(const core::ClipInfo& info) {
  return info.frames.value_or(0) > static_cast<std::int64_t>(detail::kMostFrames);
}

LearnResult learn_by_blocks(core::FrameSource& source, const LearnOptions& options, std::size_t block,
                            const core::Context& context) {
  options.validate();
  core::ClipInfo info = source.info();
  refuse_all_at_once(options);
  const std::size_t some = frames_of_block(info, options.memory, block);
  SeenFrames seen = see_frames(source, some, kept_directions(options), context);
  const Index frames = seen.V.rows();
  detail::check_least_frames(static_cast<std::size_t>(frames));
  detail::check_count(options, frames);
  fix_signs(seen);
  info.frames = frames;
  const double to_levels = 255 / info.white;
  LearnResult result = detail::fit_spectrum(whole_spectrum(seen, to_levels), {}, info, options).result;
  context.report("making components", 0);
  const Index n = result.texture.components();
  result.texture.C = seen.scores.leftCols(n);
  for (Index i = 0; i < n; ++i) result.texture.C.col(i) /= static_cast<float>(seen.singular[i]);
  detail::orthonormalise(result.texture.C, context);
  result.texture.mean = (seen.mean * to_levels).cast<float>();
  if (block == 0)
    result.notes.push_back("the clip is long: blocks of " + std::to_string(some) +
                           " frames were decomposed and merged");
  return result;
}

}  // namespace emberfold::dytex
