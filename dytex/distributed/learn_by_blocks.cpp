// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <utility>

#include "core/error.hpp"
#include "dytex/distributed/distributed_job.hpp"
#include "dytex/distributed/stripe_products.hpp"
#include "dytex/learning/components.hpp"
#include "dytex/learning/decompositions.hpp"

namespace emberfold::dytex::detail {

namespace {

using Bytes = std::vector<std::byte>;

/// Number of strongest directions kept from block to block: enough that the rest is not missed.
Eigen::Index kept_directions(const LearnOptions& options) {
  constexpr Eigen::Index kSpare = 50, kForShare = 200;
  const Eigen::Index n = options.components;
  return options.energy ? kForShare : std::max(2 * n, n + kSpare);
}

/// Rank 0's record of a block: how its frames' directions became those of all frames up to then.
struct BlockMerge {
  Eigen::MatrixXd V;         ///< τ₂ × k₂, of the block alone
  Eigen::MatrixXd W;         ///< (k₁ + k₂ + 1) × k; of the first block k₂ × k
  Eigen::VectorXd singular;  ///< k, of all frames up to then, in the clip's values
  double squares = 0;        ///< of all frames up to then, less their mean
  Eigen::Index before = 0;   ///< τ₁
};

/// A rank's part of its stripes.
struct MergedStripes {
  StripeMeans means;
  StripeRows scores;  ///< U S, rows × k
};

void append(Bytes& bytes, const void* data, std::size_t size) {
  const auto* from = static_cast<const std::byte*>(data);
  bytes.insert(bytes.end(), from, from + size);
}

template <class Matrix>
void append_matrix(Bytes& bytes, const Matrix& matrix) {
  const std::int64_t shape[] = {matrix.rows(), matrix.cols()};
  append(bytes, shape, sizeof shape);
  append(bytes, matrix.data(), static_cast<std::size_t>(matrix.size()) * sizeof(typename Matrix::Scalar));
}

/// Reads the output of append(); throws IoError where there is less.
class KeptBytes {
 public:
  KeptBytes(StripeKeeper& keeper, const std::string& name) : name_(name) {
    auto kept = keeper.load(name);
    if (!kept) fail();
    bytes_ = std::move(*kept);
  }
  void take(void* to, std::size_t size) {
    if (bytes_.size() - at_ < size) fail();
    std::memcpy(to, bytes_.data() + at_, size);
    at_ += size;
  }
  template <class Matrix>
  Matrix matrix() {
    std::int64_t shape[2];
    take(shape, sizeof shape);
    const auto left = static_cast<std::int64_t>((bytes_.size() - at_) / sizeof(typename Matrix::Scalar));
    if (shape[0] < 0 || shape[1] < 0 || (shape[1] > 0 && shape[0] > left / shape[1])) fail();
    Matrix result(shape[0], shape[1]);
    take(result.data(), static_cast<std::size_t>(result.size()) * sizeof(typename Matrix::Scalar));
    return result;
  }

