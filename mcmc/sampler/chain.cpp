// SPDX-License-Identifier: Apache-2.0
#include "mcmc/sampler/chain.hpp"

#include <cmath>
#include <utility>

#include "core/parallel.hpp"
#include "mcmc/sampler/displacement_gibbs.hpp"

namespace emberfold::mcmc {

namespace {

constexpr int kApart = 6;  // frames: a move at t touches t … t + 1 and reads t − 2 … t + 3

// Streams of random numbers: the purpose is in the upper bits of a stream's last part, the chain in the lower
// ones.
enum Purpose : std::uint32_t { kMoves = 1U << 24U, kDisplacements = 2U << 24U };

double sum_of_weights(bool over_time) {
  double sum = 0;
  for (const Move& move : moves())
    if (move.over_time == over_time) sum += move.weight;
  return sum;
}

/// Returns the probabilities of the moves within a few frames, or of those over time.
std::vector<double> chances(bool over_time, bool last_frame) {
  std::vector<double> weights;
  double sum = 0;
  for (const Move& move : moves()) {
    weights.push_back(move.over_time != over_time || (last_frame && move.between_frames) ? 0 : move.weight);
    sum += weights.back();
  }
  for (double& w : weights) w /= sum;
  return weights;
}

}  // namespace

Chain::Chain(HiddenGraph state, const SamplerParameters& theta, std::uint64_t seed, std::uint32_t number)
    : state_(std::move(state)), density_(theta), seed_(seed), number_(number), counts_(moves().size()) {
  cache_.enable(state_);
  density_.prepare(state_);
  log_density_ = density_.total(state_);
}

void Chain::set_theta(const SamplerParameters& theta) {
  density_ = Density(theta);
  density_.prepare(state_);
  cache_.invalidate();
  log_density_.reset();
}

double Chain::log_density() {
  if (!log_density_) log_density_ = density_.total(state_);
  return *log_density_;
}

Chain::FrameTotals Chain::move_in(int frame, double proposals, bool over_time) {
  FrameTotals totals;
  totals.counts.resize(moves().size());
  const auto frames = static_cast<std::uint32_t>(state_.frames()), t = static_cast<std::uint32_t>(frame);
  const std::uint32_t part = over_time ? frames + t : t;
  core::Rng rng(seed_, {sweeps_, part, kMoves | number_});
  RandomChoices draws(rng);
  StateChange change(state_, density_, cache_, 2 * sweeps_ * frames + part);
  const auto weights = chances(over_time, t + 1 == frames);
  // As many moves as candidates, on or off: a number that depends on the state would bias the chain.
  const auto count = static_cast<std::size_t>(std::ceil(
      proposals * static_cast<double>(state_.active(frame).size() + state_.inactive(frame).size())));
  for (std::size_t n = 0; n < count; ++n) {
    const std::size_t which = draws.pick(weights);
    MoveCount& move = totals.counts[which];
    ++move.tried;
    const auto ratio = moves()[which].propose(change, draws, frame);
    if (!ratio) continue;
    ++move.evaluated;
    const double level = std::log1p(-draws.uniform());
    const double gain = change.gain(level - *ratio);
    if (level < gain + *ratio) {
      ++move.accepted;
      totals.gain += gain;
      change.commit();
    } else {
      change.rollback();
    }
  }
  return totals;
}

void Chain::sweep(double proposals, const core::Context& context) {
  move(proposals, context);
  redraw_displacements();
}

void Chain::move(double proposals, const core::Context& context) {
  std::vector<FrameTotals> frame_totals(static_cast<std::size_t>(state_.frames()));
  for (int colour = 0; colour < kApart; ++colour) {
    const int count = (state_.frames() - colour + kApart - 1) / kApart;
    core::parallel_for(static_cast<std::size_t>(std::max(0, count)), context, [&](std::size_t k) {
      const int frame = colour + static_cast<int>(k) * kApart;
      frame_totals[static_cast<std::size_t>(frame)] = move_in(frame, proposals, false);
    });
  }
  const double share = sum_of_weights(true) / sum_of_weights(false);
  for (int frame = 0; frame < state_.frames(); ++frame)
    frame_totals.push_back(move_in(frame, share * proposals, true));
  for (const FrameTotals& totals : frame_totals) {
    if (log_density_) *log_density_ += totals.gain;
    for (std::size_t m = 0; m < counts_.size(); ++m) counts_[m] += totals.counts[m];
  }
  ++sweeps_;
}

void Chain::redraw_displacements() {
  for (const auto& path : find_paths(state_)) {
    RandomChoices draws(core::Rng(seed_, {sweeps_, path[0], kDisplacements | number_}));
    draw_displacements(state_, density_, path, draws);
  }
  cache_.invalidate_arrivals();
  log_density_.reset();
}

}  // namespace emberfold::mcmc
