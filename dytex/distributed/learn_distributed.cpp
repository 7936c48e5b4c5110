// SPDX-License-Identifier: Apache-2.0
#include "dytex/distributed/learn_distributed.hpp"

#include <utility>

#include "core/error.hpp"
#include "core/text/check_range.hpp"
#include "dytex/distributed/distributed_job.hpp"
#include "dytex/learning/components.hpp"

namespace emberfold::dytex {

namespace {

constexpr std::size_t kMostAtOnce = 10'000;  // frames: a Gram matrix of 800 MB, decomposed in an hour
constexpr std::size_t kUsualBlock = 1024;    // frames: decomposed in seconds

void check_blocks(const LearnOptions& options) {
  if (options.order != Order::given)
    throw core::InputError(
        "order: a rule needs all frames at once; by blocks the number of components or "
        "their share of the variance is told");
}

}  // namespace

namespace detail {

DistributedResult learn_at_once(const DistributedJob& job, std::size_t most_frames) {
  DistributedResult result;
  Progress progress = load_progress(job);
  result.resumed = static_cast<std::size_t>(progress.frames);
  while (progress.ended == 0) {
    const auto first = static_cast<std::size_t>(progress.frames);
    const std::size_t count = job.rounds.next(
        first, most_frames + 1 - first,
        [&](std::size_t stripe, std::size_t frame, std::span<const std::byte> values) {
          job.keeper.put(stripe, frame * job.stripes.size(stripe) * job.rounds.value_bytes(), values);
        },
        job.context);
    progress.frames += static_cast<std::int64_t>(count);
    progress.ended = count == 0 ? 1 : 0;
    together(job.ranks, [&] {
      if (progress.frames > static_cast<std::int64_t>(most_frames))
        throw core::InputError("the clip has more than " + std::to_string(most_frames) +
                               " frames: learn.block tells how many are decomposed at a time");
      if (progress.ended != 0 && progress.frames < 2)
        throw core::InputError("the clip has " + std::to_string(progress.frames) +
                               (progress.frames == 1 ? " frame" : " frames") + ", at least 2 are needed");
    });
    save_progress(job, progress);
    if (job.rounds.info().frames)
      job.context.report(
          "reading", static_cast<double>(progress.frames) / static_cast<double>(*job.rounds.info().frames));
  }
  result.frames = static_cast<std::size_t>(progress.frames);
  const auto values = [&](std::size_t stripe) {
    const std::size_t size = result.frames * job.stripes.size(stripe) * job.rounds.value_bytes();
    return stripe_values(job, stripe, job.keeper.values(stripe, size).data(), result.frames);
  };
  job.context.report("comparing frames", 0);
  const StripeMeans means = stripe_means(job, result.frames, values);
  const Eigen::MatrixXd gram = gram_of_stripes(job, result.frames, values);
  FittedSpectra fitted;
  together(job.ranks, [&] {
    if (!job.is_root()) return;
    core::ClipInfo info = job.rounds.info();
    info.frames = progress.frames;
    check_count(job.options, progress.frames);
    const auto m = static_cast<Eigen::Index>(job.stripes.values());
    fitted = fit_spectra({spectrum(gram, 255 / info.white, m)}, {gram}, info, job.options, job.context);
  });
  broadcast_matrix(job.ranks, fitted.weights);
  fitted.single = broadcast_number(job.ranks, fitted.single ? 1 : 0) != 0;
  job.context.report("making components", 0);
  StripeRows C;
  together(job.ranks, [&] {
    for (const auto& [stripe, mean] : means) {
      Eigen::MatrixXf& rows = C[stripe];
      rows = Eigen::MatrixXf::Zero(mean.size(), fitted.weights.cols());
      if (fitted.weights.cols() == 0) continue;
      if (fitted.single)
        add_components(values(stripe), 0, mean, fitted.weights, rows, job.context);
      else
        make_components(values(stripe), 0, mean, fitted.weights, rows, job.context);
    }
  });
  finish_model(job, std::move(C), means, fitted.result);
  result.learned = std::move(fitted.result);
  return result;
}

}  // namespace detail

DistributedResult learn_distributed(Communicator& ranks, const SharedClip& clip, const LearnOptions& options,
                                    std::size_t block, StripeKeeper& keeper, const RowSink& rows,
                                    const core::Context& context) {
  const core::ClipInfo& info = clip.info;
  const auto values = static_cast<std::size_t>(info.width) * static_cast<std::size_t>(info.height) *
                      static_cast<std::size_t>(info.channels);
  const Stripes stripes(values, ranks.ranks());
  FrameRounds rounds(ranks, stripes, clip, options.memory);
  const bool by_blocks = block > 0 || info.frames.value_or(0) > static_cast<std::int64_t>(kMostAtOnce);
  if (by_blocks && block == 0) block = kUsualBlock;
  const detail::DistributedJob job{ranks, stripes, rounds, keeper, options, rows, context};
  together(ranks, [&] {
    options.validate();
    if (options.channels != Channels::joint && info.channels > 1)
      throw core::InputError("channels: learned by stripes are joint channels alone");
    if (by_blocks) check_blocks(options);
    const std::size_t own = stripes.begin(job.end_stripe()) - stripes.begin(job.first_stripe()),
                      frame = own * rounds.value_bytes();
    if (block > 0 && frame > 0 && options.memory / frame < block)
      throw core::InputError("learn.block is " + std::to_string(block) + "; on " +
                             std::to_string(ranks.ranks()) + (ranks.ranks() == 1 ? " rank " : " ranks ") +
                             std::to_string(options.memory >> 20) + " MiB of learn.memory hold at most " +
                             std::to_string(options.memory / frame) + " frames");
  });
  DistributedResult result =
      by_blocks ? detail::learn_by_blocks(job, block) : detail::learn_at_once(job, kMostAtOnce);
  result.block = block;
  result.decoded = rounds.decoded();
  return result;
}

}  // namespace emberfold::dytex