 private:
  [[noreturn]] void fail() const {
    throw core::IoError("what an earlier run kept is damaged (" + name_ + "): remove its folder");
  }
  std::string name_;
  Bytes bytes_;
  std::size_t at_ = 0;
};

std::string stripes_name(std::int64_t blocks, std::size_t stripe) {
  return "merged-" + std::to_string(blocks) + "-" + std::to_string(stripe);
}

std::string block_name(std::int64_t blocks) {
  return "block-" + std::to_string(blocks);
}

void save_stripes(const DistributedJob& job, const MergedStripes& merged, std::int64_t blocks) {
  for (const auto& [stripe, mean] : merged.means) {
    Bytes bytes;
    append_matrix(bytes, Eigen::MatrixXd(mean));
    append_matrix(bytes, merged.scores.at(stripe));
    job.keeper.save(stripes_name(blocks, stripe), bytes);
  }
}

MergedStripes load_stripes(const DistributedJob& job, std::int64_t blocks) {
  MergedStripes merged;
  for (std::size_t s = job.first_stripe(); s < job.end_stripe(); ++s) {
    KeptBytes kept(job.keeper, stripes_name(blocks, s));
    merged.means[s] = kept.matrix<Eigen::MatrixXd>();
    merged.scores[s] = kept.matrix<Eigen::MatrixXf>();
  }
  return merged;
}

void save_block(const DistributedJob& job, const BlockMerge& block, std::int64_t blocks) {
  Bytes bytes;
  append_matrix(bytes, block.V);
  append_matrix(bytes, block.W);
  append_matrix(bytes, Eigen::MatrixXd(block.singular));
  append(bytes, &block.squares, sizeof block.squares);
  append(bytes, &block.before, sizeof block.before);
  job.keeper.save(block_name(blocks), bytes);
}

BlockMerge load_block(const DistributedJob& job, std::int64_t blocks) {
  KeptBytes kept(job.keeper, block_name(blocks));
  BlockMerge block;
  block.V = kept.matrix<Eigen::MatrixXd>();
  block.W = kept.matrix<Eigen::MatrixXd>();
  block.singular = kept.matrix<Eigen::MatrixXd>();
  kept.take(&block.squares, sizeof block.squares);
  kept.take(&block.before, sizeof block.before);
  return block;
}

/// Frames of one block: this rank's stripes of them.
class BlockFrames {
 public:
  BlockFrames(const DistributedJob& job, std::size_t most) : job_(job) {
    together(job.ranks, [&] {
      for (std::size_t s = job.first_stripe(); s < job.end_stripe(); ++s)
        values_[s].resize(most * job.stripes.size(s) * job.rounds.value_bytes());
    });
  }

  /// Reads up to `most` frames from `first` on, in several rounds if needed; `ended` is
  /// set at the clip's end.
  std::size_t read(std::size_t first, std::size_t most, bool& ended) {
    std::size_t count = 0;
    while (count < most && !ended) {
      const std::size_t some = job_.rounds.next(
          first + count, most - count,
          [&](std::size_t stripe, std::size_t frame, std::span<const std::byte> bytes) {
            const std::size_t at = (frame - first) * job_.stripes.size(stripe) * job_.rounds.value_bytes();
            std::ranges::copy(bytes, values_.at(stripe).begin() + static_cast<std::ptrdiff_t>(at));
          },
          job_.context);
      ended = some == 0;
      count += some;
    }
    return count;
  }

  [[nodiscard]] FrameValues values(std::size_t stripe, std::size_t count) const {
    return stripe_values(job_, stripe, values_.at(stripe).data(), count);
  }

