// SPDX-License-Identifier: Apache-2.0
#include "mcmc/learning/stroke_statistics.hpp"

#include <cmath>
#include <numeric>
#include <vector>

#include "core/error.hpp"
#include "core/rng.hpp"
#include "tests/support/catch.hpp"

using namespace emberfold;
using namespace emberfold::mcmc;
using namespace emberfold::test;

namespace {

int poisson(double mean, core::Rng& rng) {
  double product = rng.uniform();
  int count = 0;
  for (const double limit = std::exp(-mean); product > limit; ++count) product *= rng.uniform();
  return count;
}

graph::Vertex patch_of(std::uint32_t id, std::uint32_t stroke, double x, double y) {
  graph::Vertex v;
  v.id = {id}, v.subgraph = {stroke};
  v.patch.position = {x, y};
  v.patch.width = 2;
  return v;
}

}  // namespace

TEST_CASE("the series of a clip count its strokes and their ends and lengths") {
  graph::MotionGraph motion;
  motion.sketch.width = 50, motion.sketch.height = 50;
  // Stroke 1 (3-4-5 triangle's side: 5 px, in all frames), stroke 2 in the first two.
  std::uint32_t id = 0;
  for (int t = 0; t < 4; ++t) {
    std::vector<graph::Vertex> vertices{patch_of(id, 1, 10, 10), patch_of(id + 1, 1, 13, 14)};
    std::vector<graph::Edge> edges{{{id}, {id + 1}}};
    if (t < 2) vertices.push_back(patch_of(id + 2, 2, 30, 30));
    id += 3;
    motion.sketch.frames.emplace_back(vertices, edges);
  }
  motion.links.resize(4);
  const std::vector<graph::Event> events{{2, graph::EventType::death, {30, 30}, 1, {{2}}, {}}};
  const auto series = mcmc::stroke_series(motion, events);
  CHECK(series.strokes == std::vector<double>{2, 2, 1, 1});
  CHECK(series.ended == std::vector<double>{0, 1, 0, 0});
  CHECK(series.length == std::vector<double>{5, 5, 5, 5});
  CHECK(series.events[static_cast<std::size_t>(graph::EventType::death)] == std::vector<double>{0, 1, 0});
  const auto told = stroke_statistics(series);
  CHECK(told.lifetime.mean == 5);  // five stroke-frames in which one stroke ended
  CHECK_THAT(told.length.mean, WithinAbs(20.0 / 6, 1e-12));
  CHECK_THAT(told.events_a_frame[static_cast<std::size_t>(graph::EventType::death)].mean,
             WithinAbs(1.0 / 3, 1e-12));
  CHECK(told.strokes_a_frame == 1.5);
}

TEST_CASE("a mean count lies in its interval as often as is told") {
  // Independent counts, and counts whose rate itself changes slowly by chance.
  for (const bool bursts : {false, true})
    for (const double rate : {0.05, 0.6}) {
      core::Rng rng(17);
      constexpr int kClips = 600, kFrames = 240;
      int within = 0;
      double width = 0;
      for (int clip = 0; clip < kClips; ++clip) {
        std::vector<double> counts;
        double state = rng.normal();
        for (int t = 0; t < kFrames; ++t) {
          state = 0.9 * state + std::sqrt(1 - 0.81) * rng.normal();
          counts.push_back(poisson(bursts ? rate * std::exp(0.7 * state - 0.245) : rate, rng));
        }
        const auto told = mean_count(counts);
        within += told.low <= rate && rate <= told.high ? 1 : 0;
        width += (told.high - told.low) / kClips;
      }
      INFO("bursts " << bursts << ", rate " << rate << ": " << within << " of " << kClips << ", width "
                     << width);
      // Eight blocks hardly see bursts of ten frames whole.
      CHECK(within >= (bursts ? 0.88 : 0.93) * kClips);
      CHECK(within < kClips);
      if (!bursts) CHECK(width < 2 * 2 * 1.96 * std::sqrt(rate / kFrames));
    }
  const auto none = mean_count(std::vector<double>(100, 0.0));
  CHECK(none.mean == 0);
  CHECK(none.low == 0);
  CHECK_THAT(none.high, WithinAbs(0.0251, 1e-3));  // χ²₁(0.975)/2/100
  CHECK_THROWS_AS(mean_count({}), core::InputError);
}

TEST_CASE("a mean life lies in its interval as often as is told") {
  // Strokes are born at a rate and die at another: of each in a frame a share ends.
  core::Rng rng(5);
  constexpr int kClips = 400, kFrames = 250;
  constexpr double kLife = 12;
  int within = 0;
  for (int clip = 0; clip < kClips; ++clip) {
    std::vector<double> strokes, ended;
    int now = poisson(15, rng);
    for (int t = 0; t < kFrames; ++t) {
      int ends = 0;
      for (int i = 0; i < now; ++i) ends += rng.uniform() < 1 / kLife ? 1 : 0;
      strokes.push_back(now), ended.push_back(ends);
      now += poisson(15 / kLife, rng) - ends;
    }
    const auto told = mean_ratio(strokes, ended);
    within += told.low <= kLife && kLife <= told.high ? 1 : 0;
  }
  INFO(within << " of " << kClips);
  CHECK(within >= 0.91 * kClips);
  CHECK(within < kClips);
}

TEST_CASE("ratios of too little are told as unknown") {
  const std::vector<double> one(5, 1.0), none(5, 0.0), long_one(4, 1.0);
  CHECK(mean_ratio(one, none).mean == 0);
  const auto few = mean_ratio(one, one);
  CHECK(few.mean == 1);
  CHECK(std::isinf(few.high));
  CHECK_THROWS_AS(mean_ratio(one, long_one), core::InputError);
  CHECK_THROWS_AS(stroke_statistics({}), core::InputError);
}
