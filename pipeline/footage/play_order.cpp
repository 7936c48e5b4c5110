// SPDX-License-Identifier: Apache-2.0
#include "pipeline/footage/play_order.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>

#include "core/rng.hpp"

namespace emberfold::pipeline {

namespace {

constexpr std::uint32_t kOrderStream = 0x6a756d70;  // of the random stream
constexpr int kShortestRun = 20;                    // frames before a jump, fewer in short footages
constexpr int kSpan = 60;                           // frames, at most half of the footage: longest useful run
constexpr double kChoice = 0.3;          // excess over the best squared cost that divides weights by e
constexpr int kLongestTurn = 10;         // half of the frames that a jump may take
constexpr double kTurn = 4;              // half of the frames of a jump at twice the usual change
constexpr double kLike = 4;              // cost over the usual change, up to which moments are similar
constexpr double kLeastRoom = 0.05;      // minimum share of a span left after a jump
constexpr int kFirstPart = 8;            // part of the footage in which an order begins
constexpr std::size_t kMostJumps = 200;  // that are compared with other plays
constexpr std::array kLaterOn = {1, 7, 13, 19};  // frames after a jump that are compared with other plays

int shortest_run(int frames) {
  return std::min(kShortestRun, std::max(1, frames / 5));
}

}  // namespace

PlayOrder::PlayOrder(LikeMoments moments, PlayOrderOptions options)
    : moments_(std::move(moments)),
      options_(std::move(options)),
      played_(static_cast<std::size_t>(moments_.frames)) {
  if (options_.loop)
    close_loop(*options_.loop);
  else
    begin_first_run();
}

/// Begins early, or with the first frame where no jump is possible and the footage is played to its end.
void PlayOrder::begin_first_run() {
  const int begin = moments_.half, some = std::max(1, moments_.frames / kFirstPart - begin);
  core::Rng rng(options_.seed, {kOrderStream, 0});
  const int first = begin + static_cast<int>(rng.below(static_cast<std::uint32_t>(some)));
  add_run(first, first);
  if (find_jumps(runs_.front()).empty()) runs_.front().first = runs_.front().last = 0;
  if (!options_.beside) return;
  double least = std::numeric_limits<double>::infinity();
  for (int f = begin; f < moments_.frames * 3 / 4; ++f)
    if (const double cost = options_.beside(0, f); cost < least) {
      least = cost;
      runs_.front().first = runs_.front().last = f;
    }
}

void PlayOrder::add_run(int first, int last) {
  runs_.push_back({runs_.empty() ? 0 : runs_.back().end(), first, last, 0});
}

/// Sets the duration of the transition from a run to the next one, which begins with frame `next`. It takes
/// at most `room` frames of that run, to leave some for the run's own transition.
void PlayOrder::set_half(std::size_t run, int next, int room) {
  const auto& r = runs_[run];
  const double relative = double{moments_.cost(r.last, next)} / std::max(1e-6, moments_.change);
  const int wanted = std::clamp(static_cast<int>(std::lround(kTurn * (relative - 1))), 0, kLongestTurn);
  const int before = run == 0 ? 0 : runs_[run - 1].half;
  runs_[run].half =
      std::max(0, std::min({wanted, moments_.frames - 1 - r.last, next, r.length() - before, room}));
}

/// Returns the jumps from a run to frames similar to its end.
std::vector<PlayOrder::Jump> PlayOrder::find_jumps(const Run& run) const {
  const int n = moments_.frames, last_way_out = n - 1 - moments_.half;
  const int span = std::min(kSpan, std::max(1, n / 2));
  // Frames that were shown less are preferred: means over the spans after each frame.
  std::vector<double> sums{0}, shown;
  for (const int times : played_) sums.push_back(sums.back() + times);
  for (int b = 0; b < n; ++b) {
    const int seen = std::min(n - b, span);
    const auto first = sums.begin() + b;
    shown.push_back((first[seen] - *first) / seen);
  }
  std::vector<Jump> jumps;
  for (int a = std::min(run.first + shortest_run(n), last_way_out); a <= last_way_out; ++a)
    for (int b = 0; b < n; ++b) {
      const double cost{moments_.cost(a, b)};
      if (!(cost <= kLike * moments_.change)) continue;
      const double relative = cost / std::max(1e-6, moments_.best);
      const double again = 1 + shown[static_cast<std::size_t>(b)];
      const double room = std::clamp(double(last_way_out - b) / span, kLeastRoom, 1.0);
      const double length = std::clamp(double(a - run.first + 1) / span, 0.0, 1.0);
      jumps.push_back({a, b, relative * relative * again * again / (room * room * length)});
    }
  return jumps;
}

/// Keeps the best jumps and adds how well they fit next to the other plays.
void PlayOrder::add_neighbours_cost(const Run& run, std::vector<Jump>& jumps) const {
  if (!options_.beside) return;
  std::ranges::stable_sort(jumps, {}, &Jump::cost);
  jumps.resize(std::min(jumps.size(), kMostJumps));
  auto held = jumps;
  for (auto& jump : held)
    for (const int d : kLaterOn) {
      const int frame = std::min(jump.to + d, moments_.frames - 1);
      const double cost = options_.beside(run.begin + jump.from - run.first + 1 + d, frame);
      jump.cost += cost * cost / double(kLaterOn.size());
    }
  std::erase_if(held, [](const Jump& jump) { return !std::isfinite(jump.cost); });
  if (!held.empty()) jumps = std::move(held);
}

/// Plays on to the end, and from there backwards to the beginning.
void PlayOrder::turn_back() {
  const int n = moments_.frames;
  runs_.back().last = n - 1;
  if (n > 2) add_run(n - 2, 1);
  add_run(0, 0);
}

/// Decides where the last run ends and which run follows.
void PlayOrder::draw_run() {
  const auto before = runs_.size() - 1;
  auto jumps = find_jumps(runs_[before]);
  if (jumps.empty()) return turn_back();
  add_neighbours_cost(runs_[before], jumps);
  const double least = std::ranges::min(jumps, {}, &Jump::cost).cost;
  std::vector<double> weights;
  for (const auto& jump : jumps) weights.push_back(std::exp(-(jump.cost - least) / kChoice));
  core::Rng rng(options_.seed, {kOrderStream, static_cast<std::uint32_t>(runs_.size())});
  const auto& [a, b, cost] = jumps[rng.categorical(weights)];
  runs_[before].last = a;
  for (int t = runs_[before].first; t <= a; ++t) ++played_[static_cast<std::size_t>(t)];
  const int room = moments_.frames - 1 - moments_.half - b;
  set_half(before, b, (1 + std::min(shortest_run(moments_.frames), room)) / 2);
  add_run(b, b);
}

/// Plays a part of the footage forwards and back, as often as needed, unless the loop is longer than that.
bool PlayOrder::close_loop_backwards(int frames) {
  const int way = frames / 2;  // frames from one turning point to the other
  if (way < 1 || way > moments_.frames - 1) return false;
  const int first = (moments_.frames - 1 - way) / 2, last = first + way;
  add_run(first, last);
  // An odd loop shows the last frame twice.
  if (frames - way > 1) add_run(frames % 2 == 0 ? last - 1 : last, first + 1);
  return true;
}

/// Finds an order of that many frames that ends where it begins.
void PlayOrder::close_loop(int frames) {
  const int n = moments_.frames, begin = moments_.half, end = n - 1 - moments_.half;
  // A long enough footage takes one run and one jump, others equal runs.
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
  const double alike = kLike * moments_.change;
  if (!(best <= alike * alike * count) && close_loop_backwards(frames)) return;
  for (std::size_t i = 0; i < firsts.size(); ++i) add_run(firsts[i], firsts[i] + lengths[i] - 1);
  for (std::size_t i = 0; i < firsts.size(); ++i)
    set_half(i, firsts[(i + 1) % firsts.size()], lengths.back() / 2);
}

PlayedMoment PlayOrder::at(std::int64_t n) {
  const auto loop = options_.loop;
  if (loop) n = ((n + options_.shift) % *loop + *loop) % *loop;
  while (!loop && (runs_.size() < 2 || runs_[runs_.size() - 2].end() <= n)) draw_run();
  // The runs before and after the nearest jump.
  const auto behind = std::ranges::upper_bound(runs_, n, {}, &Run::begin);
  const auto i = static_cast<std::size_t>(behind - runs_.begin()) - 1;
  const Run& run = runs_[i];
  const auto turn = [&](std::size_t from, std::size_t to, std::int64_t d) {
    // `d` moments after the first one of run `to`; negative before it.
    const int place = static_cast<int>(d);
    return PlayedMoment{runs_[from].last + 1 + place, runs_[to].first + place, runs_[from].half, place};
  };
  const std::size_t before = i > 0 ? i - 1 : runs_.size() - 1, next = i + 1 < runs_.size() ? i + 1 : 0;
  if ((i > 0 || loop) && n - run.begin < runs_[before].half) return turn(before, i, n - run.begin);
  const bool decided = loop || i + 1 < runs_.size();
  if (decided && run.end() - n <= run.half) return turn(i, next, n - run.end());
  const int d = static_cast<int>(n - run.begin);
  return {run.last < run.first ? run.first - d : run.first + d};
}

bool PlayOrder::plays_back() const {
  return std::ranges::any_of(runs_, [](const Run& run) { return run.last < run.first; });
}

double PlayOrder::relative_cost() const {
  double sum = 0;
  int jumps = 0;
  for (std::size_t i = 0; i + 1 < runs_.size() + (options_.loop ? 1 : 0); ++i) {
    const float cost = moments_.cost(runs_[i].last, runs_[(i + 1) % runs_.size()].first);
    if (!std::isfinite(cost)) continue;
    sum += double{cost};
    ++jumps;
  }
  return jumps == 0 ? 0 : sum / jumps / std::max(1e-6, moments_.change);
}

}  // namespace emberfold::pipeline