 private:
  const DistributedJob& job_;
  std::map<std::size_t, Bytes> values_;
};

/// Decomposes a block by itself: its means and scores; rank 0 also has V, and the squares of its frames.
MergedStripes decompose(const DistributedJob& job, const BlockFrames& frames, std::size_t count,
                        BlockMerge& block) {
  const auto values = [&](std::size_t stripe) { return frames.values(stripe, count); };
  MergedStripes result;
  result.means = stripe_means(job, count, values);
  const Eigen::MatrixXd gram = gram_of_stripes(job, count, values);
  together(job.ranks, [&] {
    if (!job.is_root()) return;
    const Spectrum found = spectrum(gram, 1, static_cast<Eigen::Index>(job.stripes.values()));
    const Eigen::Index kept = std::min(found.rank(), kept_directions(job.options));
    block.V = found.V.leftCols(kept);
    block.singular = found.singular.head(kept);
    block.squares = found.singular.squaredNorm();
  });
  broadcast_matrix(job.ranks, block.V);
  together(job.ranks, [&] {
    for (const auto& [stripe, mean] : result.means) {
      Eigen::MatrixXf& scores = result.scores[stripe];
      scores = Eigen::MatrixXf::Zero(mean.size(), block.V.cols());
      if (block.V.cols() > 0) make_components(values(stripe), 0, mean, block.V, scores, job.context);
    }
  });
  return result;
}

/// The strongest directions of columns from their Gram matrix, of which the lower half is read.
void take_directions(const Eigen::MatrixXd& products, Eigen::Index most, BlockMerge& block) {
  if (!products.triangularView<Eigen::Lower>().toDenseMatrix().allFinite())
    throw core::InputError("the clip has a value that is not finite");
  const SymmetricEigen eigen = symmetric_eigen(products);
  const double least = 8 * static_cast<double>(products.rows()) * std::numeric_limits<double>::epsilon() *
                       products.diagonal().maxCoeff();
  const Eigen::Index kept = std::min<Eigen::Index>((eigen.values.array() > least).count(), most);
  block.W = eigen.vectors.leftCols(kept);
  block.singular = eigen.values.head(kept).cwiseSqrt();
}

/// Merges a block into the result of the frames before it; `squares`: of those.
void merge(const DistributedJob& job, MergedStripes& merged, const MergedStripes& added, double squares,
           std::size_t count, BlockMerge& block) {
  const auto before = static_cast<double>(block.before), frames = static_cast<double>(count),
             all = before + frames;
  const auto scale = static_cast<float>(std::sqrt(before * frames / all));
  StripeRows steps;  // between the means, scaled
  together(job.ranks, [&] {
    for (const auto& [stripe, mean] : merged.means)
      steps[stripe] = (added.means.at(stripe) - mean).cast<float>() * scale;
  });
  const auto columns = [&](std::size_t stripe) {
    return SideBySide{&merged.scores.at(stripe), &added.scores.at(stripe), &steps.at(stripe)};
  };
  Eigen::Index width = 0;  // the same on all ranks; one without stripes does not know it
  width = broadcast_number(
      job.ranks,
      job.is_root() ? merged.scores.begin()->second.cols() + added.scores.begin()->second.cols() + 1 : 0);
  const Eigen::MatrixXd products = sum_stripes(job.ranks, job.stripes, width, width, false, true,
                                               [&](std::size_t stripe, Eigen::MatrixXd& sum) {
                                                 add_stripe_products(columns(stripe), sum, job.context);
                                               });
  together(job.ranks, [&] {
    if (!job.is_root()) return;
    take_directions(products, kept_directions(job.options), block);
    block.squares += squares + products(width - 1, width - 1);
  });
  broadcast_matrix(job.ranks, block.W);
  together(job.ranks, [&] {
    for (auto& [stripe, mean] : merged.means) {
      merged.scores.at(stripe) = product(columns(stripe), block.W, job.context);
      mean += (added.means.at(stripe) - mean) * (frames / all);
    }
  });
}

/// Returns the right singular vectors of all frames, from those of the blocks and their merges, last first.
Eigen::MatrixXd right_vectors(const std::vector<BlockMerge>& blocks, Eigen::Index frames) {
  const Eigen::Index kept = blocks.back().singular.size();
  Eigen::MatrixXd V(frames, kept), later = Eigen::MatrixXd::Identity(kept, kept);
  Eigen::RowVectorXd shift = Eigen::RowVectorXd::Zero(kept);  // of all frames before, by the steps of means
  for (auto block = blocks.rbegin(); block != blocks.rend(); ++block) {
    const Eigen::Index count = block->V.rows(), own = block->V.cols();
    if (block->before == 0) {
      V.topRows(count) = (block->V * (block->W * later)).rowwise() + shift;
      continue;
    }
    const auto before = static_cast<double>(block->before), some = static_cast<double>(count);
    const double size = std::sqrt(before * some / (before + some));
    const Eigen::RowVectorXd step = block->W.bottomRows(1) * later / size;
    V.middleRows(block->before, count) =
        (block->V * (block->W.middleRows(block->W.rows() - 1 - own, own) * later)).rowwise() +
        (shift + step * (before / (before + some)));
    shift -= step * (some / (before + some));
    later = block->W.topRows(block->W.rows() - 1 - own) * later;
  }
  return V;
}

/// The spectrum of all frames, and which of its directions had their sign changed against the scores.
struct WholeSpectrum {
  Spectrum spectrum;
  Eigen::VectorXd signs;
};

/// Treats directions that were not kept as equally strong.
WholeSpectrum whole_spectrum(const std::vector<BlockMerge>& blocks, Eigen::Index frames, double to_levels,
                             Eigen::Index values) {
  const BlockMerge& last = blocks.back();
  const Eigen::Index kept = last.singular.size(), others = std::min(frames - 1, values) - kept;
  WholeSpectrum whole{{Eigen::VectorXd::Zero(frames), right_vectors(blocks, frames)},
                      Eigen::VectorXd::Ones(kept)};
  Spectrum& result = whole.spectrum;
  result.singular.head(kept) = to_levels * last.singular;
  const double left = std::max(last.squares - last.singular.squaredNorm(), 0.0);
  if (others > 0 && kept > 0)
    result.singular.segment(kept, others)
        .setConstant(to_levels *
                     std::min(std::sqrt(left / static_cast<double>(others)), last.singular[kept - 1]));
  for (Eigen::Index i = 0; i < kept; ++i) {
    Eigen::Index largest = 0;
    result.V.col(i).cwiseAbs().maxCoeff(&largest);
    if (result.V(largest, i) >= 0) continue;
    result.V.col(i) *= -1;
    whole.signs[i] = -1;
  }
  return whole;
}

}  // namespace

DistributedResult learn_by_blocks(const DistributedJob& job, std::size_t block_frames) {
  DistributedResult result;
  Progress progress = load_progress(job);
  result.resumed = static_cast<std::size_t>(progress.frames);
  MergedStripes merged;
  std::vector<BlockMerge> blocks;  // on rank 0
  together(job.ranks, [&] {
    if (progress.blocks == 0) return;
    merged = load_stripes(job, progress.blocks);
    if (job.is_root())
      for (std::int64_t b = 1; b <= progress.blocks; ++b) blocks.push_back(load_block(job, b));
  });
  BlockFrames frames(job, block_frames);
  while (progress.ended == 0) {
    bool ended = false;
    const auto first = static_cast<std::size_t>(progress.frames);
    const std::size_t count = frames.read(first, block_frames, ended);
    if (count > 0) {
      BlockMerge block;
      block.before = progress.frames;
      MergedStripes added = decompose(job, frames, count, block);
      if (progress.blocks == 0) {
        block.W = Eigen::MatrixXd::Identity(block.V.cols(), block.V.cols());
        merged = std::move(added);
      } else {
        merge(job, merged, added, blocks.empty() ? 0 : blocks.back().squares, count, block);
      }
      progress.frames += static_cast<std::int64_t>(count), ++progress.blocks;
      together(job.ranks, [&] {
        save_stripes(job, merged, progress.blocks);
        if (!job.is_root()) return;
        save_block(job, block, progress.blocks);
        blocks.push_back(std::move(block));
      });
    }
    progress.ended = ended ? 1 : 0;
    save_progress(job, progress);
    together(job.ranks, [&] {
      if (count == 0) return;
      for (const auto& [stripe, mean] : merged.means)
        job.keeper.remove(stripes_name(progress.blocks - 1, stripe));
    });
    if (job.rounds.info().frames)
      job.context.report("comparing frames", static_cast<double>(progress.frames) /
                                                 static_cast<double>(*job.rounds.info().frames));
  }
  result.frames = static_cast<std::size_t>(progress.frames);
  FittedSpectra fitted;
  Eigen::MatrixXd weights;  // k × n: scores times it are C
  together(job.ranks, [&] {
    if (progress.frames < 2)
      throw core::InputError("the clip has " + std::to_string(progress.frames) +
                             (progress.frames == 1 ? " frame" : " frames") + ", at least 2 are needed");
    if (!job.is_root()) return;
    core::ClipInfo info = job.rounds.info();
    info.frames = progress.frames;
    check_count(job.options, progress.frames);
    const double to_levels = 255 / info.white;
    const auto [spectrum, signs] =
        whole_spectrum(blocks, progress.frames, to_levels, static_cast<Eigen::Index>(job.stripes.values()));
    fitted = fit_spectra({spectrum}, {}, info, job.options, job.context);
    const Eigen::Index n = fitted.result.texture.components();
    weights = Eigen::MatrixXd::Zero(signs.size(), n);
    for (Eigen::Index i = 0; i < n; ++i) weights(i, i) = signs[i] * to_levels / spectrum.singular[i];
  });
  broadcast_matrix(job.ranks, weights);
  job.context.report("making components", 0);
  StripeRows C;
  together(job.ranks, [&] {
    for (const auto& [stripe, scores] : merged.scores) C[stripe] = product({&scores}, weights, job.context);
  });
  finish_model(job, std::move(C), merged.means, fitted.result);
  result.learned = std::move(fitted.result);
  return result;
}

}  // namespace emberfold::dytex::detail
