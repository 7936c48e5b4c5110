// SPDX-License-Identifier: Apache-2.0
#include "pipeline/footage/play_order.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>

#include "core/rng.hpp"

namespace emberfold::pipeline {

namespace {

constexpr std::uint32_t kOrderStream = 0x6a756d70;  // of the random stream
constexpr int kShortestRun = 20, kLongestRun = 60;  // frames before a jump, less in short footages
constexpr double kChoice = 0.3;      // a jump's weight falls by e for so much more of the best squared cost
constexpr int kLongestTurn = 10;     // half of the frames that a jump takes
constexpr double kTurn = 4;          // half of the frames of a jump that costs twice the usual change
constexpr double kAgain = 0.5;       // what was shown once already costs so much more
constexpr double kLeastRoom = 0.05;  // weight of a jump to where the footage ends at once

int shortest_run(int frames) {
  return std::min(kShortestRun, std::max(1, frames / 5));
}
int longest_run(int frames) {
  return std::min(kLongestRun, std::max(1, frames / 2));
}

}  // namespace

PlayOrder::PlayOrder(LikeMoments moments, std::uint64_t seed, std::optional<int> loop)
    : moments_(std::move(moments)),
      seed_(seed),
      loop_(loop),
      played_(static_cast<std::size_t>(moments_.frames)) {
  const int n = moments_.frames, begin = moments_.half;
  core::Rng rng(seed_, {kOrderStream, 0});
  const int first =
      begin + static_cast<int>(rng.below(static_cast<std::uint32_t>(std::max(1, n / 3 - begin))));
  if (loop_)
    close_loop(*loop_);
  else
    add_run(first, first);
}

void PlayOrder::add_run(int first, int last) {
  runs_.push_back({runs_.empty() ? 0 : end(runs_.back()), first, last, 0});
}

/// Sets how long the turn from a run to the next one takes, which begins with frame `next`: at most
/// `room` frames of that, so that its own turn has some left.
void PlayOrder::set_half(std::size_t run, int next, int room) {
  const auto& r = runs_[run];
  const double relative = double{moments_.cost(r.last, next)} / std::max(1e-6, moments_.change);
  const int wanted = std::clamp(static_cast<int>(std::lround(kTurn * (relative - 1))), 0, kLongestTurn);
  const int before = run == 0 ? 0 : runs_[run - 1].half;
  const int length = r.last - r.first + 1;
  runs_[run].half =
      std::max(0, std::min({wanted, moments_.frames - 1 - r.last, next, length - before, room}));
}

/// Decides where the last run ends and which one follows.
void PlayOrder::draw_run() {
  auto& run = runs_.back();
  const int n = moments_.frames, last_way_out = n - 1 - moments_.half;
  const int from = std::min(run.first + shortest_run(n), last_way_out);
  const int to = std::min(run.first + longest_run(n), last_way_out);
  const double span = shortest_run(n) + longest_run(n);
  std::vector<double> costs;
  std::vector<std::pair<int, int>> jumps;
  for (int a = from; a <= to; ++a)
    for (int b = 0; b < n; ++b) {
      if (!std::isfinite(moments_.cost(a, b))) continue;
      const double room = std::clamp(2 * (last_way_out - b) / span, kLeastRoom, 1.0);
      // Where less was shown so far is the better way on.
      double shown = 0;
      for (int t = b; t < std::min(n, b + shortest_run(n)); ++t)
        shown += double(played_[static_cast<std::size_t>(t)]) / shortest_run(n);
      const double cost = double{moments_.cost(a, b)} / std::max(1e-6, moments_.best);
      costs.push_back(cost * cost * (1 + kAgain * shown) / room);
      jumps.emplace_back(a, b);
    }
  if (jumps.empty()) {  // too short a footage: over and over
    run.last = n - 1;
    add_run(0, 0);
    return;
  }
  const double least = *std::ranges::min_element(costs);
  for (auto& cost : costs) cost = std::exp(-(cost - least) / kChoice);
  core::Rng rng(seed_, {kOrderStream, static_cast<std::uint32_t>(runs_.size())});
  const auto [a, b] = jumps[rng.categorical(costs)];
  run.last = a;
  for (int t = run.first; t <= a; ++t) ++played_[static_cast<std::size_t>(t)];
  set_half(runs_.size() - 1, b, (1 + std::min(shortest_run(n), last_way_out - b)) / 2);
  add_run(b, b);
}

/// Finds an order of that many frames that ends where it begins.
void PlayOrder::close_loop(int frames) {
  const int n = moments_.frames, begin = moments_.half, end = n - 1 - moments_.half;
  // One run and one jump where the footage is long enough, else equal runs.
  const int most = std::max(1, end - begin + 1), count = (frames + most - 1) / most;
  std::vector<int> lengths(static_cast<std::size_t>(count), frames / count);
  for (int i = 0; i < frames % count; ++i) ++lengths[static_cast<std::size_t>(i)];
  const int length = lengths.front();
  const auto cost = [&](int last, int next) {
    const double found{moments_.cost(last, next)};
    return std::isfinite(found) ? found : 1e15;
  };
  // Jumps lead from the end of a run to the beginning of the next, the last one to the first run.
  std::vector<int> firsts;
  double best = std::numeric_limits<double>::infinity();
  for (int s = begin; s + length - 1 <= end; ++s) {
    std::vector<int> some = {s};
    double sum = 0;
    for (int i = 1; i < count; ++i) {
      const int last = some.back() + lengths[static_cast<std::size_t>(i - 1)] - 1;
      int next = begin;
      for (int b = begin; b + length - 1 <= end; ++b)
        if (cost(last, b) < cost(last, next)) next = b;
      sum += cost(last, next) * cost(last, next);
      some.push_back(next);
    }
    const double closing = cost(some.back() + lengths.back() - 1, s);
    sum += closing * closing;
    if (sum < best) {
      best = sum;
      firsts = std::move(some);
    }
  }
  for (std::size_t i = 0; i < firsts.size(); ++i) add_run(firsts[i], firsts[i] + lengths[i] - 1);
  for (std::size_t i = 0; i < firsts.size(); ++i)
    set_half(i, firsts[(i + 1) % firsts.size()], lengths.back() / 2);
}

PlayedMoment PlayOrder::at(std::int64_t n) {
  if (loop_) n = (n % *loop_ + *loop_) % *loop_;
  while (!loop_ && (runs_.size() < 2 || end(runs_[runs_.size() - 2]) <= n)) draw_run();
  // The runs before and behind the nearest jump.
  const auto behind = std::ranges::upper_bound(runs_, n, {}, &Run::begin);
  const auto i = static_cast<std::size_t>(behind - runs_.begin()) - 1;
  const Run& run = runs_[i];
  const auto turn = [&](std::size_t from, std::size_t to, std::int64_t d) {
    // `d` moments after the first one of run `to`, before it below 0.
    const int place = static_cast<int>(d);
    return PlayedMoment{runs_[from].last + 1 + place, runs_[to].first + place, runs_[from].half, place};
  };
  const std::size_t before = i > 0 ? i - 1 : runs_.size() - 1, next = i + 1 < runs_.size() ? i + 1 : 0;
  if ((i > 0 || loop_) && n - run.begin < runs_[before].half) return turn(before, i, n - run.begin);
  const bool decided = loop_ || i + 1 < runs_.size();
  if (decided && end(run) - n <= run.half) return turn(i, next, n - end(run));
  return {run.first + static_cast<int>(n - run.begin)};
}

double PlayOrder::relative_cost() const {
  double sum = 0;
  int jumps = 0;
  for (std::size_t i = 0; i + 1 < runs_.size() + (loop_ ? 1 : 0); ++i) {
    const float cost = moments_.cost(runs_[i].last, runs_[(i + 1) % runs_.size()].first);
    if (!std::isfinite(cost)) continue;
    sum += double{cost};
    ++jumps;
  }
  return jumps == 0 ? 0 : sum / jumps / std::max(1e-6, moments_.change);
}

}  // namespace emberfold::pipeline
