// SPDX-License-Identifier: Apache-2.0
#include "dytex/estimation/observations.hpp"

#include <string>
#include <vector>

#include "core/error.hpp"
#include "core/text/size_text.hpp"
#include "dytex/estimation/level_blocks.hpp"
#include "dytex/learning/decompositions.hpp"

namespace emberfold::dytex {

namespace {

constexpr std::size_t kBatch = 8;  // frames at a time

void check_sizes(const LinearDynamicTexture& texture, const core::ClipInfo& clip) {
  const core::ClipInfo& info = texture.info;
  if (clip.width == info.width && clip.height == info.height && clip.channels == info.channels) return;
  const auto text = [](const core::ClipInfo& of) {
    return core::size_text(of.width, of.height) + (of.channels == 3 ? " colour" : " grey");
  };
  throw core::InputError("the clip is " + text(clip) + ", the texture " + text(info));
}

/// The rows of C diag(weights), with their inverse noise.
detail::RowsOf rows_of(const LinearDynamicTexture& texture, double least_noise) {
  return [&texture, least_noise](Eigen::Index row, Eigen::Index rows) {
    detail::WeightedRows block;
    block.C = texture.C.middleRows(row, rows).cast<double>() * texture.weights.asDiagonal();
    block.inverse = texture.noise.size() == 0 ? Eigen::VectorXd::Constant(rows, texture.r).eval()
                                              : texture.noise.segment(row, rows).cast<double>().eval();
    block.inverse = block.inverse.cwiseMax(least_noise).cwiseInverse().eval();
    return block;
  };
}

/// The next frames of a source.
struct Batch {
  std::vector<cv::Mat> frames;
  detail::FrameValues values;
};
Batch next_batch(core::FrameSource& source, std::size_t first) {
  const core::ClipInfo& info = source.info();
  Batch batch;
  batch.values.depth = info.depth;
  batch.values.count = static_cast<std::size_t>(info.width) * static_cast<std::size_t>(info.height) *
                       static_cast<std::size_t>(info.channels);
  while (batch.frames.size() < kBatch) {
    cv::Mat frame = source.next();
    if (frame.empty()) break;
    if (frame.cols != info.width || frame.rows != info.height ||
        frame.type() != CV_MAKETYPE(info.depth, info.channels))
      throw core::IoError("frame " + std::to_string(first + batch.frames.size()) +
                          " has another size or type than the clip's");
    batch.frames.push_back(frame.isContinuous() ? frame : frame.clone());
    batch.values.frames.push_back(batch.frames.back().data);
  }
  return batch;
}

/// Cᵀ R⁻¹ y and yᵀ R⁻¹ y of a batch's frames, in the last columns of the result.
struct BatchSums {
  Eigen::MatrixXd vectors;
  Eigen::VectorXd squares;
};
BatchSums sums_of(const Batch& batch, std::size_t first, const LinearDynamicTexture& texture,
                  const detail::LevelScale& scale, const Missing& missing, const detail::RowsOf& rows_at,
                  const core::Context& context) {
  const auto count = static_cast<Eigen::Index>(batch.frames.size());
  const BatchSums none{Eigen::MatrixXd::Zero(texture.components(), count), Eigen::VectorXd::Zero(count)};
  std::vector<BatchSums> slabs(detail::kSumSlabs, none);
  detail::for_sum_blocks(
      texture.pixels(), context, [&](std::size_t slab, Eigen::Index row, Eigen::Index rows) {
        const detail::WeightedRows block = rows_at(row, rows);
        const Eigen::MatrixXd Y =
            detail::level_block(batch.values, 0, static_cast<std::size_t>(row), rows, first, scale, missing,
                                texture.mean.segment(row, rows).cast<double>());
        const Eigen::MatrixXd weighted = block.inverse.asDiagonal() * Y;
        slabs[slab].vectors += block.C.transpose() * weighted;
        slabs[slab].squares += weighted.cwiseProduct(Y).colwise().sum().transpose();
      });
  for (std::size_t s = 1; s < detail::kSumSlabs; ++s) {
    slabs[0].vectors += slabs[s].vectors;
    slabs[0].squares += slabs[s].squares;
  }
  return slabs[0];
}

/// Extends the n numbers that frames show to all N.
void widen(Observations& seen, Eigen::Index order) {
  const Eigen::Index n = seen.vectors.rows();
  if (n == order) return;
  seen.vectors.conservativeResize(order, Eigen::NoChange);
  seen.vectors.bottomRows(order - n).setZero();
  for (Eigen::MatrixXd& information : seen.information) {
    Eigen::MatrixXd wide = Eigen::MatrixXd::Zero(order, order);
    wide.topLeftCorner(n, n) = information;
    information = std::move(wide);
  }
}

}  // namespace

StateSpace state_space(const LinearDynamicTexture& texture) {
  return {texture.A, texture.B, Eigen::VectorXd::Zero(texture.order()),
          detail::symmetric_factor(stationary_covariance(texture.A, texture.B))};
}

Observations observe(const LinearDynamicTexture& texture, core::FrameSource& source, const Missing& missing,
                     const core::Context& context, double least_noise) {
  if (!(least_noise > 0)) throw core::InputError("least_noise must be above 0");
  validate(texture);
  check_sizes(texture, source.info());
  const detail::LevelScale scale{255 / source.info().white, static_cast<std::size_t>(source.info().channels)};
  const detail::RowsOf rows_at = rows_of(texture, least_noise);
  const double known = static_cast<double>(source.info().frames.value_or(0));
  std::vector<BatchSums> batches;
  std::size_t frames = 0;
  source.rewind();
  for (Batch batch = next_batch(source, 0); !batch.frames.empty(); batch = next_batch(source, frames)) {
    context.check();
    if (missing.any() && frames + batch.frames.size() > missing.frames())
      throw core::InputError("the mask has " + std::to_string(missing.frames()) + " frames, the clip more");
    batches.push_back(sums_of(batch, frames, texture, scale, missing, rows_at, context));
    frames += batch.frames.size();
    if (known > 0) context.report("observing", static_cast<double>(frames) / known);
  }
  if (frames == 0) throw core::InputError("the clip has no frames");
  missing.check_frames(frames);
  Observations result;
  result.vectors.resize(texture.components(), static_cast<Eigen::Index>(frames));
  result.squares.resize(static_cast<Eigen::Index>(frames));
  Eigen::Index at = 0;
  for (const BatchSums& batch : batches) {
    result.vectors.middleCols(at, batch.squares.size()) = batch.vectors;
    result.squares.segment(at, batch.squares.size()) = batch.squares;
    at += batch.squares.size();
  }
  detail::add_information(texture.pixels(), texture.components(), frames, scale, missing, rows_at, result,
                          context);
  widen(result, texture.order());
  return result;
}

StateGuess last_state(const Filtered& filtered) {
  if (filtered.step.empty()) throw core::InputError("last_state: nothing was filtered");
  return {filtered.states.rightCols(1),
          filtered.steps[static_cast<std::size_t>(filtered.step.back())].filtered};
}

StateGuess last_training_state(const LinearDynamicTexture& texture, double least_noise) {
  validate(texture);
  const Eigen::Index n = texture.components(), frames = texture.states.cols();
  Observations seen;  // covariances do not depend on what is seen
  seen.vectors = Eigen::MatrixXd::Zero(n, frames);
  seen.squares = Eigen::VectorXd::Zero(frames);
  detail::add_information(texture.pixels(), n, static_cast<std::size_t>(frames), {}, {},
                          rows_of(texture, least_noise), seen, {});
  widen(seen, texture.order());
  return {texture.states.rightCols(1), last_state(filter(state_space(texture), seen)).factor};
}

}  // namespace emberfold::dytex
