// SPDX-License-Identifier: Apache-2.0
#include "pipeline/carried/life_again.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>

#include "mcmc/learning/stroke_places.hpp"
#include "pipeline/carried/hidden_place.hpp"

namespace emberfold::pipeline {

namespace {

using graph::Point;

constexpr int kLives = 4, kMostLives = 16;  // candidates compared; more only until one fits:
constexpr double kFits = 8;                 // grey levels; otherwise all would be where the frame is dark
constexpr int kPlaces = 16;                 // per candidate
constexpr double kJitter = 8;               // px, SD: from a stroke's place to that of its repetition
constexpr int kApart = 8;                   // frames between a stroke's life and its repetition, at least
constexpr double kCrowd = 30;               // grey levels of misfit for another stroke at its place
constexpr std::size_t kCompared = 10;       // patches whose surroundings are compared
constexpr int kAhead = 8;                   // frames, at most, from the birth to the second comparison

/// Returns the mean misfit over a stroke's patches at an age, grey levels, on the frame shown then.
double misfit_at(const SeenClip& clip, int shown, const StrokeLife& life, int age, Point offset) {
  const auto& graph = clip.graph(life.first + age);
  const auto& patches = life.patches[static_cast<std::size_t>(age)];
  double sum = 0;
  int count = 0;
  for (std::size_t k = 0; k < patches.size();
       k += std::max<std::size_t>(1, patches.size() / kCompared), ++count) {
    const auto& patch = graph.patch(patches[k]);
    const Point to = patch.position + offset;
    sum += unlikeness_around(clip, patch, to, shown, offset * -1, life.first + age);
    if (clip.occupied(shown, to)) sum += kCrowd;
  }
  return sum / std::max(1, count);
}

/// Returns the mean misfit of a stroke at its birth and half way through its life.
double misfit(const SeenClip& clip, int t, const StrokeLife& life, Point offset) {
  const int later = std::min(static_cast<int>(life.patches.size()) / 2, kAhead);
  return 0.5 * (misfit_at(clip, t, life, 0, offset) +
                misfit_at(clip, std::min(t + later, clip.size() - 1), life, later, offset));
}

}  // namespace

std::optional<LifeAgain> find_life_again(const SeenClip& clip, int t,
                                         const std::optional<mcmc::CellMap>& births, core::Rng& rng) {
  const auto& lives = clip.lives();
  if (lives.empty()) return std::nullopt;
  std::optional<LifeAgain> best;
  double least = std::numeric_limits<double>::infinity();
  for (int i = 0; i < kLives || (i < kMostLives && least > kFits); ++i) {
    const auto& life = lives[rng.below(static_cast<std::uint32_t>(lives.size()))];
    for (int j = 0; j < kPlaces; ++j) {
      Point offset{kJitter * rng.normal(), kJitter * rng.normal()};
      if (births)
        offset = mcmc::draw_place(*births, rng) -
                 mcmc::stroke_middle(clip.graph(life.first), life.patches.front());
      else if (std::abs(life.first - t) < kApart)
        continue;
      if (const double found = misfit(clip, t, life, offset); found < least) {
        least = found;
        best = LifeAgain{&life, offset};
      }
    }
  }
  return best;
}

}  // namespace emberfold::pipeline
